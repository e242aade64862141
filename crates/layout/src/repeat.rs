//! Grids and mirrors of one tile.

use glam::{DQuat, DVec3};

use crate::layout::NamedTile;
use crate::resolve::{MAX_TILES, checked_tile};
use crate::written::{Axis, Mirror, Reflection, Repeat, Rotation};

impl Axis {
    fn index(self) -> usize {
        self as usize
    }

    fn letter(self) -> char {
        ['x', 'y', 'z'][self.index()]
    }
}

/// Adds the tile, its copies on the grid, and the mirror images of all of them.
pub(crate) fn repeated(
    tile: NamedTile,
    grid: Option<&Repeat>,
    mirror: Option<&Mirror>,
    tiles: &mut Vec<NamedTile>,
    report: &mut dyn FnMut(String),
) {
    let Some(mut copies) = on_grid(tile, grid, report) else { return };
    if let Some(mirror) = mirror {
        if !sound_mirror(mirror, copies.len(), report) {
            return;
        }
        for &axis in &mirror.axes {
            let images: Vec<NamedTile> = copies.iter().filter_map(|tile| image(tile, axis, mirror, report)).collect();
            copies.extend(images);
        }
    }
    tiles.extend(copies);
}

fn sound_mirror(mirror: &Mirror, copies: usize, report: &mut dyn FnMut(String)) -> bool {
    let mut sound = true;
    let mut complain = |message: String| {
        sound = false;
        report(message);
    };
    if mirror.axes.is_empty() {
        complain("mirror.axes is empty, must name at least one of \"x\", \"y\", \"z\"".to_owned());
    }
    if let Some(axis) = repeated_axis(&mirror.axes) {
        complain(format!("mirror.axes names \"{}\" twice, must name an axis once", axis.letter()));
    }
    if !mirror.at_mm.iter().all(|c| c.is_finite()) {
        complain(format!("mirror.at_mm = {:?}, must be three finite numbers", mirror.at_mm));
    }
    if copies << mirror.axes.len().min(3) > MAX_TILES {
        complain(format!("mirror makes more than {MAX_TILES} tiles"));
    }
    sound
}

fn repeated_axis(axes: &[Axis]) -> Option<Axis> {
    axes.iter().enumerate().find(|(i, axis)| axes[..*i].contains(axis)).map(|(_, axis)| *axis)
}

fn on_grid(tile: NamedTile, grid: Option<&Repeat>, report: &mut dyn FnMut(String)) -> Option<Vec<NamedTile>> {
    let Some(grid) = grid else { return Some(vec![tile]) };
    let total = grid.count.iter().try_fold(1_usize, |product, n| product.checked_mul(*n)).unwrap_or(usize::MAX);
    if total == 0 || total > MAX_TILES {
        let count = grid.count;
        report(format!("grid.count = {count:?}, must be at least 1 each and {MAX_TILES} tiles in all"));
        return None;
    }
    let mut sound = true;
    if let Some(axis) = repeated_axis(&grid.alternate) {
        sound = false;
        report(format!("grid.alternate names \"{}\" twice, must name an axis once", axis.letter()));
    }
    if !grid.pitch_mm.iter().all(|c| c.is_finite()) {
        sound = false;
        report(format!("grid.pitch_mm = {:?}, must be three finite numbers", grid.pitch_mm));
    }
    if !sound {
        return None;
    }
    let mut copies = Vec::with_capacity(total);
    for i in 0..grid.count[0] {
        for j in 0..grid.count[1] {
            for k in 0..grid.count[2] {
                let steps = [i, j, k];
                let shift = DVec3::from(grid.pitch_mm) * DVec3::new(i as f64, j as f64, k as f64);
                let odd = grid.alternate.iter().map(|axis| steps[axis.index()]).sum::<usize>() % 2 == 1;
                let polarization = tile.tile.polarization_t() * if odd { -1.0 } else { 1.0 };
                let place: String = (0..3)
                    .filter(|&axis| grid.count[axis] > 1)
                    .map(|axis| format!("-{}{}", ['x', 'y', 'z'][axis], steps[axis] + 1))
                    .collect();
                let moved = checked_tile(tile.tile.position() + shift, tile.tile.size(), polarization, report)?;
                copies.push(NamedTile {
                    name: format!("{}{place}", tile.name),
                    tile: moved.rotated(tile.tile.rotation()).ok()?,
                    ..tile.clone()
                });
            }
        }
    }
    Some(copies)
}

fn image(named: &NamedTile, axis: Axis, mirror: &Mirror, report: &mut dyn FnMut(String)) -> Option<NamedTile> {
    let flip = |mut v: DVec3| {
        v[axis.index()] = -v[axis.index()];
        v
    };
    let tile = &named.tile;
    let mut position = tile.position();
    position[axis.index()] = 2.0 * mirror.at_mm[axis.index()] - position[axis.index()];
    // With M the mirror, a tile turned by R becomes one turned by M R M; a cuboid is its own mirror image in its own
    // frame, where the arrow of its polarization is reflected by M. The vector part of M R M is -M times that of R.
    let q = tile.rotation();
    let vector = -flip(DVec3::new(q.x, q.y, q.z));
    let rotation = DQuat::from_xyzw(vector.x, vector.y, vector.z, q.w);
    let written =
        named.rotation.map(|r| Rotation { axis: flip(DVec3::from(r.axis)).to_array(), angle_deg: -r.angle_deg });
    let own = tile.polarization_t();
    let polarization = match mirror.polarization {
        Reflection::Reflect => flip(own),
        Reflection::Axial => -flip(own),
        // In the scene's frame it stays; in the tile's own frame that is R'^-1 R.
        Reflection::Keep if named.rotation.is_some() => rotation.inverse() * (q * own),
        Reflection::Keep => own,
    };
    Some(NamedTile {
        name: format!("{}-m{}", named.name, axis.letter()),
        kind: named.kind.clone(),
        rotation: written,
        tile: checked_tile(position, tile.size(), polarization, report)?.rotated(rotation).ok()?,
    })
}
