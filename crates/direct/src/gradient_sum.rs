//! The gradient of B summed over the tiles of a scene at a batch of points.

use std::cell::RefCell;
use std::collections::BTreeMap;

use fearless_simd::{Level, dispatch};
use glam::{DMat3, DVec3};
use magsplice_cuboid::block::{Block, LocalPoint};
use magsplice_cuboid::closed_form::gradient::COMPONENTS;
use magsplice_cuboid::gradient_evaluator::{GradientEvaluator, GradientMethod};
use magsplice_cuboid::method::{CLOSED_FORM, Method, MethodIndex, SMALL_ELEMENTS};
use magsplice_cuboid::scalar::kernel::cuboid_gradient;
use magsplice_expansion::tolerances::{HIGHEST_DEGREE, POINTS_PER_DEGREE};
use magsplice_simd::column::{Column, views};
use magsplice_simd::compensated_sum::RunningSum;

use super::cluster_gradient::cluster_gradients;
use super::coordinates::Coordinates;
use super::edges::EdgesAtPoint;
use super::sorted_points::SortedPoints;
use crate::prepare::clusters::Cluster;
use crate::prepare::frames::{Frame, Frames};
use crate::tolerances::FURTHER_DEGREES;

/// Buffers for a batch of points; none of them grows with the number of tiles.
pub struct GradientSum {
    points: Coordinates,
    /// The points in the current frame.
    local: Coordinates,
    sums: Vec<[RunningSum; COMPONENTS]>,
    /// The points on edge lines, with the edges they are on.
    edges: BTreeMap<usize, EdgesAtPoint>,
    sorted: SortedPoints,
    sorted_by_tile: SortedPoints,
    gathered: Coordinates,
    /// The points near a cluster.
    gathered_near: Coordinates,
    /// The points at which the field's closed form has no gradient, by method.
    near: [(GradientMethod, Vec<u32>); 2],
    /// The gradient of one tile or cluster, in its frame.
    gradients: [Column; COMPONENTS],
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
    fn new() -> GradientSum {
        GradientSum {
            points: Coordinates::default(),
            local: Coordinates::default(),
            sums: Vec::new(),
            edges: BTreeMap::new(),
            sorted: SortedPoints::default(),
            sorted_by_tile: SortedPoints::default(),
            gathered: Coordinates::default(),
            gathered_near: Coordinates::default(),
            near: [(GradientMethod::Near, Vec::new()), (GradientMethod::Positive, Vec::new())],
            gradients: Default::default(),
        }
    }

    /// Calls `work` with the buffers of the calling thread.
    pub fn with_buffers<R>(work: impl FnOnce(&mut GradientSum) -> R) -> R {
        thread_local! {
            static BUFFERS: RefCell<GradientSum> = RefCell::new(GradientSum::new());
        }
        BUFFERS.with_borrow_mut(work)
    }

    /// Writes the sum over all tiles at `points`; NaN where a point is out of range.
    pub fn sum_all(&mut self, level: Level, frames: &Frames, points: &[DVec3], gradient: &mut [DMat3]) {
        self.edges.clear();
        self.sums.clear();
        self.sums.resize(points.len(), Default::default());
        if !points.is_empty() {
            dispatch!(level, simd => self.points.set(simd, points));
            for frame in frames.frames() {
                let mut local = std::mem::take(&mut self.local);
                dispatch!(level, simd => local.set_in_frame(simd, frames, frame, &self.points));
                let of = FrameSum { level, frames, frame, points, local: &local };
                for cluster in &frame.clusters.clusters {
                    self.add_cluster(of, cluster);
                }
                self.local = local;
            }
        }
        for (gradient, sum) in gradient.iter_mut().zip(&self.sums) {
            let [xx, yy, zz, yz, xz, xy] = sum.map(RunningSum::value);
            *gradient = DMat3::from_cols_array(&[xx, xy, xz, xy, yy, yz, xz, yz, zz]);
        }
        for &index in self.points.out_of_range() {
            gradient[index] = DMat3::NAN;
        }
    }

    /// The points on edge lines, in order, with the edges through them.
    pub fn edges(&self) -> impl Iterator<Item = (usize, &EdgesAtPoint)> {
        self.edges.iter().map(|(index, edges)| (*index, edges))
    }

    /// Whether terms of edges at a point are unbounded.
    pub fn is_singular(&self, index: usize) -> bool {
        self.edges.get(&index).is_some_and(EdgesAtPoint::singular)
    }

    fn add_cluster(&mut self, of: FrameSum, cluster: &Cluster) {
        let mut sorted = std::mem::take(&mut self.sorted);
        sorted.sort_all(of.level, &cluster.ranges, of.local, of.points.len(), false, None);
        for method in sorted.methods() {
            let points = sorted.points(method);
            match (method, &cluster.corners) {
                (_, None) => self.add_tile(of, cluster.blocks.start, method, points),
                (CLOSED_FORM | SMALL_ELEMENTS, Some(corners)) if corners.has_gradient() => {
                    self.gathered.gather(of.local, points);
                    let axes = &self.gathered.axes;
                    let gradients = room(&mut self.gradients, axes[0].len());
                    dispatch!(of.level, simd => cluster_gradients(simd, corners, views(axes), gradients));
                    self.add_gradients(of.frame, points);
                }
                (method, Some(_)) if matches!(cluster.ranges.method(method), Method::Expansion { .. }) => {
                    self.gathered.gather(of.local, points);
                    self.set_by_expansions(of, cluster, cluster.ranges.method(method));
                    self.add_gradients(of.frame, points);
                }
                (_, Some(_)) => {
                    let mut sorted_by_tile = std::mem::take(&mut self.sorted_by_tile);
                    self.gathered_near.gather(of.local, points);
                    for index in cluster.blocks.clone() {
                        let ranges = &of.frame.clusters.tiles[index].ranges;
                        sorted_by_tile.sort(of.level, ranges, &self.gathered_near, points);
                        for method in sorted_by_tile.methods() {
                            self.add_tile(of, index, method, sorted_by_tile.points(method));
                        }
                    }
                    self.sorted_by_tile = sorted_by_tile;
                }
            }
        }
        self.sorted = sorted;
    }

    /// Sets the gradients of a cluster at the gathered points by the expansions of the derivatives
    /// of its potential.
    fn set_by_expansions(&mut self, of: FrameSum, cluster: &Cluster, method: Method) {
        let Method::Expansion { degree } = method else { unreachable!("{method:?} is no expansion") };
        let points = &self.gathered.axes;
        let degree = (degree + FURTHER_DEGREES).min(HIGHEST_DEGREE);
        let degrees = vec![degree; points[0].len().div_ceil(POINTS_PER_DEGREE)];
        let [by_x, by_y] = cluster.slopes(of.level, &of.frame.blocks);
        let [xx, yy, zz, yz, xz, xy] = room(&mut self.gradients, points[0].len());
        dispatch!(of.level, simd => {
            by_x.fields(simd, &degrees, views(points), [&mut *zz, &mut *xy, &mut *xz]);
            by_y.fields(simd, &degrees, views(points), [&mut *xx, &mut *yy, &mut *yz]);
        });
        // The first call wrote xx to zz, and the second xy to xx.
        let scale = cluster.ranges.scale;
        for ((xx, zz), yy) in xx.iter_mut().zip(zz.iter_mut()).zip(yy.iter_mut()) {
            (*xx, *yy) = (*zz * scale, *yy * scale);
            *zz = -(*xx + *yy);
        }
        [yz, xz, xy].into_iter().flatten().for_each(|component| *component *= scale);
    }

    /// Adds one tile at the chosen points.
    fn add_tile(&mut self, of: FrameSum, index: usize, method: MethodIndex, chosen: &[u32]) {
        let (tables, block) = (&of.frame.clusters, &of.frame.blocks[index]);
        let tile = &tables.tiles[index];
        let mut made = None;
        let series = tables.series(&of.frame.blocks, index, &mut made);
        let evaluator = GradientEvaluator::new(block, &tile.ranges, &tile.distant, series);
        match tile.ranges.method(method) {
            Method::ClosedForm | Method::SmallElements if evaluator.has_closed_form() => {
                self.add_in_vectors(of, &evaluator, GradientMethod::ClosedForm, chosen);
            }
            Method::Scalar | Method::ClosedForm | Method::SmallElements => {
                let none = [GradientMethod::Near, GradientMethod::Positive].map(|method| (method, Vec::new()));
                let mut near = std::mem::replace(&mut self.near, none);
                near.iter_mut().for_each(|(_, points)| points.clear());
                for &index in chosen {
                    let method = evaluator.method_near(&of.local_point(index));
                    match near.iter_mut().find(|(of, _)| Some(*of) == method) {
                        Some((_, points)) => points.push(index),
                        None => self.add_by_scalar_kernel(of, block, index),
                    }
                }
                for (method, points) in near.iter().filter(|(_, points)| !points.is_empty()) {
                    self.add_in_vectors(of, &evaluator, *method, points);
                }
                self.near = near;
            }
            Method::Series { order } => {
                self.add_in_vectors(of, &evaluator, GradientMethod::Series(order), chosen);
            }
            Method::Expansion { .. } => unreachable!("no method of one tile"),
        }
    }

    fn add_in_vectors(&mut self, of: FrameSum, tile: &GradientEvaluator, method: GradientMethod, chosen: &[u32]) {
        self.gathered.gather(of.local, chosen);
        let points = &self.gathered.axes;
        let gradients = room(&mut self.gradients, points[0].len());
        dispatch!(of.level, simd => tile.gradients(simd, method, views(points), gradients));
        self.add_gradients(of.frame, chosen);
    }

    fn add_by_scalar_kernel(&mut self, of: FrameSum, block: &Block, index: u32) {
        let Some(placed) = block.place(&of.local_point(index)) else { return };
        let gradient = cuboid_gradient(&placed.offsets, block.polarization_t.to_array());
        let scaled = gradient.map(|row| row.map(|slope| slope * placed.scale));
        self.add(index as usize, of.frame.to_scene.tensor(DMat3::from_cols_array_2d(&scaled)));
        if placed.on_edge_line() {
            self.edges.entry(index as usize).or_default().add(block, &placed, &of.frame.to_scene);
        }
    }

    /// Adds gradients in the frame of a tile or cluster at the chosen points.
    fn add_gradients(&mut self, frame: &Frame, chosen: &[u32]) {
        let gradients = std::mem::take(&mut self.gradients);
        for (number, &index) in chosen.iter().enumerate() {
            let [xx, yy, zz, yz, xz, xy] = gradients.each_ref().map(|values| values[number]);
            if frame.to_scene.rotation().is_none() {
                for (sum, term) in self.sums[index as usize].iter_mut().zip([xx, yy, zz, yz, xz, xy]) {
                    sum.add(term);
                }
            } else {
                let own = DMat3::from_cols_array(&[xx, xy, xz, xy, yy, yz, xz, yz, zz]);
                self.add(index as usize, frame.to_scene.tensor(own));
            }
        }
        self.gradients = gradients;
    }

    fn add(&mut self, index: usize, gradient: DMat3) {
        let DMat3 { x_axis, y_axis, z_axis } = gradient;
        let terms = [x_axis.x, y_axis.y, z_axis.z, z_axis.y, z_axis.x, y_axis.x];
        for (sum, term) in self.sums[index].iter_mut().zip(terms) {
            sum.add(term);
        }
    }
}

/// Columns of `count` unspecified values, to be written.
fn room(columns: &mut [Column; COMPONENTS], count: usize) -> [&mut [f64]; COMPONENTS] {
    columns.each_mut().map(|column| {
        column.set_len(count);
        &mut **column
    })
}
