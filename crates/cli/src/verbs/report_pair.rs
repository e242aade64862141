//! The numbers of two films side by side.

use magsplice::decouple::PerParameter;
use magsplice::{Film, FilmError};
use magsplice_report::PairedNumber;

use crate::evaluation::Evaluation;

const MT_PER_T: f64 = 1e3;
/// One of the decoupling errors of a film.
type ErrorOf = fn(&Evaluation) -> PerParameter<Option<f64>>;

/// Error bounds by which a component of B must exceed zero, as in the figures.
const BOUNDS_OF_ZERO: f64 = 2.0;
const AXES: [&str; 3] = ["x", "y", "z"];
const PARAMETERS: [&str; 3] = ["R_x", "R_y", "S_z"];

/// The film evaluated; `None` if its layout has no working volume or no ideal film.
pub(super) fn evaluated<'a>(film: &'a Film<'a>) -> Result<Option<Evaluation<'a>>, FilmError> {
    if film.ideal().is_ok() && film.volume().is_ok() { Evaluation::new(film).map(Some) } else { Ok(None) }
}

/// The numbers that `decouple` prints, of both films.
pub(super) fn numbers(films: &[Film; 2], evaluated: &[Option<Evaluation>; 2]) -> Vec<PairedNumber> {
    let mut numbers = Vec::new();
    let tiles = films.each_ref().map(|film| Some(film.layout().tiles.len() as f64));
    numbers.push(PairedNumber { name: "tiles".to_owned(), values: tiles });
    let mut add = |name: String, of: &dyn Fn(&Evaluation) -> Option<f64>| {
        let values = evaluated.each_ref().map(|evaluation| evaluation.as_ref().and_then(of));
        numbers.push(PairedNumber { name, values });
    };
    for (i, axis) in AXES.into_iter().enumerate() {
        add(format!("B_{axis} at the reference point, mT"), &|e| {
            let b_t = e.reference_field_t[i];
            let bound_t = e.film.scene().error_bounds_t(&[e.volume.reference_mm])[0];
            Some(if b_t.abs() <= BOUNDS_OF_ZERO * bound_t { 0.0 } else { b_t * MT_PER_T })
        });
    }
    for (i, axis) in AXES.into_iter().enumerate() {
        let of = |e: &Evaluation| Some(e.comparison.component_rmse_t[i] * MT_PER_T);
        add(format!("RMSE of B_{axis} against the ideal film, mT"), &of);
    }
    for (i, axis) in AXES.into_iter().enumerate() {
        add(format!("correlation of B_{axis} with the ideal film"), &|e| e.comparison.correlation[i]);
    }
    add("best-fit amplitude".to_owned(), &|e| Some(e.comparison.amplitude));
    add("relative RMSE as is".to_owned(), &|e| Some(e.comparison.relative_rmse));
    add("relative RMSE after scaling".to_owned(), &|e| e.comparison.scaled_relative_rmse);
    add("largest difference from the ideal film, mT".to_owned(), &|e| Some(e.comparison.worst_t * MT_PER_T));
    let errors: [(&str, ErrorOf); 2] = [
        ("uniformity RMSE", |e| e.decoupling.uniformity_rmse),
        ("RMSE against the ideal film", |e| e.decoupling.ideal_rmse.map(Some)),
    ];
    for (name, of) in errors {
        for (i, parameter) in PARAMETERS.into_iter().enumerate() {
            add(format!("{name} of {parameter}"), &|e| of(e).to_array()[i]);
        }
        for (i, axis) in AXES.into_iter().enumerate() {
            let length = |e: &Evaluation| of(e).to_array()[i].map(|error| error / e.ideal.wavenumber());
            add(format!("{name} as displacement {axis}, mm"), &length);
        }
    }
    add("singular points (B_z = 0)".to_owned(), &|e| Some(e.decoupling.singular.len() as f64));
    numbers
}
