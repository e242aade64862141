//! Where a fit starts: signed exchanges of the axes of sensor and stage, and shifts of the scan.

use glam::{DMat3, DQuat, DVec3};
use magsplice_field::Scene;
use magsplice_magnet::BoundingBox;
use magsplice_sensor::SensedField;
use nalgebra::{Matrix3, Matrix4, SMatrix};
use rayon::prelude::*;

use crate::exclusion::Exclusion;
use crate::parameters::{FreeParameters, ScanParameters};
use crate::signed_axes::SignedAxes;

/// Distance of neighbouring shifts, in units of the field over its gradient: a wavelength over
/// 2 pi. A fit converges from within a quarter of a wavelength.
const STEP: f64 = 1.5;

/// Numbers of steps to each side along x, y, z: three quarters of a wavelength, and a quarter along
/// z, beyond which the field hardly exists or the sensor is in the film.
const STEPS: [i32; 3] = [3, 3, 1];

/// The same about likely places nearer to the film.
const NEAR_STEPS: [i32; 3] = [1, 1, 1];

/// Distances of likely planes from the film, over that of the likely place of a scan: films are
/// scanned in the working volume, or a millimetre or two below where faulty tiles are seen best.
const HEIGHTS: [f64; 3] = [1.0, 0.5, 0.25];

/// Number of starts of one search that are fitted.
const FITTED: usize = 6;

/// Error over the least one up to which a start with less changes comes first.
pub(crate) const SIMILAR: f64 = 1.1;

/// Strengths, over the strength of the layout, of starts. A scan far from the film fits with any.
const STRENGTHS: std::ops::RangeInclusive<f64> = 0.3..=3.0;

/// Largest ratio of the gains along two axes of a start that rotates or exchanges axes.
const MOST_SKEW: f64 = 1.5;

/// Share of the readings, the best, that a start explains: the others may be outliers.
const EXPLAINED: f64 = 0.75;

/// The start of a fit: the sensor at p of the stage reads `sensor_axes` of the reading with
/// these parameters at `stage_axes` of p.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Start {
    pub(crate) sensor_axes: SignedAxes,
    pub(crate) stage_axes: SignedAxes,
    pub(crate) parameters: ScanParameters,
}

impl Start {
    /// A perfect scan.
    pub(crate) const PERFECT: Start =
        Start { sensor_axes: SignedAxes::SAME, stage_axes: SignedAxes::SAME, parameters: ScanParameters::PERFECT };
}

/// What may be otherwise than in a perfect scan.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Search {
    /// The axes of the sensor.
    Sensor,
    /// The axes of the stage too, with its middle at the likely place.
    Stage,
    /// The place of its middle too.
    Shifts,
}

impl Search {
    /// Whether it can find other parameters than the fit that has begun with the perfect scan.
    pub(crate) const fn is_free(self, free: FreeParameters) -> bool {
        match self {
            Search::Sensor => free.rotation,
            Search::Stage | Search::Shifts => free.start,
        }
    }

    /// Largest number of readings by which starts are compared. Twelve coefficients are determined
    /// by three numbers of each. The last search has up to 10 000 starts.
    const fn compared(self) -> usize {
        match self {
            Search::Sensor | Search::Stage => 100,
            Search::Shifts => 40,
        }
    }
}

/// The starts of a search that explain the readings best, the best first. The readings at a start
/// are a linear function of the field, whose least squares give strength, offset and orientation at
/// once. `centre` is the likely place of the middle of the scan.
pub(crate) fn starts(
    search: Search,
    field: &SensedField,
    points: &[DVec3],
    readings_t: &[DVec3],
    exclusions: &[Option<Exclusion>],
    free: FreeParameters,
    centre: Option<DVec3>,
) -> Vec<Start> {
    let (points, readings_t) = sparse(points, readings_t, exclusions, search.compared());
    let lower = points.iter().copied().reduce(DVec3::min).unwrap_or_default();
    let upper = points.iter().copied().reduce(DVec3::max).unwrap_or_default();
    let middle = 0.5 * (lower + upper);
    let places = centre.map_or_else(Vec::new, |centre| planes(field.scene(), centre));
    let stages = if search == Search::Sensor { vec![SignedAxes::SAME] } else { SignedAxes::all() };
    let of_stage = |stage_axes: SignedAxes| -> Vec<(f64, Start)> {
        let turned: Vec<DVec3> = points.iter().map(|point| stage_axes.apply(*point)).collect();
        let likely: Vec<DVec3> = places.iter().map(|place| *place - stage_axes.apply(middle)).collect();
        let oriented = |shift: DVec3| {
            let places: Vec<DVec3> = turned.iter().map(|point| *point + shift).collect();
            // A place without a field, such as in a tile, is no place of a sensor.
            let (error, start) = oriented(&field.readings_t(&places).ok()?, &readings_t, free)?;
            Some((
                error,
                Start { stage_axes, parameters: ScanParameters { start: shift, ..start.parameters }, ..start },
            ))
        };
        search.shifts(field, &turned, &likely).into_iter().filter_map(oriented).collect()
    };
    simplest_first(stages.into_par_iter().flat_map_iter(of_stage).collect())
}

/// The likely place of the middle of a scan, then the places between it and the film.
fn planes(scene: &Scene, centre: DVec3) -> Vec<DVec3> {
    let BoundingBox { lower, upper } = scene.bounding_box();
    let face = centre.z.clamp(lower.z, upper.z);
    HEIGHTS.map(|height| DVec3::new(centre.x, centre.y, face + height * (centre.z - face))).to_vec()
}

/// At most so many of the usable points and readings, evenly along the scan.
pub(crate) fn sparse(
    points: &[DVec3],
    readings_t: &[DVec3],
    exclusions: &[Option<Exclusion>],
    most: usize,
) -> (Vec<DVec3>, Vec<DVec3>) {
    let usable: Vec<usize> = (0..points.len()).filter(|index| exclusions[*index].is_none()).collect();
    let chosen = usable.iter().step_by(usable.len().div_ceil(most).max(1));
    chosen.map(|index| (points[*index], readings_t[*index])).unzip()
}

/// The starts of least error. Of similar errors, such as those of the reflections of a symmetric
/// film, the start that comes first changes least.
fn simplest_first(found: Vec<(f64, Start)>) -> Vec<Start> {
    let mut left: Vec<(usize, (f64, Start))> = found.into_iter().enumerate().collect();
    left.sort_by(|a, b| a.1.0.total_cmp(&b.1.0));
    let mut starts = Vec::new();
    while starts.len() < FITTED && !left.is_empty() {
        let limit = SIMILAR * left[0].1.0;
        let similar = left.partition_point(|(_, (error, _))| *error <= limit);
        let mut group: Vec<(usize, (f64, Start))> = left.drain(..similar.max(1)).collect();
        group.sort_by_key(|(index, _)| *index);
        starts.extend(group.into_iter().map(|(_, (_, start))| start));
    }
    starts.truncate(FITTED);
    starts
}

impl Search {
    /// The shifts to be tried: none, and those that bring the scan to its likely places, or those
    /// about them.
    fn shifts(self, field: &SensedField, points: &[DVec3], likely: &[DVec3]) -> Vec<DVec3> {
        let mut shifts = vec![DVec3::ZERO];
        if self != Search::Sensor {
            shifts.extend(likely);
        }
        if self == Search::Shifts {
            let steps = std::iter::once(STEPS).chain(std::iter::repeat(NEAR_STEPS));
            shifts.extend(likely.iter().zip(steps).flat_map(|(likely, steps)| about(field, points, *likely, steps)));
        }
        shifts
    }
}

/// The shifts about one that brings the scan to a likely place.
fn about(field: &SensedField, points: &[DVec3], likely: DVec3, steps: [i32; 3]) -> Vec<DVec3> {
    let places: Vec<DVec3> = points.iter().map(|point| *point + likely).collect();
    let (Ok(field_t), Ok(gradients)) = (field.readings_t(&places), field.gradients(&places)) else { return Vec::new() };
    let squares = |matrix: &DMat3| matrix.to_cols_array().iter().map(|g| g * g).sum::<f64>();
    let field_squares: f64 = field_t.iter().map(|field| field.length_squared()).sum();
    let step = STEP * (field_squares / gradients.iter().map(squares).sum::<f64>()).sqrt();
    if !step.is_finite() {
        return Vec::new();
    }
    let [x, y, z] = steps.map(|steps| -steps..=steps);
    let mut shifts = Vec::new();
    for i in x {
        for j in y.clone() {
            shifts.extend(z.clone().map(|k| likely + step * DVec3::from([i, j, k].map(f64::from))));
        }
    }
    shifts
}

/// Orientation, strength and offset of the best linear function of the field, and the largest error
/// of the readings that it explains. `None` for functions that no sensor has.
pub(crate) fn oriented(field_t: &[DVec3], readings_t: &[DVec3], free: FreeParameters) -> Option<(f64, Start)> {
    let mut kept: Vec<usize> = (0..field_t.len()).collect();
    let explained = (EXPLAINED * field_t.len() as f64).ceil() as usize;
    let (mut linear, mut offset_t) = regression(field_t, readings_t, &kept, free.offset)?;
    let mut error = f64::INFINITY;
    for _ in 0..2 {
        let errors: Vec<f64> = field_t
            .iter()
            .zip(readings_t)
            .map(|(field, reading)| (*reading - linear * *field - offset_t).length_squared())
            .collect();
        kept = (0..field_t.len()).collect();
        kept.sort_by(|a, b| errors[*a].total_cmp(&errors[*b]));
        kept.truncate(explained.max(1));
        error = errors[*kept.last()?].sqrt();
        (linear, offset_t) = regression(field_t, readings_t, &kept, free.offset)?;
    }
    let svd = Matrix3::from_column_slice(&linear.to_cols_array()).svd(true, true);
    let (gains, orthogonal) = (svd.singular_values, svd.u? * svd.v_t?);
    let strength = gains.sum() / 3.0;
    if !STRENGTHS.contains(&strength) || !(gains.max() < MOST_SKEW * gains.min()) {
        return None;
    }
    // The orthogonal matrix is E R^-1 with the nearest signed exchange E. E that is a rotation
    // belongs to R.
    let orthogonal = DMat3::from_cols_slice(orthogonal.as_slice());
    let nearest = SignedAxes::nearest(orthogonal);
    let sensor_axes = if nearest.is_rotation() { SignedAxes::SAME } else { nearest };
    let turn = DQuat::from_mat3(&(sensor_axes.matrix().transpose() * orthogonal)).inverse();
    if !free.rotation && (nearest != SignedAxes::SAME) {
        return None;
    }
    let parameters = ScanParameters {
        strength: if free.strength { strength } else { 1.0 },
        offset_t: if free.offset { sensor_axes.inverse().apply(offset_t) } else { DVec3::ZERO },
        rotation_rad: if free.rotation { turn.to_scaled_axis() } else { DVec3::ZERO },
        start: DVec3::ZERO,
    };
    Some((error, Start { sensor_axes, stage_axes: SignedAxes::SAME, parameters }))
}

/// The matrix and the constant that give readings from the field by least squares.
fn regression(field_t: &[DVec3], readings_t: &[DVec3], kept: &[usize], has_offset: bool) -> Option<(DMat3, DVec3)> {
    // The constant is a fourth component of the field, in its unit.
    let squares: f64 = kept.iter().map(|index| field_t[*index].length_squared()).sum();
    let unit = (squares / (3 * kept.len().max(1)) as f64).sqrt();
    let (mut normal, mut right) = (Matrix4::zeros(), SMatrix::<f64, 4, 3>::zeros());
    for &index in kept {
        let DVec3 { x, y, z } = field_t[index];
        let row = nalgebra::Vector4::new(x, y, z, if has_offset { unit } else { 0.0 });
        normal += row * row.transpose();
        right += row * nalgebra::RowVector3::from(readings_t[index].to_array());
    }
    if !has_offset {
        normal[(3, 3)] = unit * unit;
    }
    let solved = normal.cholesky()?.solve(&right);
    let row = |i: usize| DVec3::new(solved[(i, 0)], solved[(i, 1)], solved[(i, 2)]);
    Some((DMat3::from_cols(row(0), row(1), row(2)), unit * row(3)))
}
