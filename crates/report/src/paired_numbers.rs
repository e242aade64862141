//! The numbers of two films side by side.

use magsplice::Film;
use magsplice::decouple::{PerAxis, PerParameter};
use magsplice::results::{FilmDecoupling, FilmEvaluation};

/// One of the decoupling errors of a film.
type ErrorOf = fn(&FilmDecoupling) -> PerParameter<Option<f64>>;
/// One of the decoupling errors of a film as a displacement.
type LengthOf = fn(&FilmDecoupling) -> PerAxis<Option<f64>>;

/// A number of both films.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct PairedNumber {
    /// What it is, with its unit.
    pub(crate) name: String,
    /// Its value for each film; `None` where there is none.
    pub(crate) values: [Option<f64>; 2],
}

const MT_PER_T: f64 = 1e3;

/// Error bounds by which a component of B must exceed zero, as in the figures.
const BOUNDS_OF_ZERO: f64 = 2.0;
const AXES: [&str; 3] = ["x", "y", "z"];
const PARAMETERS: [&str; 3] = ["R_x", "R_y", "S_z"];

/// The numbers that `decouple` prints, of both films.
pub(crate) fn numbers(films: [&Film; 2], evaluated: &[Option<FilmEvaluation>; 2]) -> Vec<PairedNumber> {
    let mut numbers = Vec::new();
    let tiles = films.map(|film| Some(film.layout().tiles.len() as f64));
    numbers.push(PairedNumber { name: "tiles".to_owned(), values: tiles });
    let mut add = |name: String, of: &dyn Fn(&FilmEvaluation) -> Option<f64>| {
        let values = evaluated.each_ref().map(|evaluation| evaluation.as_ref().and_then(of));
        numbers.push(PairedNumber { name, values });
    };
    for (i, axis) in AXES.into_iter().enumerate() {
        add(format!("B_{axis} at the reference point, mT"), &|e| {
            let (b_t, at_mm) = (e.decoupling.reference_field_t[i], e.decoupling.reference_mm);
            let bound_t = e.decoupling.film.scene().error_bounds_t(&[at_mm])[0];
            Some(if b_t.abs() <= BOUNDS_OF_ZERO * bound_t { 0.0 } else { MT_PER_T * b_t })
        });
    }
    for (i, axis) in AXES.into_iter().enumerate() {
        let of = |e: &FilmEvaluation| Some(MT_PER_T * e.comparison.component_rmse_t[i]);
        add(format!("RMSE of B_{axis} against the ideal film, mT"), &of);
    }
    for (i, axis) in AXES.into_iter().enumerate() {
        add(format!("correlation of B_{axis} with the ideal film"), &|e| e.comparison.correlation[i]);
    }
    add("best-fit amplitude".to_owned(), &|e| Some(e.comparison.amplitude));
    add("relative RMSE as is".to_owned(), &|e| Some(e.comparison.relative_rmse));
    add("relative RMSE after scaling".to_owned(), &|e| e.comparison.scaled_relative_rmse);
    add("largest difference from the ideal film, mT".to_owned(), &|e| Some(MT_PER_T * e.comparison.worst_t));
    let errors: [(&str, ErrorOf, LengthOf); 2] = [
        ("uniformity RMSE", |d| d.decoupling.uniformity_rmse, |d| d.uniformity_rmse_mm),
        (
            "RMSE against the ideal film",
            |d| d.decoupling.ideal_rmse.map(Some),
            |d| d.decoupling.displacement_rmse_mm.map(Some),
        ),
    ];
    for (name, of, length_of) in errors {
        for (i, parameter) in PARAMETERS.into_iter().enumerate() {
            add(format!("{name} of {parameter}"), &|e| of(&e.decoupling).to_array()[i]);
        }
        for (i, axis) in AXES.into_iter().enumerate() {
            add(format!("{name} as displacement {axis}, mm"), &|e| length_of(&e.decoupling).to_array()[i]);
        }
    }
    add("singular points (B_z = 0)".to_owned(), &|e| Some(e.decoupling.decoupling.singular.len() as f64));
    numbers
}
