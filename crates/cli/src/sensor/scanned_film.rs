//! Results of `scan`: a fitted scan with what its positions and its parameters show.

use std::collections::HashMap;

use magsplice::decouple::uniformity_by_planes;
use magsplice::magnet::Quantity;
use magsplice::prelude::{Branch, DVec3, Parameters};
use magsplice::sensor::ScanFit;
use magsplice::{Film, FilmError};

/// A scan that was fitted.
pub(crate) struct ScannedFilm {
    pub(crate) fit: ScanFit,
    /// Line of each reading.
    pub(crate) lines: Vec<u64>,
    /// Where the sensor was, in the frame of the film.
    pub(crate) places_mm: Vec<DVec3>,
    /// Readings without offset and rotation of the sensor, in the frame of the film.
    pub(crate) corrected_t: Vec<DVec3>,
    /// The field of the layout, times the fitted strength.
    pub(crate) simulated_t: Vec<DVec3>,
    pub(crate) positions: Positions,
    /// With an ideal film.
    pub(crate) uniformity: Option<Uniformity>,
}

/// Positions of a scan.
pub(crate) struct Positions {
    /// Number of positions along x, y, z, if they are a grid but for gaps.
    pub(crate) grid: Option<[usize; 3]>,
    /// Positions of the grid without a reading.
    pub(crate) missing: Vec<DVec3>,
    /// Lines of readings at a position that an earlier one has.
    pub(crate) repeated: Vec<u64>,
}

/// Uniformity RMSE of R_x, R_y, S_z, without outliers; nothing where no plane has two points.
pub(crate) struct Uniformity {
    pub(crate) readings: [Option<f64>; 3],
    pub(crate) corrected: [Option<f64>; 3],
    pub(crate) simulated: [Option<f64>; 3],
    /// Readings whose parameters do not exist, because B_z is 0.
    pub(crate) singular: usize,
}

impl ScannedFilm {
    pub(crate) fn new(
        film: &Film,
        points: &[DVec3],
        readings_t: &[DVec3],
        lines: Vec<u64>,
        fit: ScanFit,
    ) -> Result<ScannedFilm, FilmError> {
        let parameters = &fit.parameters;
        let places_mm: Vec<DVec3> = points.iter().map(|point| *point + parameters.start).collect();
        let corrected_t: Vec<DVec3> = readings_t.iter().map(|reading| parameters.corrected_t(*reading)).collect();
        let field_t = film.scene().field_at(Quantity::FluxDensity, &places_mm).map_err(FilmError::Points)?;
        let simulated_t: Vec<DVec3> = field_t.into_iter().map(|field| parameters.strength * field).collect();
        let kept: Vec<usize> = (0..points.len()).filter(|index| fit.outliers.binary_search(index).is_err()).collect();
        let uniformity = match (film.ideal(), film.reference_field_t()) {
            (Ok(_), Ok(reference_t)) => Branch::from_axis_field(reference_t)
                .map(|branch| Uniformity::new(points, &kept, [readings_t, &corrected_t, &simulated_t], branch)),
            _ => None,
        };
        let positions = Positions::new(points, &lines);
        Ok(ScannedFilm { fit, lines, places_mm, corrected_t, simulated_t, positions, uniformity })
    }
}

impl Uniformity {
    /// `fields_t` are the readings, the corrected ones and the field of the layout.
    fn new(points: &[DVec3], kept: &[usize], fields_t: [&[DVec3]; 3], branch: Branch) -> Uniformity {
        let parameters = fields_t.map(|field_t| -> Vec<Option<Parameters>> {
            kept.iter().map(|index| Parameters::from_field(field_t[*index], branch)).collect()
        });
        let usable: Vec<usize> =
            (0..kept.len()).filter(|n| parameters.iter().all(|of_field| of_field[*n].is_some())).collect();
        let places: Vec<DVec3> = usable.iter().map(|n| points[kept[*n]]).collect();
        let [readings, corrected, simulated] = parameters.map(|of_field| {
            let usable: Vec<Parameters> = usable.iter().filter_map(|n| of_field[*n]).collect();
            uniformity_by_planes(&places, &usable)
        });
        Uniformity { readings, corrected, simulated, singular: kept.len() - usable.len() }
    }
}

/// Steps of a grid per distance below which two coordinates are the same.
const SAME_COORDINATE: f64 = 1e-6;

/// A scan is a grid with gaps if it has at least this share of the positions of the grid.
const LEAST_FILLED: f64 = 0.5;

impl Positions {
    fn new(points: &[DVec3], lines: &[u64]) -> Positions {
        let coordinates: [Vec<f64>; 3] = std::array::from_fn(|axis| {
            let mut values: Vec<f64> = points.iter().map(|point| point[axis]).collect();
            values.sort_by(f64::total_cmp);
            let extent = values.last().unwrap_or(&0.0) - values.first().unwrap_or(&0.0);
            values.dedup_by(|a, b| (*a - *b).abs() <= SAME_COORDINATE * extent);
            values
        });
        let cell = |point: &DVec3| -> [usize; 3] {
            std::array::from_fn(|axis| {
                let nearest = coordinates[axis].partition_point(|value| *value <= point[axis]);
                nearest.saturating_sub(1)
            })
        };
        let mut first: HashMap<[usize; 3], u64> = HashMap::new();
        let mut repeated = Vec::new();
        for (point, line) in points.iter().zip(lines) {
            match first.entry(cell(point)) {
                std::collections::hash_map::Entry::Occupied(_) => repeated.push(*line),
                std::collections::hash_map::Entry::Vacant(entry) => {
                    entry.insert(*line);
                }
            }
        }
        let counts = [0, 1, 2].map(|axis| coordinates[axis].len());
        let cells = counts.iter().try_fold(1_usize, |product, count| product.checked_mul(*count));
        let is_grid = cells.is_some_and(|cells| first.len() as f64 >= LEAST_FILLED * cells as f64);
        let mut missing = Vec::new();
        if is_grid {
            let [x, y, z] = &coordinates;
            for (i, x) in x.iter().enumerate() {
                for (j, y) in y.iter().enumerate() {
                    let absent = z.iter().enumerate().filter(|(k, _)| !first.contains_key(&[i, j, *k]));
                    missing.extend(absent.map(|(_, z)| DVec3::new(*x, *y, *z)));
                }
            }
        }
        Positions { grid: is_grid.then_some(counts), missing, repeated }
    }
}
