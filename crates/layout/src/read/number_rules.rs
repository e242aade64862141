//! Rules for single numbers and vectors.

use crate::read::faults::TableFaults;

/// Requires a finite number greater than 0.
pub(crate) fn check_positive(key: &str, value: f64, faults: &mut TableFaults) {
    if !(value.is_finite() && value > 0.0) {
        faults.add(format!("{key} = {value}, must be a finite number greater than 0"));
    }
}

/// Requires a finite number of at least 0.
pub(crate) fn check_not_negative(key: &str, value: f64, faults: &mut TableFaults) {
    if !(value.is_finite() && value >= 0.0) {
        faults.add(format!("{key} = {value}, must be a finite number of at least 0"));
    }
}

/// Requires a finite number.
pub(crate) fn check_finite(key: &str, value: f64, faults: &mut TableFaults) {
    if !value.is_finite() {
        faults.add(format!("{key} = {value}, must be a finite number"));
    }
}

/// Requires three finite numbers.
pub(crate) fn check_finite_vector(key: &str, value: [f64; 3], faults: &mut TableFaults) {
    if !value.iter().all(|component| component.is_finite()) {
        faults.add(format!("{key} = {value:?}, must be three finite numbers"));
    }
}
