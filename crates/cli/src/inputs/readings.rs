//! Readings of a sensor from a CSV file, alone or with their positions or forces.

use std::path::Path;

use magsplice::prelude::{DVec3, Quantity};
use magsplice::scan::SignedAxes;

use crate::args::given_units::GivenUnits;
use crate::csv_input::finder::{Column, Finder};
use crate::csv_input::quantities::{FIELD_STRENGTH, FORCE, Group, POSITION, READING};
use crate::csv_input::rows::{Cells, Form, Rows};
use crate::failure::Failure;
use crate::session::Session;
use crate::text::number::{counted, number};
use crate::text::units::in_mt;
use crate::words::{flux_density_mt, larger_range};

/// Largest number of readings held in memory: with their positions they take 3 GB.
const MAX_READINGS: usize = 10_000_000;

const FORM: Form = Form { rows: "readings", most: MAX_READINGS, too_many: ": divide the file", is_log: true };

/// Readings, and what was recorded with each. A missing component is NaN.
pub(crate) struct Readings {
    /// Positions of the sensor, or forces on the film.
    pub(crate) beside: Vec<DVec3>,
    /// Flux densities.
    pub(crate) readings_t: Vec<DVec3>,
    pub(crate) lines: Vec<u64>,
}

/// What is recorded beside a reading.
#[derive(Clone, Copy, PartialEq)]
enum Beside {
    Nothing,
    /// In millimetres. A reading without a position is left out.
    Position,
    /// In newton. Components without a column were not measured.
    Force,
}

/// Readings alone.
pub(crate) fn alone(session: &Session, path: &Path, units: Option<&GivenUnits>) -> Result<Readings, Failure> {
    read(session, path, units, Beside::Nothing)
}

/// Readings at positions in millimetres. Readings without a position are left out.
pub(crate) fn at_positions(session: &Session, path: &Path, units: Option<&GivenUnits>) -> Result<Readings, Failure> {
    read(session, path, units, Beside::Position)
}

/// Readings under forces in newton.
pub(crate) fn with_forces(session: &Session, path: &Path, units: Option<&GivenUnits>) -> Result<Readings, Failure> {
    read(session, path, units, Beside::Force)
}

/// Columns of a vector beside the reading, if there is one, and of the reading.
struct Columns {
    beside: Option<[Option<Column>; 3]>,
    reading: [Column; 3],
}

fn read(session: &Session, path: &Path, units: Option<&GivenUnits>, beside: Beside) -> Result<Readings, Failure> {
    let group: Option<&Group<3>> = match beside {
        Beside::Nothing => None,
        Beside::Position => Some(&POSITION),
        Beside::Force => Some(&FORCE),
    };
    let example = group.map_or(READING.example(), |group| format!("{},{}", group.example(), READING.example()));
    let no_units = GivenUnits::default();
    let fit = |names: &[String]| {
        let reading = READING.fit(names).max(FIELD_STRENGTH.fit(names));
        reading.min(match beside {
            Beside::Nothing => reading,
            Beside::Position => POSITION.fit(names),
            Beside::Force => FORCE.partial_fit(names),
        })
    };
    let find = |finder: &mut Finder| {
        let beside = match beside {
            Beside::Nothing => Some(None),
            Beside::Position => finder.required(&POSITION).map(|columns| Some(columns.map(Some))),
            Beside::Force => force_columns(finder).map(Some),
        };
        let reading = reading_columns(finder, session);
        Some(Columns { beside: beside?, reading: reading? })
    };
    let rows = Rows::open(path, FORM, &example, Some(units.unwrap_or(&no_units)), fit, find)?;
    let (found, lines) = rows
        .read_all(&|remark| session.tell(remark), |columns, cells| row(columns, cells, beside == Beside::Position))?;
    let has_positions = beside == Beside::Position;
    let (beside, readings_t): (Vec<DVec3>, Vec<DVec3>) = found.into_iter().unzip();
    let positions = if has_positions { &beside[..] } else { &[] };
    if let Some(remark) = at_limit(session, positions, &readings_t) {
        session.tell(&format!("{}: {remark}", path.display()));
    }
    Ok(Readings { beside, readings_t, lines })
}

/// Words for readings at the limit of the sensor's range or beyond it, with the setting of the part
/// that has the range for them, and for the field of the layout at `positions`.
fn at_limit(session: &Session, positions: &[DVec3], readings_t: &[DVec3]) -> Option<String> {
    let sensor = session.layout.sensor.as_ref()?;
    let range_t = sensor.element.range_t;
    let finite = || readings_t.iter().filter(|reading| reading.is_finite());
    let count = finite().filter(|reading| sensor.element.is_saturated(**reading)).count();
    let largest_t = finite().fold(DVec3::ZERO, |largest, reading| largest.max(reading.abs()));
    if count == 0 {
        return None;
    }
    // The conversion of readings from counts rounds.
    let is_beyond = largest_t.cmpgt(range_t + sensor.element.count_t).any();
    let (largest, range) = (flux_density_mt(largest_t), flux_density_mt(range_t));
    let strongest_t = session.layout.tiles.iter().map(|of| of.tile.polarization_t().length()).fold(0.0, f64::max);
    let impossible = finite().filter(|reading| reading.abs().max_element() > strongest_t).count();
    if impossible > 0 && is_beyond {
        let most = number(in_mt(strongest_t));
        return Some(if 2 * impossible > finite().count() {
            format!("readings reach {largest}, the polarization of the tiles at most {most} mT: check their unit")
        } else {
            let readings = counted(impossible, "reading is", "readings are");
            format!("{readings} above {most} mT, the largest polarization of a tile: wild, or of another unit")
        });
    }
    let found = if is_beyond {
        let is_within = |axes: &SignedAxes| axes.apply(largest_t).abs().cmplt(range_t).all();
        let exchanged = SignedAxes::all().into_iter().find(is_within);
        let or_exchanged =
            exchanged.map_or(String::new(), |axes| format!(", or its axes are exchanged: within it where {axes}"));
        let another = "the sensor had another setting";
        format!("readings reach {largest}, beyond the range of [sensor], {range}: {another}{or_exchanged}")
    } else {
        let readings = counted(count, "reading is", "readings are");
        format!("{readings} at the limit of the range of [sensor], {range}")
    };
    let correction = if is_beyond { "; correct range_mt in [sensor]".to_owned() } else { String::new() };
    // A reading at the limit does not tell how large the field is.
    let film = session.film().ok();
    let field_t =
        film.and_then(|film| film.scene().field_at(Quantity::FluxDensity, positions).ok()).unwrap_or_default();
    Some(found + &larger_range(sensor, readings_t.iter().chain(&field_t)).unwrap_or(correction))
}

/// The columns of the forces, one at least.
fn force_columns(finder: &mut Finder) -> Option<[Option<Column>; 3]> {
    let columns = finder.partial_group(&FORCE);
    if columns.iter().all(Option::is_none) {
        finder.missing(&[FORCE.needed()]);
        return None;
    }
    Some(columns)
}

/// The columns of the readings. Counts are converted by the sensor of the layout.
fn reading_columns(finder: &mut Finder, session: &Session) -> Option<[Column; 3]> {
    let Some(mut columns) = finder.group(&READING).or_else(|| finder.group(&FIELD_STRENGTH)) else {
        finder.missing(&[READING.needed()]);
        return None;
    };
    let count_t = session.layout.sensor.as_ref().map_or(DVec3::ZERO, |sensor| sensor.element.count_t);
    let unknown: Vec<Column> = columns
        .iter()
        .zip(count_t.to_array())
        .filter(|(of, count_t)| of.unit.is_count && *count_t == 0.0)
        .map(|(of, _)| *of)
        .collect();
    if !unknown.is_empty() {
        let (columns, layout) = (finder.listed(&unknown), session.path.display());
        finder.fault(format!(
            "counts in {columns}, and {layout} does not give the flux density of a count: add part or count_ut to [sensor]"
        ));
    }
    for (column, count_t) in columns.iter_mut().zip(count_t.to_array()).filter(|(column, _)| column.unit.is_count) {
        column.unit.factor = count_t;
    }
    Some(columns)
}

/// The vector beside the reading of a row, and the reading.
fn row(columns: &Columns, cells: &mut Cells, is_position: bool) -> Option<(DVec3, DVec3)> {
    let position: Vec<Column> = columns.beside.filter(|_| is_position).into_iter().flatten().flatten().collect();
    if cells.is_any_missing(&position) {
        cells.leave_out("a coordinate of its position is missing");
        return None;
    }
    let beside = columns.beside.map_or(Some(DVec3::ZERO), |beside| cells.measured(&beside));
    let reading = cells.measured(&columns.reading.map(Some));
    Some((beside?, reading?))
}
