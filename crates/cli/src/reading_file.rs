//! Readings of a sensor from a CSV file.

use std::path::Path;

use magsplice::prelude::DVec3;

use crate::args::sensor::FluxUnitArg;
use crate::csv_input::limited_lines::shown;
use crate::csv_input::names::unit_in;
use crate::csv_input::table::{CsvTable, Row};
use crate::failure::Failure;
use crate::faults::FaultList;
use crate::units::{self, FLUX_DENSITIES};

/// The line of names that messages show.
const EXAMPLE: &str = "bx_t,by_t,bz_t";

const COMPONENTS: [&str; 3] = ["bx", "by", "bz"];

/// Largest number of readings held in memory: with their positions they take 3 GB.
pub(crate) const MAX_READINGS: usize = 10_000_000;

/// The readings of a file in tesla, and the line of each.
pub(crate) fn read_all(path: &Path, unit: Option<FluxUnitArg>) -> Result<(Vec<DVec3>, Vec<u64>), Failure> {
    let failed = |message: String| Failure::Points { path: path.to_owned(), message };
    let is_component = |name: &str, base: &str| {
        unit_in(name, base).is_some_and(|unit| unit.is_empty() || units::exponent(&FLUX_DENSITIES, &unit).is_some())
    };
    let has_names = |names: &[String]| COMPONENTS.iter().all(|base| names.iter().any(|name| is_component(name, base)));
    let mut table = CsvTable::open(path, has_names, EXAMPLE).map_err(failed)?;
    let columns = columns(&table.names, unit).map_err(|why| failed(format!("line {}: {why}", table.names_line)))?;
    let (mut readings, mut lines, mut faults) = (Vec::new(), Vec::new(), FaultList::default());
    while let Some(row) = table.next_row().map_err(failed)? {
        let line = match row {
            Row::Cells(line) => line,
            Row::Fault(line, fault) => {
                faults.add(line, fault);
                continue;
            }
        };
        let (mut reading, mut wrong) = (DVec3::ZERO, Vec::new());
        for (axis, (index, exponent)) in columns.into_iter().enumerate() {
            match table.number(index, exponent, line) {
                Ok(value) => reading[axis] = value,
                Err(fault) => wrong.push(fault),
            }
        }
        if !wrong.is_empty() {
            faults.add(line, format!("line {line}: {}", wrong.join("; ")));
        } else if readings.len() < MAX_READINGS {
            readings.push(reading);
            lines.push(line);
        } else {
            return Err(failed(format!("has more than {MAX_READINGS} readings: divide the file")));
        }
    }
    if !faults.is_empty() {
        return Err(faults.failure(path.display().to_string()));
    }
    if readings.is_empty() {
        return Err(failed("has no readings below its names of columns".to_owned()));
    }
    Ok((readings, lines))
}

/// The columns of bx, by, bz with the powers of ten that convert them to tesla.
fn columns(names: &[String], unit: Option<FluxUnitArg>) -> Result<[(usize, i32); 3], String> {
    let known = units::names(&FLUX_DENSITIES);
    let column = |base: &str| {
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
                    "has no column {base} with a unit, such as {base}_t or {base} (mT) (found: {found})"
                ));
            }
            _ => return Err(format!("has more than one column {base}")),
        };
        let name = shown(&names[*index]);
        match (named.as_str(), unit) {
            ("", None) => Err(format!("the column {name} has no unit: name it, such as {base}_mt, or give --unit")),
            ("", Some(unit)) => Ok((*index, units::exponent(&FLUX_DENSITIES, unit.name()).expect("a known unit"))),
            (named, _) => match units::exponent(&FLUX_DENSITIES, named) {
                None => Err(format!("the column {name} has the unit {}, must be one of: {known}", shown(named))),
                Some(exponent)
                    if unit.is_some_and(|unit| units::exponent(&FLUX_DENSITIES, unit.name()) != Some(exponent)) =>
                {
                    Err(format!("--unit contradicts the column {name}: leave it out"))
                }
                Some(exponent) => Ok((*index, exponent)),
            },
        }
    };
    Ok([column("bx")?, column("by")?, column("bz")?])
}
