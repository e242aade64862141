//! `[expect]`: requirements on the film.

use crate::expectations::{Expectations, ExpectedField};
use crate::read::faults::TableFaults;
use crate::read::number_rules::{check_finite, check_not_negative};
use crate::read::tables_present::TablesPresent;
use crate::tables::expect::{DisplacementBounds, ExpectTable, UniformityBounds};

/// The relative difference of opposite fields, the largest that there is.
const MOST_DIFFERENT: f64 = 2.0;

/// The requirements. Faults are added; the result is meant for use only if there are none.
pub(crate) fn resolve(table: ExpectTable, present: TablesPresent, faults: &mut TableFaults) -> Expectations {
    let ExpectTable { uniformity_rmse, displacement_rmse_mm, amplitude, field, clearance_mm, made } = table;
    let keys = [
        ("uniformity_rmse", uniformity_rmse.is_some(), true),
        ("displacement_rmse_mm", displacement_rmse_mm.is_some(), true),
        ("amplitude", amplitude.is_some(), true),
        ("field", field.is_some(), false),
        ("clearance_mm", clearance_mm.is_some(), false),
    ];
    if keys.iter().all(|(_, given, _)| !given) && made.is_none() {
        faults.add(
            "is empty, must give at least one of uniformity_rmse, displacement_rmse_mm, amplitude, field, clearance_mm, \
             made",
        );
    }
    for (key, _, needs_ideal) in keys.into_iter().filter(|(_, given, _)| *given) {
        present.check(&format!("{key} "), needs_ideal, faults);
    }
    let uniformity = uniformity_bounds(uniformity_rmse.as_ref(), faults);
    let displacement = displacement_bounds(displacement_rmse_mm.as_ref(), faults);
    let (least_amplitude, least_clearance_mm) = (amplitude.map(|bound| bound.min), clearance_mm.map(|bound| bound.min));
    for (key, least) in [("amplitude.min", least_amplitude), ("clearance_mm.min", least_clearance_mm)] {
        if let Some(least) = least {
            check_finite(key, least, faults);
        }
    }
    if let Some(ExpectedField { file, within }) = &field {
        if file.as_os_str().is_empty() {
            faults.add("field.file is empty, must name a CSV file");
        }
        if !(within.is_finite() && *within > 0.0) {
            faults.add(format!("field.within = {within}, must be a finite number greater than 0, a fraction of |B|"));
        } else if *within >= MOST_DIFFERENT {
            faults.add(format!(
                "field.within = {within}, must be less than {MOST_DIFFERENT}, a fraction of |B| that no field exceeds"
            ));
        }
    }
    Expectations {
        uniformity_rmse: uniformity,
        displacement_rmse_mm: displacement,
        least_amplitude,
        field,
        least_clearance_mm,
        // Read by itself, because it has a line of its own.
        made: None,
    }
}

/// The upper bounds of the uniformity RMSE, after adding their faults.
pub(crate) fn uniformity_bounds(bounds: Option<&UniformityBounds>, faults: &mut TableFaults) -> [Option<f64>; 3] {
    let Some(UniformityBounds { r_x, r_y, s_z }) = bounds else { return [None; 3] };
    upper_bounds("uniformity_rmse", ["r_x", "r_y", "s_z"], [*r_x, *r_y, *s_z], faults)
}

/// The upper bounds of the displacement RMSE in mm, after adding their faults.
pub(crate) fn displacement_bounds(bounds: Option<&DisplacementBounds>, faults: &mut TableFaults) -> [Option<f64>; 3] {
    let Some(DisplacementBounds { x, y, z }) = bounds else { return [None; 3] };
    upper_bounds("displacement_rmse_mm", ["x", "y", "z"], [*x, *y, *z], faults)
}

fn upper_bounds(table: &str, keys: [&str; 3], bounds: [Option<f64>; 3], faults: &mut TableFaults) -> [Option<f64>; 3] {
    if bounds == [None; 3] {
        faults.add(format!("{table} is empty, must give at least one of {}", keys.join(", ")));
    }
    for (key, bound) in keys.into_iter().zip(bounds) {
        if let Some(bound) = bound {
            check_not_negative(&format!("{table}.{key}"), bound, faults);
        }
    }
    bounds
}
