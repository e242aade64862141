//! The readings of a scan as a function of the unknowns: residuals and exact derivatives, whitened
//! by the noise.

use glam::DVec3;
use magsplice_magnet::{DirectionError, PerTileError, Quantity, Tile, TileError};
use magsplice_tolerance::{RealFilm, TileResponse};
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use crate::diagnosis::error::DiagnosisError;
use crate::diagnosis::unknowns::{State, Unknown, Unknowns};
use crate::parameters::ScanParameter;

/// Largest size in bytes of derivatives, and of the products of all their pairs. Three times as
/// many are in use.
const LARGEST_BYTES: usize = 1 << 30;

/// Bytes of the response of one tile at one point.
const RESPONSE_BYTES: usize = 272;

/// Number of columns whose products with all columns are computed at once.
const BLOCK: usize = 128;

/// Number of independent sums, so that a processor adds several at once.
const LANES: usize = 8;

/// A film above the points of a scan.
#[derive(Clone, Debug)]
pub(crate) struct ScanModel {
    pub(crate) film: RealFilm,
    pub(crate) points: Vec<DVec3>,
    pub(crate) noise_t: DVec3,
    pub(crate) unknowns: Unknowns,
}

/// The model at one state, as a linear function of the unknowns around it.
#[derive(Clone, Debug)]
pub(crate) struct Linearized {
    pub(crate) state: State,
    /// Where the derivatives are taken, if not at the state.
    pub(crate) slopes_at: Option<State>,
    /// Whether each reading is used. Derivatives of the others are 0.
    pub(crate) is_used: Vec<bool>,
    /// The readings of the scan's sensor at the points for this film.
    field_t: Vec<DVec3>,
    /// The derivative of all whitened readings by each unknown.
    pub(crate) columns: Vec<Vec<f64>>,
    /// Products of all pairs of columns.
    pub(crate) gram: DMatrix<f64>,
}

/// A state compared with the measured readings.
#[derive(Clone, Debug)]
pub(crate) struct Compared {
    /// Measured readings minus the model's readings, in tesla.
    pub(crate) residuals_t: Vec<DVec3>,
    /// The residuals over the noise; 0 for readings that are not used.
    pub(crate) whitened: Vec<f64>,
    /// The sum of the squared residuals, each over the square of the noise.
    pub(crate) chi_squared: f64,
    /// The products of the columns with the residuals of the linear model at the origin of all
    /// unknowns.
    pub(crate) projected: DVector<f64>,
}

impl ScanModel {
    /// Rejects models that do not fit in memory.
    pub(crate) fn checked(self) -> Result<ScanModel, DiagnosisError> {
        let (unknowns, tiles) = (self.unknowns.list.len(), self.film.tiles().len());
        let number = size_of::<f64>();
        let of_point = 3 * number * unknowns + RESPONSE_BYTES * tiles * (1 + self.film.reflections().len());
        let of_pairs = unknowns.checked_mul(unknowns).and_then(|pairs| pairs.checked_mul(number));
        let bytes = of_point.checked_mul(self.points.len()).and_then(|bytes| bytes.checked_add(of_pairs?));
        if bytes.is_none_or(|bytes| bytes > LARGEST_BYTES) {
            return Err(DiagnosisError::TooLarge { bytes });
        }
        Ok(self)
    }

    /// Places of the readings.
    fn places(&self, state: &State) -> Vec<DVec3> {
        let start = state.scan_parameters().start;
        self.points.iter().map(|point| *point + start).collect()
    }

    /// Number of components of used readings: the expectation of the sum of squares with expected
    /// errors, but for a few unknowns of the scan.
    pub(crate) fn freedom(&self, is_used: &[bool]) -> usize {
        3 * is_used.iter().filter(|is_used| **is_used).count()
    }

    /// The sum of the squared residuals of used readings at a state, each over the square of the
    /// noise.
    pub(crate) fn chi_squared(
        &self,
        state: &State,
        is_used: &[bool],
        readings_t: &[DVec3],
    ) -> Result<f64, DiagnosisError> {
        let scene = self.film.scene(&self.tiles(state)?).map_err(DiagnosisError::Tile)?;
        let field_t = scene.field_at(Quantity::FluxDensity, &self.places(state)).map_err(DiagnosisError::Points)?;
        let scan = state.scan_parameters();
        let used = readings_t.iter().zip(field_t).zip(is_used).filter(|(_, is_used)| **is_used);
        Ok(used.map(|((read_t, b), _)| ((*read_t - scan.reading_t(b)) / self.noise_t).length_squared()).sum())
    }

    /// The model of the used readings at a state. The derivatives are those at `slopes_at`, a film
    /// in the same scan, or else exact. Derivatives by tiles unchanged since `before` are reused.
    pub(crate) fn linearized(
        &self,
        state: State,
        slopes_at: Option<State>,
        is_used: &[bool],
        before: Option<&Linearized>,
    ) -> Result<Linearized, DiagnosisError> {
        let (tiles, places) = (self.tiles(&state)?, self.places(&state));
        let scene_of = |tiles: &[Tile]| self.film.scene(tiles).map_err(DiagnosisError::Tile);
        let scene = scene_of(&tiles)?;
        let field_t = scene.field_at(Quantity::FluxDensity, &places).map_err(DiagnosisError::Points)?;
        let scan = state.scan_parameters();
        let slopes = slopes_at.as_ref().unwrap_or(&state);
        let is_reusable = |before: &&Linearized| {
            let known = before.slopes();
            known.scan == slopes.scan && known.groups == slopes.groups && before.is_used == is_used
        };
        let before = before.filter(is_reusable);
        let is_new = |tile: usize| before.is_none_or(|before| before.slopes().tiles[tile] != slopes.tiles[tile]);
        let other = slopes_at.as_ref().map(|other| self.tiles(other)).transpose()?;
        let (sloped, sloped_scene) = match &other {
            Some(other) => (other, &scene_of(other)?),
            None => (&tiles, &scene),
        };
        let has_groups = self.unknowns.list.iter().any(|unknown| matches!(unknown, Unknown::Group { .. }));
        let responses: Vec<Option<TileResponse>> = (0..tiles.len())
            .into_par_iter()
            .map(|tile| match has_groups || is_new(tile) {
                true => TileResponse::in_film(&self.film, tile, &sloped[tile], &places).map(Some),
                false => Ok(None),
            })
            .collect::<Result<_, _>>()?;
        let moves_scan =
            self.unknowns.list.iter().any(|unknown| matches!(unknown, Unknown::Scan(ScanParameter::Start(_))));
        let slope_t = match other {
            Some(_) => sloped_scene.field_at(Quantity::FluxDensity, &places).map_err(DiagnosisError::Points)?,
            None => field_t.clone(),
        };
        let gradient = match moves_scan {
            true => sloped_scene.gradient_at(Quantity::FluxDensity, &places).map_err(DiagnosisError::Points)?,
            false => Vec::new(),
        };
        let back = scan.turn().inverse();
        let column = |index: usize| -> Option<Vec<f64>> {
            let mut change_t = vec![DVec3::ZERO; places.len()];
            match self.unknowns.list[index] {
                Unknown::Tile { tile, error } => {
                    responses[tile].as_ref().filter(|_| is_new(tile))?.add_derivative(
                        error,
                        sloped[tile].position(),
                        &mut change_t,
                    );
                    at_nominal(error, &slopes.tiles[tile], &mut change_t);
                }
                Unknown::Group { group, error } => {
                    let tolerance = &self.film.tolerance().groups[group];
                    let centre = self.film.group_centre_mm(tolerance);
                    for &tile in &tolerance.tiles {
                        responses[tile].as_ref()?.add_derivative(error, centre, &mut change_t);
                    }
                    at_nominal(error, &slopes.groups[group], &mut change_t);
                }
                Unknown::Scan(ScanParameter::Strength) => {
                    change_t.iter_mut().zip(&slope_t).for_each(|(change, b)| *change = *b / scan.strength);
                }
                // The offset is added after the rotation; the inverse rotation below cancels this
                // factor.
                Unknown::Scan(ScanParameter::Offset(axis)) => {
                    let along = back.inverse() * axis.unit() / scan.strength;
                    change_t.iter_mut().for_each(|change| *change = along);
                }
                // A turn by d of the sensor changes the reading R^-1 b by R^-1 (b x d).
                Unknown::Scan(ScanParameter::Rotation(axis)) => {
                    change_t.iter_mut().zip(&slope_t).for_each(|(change, b)| *change = b.cross(axis.unit()));
                }
                Unknown::Scan(ScanParameter::Start(axis)) => {
                    change_t.iter_mut().zip(&gradient).for_each(|(change, slope)| *change = slope.col(axis.index()));
                }
            }
            let whitened = |(change, is_used): (DVec3, &bool)| match is_used {
                true => (back * (scan.strength * change) / self.noise_t).to_array(),
                false => [0.0; 3],
            };
            Some(change_t.into_iter().zip(is_used).flat_map(whitened).collect())
        };
        let fresh: Vec<Option<Vec<f64>>> = (0..self.unknowns.list.len()).into_par_iter().map(column).collect();
        let is_fresh: Vec<bool> = fresh.iter().map(Option::is_some).collect();
        let old = |index: usize| before.map_or_else(Vec::new, |before| before.columns[index].clone());
        let columns: Vec<Vec<f64>> =
            fresh.into_iter().enumerate().map(|(index, column)| column.unwrap_or_else(|| old(index))).collect();
        let gram = products(&columns, before.map(|before| (&before.gram, &is_fresh[..])));
        let field_t = field_t.into_iter().map(|field_t| scan.reading_t(field_t)).collect();
        Ok(Linearized { state, slopes_at, is_used: is_used.to_vec(), field_t, columns, gram })
    }

    /// The tiles of a state.
    pub(crate) fn tiles(&self, state: &State) -> Result<Vec<Tile>, DiagnosisError> {
        self.film.tiles_with_errors(&state.tiles, &state.groups).map_err(DiagnosisError::Tile)
    }

    /// The measured readings compared with a state.
    pub(crate) fn compared(&self, at: &Linearized, readings_t: &[DVec3]) -> Compared {
        let residuals_t: Vec<DVec3> = readings_t.iter().zip(&at.field_t).map(|(reading, b)| *reading - *b).collect();
        let used = residuals_t.iter().zip(&at.is_used);
        let whitened: Vec<f64> = used
            .flat_map(|(residual, is_used)| if *is_used { (*residual / self.noise_t).to_array() } else { [0.0; 3] })
            .collect();
        let values = self.values(&at.state);
        let projected: Vec<f64> = at.columns.par_iter().map(|column| dot(column, &whitened)).collect();
        let projected = DVector::from_vec(projected) + &at.gram * values;
        Compared { residuals_t, chi_squared: dot(&whitened, &whitened), whitened, projected }
    }

    /// The values of all unknowns in a state.
    pub(crate) fn values(&self, state: &State) -> DVector<f64> {
        DVector::from_iterator(self.unknowns.list.len(), self.unknowns.list.iter().map(|unknown| state.get(*unknown)))
    }

    /// A state without its expected errors. Other deviations are those of identified errors.
    pub(crate) fn without_expected(&self, state: &State, deviations: &[f64]) -> State {
        let mut state = state.clone();
        let Unknowns { list, expected } = &self.unknowns;
        for (unknown, _) in list.iter().zip(expected).zip(deviations).filter(|((_, a), b)| a == b).map(|(of, _)| of) {
            if !matches!(unknown, Unknown::Scan(_)) {
                state.set(*unknown, 0.0);
            }
        }
        state
    }

    /// A state with these values of the unknowns.
    pub(crate) fn state(&self, from: &State, values: &DVector<f64>) -> State {
        let mut state = from.clone();
        self.unknowns.list.iter().zip(values.iter()).for_each(|(unknown, value)| state.set(*unknown, *value));
        state
    }
}

impl Linearized {
    /// Where the derivatives are taken.
    fn slopes(&self) -> &State {
        self.slopes_at.as_ref().unwrap_or(&self.state)
    }

    /// The model without some of the readings.
    pub(crate) fn without(mut self, readings: &[usize]) -> Linearized {
        if readings.is_empty() {
            return self;
        }
        for &reading in readings {
            self.columns.iter_mut().for_each(|column| column[3 * reading..][..3].fill(0.0));
            self.is_used[reading] = false;
        }
        let gram = products(&self.columns, None);
        Linearized { gram, ..self }
    }
}

/// A response is a derivative at the actual J. Errors are fractions of the nominal strength, and J
/// of a reversed tile turns out of the plane the other way.
fn at_nominal(error: TileError, errors: &PerTileError<f64>, change_t: &mut [DVec3]) {
    let strength = 1.0 + errors.strength;
    let factor = match error {
        TileError::Strength if strength != 0.0 => strength.recip(),
        TileError::Direction(DirectionError::OutOfPlane) => strength.signum(),
        _ => return,
    };
    change_t.iter_mut().for_each(|change| *change *= factor);
}

/// The products of all pairs of columns. `known` are earlier products, and which columns have
/// changed since.
fn products(columns: &[Vec<f64>], known: Option<(&DMatrix<f64>, &[bool])>) -> DMatrix<f64> {
    let is_changed = |index: &usize| known.is_none_or(|(_, is_changed)| is_changed[*index]);
    let changed: Vec<usize> = (0..columns.len()).filter(is_changed).collect();
    let rows = columns.first().map_or(0, Vec::len);
    let all = DMatrix::from_iterator(rows, columns.len(), columns.iter().flatten().copied());
    // Blocks of a fixed size give the same products for any number of threads.
    let block = |some: &[usize]| {
        let values = some.iter().flat_map(|index| columns[*index].iter().copied());
        DMatrix::from_row_iterator(some.len(), rows, values) * &all
    };
    let blocks: Vec<DMatrix<f64>> = changed.par_chunks(BLOCK).map(block).collect();
    let mut products = known.map_or_else(|| DMatrix::zeros(columns.len(), columns.len()), |(known, _)| known.clone());
    for (place, &index) in changed.iter().enumerate() {
        let row = blocks[place / BLOCK].row(place % BLOCK);
        products.set_column(index, &row.transpose());
        products.set_row(index, &row);
    }
    products
}

/// The scalar product, in an order that depends on the length alone.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; LANES];
    let (blocks_a, blocks_b) = (a.chunks_exact(LANES), b.chunks_exact(LANES));
    let rest: f64 = blocks_a.remainder().iter().zip(blocks_b.remainder()).map(|(a, b)| a * b).sum();
    for (a, b) in blocks_a.zip(blocks_b) {
        for (sum, (a, b)) in sums.iter_mut().zip(a.iter().zip(b)) {
            *sum += a * b;
        }
    }
    sums.iter().sum::<f64>() + rest
}

#[cfg(test)]
mod tests {
    use magsplice_layout::{FilmTolerance, Preset};
    use magsplice_magnet::{IronPlane, IronPlanes};

    use super::*;
    use crate::parameters::{FreeParameters, ScanParameters};

    /// Columns agree with central differences of the readings, for a reversed tile too. Steps of
    /// 1e-5 leave differences of 1e-10 by the third derivative and 1e-11 by round-off. The film is
    /// alone, or before an oblique plane of iron.
    #[test]
    fn columns_are_derivatives_of_readings() {
        let plane = IronPlane::new(2.0 * DVec3::Z, DVec3::new(0.2, 0.1, -1.0), 5.0).unwrap();
        for iron in [IronPlanes::default(), IronPlanes::new(vec![plane]).unwrap()] {
            check_columns(iron);
        }
    }

    fn check_columns(iron: IronPlanes) {
        let tile = |x: f64, j_t: DVec3| Tile::new(DVec3::new(x, 0.0, 0.5), DVec3::new(2.0, 1.5, 1.0), j_t).unwrap();
        let tiles = [tile(-1.5, DVec3::new(0.1, 0.02, 0.05)), tile(1.0, DVec3::new(-0.03, 0.1, 0.0))];
        let expected = FilmTolerance::of_tiles(&Preset::Jig.errors(), tiles.len());
        let unknowns = Unknowns::new(tiles.len(), &expected, FreeParameters::ALL);
        let film = RealFilm::new(&tiles, &expected).with_iron(iron);
        let points: Vec<DVec3> =
            (0..12).map(|n| DVec3::new(f64::from(n % 4) - 2.0, f64::from(n / 4) - 1.0, -1.0)).collect();
        let model = ScanModel { film, points, noise_t: DVec3::ONE, unknowns };
        let mut state = State::nominal(tiles.len(), 0, &ScanParameters::PERFECT);
        let errors = [(0, TileError::Strength, -2.0), (0, TileError::ALL[0], 0.03), (1, TileError::Strength, 0.1)];
        errors.into_iter().for_each(|(tile, error, value)| state.set(Unknown::Tile { tile, error }, value));
        let is_used = [true; 12];
        let at = model.linearized(state.clone(), None, &is_used, None).unwrap();
        let readings = |state: State| model.linearized(state, None, &is_used, None).unwrap().field_t;
        for (unknown, column) in model.unknowns.list.iter().zip(&at.columns) {
            let moved = |step: f64| {
                let mut moved = state.clone();
                moved.set(*unknown, state.get(*unknown) + step);
                readings(moved)
            };
            let (above, below) = (moved(1e-5), moved(-1e-5));
            let differences = above.iter().zip(&below).flat_map(|(above, below)| ((*above - *below) / 2e-5).to_array());
            let largest = column.iter().zip(differences).map(|(of, other)| (of - other).abs()).fold(0.0, f64::max);
            assert!(largest < 1e-9, "{unknown:?}: {largest:e}");
        }
    }
}
