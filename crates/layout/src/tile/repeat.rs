//! Repetition of one tile: copies on a grid, and mirror images.

use glam::DVec3;
use magsplice_magnet::Axis;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::faults::TableFaults;
use crate::layout::NamedTile;
use crate::tile::checked_tile;
use crate::tile::room::Room;

/// Copies of a tile on a regular grid that begins at the tile's position.
#[derive(Deserialize, JsonSchema, Serialize)]
#[schemars(extend("example" = "{ count = [4, 4, 1], pitch_mm = [5.0, 5.0, 0.0] }"))]
pub(crate) struct GridTable {
    /// Number of copies along x, y, z, the tile itself included.
    #[schemars(extend("example" = "[4, 4, 1]"))]
    count: [usize; 3],
    /// Distance between neighbouring copies along x, y, z, in mm.
    #[schemars(extend("example" = "[5.0, 5.0, 0.0]"))]
    pitch_mm: [f64; 3],
    /// Axes along which the polarization of every other copy is reversed.
    #[serde(default)]
    alternate: Vec<Axis>,
}

/// Mirror images of a tile and its copies.
#[derive(Default, Deserialize, JsonSchema, Serialize)]
#[schemars(extend("example" = "{ axes = [\"x\"] }"))]
pub(crate) struct MirrorTable {
    /// Axes normal to the mirrors, which are applied one after the other.
    #[schemars(extend("example" = "[\"x\"]"))]
    pub(crate) axes: Vec<Axis>,
    /// A point on the mirrors, in mm. Default: the origin.
    #[serde(default)]
    #[schemars(extend("example" = "[0.0, 0.0, 0.0]"))]
    pub(crate) at_mm: [f64; 3],
    /// How the polarization is mirrored. Default: reflect.
    #[serde(default)]
    pub(crate) polarization: Reflection,
}

#[derive(Clone, Copy, Default, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Reflection {
    /// Like an arrow drawn on the tile: the component normal to the mirror changes sign.
    #[default]
    Reflect,
    /// Like a magnetization, which is a pseudovector: the components in the mirror plane change
    /// sign.
    Axial,
    /// Not changed.
    Keep,
}

/// A tile, its copies on the grid, and the mirror images of all of them, each of which makes
/// `strips` tiles. `None` after adding a fault.
pub(crate) fn resolve(
    tile: NamedTile,
    strips: usize,
    grid: Option<&GridTable>,
    mirror: Option<&MirrorTable>,
    room: &mut Room,
    faults: &mut TableFaults,
) -> Option<Vec<NamedTile>> {
    let before = faults.count();
    if let Some(grid) = grid {
        check_grid(grid, faults);
    }
    if let Some(mirror) = mirror {
        check_mirror(mirror, faults);
    }
    if faults.count() > before {
        return None;
    }
    let copies = grid.map_or(1, |grid| grid.count.iter().fold(1, |product: usize, n| product.saturating_mul(*n)));
    let copies = copies.saturating_mul(strips);
    let total = mirror.map_or(copies, |mirror| copies.saturating_mul(1 << mirror.axes.len()));
    let what = match (grid, mirror) {
        (Some(grid), None) => format!("grid.count = {:?} makes {total} tiles", grid.count),
        (Some(_), Some(_)) => format!("grid and mirror make {total} tiles"),
        (None, _) => format!("makes {total} tiles"),
    };
    let name_bytes = tile.name.len() + tile.kind.as_ref().map_or(0, String::len);
    if !room.take(total, name_bytes, what, faults) {
        return None;
    }
    let mut tiles = match grid {
        None => vec![tile],
        Some(grid) => copies_on_grid(&tile, grid, faults)?,
    };
    if let Some(mirror) = mirror {
        for &axis in &mirror.axes {
            let images: Vec<NamedTile> =
                tiles.iter().filter_map(|tile| mirror_image(tile, axis, mirror, faults)).collect();
            tiles.extend(images);
        }
    }
    Some(tiles)
}

fn check_mirror(mirror: &MirrorTable, faults: &mut TableFaults) {
    if mirror.axes.is_empty() {
        faults.add("mirror.axes is empty, must have at least one of \"x\", \"y\", \"z\"");
    }
    check_axes_differ("mirror.axes", &mirror.axes, faults);
    faults.point("mirror.at_mm", mirror.at_mm);
}

fn check_grid(grid: &GridTable, faults: &mut TableFaults) {
    if grid.count.contains(&0) {
        faults.add(format!("grid.count = {:?}, must be at least 1 along each axis", grid.count));
    }
    check_axes_differ("grid.alternate", &grid.alternate, faults);
    faults.point("grid.pitch_mm", grid.pitch_mm);
}

fn check_axes_differ(key: &str, axes: &[Axis], faults: &mut TableFaults) {
    if let Some((_, axis)) = axes.iter().enumerate().find(|(i, axis)| axes[..*i].contains(axis)) {
        faults.add(format!("{key} names \"{}\" twice, must name an axis once", axis));
    }
}

fn copies_on_grid(tile: &NamedTile, grid: &GridTable, faults: &mut TableFaults) -> Option<Vec<NamedTile>> {
    let mut copies = Vec::with_capacity(grid.count.iter().product());
    for i in 0..grid.count[0] {
        for j in 0..grid.count[1] {
            for k in 0..grid.count[2] {
                let steps = [i, j, k];
                let shift = DVec3::from(grid.pitch_mm) * DVec3::new(i as f64, j as f64, k as f64);
                let reversed = grid.alternate.iter().map(|axis| steps[axis.index()]).sum::<usize>() % 2 == 1;
                let polarization = tile.tile.polarization_t() * if reversed { -1.0 } else { 1.0 };
                let suffix: String = (0..3)
                    .filter(|&axis| grid.count[axis] > 1)
                    .map(|axis| format!("-{}{}", Axis::ALL[axis], steps[axis] + 1))
                    .collect();
                let moved = checked_tile(tile.tile.position() + shift, tile.tile.size(), polarization, faults)?;
                copies.push(NamedTile {
                    name: format!("{}{suffix}", tile.name),
                    tile: moved.rotated(tile.tile.rotation()).ok()?,
                    ..tile.clone()
                });
            }
        }
    }
    Some(copies)
}

/// The mirror image of a tile in the plane normal to `axis`.
///
/// With M the mirror, a tile rotated by R becomes one rotated by M R M. In its own frame a cuboid
/// is its own mirror image, and M reflects the arrow of its polarization.
fn mirror_image(named: &NamedTile, axis: Axis, mirror: &MirrorTable, faults: &mut TableFaults) -> Option<NamedTile> {
    let flip = |mut v: DVec3| {
        v[axis.index()] = -v[axis.index()];
        v
    };
    let tile = &named.tile;
    let mut position = tile.position();
    position[axis.index()] = 2.0 * mirror.at_mm[axis.index()] - position[axis.index()];
    let q = tile.rotation();
    // From the written rotation, so that the written image is the same tile to the last digit.
    let written = named.rotation.map(|rotation| rotation.mirrored(axis.index()));
    let rotation = written.map_or(q, |written| written.quaternion());
    let own = tile.polarization_t();
    let polarization = match mirror.polarization {
        Reflection::Reflect => flip(own),
        Reflection::Axial => -flip(own),
        // Unchanged in the scene's frame; in the frame of the image, rotated by R', it is R'^-1 R
        // J.
        Reflection::Keep if named.rotation.is_some() => rotation.inverse() * (q * own),
        Reflection::Keep => own,
    };
    Some(NamedTile {
        name: format!("{}-m{}", named.name, axis),
        kind: named.kind.clone(),
        rotation: written,
        tile: checked_tile(position, tile.size(), polarization, faults)?.rotated(rotation).ok()?,
        permeability: named.permeability,
        disc: None,
    })
}
