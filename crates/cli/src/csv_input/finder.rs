//! Groups of columns, found by their names.

use super::limited_lines::shown;
use super::quantities::Group;
use crate::units::{self, LENGTHS};

/// The group whose name takes a plural verb.
pub(crate) const EULER_ANGLES: &str = "Euler angles";

/// A column, and how its numbers are converted.
#[derive(Clone, Copy)]
pub(crate) struct Column {
    pub(crate) index: usize,
    /// Power of ten, then a factor, as in [`units::Unit`].
    pub(crate) exponent: i32,
    pub(crate) factor: f64,
}

/// Names of columns, and what is wrong with them.
pub(crate) struct Finder<'a> {
    pub(crate) names: &'a [String],
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

    /// The names of columns, for messages.
    pub(crate) fn listed<'c>(&self, columns: impl IntoIterator<Item = &'c Column>) -> String {
        columns.into_iter().map(|column| shown(&self.names[column.index])).collect::<Vec<_>>().join(", ")
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

    /// The columns of a group, `default` being the unit of those without one in their names. `None`
    /// if no column is there, or after adding a fault.
    pub(crate) fn group<const N: usize>(&mut self, group: &Group<N>, default: Option<&str>) -> Option<[Column; N]> {
        let found = group.columns.map(|names| self.columns(group, names));
        let missing: Vec<&str> = (0..N).filter(|i| found[*i].is_empty()).map(|i| group.columns[i][0]).collect();
        if missing.len() == N {
            self.explain_unknown_units(group);
            return None;
        }
        if !missing.is_empty() {
            self.fault(format!("{} {} no column {}", group.name, has(group.name), missing.join(", ")));
        }
        let columns = found.map(|columns| self.only(group, &columns, default));
        let complete: Vec<Column> = columns.into_iter().flatten().collect();
        complete.try_into().ok()
    }

    /// The column of a group of one.
    pub(crate) fn column(&mut self, group: &Group<1>) -> Option<Column> {
        self.group(group, None).map(|[column]| column)
    }

    /// The columns of a group that need not be complete. No fault is added for a missing column.
    pub(crate) fn partial_group<const N: usize>(&mut self, group: &Group<N>) -> [Option<Column>; N] {
        self.explain_unknown_units(group);
        group.columns.map(|names| self.columns(group, names)).map(|columns| self.only(group, &columns, None))
    }

    /// The one column among those found for a component. `None` without a column, or after adding a
    /// fault.
    fn only<const N: usize>(
        &mut self,
        group: &Group<N>,
        found: &[(Column, bool)],
        default: Option<&str>,
    ) -> Option<Column> {
        found.iter().for_each(|(column, _)| self.used[column.index] = true);
        let (name, has) = (group.name, has(group.name));
        match (found, default.and_then(|unit| units::find(group.units, unit))) {
            ([], _) => None,
            ([(column, true)], _) => Some(*column),
            ([(column, false)], _) if group.units.is_empty() => Some(*column),
            ([(column, false)], Some(unit)) => Some(Column { exponent: unit.exponent, factor: unit.factor, ..*column }),
            ([(column, false)], None) => {
                let (column, units) = (self.listed([column]), units::names(group.units));
                self.fault(format!("{name} in the column {column} {has} no unit, must have one of: {units}"));
                None
            }
            (several, _) => {
                let columns = self.listed(several.iter().map(|(column, _)| column));
                self.fault(format!("{name} {has} more than one column of a kind: {columns}"));
                None
            }
        }
    }

    /// The columns with one of these names and a known unit or none, and whether they have one.
    /// Columns with a unit come before those without.
    pub(crate) fn columns<const N: usize>(&self, group: &Group<N>, bases: &[&str]) -> Vec<(Column, bool)> {
        let named = |(index, name): (usize, &String)| {
            let unit = group.known_unit(name, bases)?;
            let found = units::find(group.units, &unit);
            let (exponent, factor) = found.map_or((0, 1.0), |unit| (unit.exponent, unit.factor));
            Some((Column { index, exponent, factor }, found.is_some()))
        };
        let mut columns: Vec<(Column, bool)> = self.names.iter().enumerate().filter_map(named).collect();
        if columns.iter().any(|(_, has_unit)| *has_unit) {
            columns.retain(|(_, has_unit)| *has_unit);
        }
        columns
    }

    /// Adds a fault for each column of a group whose unit is not one of the known.
    fn explain_unknown_units<const N: usize>(&mut self, group: &Group<N>) {
        for (index, name) in self.names.iter().enumerate() {
            if let Some(unit) = group.unknown_unit(name) {
                self.used[index] = true;
                let (name, unit, known, has) = (shown(name), shown(&unit), units::names(group.units), has(group.name));
                self.faults.push(format!(
                    "{} in the column {name} {has} the unit {unit}, must be one of: {known}",
                    group.name
                ));
            }
        }
    }

    /// Refuses `--unit` where a column names another unit.
    pub(crate) fn check_unit<'c>(&mut self, unit: &str, columns: impl Iterator<Item = &'c Column>) {
        let wanted = units::find(&LENGTHS, unit).map(|unit| unit.exponent);
        let others: Vec<&Column> = columns.filter(|column| Some(column.exponent) != wanted).collect();
        if !others.is_empty() {
            self.fault(format!("--unit {unit} contradicts the columns {}: rename them", self.listed(others)));
        }
    }
}

/// The verb for a group.
fn has(group: &str) -> &'static str {
    if group == EULER_ANGLES { "have" } else { "has" }
}
