//! Positions of the sensor below a film, from its readings.

use glam::DVec3;
use magsplice_decouple::{Branch, Parameters};
use magsplice_magnet::Grid;
use magsplice_sensor::{LocateError, Located, Locator, Noise, SensedField};

use crate::film::Film;
use crate::film_error::FilmError;

/// Standard deviations by which a position may be outside the volume because of noise: of normal
/// errors, one of 30 000 is larger.
const MOST_DEVIATIONS: f64 = 4.0;

/// What is known of the sensor at rest, where displacements begin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AtRest<'r> {
    /// It is at the reference point. Its readings contain this besides the field of the film, in
    /// tesla.
    Constant(DVec3),
    /// It is at the reference point, where it had these readings, one at least, in tesla. What
    /// their mean has beyond the field of the film is in all readings.
    Zero(&'r [DVec3]),
    /// It is where it had these readings, one at least, in tesla. Nothing is added to the field of
    /// the film.
    Rest(&'r [DVec3]),
}

/// Finds positions of the sensor of a film in its working volume.
#[derive(Debug)]
pub struct FilmReader<'a> {
    sensed: SensedField<'a>,
    locator: Locator<'a>,
    grid: Grid,
    /// The position from which displacements count, in millimetres.
    pub origin_mm: DVec3,
    /// What every reading has besides that of the film, in tesla.
    pub constant_t: DVec3,
    /// Noise of the readings, if it is known.
    pub noise: Option<Noise>,
    /// Wavenumber of the ideal film, and the parameters at rest. `None` without an ideal film.
    closed_form: Option<(f64, Option<(Branch, Parameters)>)>,
}

impl Film {
    /// A reader of what the sensor reads in the working volume. `noise` is that of the readings;
    /// without it, that of the sensor of the layout.
    ///
    /// # Errors
    /// If the layout has no working volume, the sensor cannot read the field, or the mean of
    /// [`AtRest::Rest`] has no position.
    pub fn reader(&self, at_rest: AtRest, noise: Option<Noise>) -> Result<FilmReader<'_>, FilmError> {
        let volume = self.volume()?;
        let sensed = self.sensed_field(&volume.grid)?;
        let at_reference_t = sensed.readings_t(&[volume.reference_mm]).map_err(FilmError::Points)?[0];
        let mean = |readings_t: &[DVec3]| readings_t.iter().sum::<DVec3>() / readings_t.len() as f64;
        let (constant_t, at_rest_t) = match at_rest {
            AtRest::Constant(constant_t) => (constant_t, at_reference_t),
            AtRest::Zero(readings_t) => (mean(readings_t) - at_reference_t, at_reference_t),
            AtRest::Rest(readings_t) => (DVec3::ZERO, mean(readings_t)),
        };
        let locator =
            Locator::new(sensed.clone(), volume.grid).map_err(FilmError::Points)?.with_constant_reading(constant_t);
        let origin_mm = match at_rest {
            AtRest::Rest(_) => match locator.locate(&[at_rest_t]).remove(0) {
                Ok(located) | Err(LocateError::Outside(located)) => located.position,
                Err(error) => return Err(FilmError::AtRest(error)),
            },
            AtRest::Constant(_) | AtRest::Zero(_) => volume.reference_mm,
        };
        let closed_form = self.ideal().ok().map(|ideal| {
            let field_t = sensed.field_of_reading_t(at_rest_t);
            let branch = Branch::from_axis_field(field_t);
            let before = branch.and_then(|branch| Some((branch, Parameters::from_field(field_t, branch)?)));
            (ideal.wavenumber(), before)
        });
        let noise = noise.or(Noise::of_sensor(sensed.sensor()));
        Ok(FilmReader { sensed, locator, grid: volume.grid, origin_mm, constant_t, noise, closed_form })
    }
}

impl FilmReader<'_> {
    /// The position of the sensor for each reading in tesla. A position that noise may have moved
    /// out of the volume counts as inside.
    pub fn locate(&self, readings_t: &[DVec3]) -> Vec<Result<Located, LocateError>> {
        let mut found = self.locator.locate(readings_t);
        for found in &mut found {
            if let (Err(LocateError::Outside(located)), Some(noise)) = (&*found, &self.noise) {
                let outside = (self.grid.lower() - located.position).max(located.position - self.grid.upper());
                if noise.of_position(located.gradient).is_some_and(|d| outside.cmple(MOST_DEVIATIONS * d).all()) {
                    *found = Ok(*located);
                }
            }
        }
        found
    }

    /// The displacement of the sensor by the closed form of the ideal film (Dai 2024, Eq. 14), in
    /// millimetres; NaN where a reading has none. `None` without an ideal film.
    pub fn closed_form_mm(&self, readings_t: &[DVec3]) -> Option<Vec<DVec3>> {
        let (wavenumber, before) = self.closed_form.as_ref()?;
        let of = |reading_t: &DVec3| {
            let (branch, before) = before.as_ref()?;
            let field_t = self.sensed.field_of_reading_t(*reading_t - self.constant_t);
            Some(Parameters::from_field(field_t, *branch)?.displacement_from(before, *wavenumber))
        };
        Some(readings_t.iter().map(|reading_t| of(reading_t).unwrap_or(DVec3::NAN)).collect())
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
        let position = |reader: &FilmReader, reading_t| reader.locate(&[reading_t])[0].clone().unwrap().position;
        let resting_t = film.reference_field_t().unwrap() + stray_t;
        let zero = film.reader(AtRest::Zero(&[resting_t]), None).unwrap();
        assert!((position(&zero, read[1] + stray_t) - at(0.5)).length() < 1e-9);
        assert!((zero.constant_t - stray_t).length() < 1e-15 && zero.origin_mm == DVec3::new(0.0, 0.0, -4.0));
        let rest = film.reader(AtRest::Rest(&read[..1]), None).unwrap();
        assert!((rest.origin_mm - at(0.0)).length() < 1e-9);
        assert!((position(&rest, read[1]) - at(0.5)).length() < 1e-9);
        let refused = film.reader(AtRest::Rest(&[DVec3::ONE]), None).unwrap_err();
        assert_eq!(refused, FilmError::AtRest(LocateError::NoPosition));
    }

    #[test]
    fn noise_excuses_positions_just_outside_the_volume() {
        let layout = layout();
        let film = Film::new(layout.clone()).unwrap();
        let reading_t = film.field_at_t(&[DVec3::new(1.01, 0.0, -3.5)]).unwrap();
        let noise = |deviation_t: f64| Noise { deviation_t: DVec3::splat(deviation_t) };
        let found = |noise| film.reader(AtRest::Constant(DVec3::ZERO), noise).unwrap().locate(&reading_t).remove(0);
        assert!(matches!(found(None), Err(LocateError::Outside(_))));
        assert!(matches!(found(Some(noise(1e-9))), Err(LocateError::Outside(_))));
        assert!(found(Some(noise(1e-4))).is_ok());
    }
}
