//! `[expect]`: requirements on the film.

use magsplice_decouple::{PerAxis, PerParameter};

use crate::expectations::{Expectations, ExpectedField, FigureBounds};
use crate::read::faults::TableFaults;
use crate::read::number_rules::{check_finite, check_not_negative};
use crate::read::tables_present::TablesPresent;
use crate::tables::expect::{DisplacementBounds, ExpectTable, LowerBound, UniformityBounds};

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
    let bounds = figure_bounds(uniformity_rmse.as_ref(), displacement_rmse_mm.as_ref(), amplitude.as_ref(), faults);
    let least_clearance_mm = clearance_mm.map(|bound| bound.min);
    if let Some(least) = least_clearance_mm {
        check_finite("clearance_mm.min", least, faults);
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
        bounds,
        field,
        least_clearance_mm,
        // Read by itself, because it has a line of its own.
        made: None,
    }
}

/// The bounds of figures, after adding their faults.
pub(crate) fn figure_bounds(
    uniformity: Option<&UniformityBounds>,
    displacement: Option<&DisplacementBounds>,
    amplitude: Option<&LowerBound>,
    faults: &mut TableFaults,
) -> FigureBounds {
    let mut bounds = FigureBounds { least_amplitude: amplitude.map(|bound| bound.min), ..FigureBounds::default() };
    if let Some(UniformityBounds { r_x, r_y, s_z }) = uniformity {
        bounds.uniformity_rmse = PerParameter { r_x: *r_x, r_y: *r_y, s_z: *s_z };
        check_upper_bounds("uniformity_rmse", ["r_x", "r_y", "s_z"], bounds.uniformity_rmse.to_array(), faults);
    }
    if let Some(DisplacementBounds { x, y, z }) = displacement {
        bounds.displacement_rmse_mm = PerAxis { x: *x, y: *y, z: *z };
        check_upper_bounds("displacement_rmse_mm", ["x", "y", "z"], bounds.displacement_rmse_mm.to_array(), faults);
    }
    if let Some(least) = bounds.least_amplitude {
        check_finite("amplitude.min", least, faults);
    }
    bounds
}

fn check_upper_bounds(table: &str, keys: [&str; 3], bounds: [Option<f64>; 3], faults: &mut TableFaults) {
    if bounds == [None; 3] {
        faults.add(format!("{table} is empty, must give at least one of {}", keys.join(", ")));
    }
    for (key, bound) in keys.into_iter().zip(bounds) {
        if let Some(bound) = bound {
            check_not_negative(&format!("{table}.{key}"), bound, faults);
        }
    }
}
