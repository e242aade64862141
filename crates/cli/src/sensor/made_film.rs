//! The film that an experiment reads, where it is not the one of the layout.

use std::path::Path;

use magsplice::Film;
use magsplice::field::Scene;
use magsplice::magnet::{Bend, Deformation, HeightMap};
use magsplice::prelude::DVec3;

use crate::args::experiment::{BendAxis, ExperimentArgs};
use crate::failure::Failure;
use crate::inputs::readings;

/// The field of the deformed film. Nothing if the film is as in the layout. Tiles with a recoil
/// permeability keep the polarization that they have in the film of the layout; in a bent film they
/// have its mean.
pub(crate) fn deformed(args: &ExperimentArgs, film: &Film) -> Result<Option<Scene>, Failure> {
    let along = if args.bend_along == BendAxis::X { 0 } else { 1 };
    let bend = match (args.bend_radius, &args.heights) {
        (Some(radius), _) => Some(Bend::Cylinder { along, radius }),
        (None, Some(path)) => Some(Bend::Heights(heights(path)?)),
        (None, None) => None,
    };
    let deformation =
        Deformation { bend, rotation_rad: args.rotate.unwrap_or_default(), shift: args.shift.unwrap_or_default() };
    if deformation == Deformation::default() {
        return Ok(None);
    }
    // Cells of a bent film would bend each tile, which is stiff.
    let tiles = match film.recoil() {
        Some(recoil) if deformation.bend.is_some() => recoil.magnetization().mean_tiles(),
        Some(recoil) => recoil.magnetization().cells().to_vec(),
        None => film.layout().bare_tiles(),
    };
    let tiles = deformation.apply(&tiles).map_err(|error| Failure::Points {
        path: args.layout.clone(),
        message: format!("the film cannot be bent or moved so (lengths in mm): {error}"),
    })?;
    Ok(Some(Scene::new(&tiles)))
}

/// The heights of a CSV file.
fn heights(path: &Path) -> Result<HeightMap, Failure> {
    let failed = |message: String| Failure::Points { path: path.to_owned(), message };
    let (rows, lines) = readings::read_all(path, &[readings::POSITIONS])?;
    let points: Vec<DVec3> = rows.into_iter().map(|[point]| point).collect();
    let coordinates = |axis: usize| -> Vec<f64> {
        let mut values: Vec<f64> = points.iter().map(|point| point[axis]).collect();
        values.sort_by(f64::total_cmp);
        values.dedup();
        values
    };
    let (x, y) = (coordinates(0), coordinates(1));
    let index = |values: &[f64], value: f64| values.partition_point(|known| *known < value);
    // A full grid has as many points as pairs of coordinates, each once.
    if x.len().checked_mul(y.len()) != Some(points.len()) {
        return Err(failed(format!(
            "has {} heights at {} x and {} y, must have one for each pair of them",
            points.len(),
            x.len(),
            y.len()
        )));
    }
    let mut heights = vec![f64::NAN; points.len()];
    for (point, line) in points.iter().zip(lines) {
        let height = &mut heights[index(&x, point.x) * y.len() + index(&y, point.y)];
        if !height.is_nan() {
            return Err(failed(format!("line {line}: has the x and y of an earlier line")));
        }
        *height = point.z;
    }
    HeightMap::new(x, y, heights).map_err(|error| failed(error.to_string()))
}
