//! Groups of columns, found by their names.

use super::limited_lines::shown;
use super::quantities::{Fit, Group};
use crate::args::given_units::GivenUnits;
use crate::units::{self, Unit};

/// A column, and the unit of its numbers.
#[derive(Clone, Copy)]
pub(crate) struct Column {
    pub(crate) index: usize,
    pub(crate) unit: Unit,
}

/// Names of columns, and what is wrong with them.
pub(crate) struct Finder<'a> {
    names: &'a [String],
    /// Units of columns without one in their names. `None` for verbs without `--unit`.
    given: Option<&'a GivenUnits>,
    used: Vec<bool>,
    /// Quantities of which units were given that could be used, and those with a fault.
    takes_units: Vec<&'static [Unit]>,
    faulty: Vec<&'static str>,
    pub(crate) faults: Vec<String>,
}

/// Quantities of which one must be there: their columns in words.
pub(crate) struct Needed {
    quantity: &'static str,
    names: Vec<String>,
}

impl<const N: usize> Group<'_, N> {
    /// The group as one that must be there.
    pub(crate) fn needed(&self) -> Needed {
        Needed { quantity: self.name, names: (0..N).map(|component| self.suggested(component)).collect() }
    }
}

impl<'a> Finder<'a> {
    pub(crate) fn new(names: &'a [String], given: Option<&'a GivenUnits>) -> Finder<'a> {
        let used = vec![false; names.len()];
        Finder { names, given, used, takes_units: Vec::new(), faulty: Vec::new(), faults: Vec::new() }
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

    /// How well the names fit a group.
    pub(crate) fn fit<const N: usize>(&self, group: &Group<N>) -> Fit {
        group.fit(self.names)
    }

    /// The names of columns, for messages.
    pub(crate) fn listed<'c>(&self, columns: impl IntoIterator<Item = &'c Column>) -> String {
        columns.into_iter().map(|column| shown(&self.names[column.index])).collect::<Vec<_>>().join(", ")
    }

    pub(crate) fn fault(&mut self, fault: impl Into<String>) {
        self.faults.push(fault.into());
    }

    /// The columns of a group that must be there. `None` after adding a fault.
    pub(crate) fn required<const N: usize>(&mut self, group: &Group<N>) -> Option<[Column; N]> {
        let found = self.group(group);
        if found.is_none() {
            self.missing(&[group.needed()]);
        }
        found
    }

    /// Adds the fault that none of these groups is there, unless one of them has a fault already.
    pub(crate) fn missing(&mut self, groups: &[Needed]) {
        if !groups.iter().any(|group| self.faulty.contains(&group.quantity)) {
            let words = |Needed { quantity, names }: &Needed| match &names[..] {
                [only] if only == quantity => format!("column {only}"),
                [only] => format!("column {only} of the {quantity}"),
                _ => format!("columns {} of the {quantity}", names.join(", ")),
            };
            let words: Vec<String> = groups.iter().map(words).collect();
            self.faults.push(format!("no {} (found: {})", words.join(", or "), self.names_found()));
        }
    }

    /// The columns of a group. `None` if no column is there, or after adding a fault.
    pub(crate) fn group<const N: usize>(&mut self, group: &Group<N>) -> Option<[Column; N]> {
        let found = group.columns.map(|names| self.columns(group, names));
        let missing: Vec<String> = (0..N).filter(|i| found[*i].is_empty()).map(|i| group.suggested(i)).collect();
        if missing.len() == N {
            self.takes_units.push(group.units);
            self.explain_unknown_units(group);
            return None;
        }
        if !missing.is_empty() && !self.explain_unknown_units(group) {
            let (columns, found) = (if missing.len() == 1 { "column" } else { "columns" }, self.names_found());
            self.fault_of(group, format!("no {columns} {} of the {} (found: {found})", missing.join(", "), group.name));
        }
        let columns = self.with_units(group, &found);
        let complete: Vec<Column> = columns.into_iter().flatten().collect();
        complete.try_into().ok()
    }

    /// The column of a group of one.
    pub(crate) fn column(&mut self, group: &Group<1>) -> Option<Column> {
        self.group(group).map(|[column]| column)
    }

    /// The columns of a group that need not be complete. No fault is added for a missing column.
    pub(crate) fn partial_group<const N: usize>(&mut self, group: &Group<N>) -> [Option<Column>; N] {
        self.explain_unknown_units(group);
        let found = group.columns.map(|names| self.columns(group, names));
        self.with_units(group, &found)
    }

    /// Adds the faults of units that were given for no group.
    pub(crate) fn check_given_units(&mut self) {
        for unit in self.given.into_iter().flat_map(|given| &given.names) {
            if !self.takes_units.iter().any(|units| units::find(units, unit).is_some()) {
                let mut known: Vec<String> = Vec::new();
                for units in self.takes_units.iter().filter(|units| !units.is_empty()).map(|units| units::names(units))
                {
                    if !known.contains(&units) {
                        known.push(units);
                    }
                }
                self.faults
                    .push(format!("--unit {unit} is no unit of these columns, must be one of: {}", known.join(", ")));
            }
        }
    }

    fn fault_of<const N: usize>(&mut self, group: &Group<N>, fault: String) {
        self.faulty.push(group.name);
        self.faults.push(fault);
    }

    /// The one column of each component, or none, among those found. Adds the faults of their
    /// units.
    fn with_units<const N: usize>(
        &mut self,
        group: &Group<N>,
        found: &[Vec<(Column, bool)>; N],
    ) -> [Option<Column>; N] {
        self.takes_units.push(group.units);
        found.iter().flatten().for_each(|(column, _)| self.used[column.index] = true);
        for (component, several) in found.iter().enumerate().filter(|(_, found)| found.len() > 1) {
            let listed = self.listed(several.iter().map(|(column, _)| column));
            let (column, name) = (group.columns[component][0], group.name);
            self.fault_of(group, format!("more than one column {column} of the {name}: {listed}"));
        }
        if found.iter().any(|columns| columns.len() > 1) {
            return [None; N];
        }
        let found: Vec<Option<(Column, bool)>> = found.iter().map(|columns| columns.first().copied()).collect();
        let given = self.given.and_then(|given| given.among(group.units));
        let is_bare = |(_, has_unit): &&(Column, bool)| !has_unit && !group.units.is_empty();
        let bare: Vec<Column> = found.iter().flatten().filter(is_bare).map(|(column, _)| *column).collect();
        let is_other =
            |(column, has_unit): &&(Column, bool)| *has_unit && given.is_some_and(|given| !given.is_same(column.unit));
        let others: Vec<Column> = found.iter().flatten().filter(is_other).map(|(column, _)| *column).collect();
        let (columns, name) = (|of: &[Column]| if of.len() == 1 { "column" } else { "columns" }, group.name);
        if let Some(given) = given.filter(|_| !others.is_empty()) {
            let (columns, listed) = (columns(&others), self.listed(&others));
            self.fault_of(
                group,
                format!(
                    "--unit {} contradicts the {columns} {listed} of the {name}: leave it out or rename",
                    given.name
                ),
            );
        } else if given.is_none() && !bare.is_empty() {
            let (has, example) = (if bare.len() == 1 { "has" } else { "have" }, group.suggested(0));
            let option = if self.given.is_some() { " or give --unit," } else { "" };
            let (columns, listed, known) = (columns(&bare), self.listed(&bare), units::names(group.units));
            self.fault_of(
                group,
                format!("the {columns} {listed} of the {name} {has} no unit: rename, as in {example},{option} with one of: {known}"),
            );
        } else {
            let unit = given.unwrap_or(Unit::NONE);
            let with_unit =
                |(column, has_unit): (Column, bool)| if has_unit { column } else { Column { unit, ..column } };
            let mut complete = found.into_iter().map(|column| column.map(with_unit));
            return [(); N].map(|()| complete.next().flatten());
        }
        [None; N]
    }

    /// The columns with one of these names and a known unit or none, and whether they have one.
    /// Columns with a unit come before those without.
    fn columns<const N: usize>(&self, group: &Group<N>, bases: &[&str]) -> Vec<(Column, bool)> {
        let named = |(index, name): (usize, &String)| {
            let unit = units::find(group.units, &group.known_unit(name, bases)?);
            Some((Column { index, unit: unit.unwrap_or(Unit::NONE) }, unit.is_some()))
        };
        let mut columns: Vec<(Column, bool)> = self.names.iter().enumerate().filter_map(named).collect();
        if columns.iter().any(|(_, has_unit)| *has_unit) {
            columns.retain(|(_, has_unit)| *has_unit);
        }
        columns
    }

    /// Adds a fault for each column of a group whose unit is not one of the known. Returns whether
    /// there is one.
    fn explain_unknown_units<const N: usize>(&mut self, group: &Group<N>) -> bool {
        let unknown: Vec<(usize, String)> = self
            .names
            .iter()
            .enumerate()
            .filter_map(|(index, name)| Some((index, group.unknown_unit(name)?)))
            .collect();
        let (quantity, known) = (group.name, units::names(group.units));
        let mut left = unknown.as_slice();
        // Neighbouring columns with the same unit have one fault.
        while let Some((_, unit)) = left.first() {
            let (same, others) = left.split_at(left.iter().take_while(|(_, other)| other == unit).count());
            left = others;
            same.iter().for_each(|(index, _)| self.used[*index] = true);
            let names = same.iter().map(|(index, _)| shown(&self.names[*index])).collect::<Vec<_>>().join(", ");
            let (columns, have) = if same.len() == 1 { ("column", "has") } else { ("columns", "have") };
            let unit = shown(unit);
            self.fault_of(
                group,
                format!("the {columns} {names} of the {quantity} {have} the unit {unit}, must be one of: {known}"),
            );
        }
        !unknown.is_empty()
    }
}
