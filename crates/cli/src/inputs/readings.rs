//! Readings of a sensor from a CSV file, alone or with their positions or forces.

use std::path::Path;

use magsplice::head::HeadElement;
use magsplice::prelude::{DVec3, Film};

use crate::args::given_units::GivenUnits;
use crate::csv_input::finder::{Column, Finder};
use crate::csv_input::quantities::{FIELD_STRENGTH, FORCE, Fit, Group, NumberedReading, POSITION, READING};
use crate::csv_input::rows::{Cells, Form, Rows};
use crate::failure::Failure;
use crate::session::Session;

/// Largest number of readings held in memory: with their positions they take 3 GB.
const MAX_READINGS: usize = 10_000_000;

const FORM: Form = Form { rows: "readings", most: MAX_READINGS, too_many: ": divide the file", is_log: true };

/// Numbers of the first sensor in names of columns.
const FIRST_NUMBERS: [usize; 2] = [0, 1];

/// Readings, and what was recorded with each. A missing component is NaN.
pub(crate) struct Readings {
    /// Positions of the sensor, or forces on the film.
    pub(crate) beside: Vec<DVec3>,
    /// Flux densities: of one sensor or the weighted sum of a head, or of each sensor of the head.
    pub(crate) readings_t: Vec<DVec3>,
    /// Number of flux densities of a row.
    pub(crate) sensors: usize,
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

/// Columns of a vector beside the reading, if there is one, and of the reading of each sensor.
struct Columns {
    beside: Option<[Option<Column>; 3]>,
    sensors: Vec<[Column; 3]>,
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
        let numbered = FIRST_NUMBERS.map(|first| NumberedReading::new(first).with(|group| group.fit(names)));
        let reading = numbered.into_iter().fold(READING.fit(names).max(FIELD_STRENGTH.fit(names)), Fit::max);
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
        let sensors = sensors_columns(finder, session);
        Some(Columns { beside: beside?, sensors: sensors? })
    };
    let rows = Rows::open(path, FORM, &example, Some(units.unwrap_or(&no_units)), fit, find)?;
    let (has_positions, sensors) = (beside == Beside::Position, rows.columns.sensors.len());
    if has_positions && sensors > 1 {
        let message = "a scan needs the readings of one sensor, or the weighted sums of the head in bx, by, bz";
        return Err(Failure::at(path, message.to_owned()));
    }
    let of_beside: Vec<Column> = rows.columns.beside.into_iter().flatten().flatten().collect();
    let what = if has_positions { "the coordinates" } else { "the forces" };
    let of_readings = |columns: &[Column; 3]| rows.remark_on_units(columns, "the readings");
    let on_units = rows.remark_on_units(&of_beside, what).into_iter();
    on_units.chain(rows.columns.sensors.iter().filter_map(of_readings)).for_each(|remark| session.tell(&remark));
    let mut readings_t = Vec::new();
    let (beside, lines) = rows.read_all(&|remark| session.tell(remark), |columns, cells| {
        row(columns, cells, has_positions, &mut readings_t)
    })?;
    let positions = if has_positions { &beside[..] } else { &[] };
    // Recoil changes the field by per cents, and a range by less than a setting.
    let film = Film::rigid(session.layout.clone());
    if let Some(remark) = film.remark_on_range(positions, &readings_t).filter(|_| sensors == 1) {
        session.tell(&format!("{}: {remark}", path.display()));
    }
    Ok(Readings { beside, readings_t, sensors, lines })
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

/// The columns of the readings: of every sensor of the head of the layout, or else of one sensor or
/// the weighted sum.
fn sensors_columns(finder: &mut Finder, session: &Session) -> Option<Vec<[Column; 3]>> {
    let sensor = session.layout.sensor.as_ref();
    let head = sensor.and_then(|sensor| sensor.head.as_ref()).map_or(&[][..], |head| &head.sensors.elements);
    let is_there =
        |finder: &Finder, number: usize| NumberedReading::new(number).with(|group| finder.fit(group)) > Fit::None;
    match FIRST_NUMBERS.into_iter().find(|first| is_there(finder, *first)).filter(|_| head.len() > 1) {
        Some(first) => {
            let next = first + head.len();
            if is_there(finder, next) {
                finder.fault(format!(
                    "has columns of sensor {next}, and the head of {} has {} sensors: bx{first} to bx{}",
                    session.path.display(),
                    head.len(),
                    next - 1
                ));
            }
            let columns = |(number, of): (usize, &HeadElement)| {
                let columns = NumberedReading::new(number).with(|group| finder.required(group));
                columns.map(|columns| in_tesla(finder, session, columns, of.sensor.count_t))
            };
            let of_all: Vec<Option<[Column; 3]>> = (first..).zip(head).map(columns).collect();
            of_all.into_iter().collect()
        }
        None => {
            let Some(columns) = finder.group(&READING).or_else(|| finder.group(&FIELD_STRENGTH)) else {
                finder.missing(&[READING.needed()]);
                return None;
            };
            let count_t = sensor.map_or(DVec3::ZERO, |sensor| sensor.as_one().count_t);
            Some(vec![in_tesla(finder, session, columns, count_t)])
        }
    }
}

/// Columns of a reading with counts converted by the flux density of a count.
fn in_tesla(finder: &mut Finder, session: &Session, mut columns: [Column; 3], count_t: DVec3) -> [Column; 3] {
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
    columns
}

/// The vector beside the readings of a row, which are added to `readings_t`.
fn row(columns: &Columns, cells: &mut Cells, is_position: bool, readings_t: &mut Vec<DVec3>) -> Option<DVec3> {
    let position: Vec<Column> = columns.beside.filter(|_| is_position).into_iter().flatten().flatten().collect();
    if cells.is_any_missing(&position) {
        cells.leave_out("a coordinate of its position is missing");
        return None;
    }
    let beside = columns.beside.map_or(Some(DVec3::ZERO), |beside| cells.measured(&beside));
    for columns in &columns.sensors {
        // A fault refuses the file.
        readings_t.push(cells.measured(&columns.map(Some)).unwrap_or(DVec3::NAN));
    }
    beside
}
