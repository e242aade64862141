//! `--unit`: units of columns without a unit in their names.

use crate::units::{self, Unit};

/// Units of columns without a unit in their names, at most one for each quantity.
#[derive(Clone, Debug, Default)]
pub(crate) struct GivenUnits {
    pub(crate) names: Vec<String>,
}

impl GivenUnits {
    /// The given unit that is one of `units`.
    pub(crate) fn among(&self, units: &[Unit]) -> Option<Unit> {
        self.names.iter().find_map(|name| units::find(units, name))
    }
}

/// Units with commas between them, such as `mm,uT`.
pub(crate) fn given_units(text: &str) -> Result<GivenUnits, String> {
    let names: Vec<String> = text.split(',').map(|name| name.trim().to_owned()).collect();
    if names.iter().any(String::is_empty) {
        return Err("must be a unit, or several with commas between them, such as mm,uT".to_owned());
    }
    Ok(GivenUnits { names })
}
