//! Groups of columns, found by their names.

use super::limited_lines::shown;
use super::names::unit_in;
use crate::units::{self, LENGTHS, Unit};

/// Columns without a unit.
pub(crate) const NO_UNIT: [Unit; 0] = [];

/// The unit of angles whose numbers are no power of ten of degrees.
const RADIANS: &str = "rad";

/// Units of angles. Radians become degrees by [`Column::is_in_radians`].
pub(crate) const ANGLES: [Unit; 3] = [("deg", 0), ("°", 0), (RADIANS, 0)];

/// The group whose name takes a plural verb.
pub(crate) const EULER_ANGLES: &str = "Euler angles";

/// A column, and the power of ten that converts its numbers to millimetres, tesla, A/m or degrees.
#[derive(Clone, Copy)]
pub(crate) struct Column {
    pub(crate) index: usize,
    pub(crate) exponent: i32,
    /// Whether the numbers are angles in radians, to be converted to degrees.
    pub(crate) is_in_radians: bool,
}

/// Names of columns, and what is wrong with them.
pub(crate) struct Finder<'a> {
    names: &'a [String],
    used: Vec<bool>,
    pub(crate) faults: Vec<String>,
}

impl<'a> Finder<'a> {
    pub(crate) fn new(names: &'a [String]) -> Finder<'a> {
        Finder { names, used: vec![false; names.len()], faults: Vec::new() }
    }

    /// Names of the columns that no group has.
    pub(crate) fn unused(&self) -> Vec<String> {
        let unused = self.names.iter().zip(&self.used).filter(|(name, used)| !**used && !name.is_empty());
        unused.map(|(name, _)| shown(name)).collect()
    }

    /// All names, for messages.
    pub(crate) fn names_found(&self) -> String {
        shown(&self.names.join(","))
    }

    pub(crate) fn fault(&mut self, fault: impl Into<String>) {
        self.faults.push(fault.into());
    }

    /// Adds the fault of a group without any column, unless its columns have faults already.
    pub(crate) fn missing(&mut self, columns: &str) {
        // Groups that stand in for each other have their names before the colons.
        let groups: Vec<&str> = columns.split(", or ").filter_map(|group| group.split(':').next()).collect();
        if !self.faults.iter().any(|fault| groups.iter().any(|group| fault.starts_with(group))) {
            self.fault(format!("no columns of the {columns} (found: {})", self.names_found()));
        }
    }

    /// The columns of a group: one for each of `wanted`, which lists the names that it may have.
    /// `None` if there is no such column, or after adding a fault.
    pub(crate) fn group<const N: usize, const M: usize>(
        &mut self,
        group: &str,
        wanted: [[&str; M]; N],
        units: &[Unit],
        default: Option<&str>,
    ) -> Option<[Column; N]> {
        let found = wanted.map(|bases| self.columns(&bases, units));
        let missing: Vec<&str> = (0..N).filter(|i| found[*i].is_empty()).map(|i| wanted[i][0]).collect();
        if missing.len() == N {
            self.explain_unknown_units(group, &wanted, units);
            return None;
        }
        if !missing.is_empty() {
            self.fault(format!("{group} {} no column {}", has(group), missing.join(", ")));
        }
        let columns = found.map(|columns| self.only(group, &columns, units, default));
        let complete: Vec<Column> = columns.into_iter().flatten().collect();
        complete.try_into().ok()
    }

    /// The columns of a group that need not be complete. No fault is added for a missing column.
    pub(crate) fn partial_group<const N: usize>(
        &mut self,
        group: &str,
        wanted: [[&str; 1]; N],
        units: &[Unit],
    ) -> [Option<Column>; N] {
        self.explain_unknown_units(group, &wanted, units);
        let found = wanted.map(|bases| self.columns(&bases, units));
        found.map(|columns| self.only(group, &columns, units, None))
    }

    /// The one column among those found for a property. `None` without a column, or after adding a
    /// fault.
    fn only(
        &mut self,
        group: &str,
        found: &[(usize, String)],
        units: &[Unit],
        default: Option<&str>,
    ) -> Option<Column> {
        found.iter().for_each(|(index, _)| self.used[*index] = true);
        let (index, unit) = match found {
            [] => return None,
            [(index, unit)] => (*index, unit.as_str()),
            _ => {
                let named: Vec<String> = found.iter().map(|(index, _)| shown(&self.names[*index])).collect();
                self.fault(format!("{group} {} more than one column of a kind: {}", has(group), named.join(", ")));
                return None;
            }
        };
        let exponent = match (unit, default) {
            _ if units.is_empty() => 0,
            ("", None) => {
                let (name, units) = (shown(&self.names[index]), units::names(units));
                self.fault(format!("{group} in the column {name} {} no unit, must name one of: {units}", has(group)));
                return None;
            }
            ("", Some(unit)) | (unit, _) => units::exponent(units, unit)?,
        };
        Some(Column { index, exponent, is_in_radians: unit == RADIANS })
    }

    /// The columns with one of these names and a known unit or none, with their units.
    fn columns(&self, bases: &[&str], units: &[Unit]) -> Vec<(usize, String)> {
        let named = |(index, name): (usize, &String)| {
            let unit = bases.iter().find_map(|base| unit_in(name, base))?;
            (unit.is_empty() || units::exponent(units, &unit).is_some()).then_some((index, unit))
        };
        self.names.iter().enumerate().filter_map(named).collect()
    }

    /// Adds a fault for each column of a group whose unit is not one of the known.
    fn explain_unknown_units<const N: usize, const M: usize>(
        &mut self,
        group: &str,
        wanted: &[[&str; M]; N],
        units: &[Unit],
    ) {
        for (index, name) in self.names.iter().enumerate() {
            let unit = wanted.iter().flatten().find_map(|base| unit_in(name, base));
            let is_unknown = |unit: &String| !unit.is_empty() && units::exponent(units, unit).is_none();
            if let Some(unit) = unit.filter(is_unknown).filter(|_| !units.is_empty()) {
                self.used[index] = true;
                let (name, unit, known) = (shown(name), shown(&unit), units::names(units));
                self.faults.push(format!(
                    "{group} in the column {name} {} the unit {unit}, must be one of: {known}",
                    has(group)
                ));
            }
        }
    }

    /// Refuses `--unit` where a column names another unit.
    pub(crate) fn check_unit<'c>(&mut self, unit: &str, columns: impl Iterator<Item = &'c Column>) {
        let wanted = units::exponent(&LENGTHS, unit);
        let others: Vec<String> =
            columns.filter(|c| Some(c.exponent) != wanted).map(|c| shown(&self.names[c.index])).collect();
        if !others.is_empty() {
            self.fault(format!("--unit {unit} contradicts the columns {}: rename them", others.join(", ")));
        }
    }
}

/// The verb for a group.
fn has(group: &str) -> &'static str {
    if group == EULER_ANGLES { "have" } else { "has" }
}
