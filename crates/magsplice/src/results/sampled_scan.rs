//! A computed scan of a film as made.

use glam::DVec3;
use magsplice_layout::Layout;
use magsplice_magnet::Tile;
use magsplice_scan::{SampleScan, SampleScanError};
use magsplice_tolerance::SampleError;
use serde::Serialize;

use super::diagnosis::made_layout;
use super::placement::FittedScan;
use super::source::Source;
use super::table::{ColumnQuantity, Points, Table};
use crate::film::Film;
use crate::film_error::FilmError;
use crate::stage::Stage;

/// A sample of a film as made, and what its sensor reads at points.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SampledScan {
    /// The film as ordered.
    #[serde(flatten)]
    pub source: Source,
    /// Seed of the random numbers.
    pub seed: u64,
    /// Number of the sample.
    pub sample: u64,
    /// Number of readings.
    pub readings: usize,
    /// Number of readings at the limit of the sensor's range.
    pub saturated: usize,
    /// The parameters that a fit to the film as made should find; see
    /// [`SampleScan::parameters`](magsplice_scan::SampleScan).
    pub scan: FittedScan,
    /// Positions of the readings in millimetres.
    #[serde(skip)]
    pub points_mm: Vec<DVec3>,
    /// The readings in tesla.
    #[serde(skip)]
    pub readings_t: Vec<DVec3>,
    /// The tiles as made.
    #[serde(skip)]
    pub tiles: Vec<Tile>,
}

impl Film {
    /// The scan of a sample of `[tolerance]` at points in millimetres, by the sensor of the layout
    /// with the errors of the sample. The sample equals sample number `sample` of
    /// [`Film::sampling`] with the same seed.
    ///
    /// # Errors
    /// [`FilmError::Missing`] without `[tolerance]`; [`FilmError::Sample`] if a tile of the sample
    /// cannot exist; [`FilmError::Points`] for points without a field; otherwise
    /// [`FilmError::SampleScan`].
    ///
    /// # Panics
    /// If a coordinate of a point is not finite.
    pub fn sampled_scan(&self, points_mm: Vec<DVec3>, seed: u64, sample: u64) -> Result<SampledScan, FilmError> {
        self.tell(Stage::uncounted("reading the sample"));
        if self.head().is_some() {
            return Err(FilmError::Head("a sampled scan has the readings of one sensor"));
        }
        let made = self.real_film()?.sample(seed, sample);
        let made = made.map_err(|faults| FilmError::Sample { sample, error: SampleError::Tile(faults) })?;
        let sensor = self.layout().sensor.as_ref().map(|sensor| sensor.element).unwrap_or_default();
        let scan = SampleScan::new(&made, &sensor, &points_mm).map_err(|error| match error {
            SampleScanError::Points(errors) => FilmError::Points(errors),
            error => FilmError::SampleScan(error),
        })?;
        let SampleScan { readings_t, parameters } = scan;
        Ok(SampledScan {
            source: Source::of(self),
            seed,
            sample,
            readings: readings_t.len(),
            saturated: readings_t.iter().filter(|reading_t| sensor.is_saturated(**reading_t)).count(),
            scan: FittedScan::new(&parameters, parameters.offset_t),
            points_mm,
            readings_t,
            tiles: made.tiles().to_vec(),
        })
    }
}

impl SampledScan {
    /// Positions and readings.
    pub fn table(&self) -> Table {
        let readings = ColumnQuantity::flux_density(&self.readings_t);
        Table::new(Points::Scattered(self.points_mm.clone()), vec![readings], self.source.metadata())
    }

    /// The film as made, as a layout. Tables about the film as ordered are omitted: `[expect]`,
    /// `[design]`, and the errors of tiles, which are now known. The history contains `program`,
    /// the name of the program.
    pub fn made_layout(&self, original: &Layout, program: &str) -> Layout {
        let mut layout = made_layout(original, &self.tiles);
        layout.history.push(format!(
            "{program}: from \"{}\" (sha256 {}), sample {} with seed {}",
            original.name,
            &original.sha256[..12],
            self.sample,
            self.seed
        ));
        layout
    }
}

#[cfg(test)]
mod tests {
    use magsplice_layout::Neighbour;
    use magsplice_scan::FreeParameters;

    use super::*;

    const LAYOUT: &str = "
        format = 1
        name = \"four squares\"
        [ideal]
        wavelength_mm = 10.0
        thickness_mm = 1.0
        amplitude_t = 0.12
        [volume]
        x_mm = [-1.0, 1.0]
        y_mm = [-1.0, 1.0]
        z_mm = [-4.0, -3.0]
        step_mm = 0.5
        [[tile]]
        position_mm = [2.5, 2.5, 0.5]
        size_mm = [3.3, 3.3, 1.0]
        polarization_t = [0.085, 0.085, 0.0]
        mirror = { axes = [\"x\", \"y\"] }
        [tolerance]
        position_mm = 0.05
        strength = 0.02
        [tolerance.film]
        position_mm = 0.1
        rotation_deg = 1
        [tolerance.stray_field]
        field_ut = 30
        [tolerance.sensor]
        offset_ut = 20
        rotation_deg = 2
        gain = 0.01
        noise_ut = 5
    ";

    /// Readings on the grid and at the reference point have the errors that `tolerance` computes.
    #[test]
    fn sample_is_the_sample_of_tolerance() {
        let mut layout = Layout::parse(LAYOUT, "layout").unwrap();
        let beside =
            Tile::new(DVec3::new(15.0, 0.0, 0.5), DVec3::new(3.0, 3.0, 1.0), DVec3::new(0.0, 0.1, 0.1)).unwrap();
        let common = &mut layout.tolerance.as_mut().unwrap().common;
        common.neighbour = Some(Neighbour {
            tiles: vec![beside],
            layout: "beside.toml".to_owned(),
            position_mm: [0.0; 3],
            rotation: None,
            later: false,
        });
        let film = Film::new(layout).unwrap();
        let (volume, sampling) = (film.evaluation_grid(0.0).unwrap(), film.sampling().unwrap());
        let sampler = sampling.sampler(3).unwrap();
        let points_mm: Vec<DVec3> = volume.grid.points().chain([volume.reference]).collect();
        let last = volume.grid.len();
        for sample in [0, 7] {
            let found = film.sampled_scan(points_mm.clone(), 3, sample).unwrap();
            let read_t = &found.readings_t;
            let figures = volume.figures(&read_t[..last], read_t[last], film.ideal().unwrap()).unwrap();
            let known = sampler.errors_of(sample).unwrap();
            for ((figure, found), (_, known)) in figures.iter().zip(known.iter()) {
                let [found, known] = [found, known].map(|value| *value.unwrap());
                assert!((found / known - 1.0).abs() < 1e-9, "{figure:?}: {found} {known}");
            }
        }
    }

    /// A turned sensor with gain and offset below a film with recoil that turned, warmed and moved:
    /// a fit to the film as made finds the parameters.
    #[test]
    fn fit_finds_the_parameters_of_a_scan() {
        let errors = "
            [material]
            recoil_permeability = 1.1
            strength_per_k = -0.001
            [sensor]
            gain = 1.2
            offset_ut = 7
            rotation = { axis = [0, 0, 1], angle_deg = 30 }
            [tolerance]
            [tolerance.film]
            position_mm = [{ fixed = 0.1 }, { fixed = -0.2 }, { fixed = 0.05 }]
            [tolerance.temperature]
            change_k = { fixed = 20 }
            [tolerance.stray_field]
            field_ut = [{ fixed = 10 }, { fixed = 20 }, { fixed = 30 }]
            [tolerance.sensor]
            offset_ut = [{ fixed = 5 }, { fixed = 0 }, { fixed = -5 }]
            rotation_deg = [{ fixed = 1 }, { fixed = 2 }, { fixed = -3 }]
        ";
        let ordered = LAYOUT.split("[tolerance]").next().unwrap();
        let film = Film::new(Layout::parse(&format!("{ordered}{errors}"), "layout").unwrap()).unwrap();
        let points_mm: Vec<DVec3> = film.volume().unwrap().grid.points().collect();
        let numbers: Vec<u64> = (0..points_mm.len() as u64).collect();
        let made = film.sampled_scan(points_mm.clone(), 1, 0).unwrap();
        let found = film.scan(&points_mm, &made.readings_t, &numbers, Some(FreeParameters::ALL)).unwrap();
        let (known, found) = (made.scan, found.fitted);
        assert!((known.strength - 0.98).abs() < 1e-12 && (found.strength / known.strength - 1.0).abs() < 1e-6);
        for (known, found, most) in [
            (known.offset_t, found.offset_t, 1e-9),
            (known.rotation_deg, found.rotation_deg, 1e-3),
            (known.start_mm, found.start_mm, 1e-5),
        ] {
            assert!((known - found).length() < most, "{known} {found}");
        }
    }
}
