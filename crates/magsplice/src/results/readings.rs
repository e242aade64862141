//! Positions of the sensor below a film and forces on it, from readings.

use glam::DVec3;
use magsplice_layout::Elastomer;
use magsplice_sensor::{LocateError, Located, Noise};
use serde::Serialize;

use super::source::Source;
use super::table::{ColumnQuantity, MetadataValue, Rows, Table};
use crate::film::Film;
use crate::film_error::FilmError;
use crate::film_reader::AtRest;
use crate::stage::Stage;

/// Readings between two reports of progress.
const STRETCH: usize = 1 << 12;

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
    /// The elastic layer, if the layout has one.
    #[serde(skip)]
    pub elastomer: Option<Elastomer>,
}

impl Film {
    /// The position of the sensor for each reading in tesla. `noise` is that of the readings;
    /// without it, that of the sensor of the layout.
    ///
    /// # Errors
    /// If the layout has no working volume, the sensor cannot read the field, or the mean of
    /// [`AtRest::Rest`] has no position.
    pub fn read(&self, readings_t: &[DVec3], at_rest: AtRest, noise: Option<Noise>) -> Result<FilmReadings, FilmError> {
        let reader = self.reader(at_rest, noise)?;
        let mut found = Vec::with_capacity(readings_t.len());
        for stretch in readings_t.chunks(STRETCH) {
            self.tell(Stage { name: "readings", done: found.len(), of: Some(readings_t.len()), unit: "readings" });
            found.extend(reader.locate(stretch));
        }
        Ok(FilmReadings {
            source: Source::of(self),
            readings: readings_t.len(),
            found,
            closed_form_mm: reader.closed_form_mm(readings_t),
            origin_mm: reader.origin_mm,
            noise: reader.noise,
            elastomer: self.layout().elastomer,
        })
    }
}

impl FilmReadings {
    /// The position of each reading, also outside the volume. `None` for a reading with two
    /// positions or none.
    pub fn positions(&self) -> impl Iterator<Item = Option<Located>> + '_ {
        self.found.iter().map(|found| match found {
            Ok(located) | Err(LocateError::Outside(located)) => Some(*located),
            Err(_) => None,
        })
    }

    /// The displacement of the sensor in millimetres; NaN without a position.
    pub fn displacement_mm(&self) -> Vec<DVec3> {
        self.of_each(|located| Some(located.position - self.origin_mm))
    }

    /// Standard deviations of the displacement in millimetres; NaN without a position. `None`
    /// without noise.
    pub fn deviation_mm(&self) -> Option<Vec<DVec3>> {
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
        let (noise, stiffness) = (self.noise?, self.elastomer?.stiffness_n_per_mm());
        Some(self.of_each(|located| Some(stiffness * noise.of_position(located.gradient)?)))
    }

    /// For each reading 0: in the volume; 1: outside; 2: two positions; 3: none; 4: at the limit of
    /// the sensor's range.
    pub fn status(&self) -> impl Iterator<Item = u8> + '_ {
        self.found.iter().map(|found| match found {
            Ok(_) => 0,
            Err(LocateError::Outside(_)) => 1,
            Err(LocateError::Ambiguous(_)) => 2,
            Err(LocateError::Saturated) => 4,
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
        let status = self.status().map(f64::from).collect();
        let status = ColumnQuantity { name: "status", components: &["status"], values: status };
        let mut metadata = self.source.metadata();
        metadata.push(("readings", MetadataValue::Text(file.to_owned())));
        let rows = Rows::Numbered { name: "reading", first: 1, count: self.found.len() };
        Table::new(rows, columns.chain([status]).collect(), metadata).expect("a value for each reading")
    }

    fn of_each(&self, value: impl Fn(Located) -> Option<DVec3>) -> Vec<DVec3> {
        self.positions().map(|located| located.and_then(&value).unwrap_or(DVec3::NAN)).collect()
    }
}
