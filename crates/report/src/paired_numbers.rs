//! The numbers of two films side by side.

use magsplice::Film;
use magsplice::results::FilmEvaluation;

use crate::survey::BOUNDS_OF_ZERO;
use crate::typeset::{AXIS_NAMES, PARAMETER_NAMES};

/// What a number is, with its unit, and its value for each film; `None` where there is none.
pub(crate) type PairedNumber = (String, [Option<f64>; 2]);

const MT_PER_T: f64 = 1e3;

/// The numbers that `decouple` prints, of both films.
pub(crate) fn numbers(films: [&Film; 2], evaluated: &[Option<FilmEvaluation>; 2]) -> Vec<PairedNumber> {
    let mut numbers = vec![("tiles".to_owned(), films.map(|film| Some(film.layout().tiles.len() as f64)))];
    let mut add = |name: String, of: &dyn Fn(&FilmEvaluation) -> Option<f64>| {
        numbers.push((name, evaluated.each_ref().map(|evaluation| evaluation.as_ref().and_then(of))));
    };
    for (i, axis) in AXIS_NAMES.into_iter().enumerate() {
        add(format!("B_{axis} at the reference point, mT"), &|e| {
            let (b_t, at_mm) = (e.decoupling.reference_field_t[i], e.decoupling.reference_mm);
            let bound_t = e.decoupling.film.scene().error_bounds_t(&[at_mm])[0];
            Some(if b_t.abs() <= BOUNDS_OF_ZERO * bound_t { 0.0 } else { MT_PER_T * b_t })
        });
    }
    for (i, axis) in AXIS_NAMES.into_iter().enumerate() {
        let of = |e: &FilmEvaluation| Some(MT_PER_T * e.comparison.component_rmse_t[i]);
        add(format!("RMSE of B_{axis} against the ideal film, mT"), &of);
    }
    for (i, axis) in AXIS_NAMES.into_iter().enumerate() {
        add(format!("correlation of B_{axis} with the ideal film"), &|e| e.comparison.correlation[i]);
    }
    add("best-fit amplitude".to_owned(), &|e| Some(e.comparison.amplitude));
    add("relative RMSE as is".to_owned(), &|e| Some(e.comparison.relative_rmse));
    add("relative RMSE after scaling".to_owned(), &|e| e.comparison.scaled_relative_rmse);
    add("largest difference from the ideal film, mT".to_owned(), &|e| Some(MT_PER_T * e.comparison.worst_t));
    type Errors = fn(&FilmEvaluation) -> ([Option<f64>; 3], [Option<f64>; 3]);
    let errors: [(&str, Errors); 2] = [
        ("uniformity RMSE", |FilmEvaluation { decoupling: found, .. }| {
            (found.decoupling.uniformity_rmse.to_array(), found.uniformity_rmse_mm.to_array())
        }),
        ("RMSE against the ideal film", |FilmEvaluation { decoupling: found, .. }| {
            let found = &found.decoupling;
            (found.ideal_rmse.map(Some).to_array(), found.displacement_rmse_mm.map(Some).to_array())
        }),
    ];
    for (name, of) in errors {
        for (i, parameter) in PARAMETER_NAMES.into_iter().enumerate() {
            add(format!("{name} of {parameter}"), &|e| of(e).0[i]);
        }
        for (i, axis) in AXIS_NAMES.into_iter().enumerate() {
            add(format!("{name} as displacement {axis}, mm"), &|e| of(e).1[i]);
        }
    }
    add("singular points (B_z = 0)".to_owned(), &|e| Some(e.decoupling.decoupling.singular.len() as f64));
    numbers
}
