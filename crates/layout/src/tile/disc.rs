//! Discs as strips of cuboids.

use std::f64::consts::PI;
use std::sync::Arc;

use glam::DVec3;
use magsplice_magnet::Tile;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::faults::{POSITIVE, Rule, TableFaults};
use crate::layout::{NamedTile, WholeDisc};

/// The shape of a tile.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Shape {
    /// A cuboid with the sides size_mm.
    #[default]
    Block,
    /// A disc about the tile's own z with diameter_mm and height_mm, as strips of cuboids.
    Disc,
}

/// Largest error of the field of a disc if none is stated: a third of the spread of magnets from a
/// shop.
const DEFAULT_ERROR: f64 = 0.01;

/// Least error, which takes 100 strips.
const LEAST_ERROR: f64 = 1e-4;

const ERROR: Rule = Rule { is_kept: |error| (LEAST_ERROR..=0.1).contains(&error), words: "must be from 0.0001 to 0.1" };

/// The keys of a disc, in a tile or in its kind.
#[derive(Clone, Copy, Default, Deserialize, JsonSchema, Serialize)]
pub(crate) struct DiscKeys {
    /// Shape of the tile. Default: block.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) shape: Option<Shape>,
    /// Diameter of a disc, in mm.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("example" = "5.0"))]
    pub(crate) diameter_mm: Option<f64>,
    /// Height of a disc along its axis, the tile's own z, in mm.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("example" = "1.0"))]
    pub(crate) height_mm: Option<f64>,
    /// Largest error of the field of a disc one radius away from it, as a fraction of the largest
    /// field there: 0.0001 to 0.1. Default: 0.01.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) shape_error: Option<f64>,
}

/// A disc about the z axis of its own frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Disc {
    diameter_mm: f64,
    height_mm: f64,
    /// Largest error of its field one radius away.
    pub(crate) error: f64,
}

impl DiscKeys {
    /// The disc, or `None` for a block, or after adding faults. `has_size` is whether `size_mm` is
    /// given beside.
    pub(crate) fn resolve(&self, has_size: bool, faults: &mut TableFaults) -> Option<Disc> {
        let given =
            [("diameter_mm", self.diameter_mm), ("height_mm", self.height_mm), ("shape_error", self.shape_error)];
        if self.shape.unwrap_or_default() == Shape::Block {
            let stray = given.into_iter().find(|(_, value)| value.is_some());
            return stray.and_then(|(key, _)| faults.refuse(format!("gives {key}, which goes with shape = \"disc\"")));
        }
        let before = faults.count();
        if has_size {
            faults.add("gives size_mm, which a disc does not have: it has diameter_mm and height_mm");
        }
        let mut length = |key: &str, value: Option<f64>| match value {
            Some(value) => {
                faults.number(key, value, POSITIVE);
                value
            }
            None => {
                faults.add(format!("has no {key}, which a disc needs"));
                1.0
            }
        };
        let (diameter_mm, height_mm) = (length("diameter_mm", self.diameter_mm), length("height_mm", self.height_mm));
        let error = self.shape_error.unwrap_or(DEFAULT_ERROR);
        faults.number("shape_error", error, ERROR);
        (faults.count() == before).then_some(Disc { diameter_mm, height_mm, error })
    }
}

impl Disc {
    /// The sides of the block around it.
    pub(crate) fn block_mm(self) -> DVec3 {
        DVec3::new(self.diameter_mm, self.diameter_mm, self.height_mm)
    }

    /// Number of strips.
    ///
    /// The largest error one radius away from the disc, over the largest field there, was at most
    /// 0.47 / N^2 for N strips magnetized along the axis, and 0.9 / N^2 across it, for heights of
    /// 0.02 to 2 diameters and 3 to 32 strips, against the closed form of the cylinder in magpylib
    /// 6.3.0 (docs/layout-format.md, tests/reference/discs.csv).
    pub(crate) fn strips(self) -> usize {
        (1.0 / self.error).sqrt().ceil() as usize
    }

    /// The strips of a tile with the block around the disc, along its own x. Their ends across are
    /// at cosines of equal angles, and each has the area of the disc between its long sides. `None`
    /// if a strip breaks a rule of tiles.
    pub(crate) fn tiles(self, named: &NamedTile) -> Option<Vec<NamedTile>> {
        let (count, radius) = (self.strips(), 0.5 * self.diameter_mm);
        let Disc { diameter_mm, height_mm, .. } = self;
        let whole = Arc::new(WholeDisc { name: named.name.clone(), diameter_mm, height_mm });
        let angle = |strip: usize| PI * strip as f64 / count as f64;
        // Twice the area between the diameter and a line at radius * cos(angle), over radius^2.
        let area = |angle: f64| angle - angle.sin() * angle.cos();
        let strip = |number: usize| {
            let (before, after) = (angle(number), angle(number + 1));
            let (lower, upper) = (-radius * before.cos(), -radius * after.cos());
            let width = upper - lower;
            let length = radius * radius * (area(after) - area(before)) / width;
            let centre = DVec3::new(0.0, 0.5 * (lower + upper), 0.0);
            let tile = &named.tile;
            let size = DVec3::new(length, width, self.height_mm);
            let position = tile.position() + tile.rotation() * centre;
            let tile = Tile::new(position, size, tile.polarization_t()).ok()?.rotated(tile.rotation()).ok()?;
            let name = format!("{}-s{}", named.name, number + 1);
            Some(NamedTile { name, tile, disc: Some(whole.clone()), ..named.clone() })
        };
        (0..count).map(strip).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Strips touch, end at the rim, and have the area of the disc.
    #[test]
    fn strips_have_the_area_of_the_disc() {
        for error in [0.1, 0.01, 1e-4] {
            let disc = Disc { diameter_mm: 5.0, height_mm: 1.0, error };
            let block = Tile::new(DVec3::new(1.0, 2.0, 3.0), disc.block_mm(), DVec3::Z).expect("a tile");
            let strips = disc.tiles(&NamedTile::new("d", block)).expect("tiles");
            assert_eq!(strips.len(), disc.strips());
            let area: f64 = strips.iter().map(|strip| strip.tile.size().x * strip.tile.size().y).sum();
            assert!((area - PI * 6.25).abs() < 1e-12, "{area}");
            let [lower, upper] = [-1.0, 1.0]
                .map(|side| move |strip: &NamedTile| strip.tile.position().y + 0.5 * side * strip.tile.size().y);
            assert!((lower(&strips[0]) + 0.5).abs() < 1e-14 && (upper(&strips[strips.len() - 1]) - 4.5).abs() < 1e-14);
            assert!(strips.windows(2).all(|pair| (upper(&pair[0]) - lower(&pair[1])).abs() < 1e-14));
            assert_eq!(strips[0].name, "d-s1");
        }
    }
}
