//! Readings of a sensor from a CSV file, alone or with their positions or forces.

use std::path::Path;

use magsplice::prelude::DVec3;

use crate::args::readings::FluxUnitArg;
use crate::csv_input::finder::{Column, Finder};
use crate::csv_input::limited_lines::shown;
use crate::csv_input::names::unit_in;
use crate::csv_input::quantities::{FORCE, Group, POSITION, READING};
use crate::csv_input::rows::{Form, Rows};
use crate::failure::Failure;
use crate::units;

/// A vector of each row.
pub(crate) struct Vector {
    group: &'static Group<3>,
    /// The unit of columns without one in their names.
    default: Option<&'static str>,
    /// What may follow the name of a column.
    examples: [&'static str; 2],
    /// Whether a component may be missing, which is then NaN.
    may_miss: bool,
}

/// Flux densities in tesla.
pub(crate) fn flux_densities(unit: Option<FluxUnitArg>) -> Vector {
    Vector { group: &READING, default: unit.map(FluxUnitArg::name), examples: ["_mt", " (mT)"], may_miss: true }
}

/// Forces in newton.
pub(crate) const FORCES: Vector = Vector { group: &FORCE, default: None, examples: ["_n", " (N)"], may_miss: true };

/// Positions in millimetres.
pub(crate) const POSITIONS: Vector =
    Vector { group: &POSITION, default: None, examples: ["_mm", " (mm)"], may_miss: false };

/// Largest number of readings held in memory: with their positions they take 3 GB.
const MAX_READINGS: usize = 10_000_000;

/// Readings at positions, and their lines in the file.
pub(crate) struct Scan {
    pub(crate) points_mm: Vec<DVec3>,
    pub(crate) readings_t: Vec<DVec3>,
    pub(crate) lines: Vec<u64>,
}

impl Scan {
    pub(crate) fn read(path: &Path) -> Result<Scan, Failure> {
        let (rows, lines) = read_all(path, &[POSITIONS, flux_densities(None)])?;
        let (points_mm, readings_t) = rows.into_iter().map(|[point, reading]| (point, reading)).unzip();
        Ok(Scan { points_mm, readings_t, lines })
    }
}

/// The vectors of each row of a file, and its line.
pub(crate) fn read_all<const N: usize>(
    path: &Path,
    vectors: &[Vector; N],
) -> Result<(Vec<[DVec3; N]>, Vec<u64>), Failure> {
    let names = vectors.iter().flat_map(|vector| vector.group.columns.map(|names| (names[0], vector.examples[0])));
    let example = names.map(|(name, unit)| format!("{name}{unit}")).collect::<Vec<_>>().join(",");
    let form = Form { rows: "readings", most: MAX_READINGS, too_many: ": divide the file" };
    let has_names = |names: &[String]| vectors.iter().all(|vector| vector.group.is_among(names));
    let find = |finder: &mut Finder| {
        let found = vectors.each_ref().map(|vector| vector.group.columns.map(|names| vector.column(finder, names[0])));
        let found: Vec<Column> = found.into_iter().flatten().flatten().collect();
        (found.len() == 3 * N).then(|| found.as_chunks::<3>().0.to_vec())
    };
    let rows = Rows::open(path, form, &example, has_names, find)?;
    rows.read_all(|columns, cells| {
        let read = |(columns, vector): (&[Column; 3], &Vector)| match vector.may_miss {
            true => cells.measured(columns),
            false => cells.vector(columns),
        };
        let vectors: Vec<DVec3> = columns.iter().zip(vectors).filter_map(read).collect();
        vectors.try_into().ok()
    })
}

impl Vector {
    /// The column of a component, or `None` after adding a fault.
    fn column(&self, finder: &mut Finder, name: &str) -> Option<Column> {
        let [with_unit, in_brackets] = self.examples.map(|example| format!("{name}{example}"));
        let given = self.default.and_then(|unit| units::find(self.group.units, unit));
        let fault = match (&finder.columns(self.group, &[name])[..], given) {
            ([(column, true)], Some(given)) if given.exponent != column.exponent => {
                format!("--unit contradicts the column {}: leave it out", finder.listed([column]))
            }
            ([(column, true)], _) => return Some(*column),
            ([(column, false)], Some(given)) => return Some(Column { exponent: given.exponent, ..*column }),
            ([(column, false)], None) => {
                format!("the column {} has no unit: rename it, as in {with_unit}", finder.listed([column]))
            }
            ([], _) => match finder.names.iter().find_map(|found| Some((found, unit_in(found, name)?))) {
                Some((column, unit)) => {
                    let known = units::names(self.group.units);
                    format!("the column {} has the unit {}, must be one of: {known}", shown(column), shown(&unit))
                }
                None => {
                    let found = finder.names_found();
                    format!("has no column {name} with a unit, such as {with_unit} or {in_brackets} (found: {found})")
                }
            },
            _ => format!("has more than one column {name}"),
        };
        finder.fault(fault);
        None
    }
}
