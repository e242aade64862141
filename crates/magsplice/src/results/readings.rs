//! Positions of the sensor below a film and forces on it, from readings.

use glam::DVec3;
use magsplice_decouple::{Branch, Parameters};
use magsplice_layout::Elastomer;
use magsplice_magnet::Grid;
use magsplice_scan::{FLUX_DENSITIES, FrozenLog, SignedAxes, StuckAxis};
use magsplice_sensor::{LocateError, Located, Locator, Noise, SensedField, mean_at_rest};
use serde::Serialize;

use super::head_fits::HeadFits;
use super::source::Source;
use super::table::{ColumnQuantity, MetadataValue, Rows, Table};
use crate::film::Film;
use crate::film_error::FilmError;
use crate::stage::Stage;

/// Readings between two reports of progress.
pub(super) const STRETCH: usize = 1 << 12;

/// Standard deviations by which a position may be outside the volume because of noise: of normal
/// errors, one of 30 000 is larger.
pub(super) const MOST_DEVIATIONS: f64 = 4.0;

/// What is known of the sensor at rest, where displacements begin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AtRest<'r> {
    /// It is at the reference point. Its readings contain this besides the field of the film, in
    /// tesla.
    Constant(DVec3),
    /// The sensor at rest is at the reference point and had these readings (at least one), in
    /// tesla. The difference of their mean, without outliers, from the field of the film is
    /// subtracted from all readings.
    Zero(&'r [DVec3]),
    /// It is where it had these readings, one at least, in tesla. Nothing is added to the field of
    /// the film.
    Rest(&'r [DVec3]),
}

/// The positions that readings of a film give. Values by reading are in [`FilmReadings::table`].
#[derive(Clone, Debug, Serialize)]
pub struct FilmReadings {
    /// The film.
    #[serde(flatten)]
    pub source: Source,
    /// Number of readings.
    pub readings: usize,
    /// The position of each reading, in millimetres.
    #[serde(skip)]
    pub found: Vec<Result<Located, LocateError>>,
    /// The displacement of the sensor by the closed form of the ideal film (Dai 2024, Eq. 14); NaN
    /// where a reading has none. `None` without an ideal film.
    #[serde(skip)]
    pub closed_form_mm: Option<Vec<DVec3>>,
    /// The position from which displacements count.
    #[serde(skip)]
    pub origin_mm: DVec3,
    /// Noise of the readings, if it is known.
    #[serde(skip)]
    pub noise: Option<Noise>,
    /// Whether the reference point is taken for the position at rest, without readings there.
    #[serde(skip)]
    pub assumes_rest: bool,
    /// Whether the layout states errors of its tiles, which the film that was made has.
    #[serde(skip)]
    pub states_errors: bool,
    /// The elastic layer, if the layout has one.
    #[serde(skip)]
    pub elastomer: Option<Elastomer>,
    /// A stuck axis, or other axes or another unit with which readings without a position in the
    /// volume have one.
    #[serde(skip)]
    pub hint: Option<String>,
    /// What the readings of all sensors of a head tell; `None` for weighted sums and one sensor.
    #[serde(skip)]
    pub of_head: Option<HeadFits>,
}

/// Share of the readings without a position in the volume from which on another reading of the
/// columns is tried, and the share of them that then must have one.
const MOST_WITHOUT_POSITION: f64 = 0.5;
pub(super) const EXPLAINED: f64 = 0.9;

/// Least and largest number of readings without a position in the volume that are tried.
const TRIED: [usize; 2] = [3, 20];

/// Difference of readings at rest from the field, in microtesla, that stray fields and offsets of
/// sensors hardly have.
const MOST_ZERO_UT: f64 = 200.0;

/// Distance from the volume, over its extent, up to which noise may have moved a position.
const NEAR: f64 = 0.02;

/// Number of places on the axis of the film, of the height of the volume, at which a sensor may
/// have been set to zero.
const HEIGHTS: usize = 5;

/// Words for readings at rest that were taken elsewhere, or for the axes or the unit with which
/// readings without a position in the volume have one. `zero_t` is the constant part from readings
/// at rest.
fn hint(
    locator: &Locator,
    readings_t: &[DVec3],
    found: &[Result<Located, LocateError>],
    zero_t: Option<DVec3>,
    at_rest_t: &[DVec3],
) -> Option<String> {
    let zero_ut = 1e6 * zero_t.unwrap_or_default().abs().max_element();
    if zero_ut > MOST_ZERO_UT {
        return Some(format!(
            "the readings at rest differ by {zero_ut:.0} uT from the field at the reference point, several times the field \
             of the earth: take them at the reference point of [volume]"
        ));
    }
    let volume = locator.grid();
    let is_lost = |found: &Result<Located, LocateError>| match found {
        Err(LocateError::Outside(Located { position, .. })) => !is_near(*position, volume),
        found => matches!(found, Err(LocateError::NoPosition)),
    };
    let without: Vec<DVec3> =
        readings_t.iter().zip(found).filter(|(_, found)| is_lost(found)).map(|(reading_t, _)| *reading_t).collect();
    if without.len() < TRIED[0] || (without.len() as f64) < MOST_WITHOUT_POSITION * readings_t.len() as f64 {
        return None;
    }
    let step = without.len().div_ceil(TRIED[1]);
    let tried: Vec<DVec3> = without.into_iter().step_by(step).collect();
    let are_explained = |change: &dyn Fn(DVec3) -> DVec3| {
        let changed: Vec<DVec3> = tried.iter().map(|reading_t| change(*reading_t)).collect();
        let has_position = |found: &&Result<Located, LocateError>| Located::of(found).is_some() && !is_lost(found);
        locator.locate(&changed).iter().filter(has_position).count() as f64 >= EXPLAINED * tried.len() as f64
    };
    let tared = || {
        let is_at_rest = |at_rest_t: &&DVec3| are_explained(&|reading_t| reading_t + **at_rest_t);
        at_rest_t.iter().find(is_at_rest).map(|_| {
            "the readings have positions with the field on the axis of the film added: the zero of the sensor was set \
             below the film; record readings without this"
                .to_owned()
        })
    };
    other_columns(are_explained).or_else(tared)
}

/// Words for readings at rest whose positions are farther apart than noise. `origin_mm` is the
/// position of their mean.
fn moved_at_rest(locator: &Locator, at_rest_t: &[DVec3], origin_mm: DVec3, noise: Option<Noise>) -> Option<String> {
    let found = locator.locate(at_rest_t);
    let apart_mm = |located: Located| {
        let deviation_mm = noise.and_then(|noise| noise.of_position(located.gradient)).unwrap_or_default();
        let apart_mm = (located.position - origin_mm).abs();
        let is_moved = apart_mm.cmpgt((MOST_DEVIATIONS_AT_REST * deviation_mm).max(DVec3::splat(MOST_MOVED_MM))).any();
        is_moved.then(|| apart_mm.max_element())
    };
    let most_mm = found.iter().filter_map(Located::of).filter_map(apart_mm).reduce(f64::max)?;
    Some(format!(
        "the readings at rest are of positions up to {most_mm:.2} mm from their mean: the film moved, and displacements count \
         from no rest"
    ))
}

/// Distance in millimetres from which on a film moved during readings at rest: a soft layer creeps
/// by some hundredths.
const MOST_MOVED_MM: f64 = 0.1;

/// Standard deviations of a position that noise does not exceed in readings at rest.
const MOST_DEVIATIONS_AT_REST: f64 = 6.0;

/// Whether a position is in the volume, but for what noise may have moved it.
pub(super) fn is_near(position: DVec3, volume: &Grid) -> bool {
    let margin = NEAR * (volume.upper() - volume.lower());
    position.cmpge(volume.lower() - margin).all() && position.cmple(volume.upper() + margin).all()
}

/// Words for another unit or other axes with which readings are explained.
pub(super) fn other_columns(are_explained: impl Fn(&dyn Fn(DVec3) -> DVec3) -> bool) -> Option<String> {
    let unit = FLUX_DENSITIES.into_iter().find(|(unit, _)| are_explained(&|reading_t| *unit * reading_t));
    if let Some((unit, example)) = unit {
        return Some(format!(
            "readings times {unit} have positions in the volume: their unit is another one, such as {example}"
        ));
    }
    let axes = SignedAxes::all().into_iter().skip(1);
    let mut explaining = axes.filter(|axes| are_explained(&|reading_t| axes.inverse().apply(reading_t)));
    let found = explaining.next()?;
    let others = explaining.count();
    let ambiguous = match others {
        0 => String::new(),
        _ => format!(
            "; so they have with {others} other exchanges, by the symmetry of the film: compare a displacement that you know"
        ),
    };
    Some(format!(
        "readings have positions in the volume if the axes of the sensor are others: {found}: {}{ambiguous}",
        found.remedy()
    ))
}

/// Bytes of the search for positions for each point of the volume. Measured: 121.
pub(super) const LOCATOR_BYTES_PER_POINT: f64 = 128.0;

/// The search for positions in the working volume, which needs an extent.
pub(super) fn locator<'a>(sensed: SensedField<'a>, grid: Grid) -> Result<Locator<'a>, FilmError> {
    if grid.lower() == grid.upper() {
        return Err(FilmError::PointVolume);
    }
    Locator::new(sensed, grid).map_err(FilmError::Points)
}

impl Film {
    /// The position of the sensor for each reading in tesla. A position that noise may have moved
    /// out of the volume counts as inside. `noise` is that of the readings; without it, that of the
    /// sensor of the layout.
    ///
    /// # Errors
    /// If the layout has no working volume, the sensor cannot read the field, or the mean of
    /// [`AtRest::Rest`] has no position.
    pub fn read(&self, readings_t: &[DVec3], at_rest: AtRest, noise: Option<Noise>) -> Result<FilmReadings, FilmError> {
        let (volume, of) = (self.volume_for(LOCATOR_BYTES_PER_POINT)?, Some(readings_t.len()));
        let sensed = self.sensed_field(&volume.grid)?;
        let at_reference_t = sensed.readings_t(&[volume.reference_mm]).map_err(FilmError::Points)?[0];
        let mean = |readings_t: &[DVec3]| mean_at_rest(readings_t).ok_or(FilmError::AtRest(LocateError::NotFinite));
        let (constant_t, at_rest_t) = match at_rest {
            AtRest::Constant(constant_t) => (constant_t, at_reference_t),
            AtRest::Zero(readings_t) => (mean(readings_t)? - at_reference_t, at_reference_t),
            AtRest::Rest(readings_t) => (DVec3::ZERO, mean(readings_t)?),
        };
        let locator = locator(sensed.clone(), volume.grid)?.with_constant_reading(constant_t);
        let origin_mm = match at_rest {
            AtRest::Rest(_) => match locator.locate(&[at_rest_t]).remove(0) {
                Ok(located) | Err(LocateError::Outside(located)) => located.position,
                Err(error) => return Err(FilmError::AtRest(error)),
            },
            AtRest::Constant(_) | AtRest::Zero(_) => volume.reference_mm,
        };
        let noise = noise.or(Noise::of_sensor(sensed.sensor()));
        let moved = match at_rest {
            AtRest::Rest(readings_t) => moved_at_rest(&locator, readings_t, origin_mm, noise),
            AtRest::Constant(_) | AtRest::Zero(_) => None,
        };
        let is_excused = |located: &Located| {
            let outside = (volume.grid.lower() - located.position).max(located.position - volume.grid.upper());
            let deviation = noise.and_then(|noise| noise.of_position(located.gradient));
            deviation.is_some_and(|deviation| outside.cmple(MOST_DEVIATIONS * deviation).all())
        };
        let mut found = Vec::with_capacity(readings_t.len());
        for stretch in readings_t.chunks(STRETCH) {
            self.tell(Stage { name: "readings", done: found.len(), of, unit: "readings" });
            found.extend(locator.locate(stretch).into_iter().map(|found| match found {
                Err(LocateError::Outside(located)) if is_excused(&located) => Ok(located),
                found => found,
            }));
        }
        let mut closed_form_mm = self.closed_form_mm(&sensed, at_rest_t, readings_t.iter().map(|of| *of - constant_t));
        for (closed_form_mm, found) in closed_form_mm.iter_mut().flatten().zip(&found) {
            if matches!(found, Err(LocateError::NoPosition | LocateError::Saturated)) {
                *closed_form_mm = DVec3::NAN;
            }
        }
        let is_saturated = |reading_t: &DVec3| sensed.sensor().is_saturated(*reading_t);
        let within_range = readings_t.iter().map(|of| if is_saturated(of) { DVec3::NAN } else { *of });
        let stuck = StuckAxis::among(&within_range.collect::<Vec<_>>()).map(|stuck| stuck.to_string());
        let frozen = FrozenLog::among(readings_t);
        let frozen = frozen.map(|frozen| format!("{frozen} of the readings: the log was frozen, or nothing moved"));
        let stuck = stuck.or(frozen);
        let (lower, upper) = (volume.grid.lower(), volume.grid.upper());
        let heights = (0..HEIGHTS).map(|n| lower.z + (upper.z - lower.z) * n as f64 / (HEIGHTS - 1) as f64);
        let on_axis: Vec<DVec3> = heights.map(|z| volume.reference_mm.with_z(z)).collect();
        let on_axis_t = sensed.readings_t(&on_axis).map_err(FilmError::Points)?;
        let zero_t = matches!(at_rest, AtRest::Zero(_)).then_some(constant_t);
        Ok(FilmReadings {
            source: Source::of(self),
            readings: readings_t.len(),
            hint: stuck.or(moved).or_else(|| hint(&locator, readings_t, &found, zero_t, &on_axis_t)),
            found,
            closed_form_mm,
            origin_mm,
            noise,
            assumes_rest: at_rest == AtRest::Constant(DVec3::ZERO),
            states_errors: self.layout().states_errors_of_tiles(),
            elastomer: self.layout().elastomer,
            of_head: None,
        })
    }

    /// The displacement of the sensor from where it had a reading at rest, by the closed form of
    /// the ideal film; NaN where a reading has none. `None` without an ideal film.
    pub(super) fn closed_form_mm(
        &self,
        sensed: &SensedField,
        at_rest_t: DVec3,
        readings_t: impl Iterator<Item = DVec3>,
    ) -> Option<Vec<DVec3>> {
        let wavenumber = self.ideal().ok()?.wavenumber();
        let at_rest_t = sensed.field_of_reading_t(at_rest_t);
        let branch = Branch::from_axis_field(at_rest_t);
        let of = |reading_t| Parameters::from_field(reading_t, branch?);
        let before = of(at_rest_t);
        let moved = |reading_t| Some(of(sensed.field_of_reading_t(reading_t))?.displacement_from(&before?, wavenumber));
        Some(readings_t.map(|reading_t| moved(reading_t).unwrap_or(DVec3::NAN)).collect())
    }
}

impl FilmReadings {
    /// The position of each reading, also outside the volume. `None` for a reading with two
    /// positions or none.
    pub fn positions(&self) -> impl Iterator<Item = Option<Located>> + '_ {
        self.found.iter().map(Located::of)
    }

    /// The displacement of the sensor in millimetres; NaN without a position.
    pub fn displacement_mm(&self) -> Vec<DVec3> {
        self.of_each(|located| Some(located.position - self.origin_mm))
    }

    /// Standard deviations of the displacement in millimetres; NaN without a position. `None`
    /// without noise.
    pub fn deviation_mm(&self) -> Option<Vec<DVec3>> {
        if let Some(of_head) = &self.of_head {
            return of_head.has_noise.then(|| of_head.of_each(|fit| fit.position_deviation));
        }
        let noise = self.noise?;
        Some(self.of_each(|located| noise.of_position(located.gradient)))
    }

    /// The force on the film in newton, which moves by the opposite of the displacement of the
    /// sensor; NaN without a position. `None` without an elastic layer.
    pub fn force_n(&self) -> Option<Vec<DVec3>> {
        let layer = self.elastomer?;
        Some(self.of_each(|located| Some(layer.force_n(self.origin_mm - located.position))))
    }

    /// Standard deviations of the force in newton. `None` without noise or an elastic layer.
    pub fn force_deviation_n(&self) -> Option<Vec<DVec3>> {
        let stiffness = self.elastomer?.stiffness_n_per_mm();
        Some(self.deviation_mm()?.into_iter().map(|deviation_mm| stiffness * deviation_mm).collect())
    }

    /// For each reading 0: in the volume; 1: outside; 2: two positions; 3: none; 4: at the limit of
    /// the sensor's range; 5: a component is missing; 6: in the volume, but the residual of the
    /// sensors of a head is too large for the noise.
    pub fn status(&self) -> impl Iterator<Item = u8> + '_ {
        self.found.iter().enumerate().map(|(reading, found)| match found {
            Ok(_) if self.of_head.as_ref().is_some_and(|of| of.is_residual_too_large(reading)) => 6,
            Ok(_) => 0,
            Err(LocateError::Outside(_)) => 1,
            Err(LocateError::Ambiguous(_)) => 2,
            Err(LocateError::Saturated) => 4,
            Err(LocateError::NotFinite) => 5,
            Err(_) => 3,
        })
    }

    /// Displacement, deviations, force and status of each reading; `file` has the readings.
    pub fn table(&self, file: &str) -> Table {
        let vectors = [
            ("displacement_mm", &["dx_mm", "dy_mm", "dz_mm"], Some(self.displacement_mm())),
            ("deviation_mm", &["deviation_x_mm", "deviation_y_mm", "deviation_z_mm"], self.deviation_mm()),
            ("force_n", &["fx_n", "fy_n", "fz_n"], self.force_n()),
            ("deviation_n", &["deviation_fx_n", "deviation_fy_n", "deviation_fz_n"], self.force_deviation_n()),
            (
                "closed_form_mm",
                &["closed_form_dx_mm", "closed_form_dy_mm", "closed_form_dz_mm"],
                self.closed_form_mm.clone(),
            ),
        ];
        let columns = vectors
            .into_iter()
            .filter_map(|(name, components, values)| Some(ColumnQuantity::of_vectors(name, components, &values?)));
        let of_head = self.of_head.iter().flat_map(HeadFits::columns);
        let status = ColumnQuantity::of_whole(&["status"], self.status());
        let mut metadata = self.source.metadata();
        metadata.push(("readings", MetadataValue::Text(file.to_owned())));
        let rows = Rows::Numbered { name: "reading", first: 1, count: self.found.len() };
        Table::new(rows, columns.chain(of_head).chain([status]).collect(), metadata)
    }

    fn of_each(&self, value: impl Fn(Located) -> Option<DVec3>) -> Vec<DVec3> {
        self.positions().map(|located| located.and_then(&value).unwrap_or(DVec3::NAN)).collect()
    }
}

#[cfg(test)]
mod tests {
    use magsplice_layout::Layout;

    use super::*;

    fn layout() -> Layout {
        let text = "format = 1\nname = \"four squares\"\n\
             [volume]\nx_mm = [-1, 1]\ny_mm = [-1, 1]\nz_mm = [-4, -3]\nstep_mm = 0.25\n\
             [[tile]]\nposition_mm = [2.5, 2.5, 0.5]\nsize_mm = [3.3, 3.3, 1.0]\npolarization_t = [0.08, 0.08, 0.0]\n\
             mirror = { axes = [\"x\", \"y\"] }\n";
        Layout::parse(text, "layout").unwrap()
    }

    #[test]
    fn readings_at_rest_give_the_constant_field_or_the_origin() {
        let layout = layout();
        let film = Film::new(layout.clone()).unwrap();
        let stray_t = DVec3::new(3e-5, -2e-5, 1e-5);
        let at = |x: f64| DVec3::new(x, 0.25, -3.5);
        let read = film.field_at_t(&[at(0.0), at(0.5)]).unwrap();
        let position = |found: &FilmReadings| found.found[0].clone().unwrap().position;
        let resting_t = film.reference_field_t().unwrap() + stray_t;
        let zero = film.read(&[read[1] + stray_t], AtRest::Zero(&[resting_t]), None).unwrap();
        assert!((position(&zero) - at(0.5)).length() < 1e-9 && zero.origin_mm == DVec3::new(0.0, 0.0, -4.0));
        let rest = film.read(&read[1..], AtRest::Rest(&read[..1]), None).unwrap();
        assert!((rest.origin_mm - at(0.0)).length() < 1e-9);
        assert!((position(&rest) - at(0.5)).length() < 1e-9);
        let refused = film.read(&read, AtRest::Rest(&[DVec3::ONE]), None).unwrap_err();
        assert_eq!(refused, FilmError::AtRest(LocateError::NoPosition));
    }

    #[test]
    fn noise_excuses_positions_just_outside_the_volume() {
        let layout = layout();
        let film = Film::new(layout.clone()).unwrap();
        let reading_t = film.field_at_t(&[DVec3::new(1.01, 0.0, -3.5)]).unwrap();
        let noise = |deviation_t: f64| Noise { deviation_t: DVec3::splat(deviation_t) };
        let found = |noise| film.read(&reading_t, AtRest::Constant(DVec3::ZERO), noise).unwrap().found.remove(0);
        assert!(matches!(found(None), Err(LocateError::Outside(_))));
        assert!(matches!(found(Some(noise(1e-9))), Err(LocateError::Outside(_))));
        assert!(found(Some(noise(1e-4))).is_ok());
    }
}
