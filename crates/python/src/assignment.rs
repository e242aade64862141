//! The assignment of measured tiles to places of a film.

use magsplice::layout::Layout;
use magsplice::making::{
    AssignmentSettings, FixedTile, MeasuredBox, MeasuredMagnet, MeasuredTile, MeasurementErrors, PartlyPlaced,
    PlaceGroup, Placement,
};
use magsplice::prelude::DVec3;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::exceptions::failed;
use crate::film::Film;
use crate::results::dictionary;

/// Name and version in the history of layouts.
const PROGRAM: &str = concat!("magsplice ", env!("CARGO_PKG_VERSION"), " assign");

/// Name, part, sides, and J along the sides, or |J| alone.
type Measured = (String, Option<String>, Option<[f64; 3]>, Vec<f64>);

/// Place, tile, centre, upper side, and direction of the mark in degrees.
type Placed = (String, String, Option<[f64; 3]>, String, f64);

/// The tiles of a box at the places of a film, with the layout of the film as TOML. `errors` are
/// the errors of strength, direction in degrees and sides in millimetres.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "Python passes them by name")]
pub(crate) fn assign<'py>(
    py: Python<'py>,
    film: &Film,
    measured: Vec<Measured>,
    placed: Vec<Placed>,
    shims: Vec<String>,
    may_turn_over: bool,
    starts: Option<usize>,
    seed: u64,
    errors: Option<(f64, f64, Option<f64>)>,
) -> PyResult<(Bound<'py, PyDict>, String)> {
    let layout = &film.layout;
    let mut tiles = MeasuredBox::new(layout);
    refused("measured", measured.iter().map(|tile| added(&mut tiles, tile)))?;
    let (has_sizes, mut groups) = (tiles.has_sizes(), tiles.into_groups());
    let shims = taken_out(layout, &shims, &mut groups)?;
    let partly = partly_placed(layout, &groups, &placed)?;
    let settings = AssignmentSettings { starts, seed, may_turn_over, ..AssignmentSettings::default() };
    let errors = errors.map(|(strength, direction_deg, size_mm)| MeasurementErrors {
        strength,
        direction_rad: direction_deg.to_radians(),
        size_mm,
    });
    let assigned = film.run(py, |film| film.assign(&partly, &shims, &settings, errors))?;
    let text = film.evaluated(py)?.assigned_layout(&assigned, has_sizes, PROGRAM).to_toml();
    Ok((dictionary(py, &assigned)?, text))
}

fn added(tiles: &mut MeasuredBox, (name, part, size_mm, j_t): &Measured) -> Result<(), Vec<String>> {
    let magnet = match j_t[..] {
        [strength_t] => MeasuredMagnet::Strength(strength_t),
        [x, y, z] => MeasuredMagnet::Polarization(DVec3::new(x, y, z)),
        _ => return Err(vec![format!("polarization_t has {} components, must have 3 or be a number", j_t.len())]),
    };
    tiles.add(&MeasuredTile { name, part: part.as_deref(), size_mm: size_mm.map(DVec3::from), magnet })
}

/// The indices of the shims. Their places are removed from the groups.
fn taken_out(layout: &Layout, shims: &[String], groups: &mut [PlaceGroup]) -> PyResult<Vec<usize>> {
    let mut found: Vec<usize> = Vec::new();
    refused(
        "shims",
        shims.iter().map(|name| match layout.tiles.iter().position(|named| named.name == *name) {
            None => Err(vec![format!("\"{name}\", must be the name of a tile of the film")]),
            Some(tile) if found.contains(&tile) => Err(vec![format!("\"{name}\" is given twice")]),
            Some(tile) => {
                found.push(tile);
                Ok(())
            }
        }),
    )?;
    groups.iter_mut().for_each(|group| group.places.retain(|place| !found.contains(place)));
    Ok(found)
}

fn partly_placed(layout: &Layout, groups: &[PlaceGroup], placed: &[Placed]) -> PyResult<PartlyPlaced> {
    let mut placement = Placement::new(layout, groups);
    let add = |(place, tile, position_mm, up, mark_deg): &Placed| {
        let position_mm = position_mm.map(DVec3::from);
        placement.place(&FixedTile { place, tile, position_mm, up, mark_deg: *mark_deg })
    };
    refused("placed", placed.iter().map(add))?;
    Ok(placement.finish())
}

/// An exception that lists the items with faults.
fn refused(list: &str, items: impl Iterator<Item = Result<(), Vec<String>>>) -> PyResult<()> {
    let with_faults = |(index, item): (usize, Result<(), Vec<String>>)| item.err().map(|faults| (index, faults));
    let faults: Vec<(usize, Vec<String>)> = items.enumerate().filter_map(with_faults).collect();
    if faults.is_empty() {
        return Ok(());
    }
    let lines = faults.iter().map(|(index, faults)| format!("{list}[{index}]: {}", faults.join("; ")));
    Err(failed(lines.collect::<Vec<String>>().join("\n")))
}
