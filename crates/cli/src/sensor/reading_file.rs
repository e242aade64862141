//! Readings of a sensor from a CSV file, alone or with their positions.

use std::path::Path;

use magsplice::prelude::DVec3;

use crate::args::sensor::FluxUnitArg;
use crate::csv_input::limited_lines::shown;
use crate::csv_input::names::unit_in;
use crate::csv_input::table::{CsvTable, Row};
use crate::failure::Failure;
use crate::faults::FaultList;
use crate::units::{self, FLUX_DENSITIES, FORCES, LENGTHS, Unit};

/// Three columns with the components of a vector.
pub(crate) struct Group {
    /// What their names begin with.
    bases: [&'static str; 3],
    units: &'static [Unit],
    /// The unit of columns without one in their names.
    default: Option<&'static str>,
    /// An example of the first of them in two forms.
    examples: [&'static str; 2],
}

/// Columns of flux densities in tesla.
pub(crate) fn flux_densities(unit: Option<FluxUnitArg>) -> Group {
    Group {
        bases: ["bx", "by", "bz"],
        units: &FLUX_DENSITIES,
        default: unit.map(FluxUnitArg::name),
        examples: ["_mt", " (mT)"],
    }
}

/// Columns of forces in newton.
pub(crate) fn forces() -> Group {
    Group { bases: ["fx", "fy", "fz"], units: &FORCES, default: None, examples: ["_n", " (N)"] }
}

/// Columns of positions in millimetres.
pub(crate) fn positions() -> Group {
    Group { bases: ["x", "y", "z"], units: &LENGTHS, default: None, examples: ["_mm", " (mm)"] }
}

/// Largest number of readings held in memory: with their positions they take 3 GB.
pub(crate) const MAX_READINGS: usize = 10_000_000;

/// The vectors of each row of a file, and its line.
pub(crate) fn read_all<const N: usize>(
    path: &Path,
    groups: &[Group; N],
) -> Result<(Vec<[DVec3; N]>, Vec<u64>), Failure> {
    let failed = |message: String| Failure::Points { path: path.to_owned(), message };
    let is_of = |group: &Group, name: &str, base: &str| {
        unit_in(name, base).is_some_and(|unit| unit.is_empty() || units::exponent(group.units, &unit).is_some())
    };
    let has_names = |names: &[String]| {
        groups.iter().all(|group| group.bases.iter().all(|base| names.iter().any(|name| is_of(group, name, base))))
    };
    let example: Vec<String> =
        groups.iter().flat_map(|group| group.bases.map(|base| format!("{base}{}", group.examples[0]))).collect();
    let mut table = CsvTable::open(path, has_names, &example.join(",")).map_err(failed)?;
    let mut columns = [[(0, 0); 3]; N];
    for (columns, group) in columns.iter_mut().zip(groups) {
        for (column, base) in columns.iter_mut().zip(group.bases) {
            *column =
                group.column(&table.names, base).map_err(|why| failed(format!("line {}: {why}", table.names_line)))?;
        }
    }
    let (mut rows, mut lines, mut faults) = (Vec::new(), Vec::new(), FaultList::default());
    while let Some(row) = table.next_row().map_err(failed)? {
        let line = match row {
            Row::Cells(line) => line,
            Row::Fault(line, fault) => {
                faults.add(line, fault);
                continue;
            }
        };
        let (mut vectors, mut wrong) = ([DVec3::ZERO; N], Vec::new());
        for (vector, columns) in vectors.iter_mut().zip(columns) {
            for (axis, (index, exponent)) in columns.into_iter().enumerate() {
                match table.number(index, exponent, line) {
                    Ok(value) => vector[axis] = value,
                    Err(fault) => wrong.push(fault),
                }
            }
        }
        if !wrong.is_empty() {
            faults.add(line, format!("line {line}: {}", wrong.join("; ")));
        } else if rows.len() < MAX_READINGS {
            rows.push(vectors);
            lines.push(line);
        } else {
            return Err(failed(format!("has more than {MAX_READINGS} readings: divide the file")));
        }
    }
    if !faults.is_empty() {
        return Err(faults.failure(path.display().to_string()));
    }
    if rows.is_empty() {
        return Err(failed("has no readings below its names of columns".to_owned()));
    }
    Ok((rows, lines))
}

impl Group {
    /// The column of a component with the power of ten that converts it.
    fn column(&self, names: &[String], base: &str) -> Result<(usize, i32), String> {
        let known = units::names(self.units);
        let [with_unit, in_brackets] = self.examples.map(|example| format!("{base}{example}"));
        let found: Vec<(usize, String)> = names
            .iter()
            .enumerate()
            .filter_map(|(index, name)| unit_in(name, base).map(|unit| (index, unit)))
            .collect();
        let (index, named) = match &found[..] {
            [one] => one,
            [] => {
                let found = shown(&names.join(","));
                return Err(format!(
                    "has no column {base} with a unit, such as {with_unit} or {in_brackets} (found: {found})"
                ));
            }
            _ => return Err(format!("has more than one column {base}")),
        };
        let name = shown(&names[*index]);
        let default = self.default.map(|unit| units::exponent(self.units, unit).expect("a known unit"));
        match (named.as_str(), default) {
            ("", None) => Err(format!("the column {name} has no unit: name it, such as {with_unit}")),
            ("", Some(exponent)) => Ok((*index, exponent)),
            (named, default) => match units::exponent(self.units, named) {
                None => Err(format!("the column {name} has the unit {}, must be one of: {known}", shown(named))),
                Some(exponent) if default.is_some_and(|default| default != exponent) => {
                    Err(format!("--unit contradicts the column {name}: leave it out"))
                }
                Some(exponent) => Ok((*index, exponent)),
            },
        }
    }
}
