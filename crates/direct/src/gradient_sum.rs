//! The gradient of B summed over the tiles of a scene at a batch of points.

use std::cell::RefCell;
use std::collections::BTreeMap;

use fearless_simd::{Level, dispatch};
use glam::{DMat3, DVec3};
use magsplice_cuboid::block::{Block, LocalPoint};
use magsplice_cuboid::closed_form::gradient::COMPONENTS;
use magsplice_cuboid::gradient_evaluator::GradientEvaluator;
use magsplice_cuboid::method::{Method, MethodIndex};
use magsplice_cuboid::scalar::kernel::cuboid_gradient;
use magsplice_cuboid::series::multipole::TruncatedGradient;
use magsplice_expansion::tolerances::{HIGHEST_DEGREE, POINTS_PER_DEGREE};
use magsplice_simd::column::{Column, views};

use super::cluster_gradient::KeptPlaces;
use super::coordinates::Coordinates;
use super::edges::EdgesAtPoint;
use super::gradient_totals::{GradientTotals, Gradients};
use super::sorted_points::SortedPoints;
use crate::prepare::clusters::Cluster;
use crate::prepare::frames::{Frame, Frames};
use crate::tolerances::FURTHER_DEGREES;

/// Buffers for a batch of points; none of them grows with the number of tiles.
#[derive(Default)]
pub struct GradientSum {
    points: Coordinates,
    /// The points in the current frame.
    local: Coordinates,
    totals: GradientTotals,
    /// The points on edge lines, with the edges they are on.
    edges: BTreeMap<usize, EdgesAtPoint>,
    sorted: SortedPoints,
    sorted_by_tile: SortedPoints,
    gathered: Coordinates,
    /// The points near a cluster.
    gathered_near: Coordinates,
    /// The points in a tile and close to it.
    near: Vec<u32>,
    /// Whether the closed form covers each point in a tile and close to it.
    covered: Column,
    gathered_in_scene: Coordinates,
    /// Bounds of the errors of the gathered coordinates.
    roundoff: Coordinates,
    /// The gradient of one tile or cluster, in its frame.
    gradients: Gradients,
    places: KeptPlaces,
    finite: bool,
}

/// The arguments shared by all clusters of a frame.
#[derive(Clone, Copy)]
struct FrameSum<'a> {
    level: Level,
    frames: &'a Frames,
    frame: &'a Frame,
    points: &'a [DVec3],
    local: &'a Coordinates,
}

impl FrameSum<'_> {
    fn local_point(&self, index: u32) -> LocalPoint {
        let index = index as usize;
        LocalPoint {
            coordinates: self.local.axes.each_ref().map(|axis| axis[index]),
            roundoff: self.frames.roundoff(self.frame, self.points[index]),
        }
    }
}

impl GradientSum {
    /// Calls `work` with the buffers of the calling thread.
    pub fn with_buffers<R>(work: impl FnOnce(&mut GradientSum) -> R) -> R {
        thread_local! {
            static BUFFERS: RefCell<GradientSum> = RefCell::default();
        }
        BUFFERS.with_borrow_mut(work)
    }

    /// Writes the sum over all tiles at `points`; NaN where a point is out of range.
    pub fn sum_all(&mut self, level: Level, frames: &Frames, points: &[DVec3], gradient: &mut [DMat3]) {
        self.edges.clear();
        if points.is_empty() {
            return;
        }
        dispatch!(level, simd => self.points.set(simd, points));
        self.totals.start(self.points.padded());
        for frame in frames.frames() {
            let mut local = std::mem::take(&mut self.local);
            let (low, high) = dispatch!(level, simd => {
                local.set_in_frame(simd, frames, frame, &self.points);
                local.reach(simd)
            });
            let of = FrameSum { level, frames, frame, points, local: &local };
            for cluster in &frame.clusters.clusters {
                let method = cluster.ranges.method_of_box(low, high, false);
                if !method.is_some_and(|method| self.add_together(of, cluster, method, None)) {
                    self.add_by_method(of, cluster);
                }
            }
            self.local = local;
        }
        self.finite = self.totals.write(gradient);
        for &index in self.points.out_of_range() {
            self.finite = false;
            gradient[index] = DMat3::NAN;
        }
    }

    /// The points on edge lines, in order, with the edges through them.
    pub fn edges(&self) -> impl Iterator<Item = (usize, &EdgesAtPoint)> {
        self.edges.iter().map(|(index, edges)| (*index, edges))
    }

    /// Whether all values are known to be finite.
    pub fn is_finite(&self) -> bool {
        self.finite
    }

    /// Whether terms of edges at a point are unbounded.
    pub fn is_singular(&self, index: usize) -> bool {
        self.edges.get(&index).is_some_and(EdgesAtPoint::singular)
    }

    /// Adds a cluster that needs different methods at different points, or at different tiles.
    fn add_by_method(&mut self, of: FrameSum, cluster: &Cluster) {
        let mut sorted = std::mem::take(&mut self.sorted);
        sorted.sort_all(of.level, &cluster.ranges, of.local, of.points.len(), false, None);
        for method in sorted.methods() {
            let points = sorted.points(method);
            if self.add_together(of, cluster, method, Some(points)) {
                continue;
            }
            if cluster.corners.is_none() {
                self.add_near(of, cluster.blocks.start, points);
                continue;
            }
            let mut sorted_by_tile = std::mem::take(&mut self.sorted_by_tile);
            self.gathered_near.gather(of.local, points);
            for index in cluster.blocks.clone() {
                let ranges = &of.frame.clusters.tiles[index].ranges;
                sorted_by_tile.sort(of.level, ranges, &self.gathered_near, points);
                for method in sorted_by_tile.methods() {
                    let points = sorted_by_tile.points(method);
                    if !self.add_tile(of, index, ranges.method(method), Some(points)) {
                        self.add_near(of, index, points);
                    }
                }
            }
            self.sorted_by_tile = sorted_by_tile;
        }
        self.sorted = sorted;
    }

    /// Adds a cluster by one method at all points or at the chosen points. Returns whether its
    /// tiles share a method.
    fn add_together(&mut self, of: FrameSum, cluster: &Cluster, method: MethodIndex, chosen: Option<&[u32]>) -> bool {
        match (cluster.ranges.method(method), &cluster.corners) {
            (method, None) => self.add_tile(of, cluster.blocks.start, method, chosen),
            (Method::ClosedForm | Method::SmallElements, Some(corners)) => {
                let mut places = std::mem::take(&mut self.places);
                let (points, gradients) = self.points_and_gradients(of, chosen);
                dispatch!(of.level, simd => places.gradients(simd, corners, points, gradients));
                self.places = places;
                self.add_gradients(of, chosen);
                true
            }
            (Method::Expansion { degree }, _) => {
                self.set_by_expansions(of, cluster, degree, chosen);
                self.add_gradients(of, chosen);
                true
            }
            (method @ Method::Series { .. }, _) => {
                cluster.blocks.clone().for_each(|index| {
                    self.add_tile(of, index, method, chosen);
                });
                true
            }
            (Method::Scalar, _) => false,
        }
    }

    /// The points by axis in whole vectors, and the place of their gradients.
    fn points_and_gradients<'a>(
        &'a mut self,
        of: FrameSum<'a>,
        chosen: Option<&[u32]>,
    ) -> ([&'a [f64]; 3], [&'a mut [f64]; COMPONENTS]) {
        let axes = match chosen {
            None => &of.local.axes,
            Some(chosen) => {
                self.gathered.gather(of.local, chosen);
                &self.gathered.axes
            }
        };
        (views(axes), room(&mut self.gradients, axes[0].len()))
    }

    /// Sets the gradients of a cluster by the expansions of the derivatives of its potential, for a
    /// field up to `degree`.
    fn set_by_expansions(&mut self, of: FrameSum, cluster: &Cluster, degree: usize, chosen: Option<&[u32]>) {
        let (points, gradients) = self.points_and_gradients(of, chosen);
        let degree = (degree + FURTHER_DEGREES).min(HIGHEST_DEGREE);
        let degrees = vec![degree; points[0].len().div_ceil(POINTS_PER_DEGREE)];
        let [by_x, by_y] = cluster.slopes(of.level, &of.frame.blocks);
        let [xx, yy, zz, yz, xz, xy] = gradients;
        dispatch!(of.level, simd => {
            by_x.fields(simd, &degrees, points, [&mut *zz, &mut *xy, &mut *xz]);
            by_y.fields(simd, &degrees, points, [&mut *xx, &mut *yy, &mut *yz]);
        });
        // The first call wrote xx to zz, and the second xy to xx.
        let scale = cluster.ranges.scale;
        for ((xx, zz), yy) in xx.iter_mut().zip(zz.iter_mut()).zip(yy.iter_mut()) {
            (*xx, *yy) = (*zz * scale, *yy * scale);
            *zz = -(*xx + *yy);
        }
        [yz, xz, xy].into_iter().flatten().for_each(|component| *component *= scale);
    }

    /// Adds one tile at all points or at the chosen points. Returns whether the field's method has
    /// a gradient.
    fn add_tile(&mut self, of: FrameSum, index: usize, method: Method, chosen: Option<&[u32]>) -> bool {
        let (tables, block) = (&of.frame.clusters, &of.frame.blocks[index]);
        let tile = &tables.tiles[index];
        match method {
            Method::ClosedForm | Method::SmallElements => {
                self.add_in_vectors(of, &GradientEvaluator::new(block, &tile.ranges), chosen);
                true
            }
            Method::Series { order } => {
                let mut made = None;
                let series = tables.gradient_series(&of.frame.blocks, index, &mut made);
                // The gradient needs one order more than the field.
                let order = (order + 1).min(tile.ranges.highest_order());
                let series = TruncatedGradient { tile: &tile.distant, series, order };
                let (points, gradients) = self.points_and_gradients(of, chosen);
                dispatch!(of.level, simd => series.gradients(simd, points, gradients));
                self.add_gradients(of, chosen);
                true
            }
            Method::Scalar | Method::Expansion { .. } => false,
        }
    }

    /// Adds one tile at points inside it, close to it, and very far away.
    fn add_near(&mut self, of: FrameSum, index: usize, chosen: &[u32]) {
        let block = &of.frame.blocks[index];
        let evaluator = GradientEvaluator::new(block, &of.frame.clusters.tiles[index].ranges);
        let mut near = std::mem::take(&mut self.near);
        near.clear();
        self.gathered_in_scene.gather(&self.points, chosen);
        self.gathered.gather(of.local, chosen);
        self.covered.set_len(self.gathered.padded());
        dispatch!(of.level, simd => {
            self.roundoff.set_roundoff(simd, of.frames, of.frame, &self.gathered_in_scene);
            let (points, roundoff) = (views(&self.gathered.axes), views(&self.roundoff.axes));
            evaluator.cover_near(simd, points, roundoff, &mut self.covered);
        });
        for (number, &index) in chosen.iter().enumerate() {
            if self.covered[number] == 1.0 {
                near.push(index);
            } else {
                self.add_by_scalar_kernel(of, block, index);
            }
        }
        if !near.is_empty() {
            self.add_in_vectors(of, &evaluator, Some(&near));
        }
        self.near = near;
    }

    fn add_in_vectors(&mut self, of: FrameSum, tile: &GradientEvaluator, chosen: Option<&[u32]>) {
        let (points, gradients) = self.points_and_gradients(of, chosen);
        dispatch!(of.level, simd => tile.gradients(simd, points, gradients));
        self.add_gradients(of, chosen);
    }

    fn add_by_scalar_kernel(&mut self, of: FrameSum, block: &Block, index: u32) {
        let Some(placed) = block.place(&of.local_point(index)) else { return };
        let gradient = cuboid_gradient(&placed.offsets, block.polarization_t.to_array());
        let scaled = gradient.map(|row| row.map(|slope| slope * placed.scale));
        let DMat3 { x_axis, y_axis, z_axis } = of.frame.to_scene.tensor(DMat3::from_cols_array_2d(&scaled));
        self.totals.add_one(index as usize, [x_axis.x, y_axis.y, z_axis.z, z_axis.y, z_axis.x, y_axis.x]);
        if placed.on_edge_line() {
            self.edges.entry(index as usize).or_default().add(block, &placed, &of.frame.to_scene);
        }
    }

    /// Adds the gradients of a tile or cluster, in its frame.
    fn add_gradients(&mut self, of: FrameSum, chosen: Option<&[u32]>) {
        self.totals.add(of.level, of.frame.to_scene.rotation(), &mut self.gradients, chosen);
    }
}

/// Columns of `count` unspecified values, to be written.
fn room(columns: &mut Gradients, count: usize) -> [&mut [f64]; COMPONENTS] {
    columns.each_mut().map(|column| {
        column.set_len(count);
        &mut **column
    })
}
