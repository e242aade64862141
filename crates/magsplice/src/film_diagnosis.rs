//! Which tiles of a film that was made are wrong, from a scan of its field.

use glam::DVec3;
use magsplice_field::Scene;
use magsplice_layout::FilmTolerance;
use magsplice_magnet::Quantity;
use magsplice_scan::{
    Diagnosis, DiagnosisError, DiagnosisSettings, FieldScan, FreeParameters, ScanDiagnosis, ScanParameters, fit_scan,
};
use magsplice_sensor::Noise;

use crate::film::Film;
use crate::film_error::FilmError;
use crate::stage::Stage;

impl Film {
    /// The errors of tiles that a scan tells: `readings_t` of the sensor of the layout at points in
    /// millimetres. Its plates count as points there. `noise` is that of the readings; without it,
    /// that of the sensor. Ordinary errors are those that the layout states of tiles and groups.
    /// What recoil adds to the field is that of the film as ordered: what a wrong tile changes in
    /// itself and in others by it is neglected.
    ///
    /// # Errors
    /// [`FilmError::NoNoise`] if the noise is not known; [`FilmError::Points`] for points without a
    /// field; otherwise [`FilmError::Diagnosis`].
    ///
    /// # Panics
    /// If there are not as many readings as points.
    pub fn diagnose(
        &self,
        points_mm: Vec<DVec3>,
        readings_t: &[DVec3],
        noise: Option<Noise>,
        free: FreeParameters,
        false_alarm: f64,
    ) -> Result<Diagnosis, FilmError> {
        let element = self.layout().sensor.as_ref().map(|sensor| sensor.element).unwrap_or_default();
        let of_sensor_t =
            Some(element.deviation_t() / element.gain.abs()).filter(|noise_t| noise_t.min_element() > 0.0);
        let noise_t = noise.map(|noise| noise.deviation_t).or(of_sensor_t).ok_or(FilmError::NoNoise)?;
        let field_t = |reading_t: &DVec3| element.rotation * ((*reading_t - element.offset_t) / element.gain);
        let mut field_t: Vec<DVec3> = readings_t.iter().map(field_t).collect();
        if self.recoil().is_some() {
            let [with_t, rigid_t] = [self, &Film::rigid(self.layout().clone())]
                .map(|film| film.scene().field_at(Quantity::FluxDensity, &points_mm).map_err(FilmError::Points));
            let added_t = with_t?.into_iter().zip(rigid_t?).map(|(with_t, rigid_t)| with_t - rigid_t);
            field_t.iter_mut().zip(added_t).for_each(|(field_t, added_t)| *field_t -= added_t);
        }
        let tiles = self.layout().bare_tiles();
        let expected = self.layout().tolerance.as_ref().map(|stated| FilmTolerance {
            tiles: stated.tiles.clone(),
            groups: stated.groups.clone(),
            ..FilmTolerance::default()
        });
        // The parameters of the nominal film, or of a perfect scan where wrong tiles do not let it
        // be fitted.
        let start = if free != FreeParameters::NONE {
            let fit = fit_scan(&Scene::new(&tiles), &points_mm, &field_t, free);
            fit.map_or(ScanParameters::PERFECT, |fit| fit.parameters)
        } else {
            ScanParameters::PERFECT
        };
        let settings = DiagnosisSettings {
            expected: expected.unwrap_or_default(),
            free,
            false_alarm,
            ..DiagnosisSettings::default()
        };
        let failed = |error: DiagnosisError| match error {
            DiagnosisError::Points(errors) => FilmError::Points(errors),
            error => FilmError::Diagnosis(error),
        };
        self.tell(Stage::uncounted("preparing the diagnosis"));
        let scan = FieldScan { points_mm, noise_t };
        let model = ScanDiagnosis::new(&tiles, scan, settings, start).map_err(failed)?;
        let show = |named: usize| {
            self.tell(Stage::uncounted(if named == 0 { "looking for wrong tiles" } else { "naming wrong tiles" }));
        };
        model.diagnose(&field_t, show).map_err(failed)
    }
}

#[cfg(test)]
mod tests {
    use magsplice_layout::Layout;
    use magsplice_magnet::{Grid, Quantity};
    use magsplice_scan::ErrorKind;

    use super::*;

    #[test]
    fn weak_tile_is_named_by_readings_of_a_sensor_with_a_gain() {
        let squares = |second_t: f64| {
            format!(
                "format = 1\nname = \"two\"\n[sensor]\ngain = 1.1\nnoise_ut = 1\n\
                 [[tile]]\nposition_mm = [2, 0, 0.5]\nsize_mm = [3, 3, 1]\npolarization_t = [0, 0, 0.1]\n\
                 [[tile]]\nposition_mm = [-2, 0, 0.5]\nsize_mm = [3, 3, 1]\npolarization_t = [0, 0, {second_t}]\n"
            )
        };
        let [ordered, made] = [0.1, 0.09].map(|second_t| Layout::parse(&squares(second_t), "layout").unwrap());
        let grid = Grid::new(DVec3::new(-4.0, -2.0, -1.0), DVec3::new(4.0, 2.0, -1.0), [17, 9, 1]).unwrap();
        let points_mm: Vec<DVec3> = grid.points().collect();
        let field_t = Film::rigid(made).scene().field_at(Quantity::FluxDensity, &points_mm).unwrap();
        let readings_t: Vec<DVec3> = field_t.iter().map(|field_t| 1.1 * *field_t).collect();
        let known = FreeParameters::NONE;
        let found = Film::rigid(ordered.clone()).diagnose(points_mm.clone(), &readings_t, None, known, 0.01).unwrap();
        let [weak] = &found.named[..] else { panic!("{:?}", found.named) };
        assert_eq!((weak.candidate.tile, weak.candidate.kind), (1, ErrorKind::Strength));
        assert!((weak.magnitude() + 0.1).abs() < 1e-4, "{}", weak.magnitude());
        let quiet = Layout { sensor: None, ..ordered };
        let refused = Film::rigid(quiet).diagnose(points_mm, &readings_t, None, known, 0.01);
        assert_eq!(refused.unwrap_err(), FilmError::NoNoise);
    }
}
