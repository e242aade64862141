//! Readings at the limit of the sensor's range, and settings that hold them.

use glam::DVec3;
use magsplice_layout::{PartSetting, StatedSensor};
use magsplice_magnet::{Axis, Quantity};
use magsplice_scan::SignedAxes;

use super::significant::number;
use crate::film::Film;
use crate::film_error::FilmError;

/// Number of readings for each one beyond the range from which on these may be wild.
const WILD: f64 = 10.0;

/// Share of the readings that share an extreme, above which it may be the limit of the sensor.
const PLATEAU: f64 = 0.02;

/// Share of the largest component from which on an extreme may be the limit of the sensor.
const LEAST_PLATEAU: f64 = 0.3;

/// Number of readings from which on a scan over a film has components of both signs.
const MOST_OF_ONE_SIGN: usize = 27;

/// The fault of a scan of magnitudes.
const NO_SIGN: &str = "no component of a reading is negative: magnitudes have lost the signs, which the fit needs";

/// Relative difference of readings that symmetric places have.
const SAME: f64 = 1e-9;

impl Film {
    /// Words for readings at the limit of the sensor's range or beyond it, with the setting of the
    /// part that has the range for them, and for the field of the film at `points_mm`. `None`
    /// without such readings.
    pub fn remark_on_range(&self, points_mm: &[DVec3], readings_t: &[DVec3]) -> Option<String> {
        let Some(sensor) = self.layout().sensor.as_ref() else { return plateau(readings_t, DVec3::ZERO) };
        let element = sensor.as_one();
        let range_t = element.range_t;
        let finite = || readings_t.iter().filter(|reading| reading.is_finite());
        let count = finite().filter(|reading| element.is_saturated(**reading)).count();
        let largest_t = finite().fold(DVec3::ZERO, |largest, reading| largest.max(reading.abs()));
        if count == 0 {
            return plateau(readings_t, element.count_t);
        }
        let readings =
            |count: usize| if count == 1 { "1 reading is".to_owned() } else { format!("{count} readings are") };
        // The conversion of readings from counts rounds.
        let limit_t = range_t + element.count_t;
        let beyond = finite().filter(|reading| reading.abs().cmpgt(limit_t).any()).count();
        let (largest, range) = (flux_density_mt(largest_t), flux_density_mt(range_t));
        let strongest_t = self.layout().tiles.iter().map(|of| of.tile.polarization_t().length()).fold(0.0, f64::max);
        let impossible = finite().filter(|reading| reading.abs().max_element() > strongest_t).count();
        let most = number(1e3 * strongest_t);
        if 2 * impossible > finite().count() {
            return Some(format!(
                "readings reach {largest}, the polarization of the tiles at most {most} mT: check their unit"
            ));
        } else if impossible > 0 && beyond > 0 {
            let readings = readings(impossible);
            return Some(format!(
                "{readings} above {most} mT, the largest polarization of a tile: wild, or of another unit"
            ));
        }
        let is_beyond = beyond > 0;
        let found = if is_beyond {
            let is_within = |axes: &SignedAxes| axes.apply(largest_t).abs().cmplt(range_t).all();
            let causes = [
                (WILD * beyond as f64 <= finite().count() as f64, "they are wild"),
                (2 * beyond > finite().count(), "they have another unit"),
                (SignedAxes::all().iter().any(is_within), "the axes of the sensor are exchanged"),
                (true, "the sensor had another setting"),
            ];
            let causes: Vec<&str> = causes.into_iter().filter(|(is_likely, _)| *is_likely).map(|of| of.1).collect();
            let causes = causes.join(", or ");
            format!("readings reach {largest}, beyond the range of [sensor], {range}: {causes}")
        } else {
            format!("{} at the limit of the range of [sensor], {range}", readings(count))
        };
        let correction = if is_beyond { "; correct range_mt in [sensor]".to_owned() } else { String::new() };
        // A reading at the limit does not tell how large the field is.
        let field_t = self.scene().field_at(Quantity::FluxDensity, points_mm).unwrap_or_default();
        Some(found + &larger_range(sensor, readings_t.iter().chain(&field_t)).unwrap_or(correction))
    }
}

impl Film {
    /// The error of a scan without a fit whose readings share an extreme below the stated range, or
    /// have no sign: they look like exchanged axes or another placement. `None` for other readings.
    pub(super) fn unfit_readings(&self, readings_t: &[DVec3]) -> Option<FilmError> {
        let element = self.layout().sensor.as_ref().map(|sensor| sensor.as_one()).unwrap_or_default();
        if readings_t.iter().any(|reading_t| element.is_saturated(*reading_t)) {
            return None;
        }
        let finite: Vec<DVec3> = readings_t.iter().copied().filter(|reading_t| reading_t.is_finite()).collect();
        let have_no_sign = finite.len() >= MOST_OF_ONE_SIGN && finite.iter().all(|of| of.cmpge(DVec3::ZERO).all());
        if have_no_sign {
            return Some(FilmError::UnfitReadings(NO_SIGN.to_owned()));
        }
        let plateau = plateau(readings_t, element.count_t)?;
        Some(FilmError::UnfitReadings(format!("{plateau}; else leave these readings out")))
    }
}

/// Words for readings that share the extreme of a component and differ in the others by more than
/// counts and signs, which symmetry explains. `None` if they are few.
fn plateau(readings_t: &[DVec3], count_t: DVec3) -> Option<String> {
    let finite: Vec<DVec3> = readings_t.iter().copied().filter(|reading| reading.is_finite()).collect();
    let of = |(axis, sign): (Axis, f64)| {
        let [i, j, k] = [0, 1, 2].map(|shift| (axis.index() + shift) % 3);
        let extreme = finite.iter().map(|reading| sign * reading[i]).fold(f64::NEG_INFINITY, f64::max);
        let beside = |reading: &DVec3| [reading[j].abs().min(reading[k].abs()), reading[j].abs().max(reading[k].abs())];
        let mut others: Vec<[f64; 2]> =
            finite.iter().filter(|reading| sign * reading[i] == extreme).map(beside).collect();
        others.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
        let least = 2.0 * count_t.max_element() + SAME * extreme.abs();
        others.dedup_by(|a, b| (a[0] - b[0]).abs() <= least && (a[1] - b[1]).abs() <= least);
        (others.len(), axis, sign * extreme)
    };
    let all = Axis::ALL.into_iter().flat_map(|axis| [(axis, 1.0), (axis, -1.0)]);
    let (count, axis, extreme_t) = all.map(of).max_by_key(|(count, _, _)| *count)?;
    let largest_t = finite.iter().map(|reading| reading.abs().max_element()).fold(0.0, f64::max);
    let is_many = count > 1 && count as f64 > PLATEAU * finite.len() as f64;
    let is_plateau = is_many && extreme_t.abs() > LEAST_PLATEAU * largest_t;
    is_plateau.then(|| {
        let (name, extreme) = (if extreme_t > 0.0 { "largest" } else { "smallest" }, number(1e3 * extreme_t));
        format!(
            "{count} different readings share the {name} b{axis}, {extreme} mT: if it is the limit of the sensor, state it \
             as range_mt in [sensor]"
        )
    })
}

/// The setting of a sensor's part that holds these readings, and its range, as the end of a
/// sentence. `None` if no setting holds them.
pub fn larger_range<'r>(sensor: &StatedSensor, readings_t: impl IntoIterator<Item = &'r DVec3>) -> Option<String> {
    sensor.setting_for(readings_t).map(range_of_setting)
}

/// A setting and its range, as the end of a sentence.
pub fn range_of_setting((setting, range_t): (PartSetting, DVec3)) -> String {
    format!("; {setting} in [sensor] has the range {}", flux_density_mt(range_t))
}

/// A flux density along x, y, z.
fn flux_density_mt(vector_t: DVec3) -> String {
    let [x, y, z] = (1e3 * vector_t).to_array().map(number);
    format!("({x}, {y}, {z}) mT")
}
