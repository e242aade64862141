//! Tiles with a common orientation, in their frames.

use glam::{DMat3, DVec3};
use magsplice_cuboid::block::{Block, LocalPoint};
use magsplice_magnet::Tile;
use magsplice_magnet::tolerances::{ROTATED_SEAM_ROUNDINGS, SEAM_ROUNDINGS, UNIT_ROUNDOFF};
use magsplice_simd::compensated_sum::TwoSum;

use super::clusters::ClusterTable;
use super::merge::merged;
use super::orientation::Orientations;
use super::seam::{Plane, joined};
use crate::tolerances::POINT_ROUNDINGS;

/// All tiles of a scene, in frames.
#[derive(Clone, Debug)]
pub struct Frames {
    axes: Vec<Axis>,
    frames: Vec<Frame>,
}

/// A direction of coordinates. Frames that share a direction share its coordinates.
#[derive(Clone, Copy, Debug)]
struct Axis {
    direction: DVec3,
    /// Axis x, y or z of the scene, whose coordinates are used unchanged.
    scene: Option<usize>,
    /// Origin of the coordinates, in the middle of the tiles to keep coordinates small.
    origin: DVec3,
}

/// Blocks with a common orientation.
#[derive(Clone, Debug)]
pub struct Frame {
    axes: [usize; 3],
    /// The rotation to the scene.
    pub to_scene: ToScene,
    /// The blocks to evaluate: tiles that form a cuboid of one polarization are merged.
    pub blocks: Vec<Block>,
    /// One block for each tile, to identify the tile at an edge.
    pub unmerged: Vec<Block>,
    /// The blocks in clusters, prepared for many points.
    pub clusters: ClusterTable,
}

/// Rotation from a frame to the scene; `None` for the scene's own frame, without rounding.
#[derive(Clone, Copy, Debug)]
pub struct ToScene(Option<DMat3>);

impl ToScene {
    /// A vector of the frame in the scene.
    pub fn vector(&self, own: DVec3) -> DVec3 {
        self.0.map_or(own, |rotation| rotation * own)
    }

    /// The rotation, or `None` for the frame of the scene.
    pub fn rotation(&self) -> Option<&DMat3> {
        self.0.as_ref()
    }

    /// A tensor of the frame in the scene.
    pub fn tensor(&self, own: DMat3) -> DMat3 {
        self.0.map_or(own, |rotation| rotation * own * rotation.transpose())
    }
}

impl Axis {
    fn coordinate(&self, point: DVec3) -> f64 {
        self.scene.map_or_else(|| self.direction.dot(point - self.origin), |axis| point[axis])
    }

    /// Bound of the error of the coordinate of `point`.
    fn roundoff(&self, point: DVec3) -> f64 {
        let distance = (point - self.origin).abs().element_sum();
        if self.scene.is_some() { 0.0 } else { POINT_ROUNDINGS * UNIT_ROUNDOFF * distance }
    }
}

impl Frames {
    /// Sorts tiles by orientation, merges tiles that form a cuboid, and divides them into clusters.
    pub fn new(tiles: &[Tile]) -> Frames {
        let rotations: Vec<_> = tiles.iter().map(Tile::rotation).collect();
        let orientations = Orientations::new(&rotations);
        let frames_of_axes = orientations.frames.iter();
        let mut frames: Vec<Frame> = frames_of_axes
            .enumerate()
            .map(|(index, &axes)| Frame {
                axes,
                to_scene: ToScene((index > 0).then(|| orientations.matrix(index))),
                blocks: Vec::new(),
                unmerged: Vec::new(),
                clusters: ClusterTable::default(),
            })
            .collect();
        let axes = axes(tiles, &orientations);
        let smallest = tiles.iter().map(|t| t.size().min_element()).fold(f64::INFINITY, f64::min);
        for (index, (tile, (frame, turn))) in tiles.iter().zip(&orientations.members).enumerate() {
            let frame = &mut frames[*frame];
            let centre = DVec3::from(frame.axes.map(|axis| axes[axis].coordinate(tile.position())));
            let block = Block::new(index, centre, turn.size(tile.size()), turn.vector(tile.polarization_t()), smallest);
            frame.unmerged.push(block);
        }
        let mut prepared = Frames { axes, frames };
        prepared.join_faces(tiles);
        for frame in &mut prepared.frames {
            frame.blocks = merged(&frame.unmerged);
            frame.clusters = ClusterTable::new(&mut frame.blocks);
        }
        prepared.frames.retain(|frame| !frame.blocks.is_empty());
        prepared
    }

    /// One frame for each orientation.
    pub fn frames(&self) -> &[Frame] {
        &self.frames
    }

    /// The frame of the only tile, if the scene has one tile.
    pub fn only_tile(&self) -> Option<&Frame> {
        let [frame] = &self.frames[..] else { return None };
        (frame.blocks.len() == 1).then_some(frame)
    }

    /// The axis of the scene that equals axis `axis` of `frame`, or else the direction and origin
    /// of that axis.
    pub fn axis(&self, frame: &Frame, axis: usize) -> Result<usize, (DVec3, DVec3)> {
        let axis = &self.axes[frame.axes[axis]];
        axis.scene.ok_or((axis.direction, axis.origin))
    }

    /// Centre of a block in the scene. It is computed from `tile`, a tile of the block, to keep
    /// rounding small.
    pub fn centre_in_scene(&self, frame: &Frame, block: &Block, tile: &Tile) -> DVec3 {
        let offset = [0, 1, 2].map(|axis: usize| {
            let from = TwoSum::exact(self.axes[frame.axes[axis]].coordinate(tile.position()));
            let [low, high] = block.faces[axis].map(|face| face.minus(from).value());
            0.5 * low + 0.5 * high
        });
        tile.position() + frame.to_scene.vector(DVec3::from(offset))
    }

    /// Bound of the error of each coordinate of `point` in `frame`.
    pub fn roundoff(&self, frame: &Frame, point: DVec3) -> [f64; 3] {
        frame.axes.map(|axis| self.axes[axis].roundoff(point))
    }

    /// The coordinates of `point` in `frame`.
    pub fn coordinates(&self, frame: &Frame, point: DVec3) -> [f64; 3] {
        frame.axes.map(|axis| self.axes[axis].coordinate(point))
    }

    /// Each frame with the coordinates of `point` in it.
    pub fn locals(&self, point: DVec3) -> impl Iterator<Item = (&Frame, LocalPoint)> {
        self.frames.iter().map(move |frame| {
            let axes = frame.axes.map(|axis| &self.axes[axis]);
            let local = LocalPoint {
                coordinates: axes.map(|axis| axis.coordinate(point)),
                roundoff: axes.map(|axis| axis.roundoff(point)),
            };
            (frame, local)
        })
    }

    /// Gives one coordinate to faces that differ by round-off only.
    fn join_faces(&mut self, tiles: &[Tile]) {
        let mut planes: Vec<Vec<Plane>> = self.axes.iter().map(|_| Vec::new()).collect();
        for (frame, blocks) in self.frames.iter().enumerate() {
            for (block, b) in blocks.unmerged.iter().enumerate() {
                for own in 0..3 {
                    let [low, high] = b.faces[own];
                    let tolerance = seam_tolerance(&tiles[b.tile], low.hi.abs().max(high.hi.abs()), frame > 0);
                    for (upper, coordinate) in [low, high].into_iter().enumerate() {
                        planes[blocks.axes[own]].push(Plane {
                            coordinate,
                            tolerance,
                            place: [frame, block, own, upper],
                        });
                    }
                }
            }
        }
        for planes in planes {
            for (coordinate, [frame, block, own, upper]) in joined(planes) {
                let block = &mut self.frames[frame].unmerged[block];
                block.moved[own][upper] = coordinate.minus(block.faces[own][upper]).value().abs();
                block.faces[own][upper] = coordinate;
                block.size[own] = block.faces[own][1].minus(block.faces[own][0]).value();
            }
        }
    }
}

fn seam_tolerance(tile: &Tile, reach: f64, rotated: bool) -> f64 {
    let position = tile.position().abs().max_element();
    UNIT_ROUNDOFF * if rotated { ROTATED_SEAM_ROUNDINGS * (position + reach) } else { SEAM_ROUNDINGS * reach }
}

fn axes(tiles: &[Tile], orientations: &Orientations) -> Vec<Axis> {
    let mut users: Vec<Vec<DVec3>> = orientations.directions.iter().map(|_| Vec::new()).collect();
    for (tile, (frame, _)) in tiles.iter().zip(&orientations.members) {
        for axis in orientations.frames[*frame] {
            users[axis].push(tile.position());
        }
    }
    let described = orientations.directions.iter().zip(users).enumerate();
    described
        .map(|(index, (&direction, positions))| {
            let scene = (index < 3).then_some(index);
            Axis { direction, scene, origin: if scene.is_some() { DVec3::ZERO } else { median(&positions) } }
        })
        .collect()
}

/// Median of each coordinate, independent of the distance of outlying tiles.
fn median(positions: &[DVec3]) -> DVec3 {
    DVec3::from([0, 1, 2].map(|axis: usize| {
        let mut values: Vec<f64> = positions.iter().map(|p| p[axis]).collect();
        values.sort_by(f64::total_cmp);
        values.get(values.len() / 2).copied().unwrap_or(0.0)
    }))
}
