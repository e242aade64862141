//! Direct summation over the tiles of a scene at a batch of points.

use std::cell::RefCell;
use std::collections::BTreeMap;

use fearless_simd::{Level, dispatch};
use glam::DVec3;
use magsplice_cuboid::block::LocalPoint;
use magsplice_cuboid::closed_form::near_edge::{NEAR_FORMS, NearEdges};
use magsplice_cuboid::method::{CLOSED_FORM, Method, MethodIndex, SCALAR, SMALL_ELEMENTS};
use magsplice_cuboid::scalar::kernel::FieldKind;
use magsplice_cuboid::series::multipole::TruncatedSeries;
use magsplice_expansion::local::LocalExpansion;
use magsplice_expansion::tolerances::POINTS_PER_DEGREE;
use magsplice_simd::column::{Column, room, views};
use magsplice_simd::lanes::LONGEST_VECTOR;
use magsplice_simd::pairwise::fields_of;
use magsplice_simd::prefetch::Prefetch;

use super::cluster_kernel::KeptTables;
use super::coordinates::Coordinates;
use super::edges::EdgesAtPoint;
use super::far_field::{BeyondSphere, DegreesByPoints, FarField};
use super::near_field::near_field;
use super::runs::Runs;
use super::single_tile::SingleTile;
use super::sorted_points::{BEYOND_SPHERE, SortedPoints};
use super::totals::Totals;
use super::weak_points::WeakPoints;
use crate::prepare::clusters::Cluster;
use crate::prepare::corner_tables::CornerTables;
use crate::prepare::frames::{Frame, Frames};

/// Buffers for a batch of points; none of them grows with the number of tiles.
#[derive(Default)]
pub struct Sum {
    points: Coordinates,
    /// The points in the current frame.
    local: Coordinates,
    totals: Totals,
    /// Sums over the tiles of a cluster, at all or at chosen points.
    partial: Totals,
    /// The points on edge lines, with the edges they are on.
    edges: BTreeMap<usize, EdgesAtPoint>,
    sorted: SortedPoints,
    sorted_by_tile: SortedPoints,
    gathered: Coordinates,
    /// The points near a cluster.
    gathered_near: Coordinates,
    /// The points close to a tile, by form.
    near_edge: [Vec<u32>; NEAR_FORMS],
    /// The form of each point close to a tile.
    forms: Column,
    gathered_in_scene: Coordinates,
    /// Bounds of the errors of the gathered coordinates.
    roundoff: Coordinates,
    /// The field of one tile or cluster, in its frame.
    fields: [Column; 3],
    runs: Runs,
    near: Vec<u32>,
    single_tile: SingleTile,
    finite: bool,
    degrees: DegreesByPoints,
    /// Upper bound of the truncation error at each of the points, in tesla.
    truncation_error_t: Vec<f64>,
    tables: KeptTables,
}

/// Clusters of one frame, each with the sphere beyond which a far field replaces it, if any.
pub type FrameClusters<'a> = (&'a Frame, Vec<(&'a Cluster, Option<BeyondSphere<'a>>)>);

/// The arguments shared by all clusters of a frame.
#[derive(Clone, Copy)]
struct FrameSum<'a> {
    level: Level,
    frames: &'a Frames,
    frame: &'a Frame,
    kind: FieldKind,
    points: &'a [DVec3],
    local: &'a Coordinates,
    /// Whether a tolerance extends the range of the closed form.
    stretched: bool,
}

impl Sum {
    /// Calls `work` with the buffers of the calling thread.
    pub fn with_buffers<R>(work: impl FnOnce(&mut Sum) -> R) -> R {
        thread_local! {
            static BUFFERS: RefCell<Sum> = RefCell::default();
        }
        BUFFERS.with_borrow_mut(work)
    }

    /// Writes the sum over all tiles at `points` to `field`; NaN where a point is out of range.
    /// `weak` receives the points of a single tile whose field may be too weak for a tolerance.
    pub fn sum_all(
        &mut self,
        level: Level,
        frames: &Frames,
        kind: FieldKind,
        points: &[DVec3],
        field: &mut [DVec3],
        weak: Option<&mut WeakPoints>,
    ) {
        if let Some(frame) = frames.only_tile() {
            let (edges, frame) = (&mut self.edges, (frames, frame));
            edges.clear();
            self.finite = self.single_tile.evaluate(level, frame, kind, points, (field, weak), edges);
            return;
        }
        self.start(level, points, 0.0);
        if !points.is_empty() {
            let all = frames.frames().iter();
            let all = all.map(|f| (f, f.clusters.clusters.iter().map(|cluster| (cluster, None)).collect()));
            self.add_clusters(level, frames, all.collect(), kind, points, false);
        }
        self.finish(field);
    }

    /// Begins a sum at `points`, whose truncation error is `truncation_error_t` so far.
    pub fn start(&mut self, level: Level, points: &[DVec3], truncation_error_t: f64) {
        self.edges.clear();
        self.finite = false;
        dispatch!(level, simd => self.points.set(simd, points));
        self.totals.start(self.points.padded());
        self.truncation_error_t.clear();
        self.truncation_error_t.resize(self.points.padded(), truncation_error_t);
    }

    /// Writes the sum; NaN where a point is out of range.
    pub fn finish(&self, field: &mut [DVec3]) {
        self.totals.write(field);
        for &index in self.points.out_of_range() {
            field[index] = DVec3::NAN;
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

    /// Whether the field is unbounded at a point.
    pub fn is_exposed(&self, index: usize) -> bool {
        self.edges.get(&index).is_some_and(EdgesAtPoint::exposed)
    }

    /// The coordinates of the points, and the upper bound of the truncation error at each, in
    /// tesla.
    pub fn points_and_truncation_error_t(&mut self) -> ([&[f64]; 3], &mut Vec<f64>) {
        (views(&self.points.axes), &mut self.truncation_error_t)
    }

    /// Adds a far field at all points.
    pub fn add_far_field(&mut self, level: Level, far_field: &dyn FarField) {
        let points = &self.points.axes;
        self.degrees.clear();
        let fields = room(&mut self.fields, points[0].len());
        far_field.fields(level, views(points), fields, &mut self.degrees);
        self.totals.add_fields(level, None, &self.fields);
        let bounds = self.truncation_error_t.chunks_mut(POINTS_PER_DEGREE).zip(&self.degrees.truncation_error_t);
        for (points, own_t) in bounds {
            points.iter_mut().for_each(|sum_t| *sum_t += own_t);
        }
    }

    /// Adds a local expansion at all points.
    pub fn add_local_expansion(&mut self, level: Level, local: &LocalExpansion) {
        let points = &self.points.axes;
        let fields = room(&mut self.fields, points[0].len());
        dispatch!(level, simd => fields_of(simd, local, views(points), fields, &mut Prefetch::nothing()));
        self.totals.add_fields(level, None, &self.fields);
    }

    /// Adds clusters at all points. `stretched` extends the range of the closed form for a
    /// tolerance.
    pub fn add_clusters(
        &mut self,
        level: Level,
        frames: &Frames,
        wanted: Vec<FrameClusters>,
        kind: FieldKind,
        points: &[DVec3],
        stretched: bool,
    ) {
        for (frame, clusters) in wanted {
            let mut local = std::mem::take(&mut self.local);
            let (low, high) = dispatch!(level, simd => {
                local.set_in_frame(simd, frames, frame, &self.points);
                local.reach(simd)
            });
            let of = FrameSum { level, frames, frame, kind, points, local: &local, stretched };
            for (cluster, beyond) in clusters {
                let method = cluster.ranges.method_of_box(low, high, stretched).filter(|_| beyond.is_none());
                match (method, &cluster.corners) {
                    (Some(method), Some(corners)) => self.add_cluster(of, cluster, corners, method, None),
                    (method, None) if beyond.is_none() && self.divide(of, cluster, method) => {
                        self.add_in_runs(of, cluster.blocks.start);
                    }
                    _ => self.add_by_method(of, cluster, beyond),
                }
            }
            self.local = local;
        }
    }

    /// Divides the points, in their order, into runs of one method of a single tile: one run, if
    /// the method is given. Returns whether runs are worthwhile.
    fn divide(&mut self, of: FrameSum, cluster: &Cluster, method: Option<MethodIndex>) -> bool {
        if let Some(method) = method {
            self.runs.set_all(method, of.local.padded());
            return true;
        }
        self.runs.divide(of.level, &cluster.ranges, &of.local.axes, of.stretched)
    }

    /// Adds a single tile in its runs.
    fn add_in_runs(&mut self, of: FrameSum, index: usize) {
        let mut made = None;
        let tile = of.frame.clusters.evaluator(&of.frame.blocks, index, &mut made);
        let points = &of.local.axes;
        let mut near = std::mem::take(&mut self.near);
        near.clear();
        self.runs.fields(of.level, &tile, points, &mut self.fields, &mut near);
        self.totals.add_fields(of.level, of.frame.to_scene.rotation(), &self.fields);
        near.retain(|&index| (index as usize) < of.points.len() && !points[0][index as usize].is_nan());
        if !near.is_empty() {
            self.add_near(of, index, &near);
        }
        self.near = near;
    }

    /// Adds a cluster by one method at all points, or at chosen, gathered points.
    fn add_cluster(
        &mut self,
        of: FrameSum,
        cluster: &Cluster,
        corners: &CornerTables,
        method: MethodIndex,
        chosen: Option<&[u32]>,
    ) {
        let points = if chosen.is_some() { &self.gathered.axes } else { &of.local.axes };
        let (level, rotation, count) = (of.level, of.frame.to_scene.rotation(), points[0].len());
        let fields = room(&mut self.fields, count);
        if let CLOSED_FORM | SMALL_ELEMENTS = method {
            let (tables, small) = (&mut self.tables, method == SMALL_ELEMENTS);
            // Without the padding of the last pair of vectors.
            let used = chosen.map_or(count, |chosen| chosen.len().next_multiple_of(LONGEST_VECTOR));
            let points = views(points).map(|axis| &axis[..used]);
            dispatch!(level, simd => tables.fields(simd, corners, small, points, fields));
        } else {
            match cluster.ranges.method(method) {
                Method::Expansion { degree } => {
                    let expansion = cluster.expansion(level, &of.frame.blocks);
                    let degrees = &mut self.degrees.degree;
                    degrees.clear();
                    degrees.resize(count.div_ceil(POINTS_PER_DEGREE), degree);
                    dispatch!(level, simd => expansion.fields(simd, degrees, views(points), fields));
                }
                Method::Series { order } => {
                    self.partial.start(count);
                    let tables = &of.frame.clusters;
                    for index in cluster.blocks.clone() {
                        let mut made = None;
                        let series = tables.series(&of.frame.blocks, index, &mut made);
                        let field = TruncatedSeries { tile: &tables.tiles[index].distant, series, order };
                        let fields = room(&mut self.fields, count);
                        dispatch!(level, simd => fields_of(simd, &field, views(points), fields, &mut Prefetch::nothing()));
                        self.partial.add_fields(level, rotation, &self.fields);
                    }
                    return match chosen {
                        None => self.totals.add_totals(level, &self.partial),
                        Some(chosen) => self.totals.add_totals_at(&self.partial, chosen),
                    };
                }
                Method::Scalar | Method::ClosedForm | Method::SmallElements => {
                    unreachable!("a far method of a cluster")
                }
            }
        }
        match chosen {
            None => self.totals.add_fields(level, rotation, &self.fields),
            Some(chosen) => self.totals.add_fields_at(level, rotation, &mut self.fields, chosen),
        }
    }

    /// Adds a cluster that needs different methods at different points.
    fn add_by_method(&mut self, of: FrameSum, cluster: &Cluster, beyond: Option<BeyondSphere>) {
        let mut sorted = std::mem::take(&mut self.sorted);
        let sphere = beyond.map(|beyond| (&self.points, (beyond.centre, beyond.radius_squared)));
        sorted.sort_all(of.level, &cluster.ranges, of.local, of.points.len(), of.stretched, sphere);
        for method in sorted.methods() {
            let points = sorted.points(method);
            match (method, &cluster.corners) {
                (BEYOND_SPHERE, _) => self.add_beyond(of.level, beyond.expect("points beyond a sphere"), points),
                (_, None) => self.add_tile(of, cluster.blocks.start, method, points),
                (SCALAR, Some(_)) => {
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
                (_, Some(corners)) => {
                    self.gathered.gather(of.local, points);
                    self.add_cluster(of, cluster, corners, method, Some(points));
                }
            }
        }
        self.sorted = sorted;
    }

    /// Adds the far field of a cluster at the chosen points.
    fn add_beyond(&mut self, level: Level, beyond: BeyondSphere, chosen: &[u32]) {
        self.gathered.gather(&self.points, chosen);
        let points = &self.gathered.axes;
        self.degrees.clear();
        let fields = room(&mut self.fields, points[0].len());
        beyond.far_field.fields(level, views(points), fields, &mut self.degrees);
        self.totals.add_fields_at(level, None, &mut self.fields, chosen);
        for (chosen, own_t) in chosen.chunks(POINTS_PER_DEGREE).zip(&self.degrees.truncation_error_t) {
            chosen.iter().for_each(|&index| self.truncation_error_t[index as usize] += own_t);
        }
    }

    /// Adds one tile at the chosen points.
    fn add_tile(&mut self, of: FrameSum, index: usize, method: MethodIndex, chosen: &[u32]) {
        if method == SCALAR {
            return self.add_near(of, index, chosen);
        }
        let mut made = None;
        let tile = of.frame.clusters.evaluator(&of.frame.blocks, index, &mut made);
        self.gathered.gather(of.local, chosen);
        let points = &self.gathered.axes;
        let fields = room(&mut self.fields, points[0].len());
        dispatch!(of.level, simd => tile.fields(simd, method, views(points), fields, &mut Prefetch::nothing()));
        self.totals.add_fields_at(of.level, of.frame.to_scene.rotation(), &mut self.fields, chosen);
    }

    /// Adds a tile at points in or close to it: in vectors where they are off the planes of its
    /// faces, else by the scalar kernel.
    fn add_near(&mut self, of: FrameSum, index: usize, chosen: &[u32]) {
        let block = &of.frame.blocks[index];
        let near_edge = NearEdges::new(block, of.kind);
        let [x, y, z] = &of.local.axes;
        let mut of_forms = std::mem::take(&mut self.near_edge);
        of_forms.iter_mut().for_each(Vec::clear);
        self.gathered_in_scene.gather(&self.points, chosen);
        self.gathered.gather(of.local, chosen);
        self.forms.set_len(self.gathered.padded());
        dispatch!(of.level, simd => {
            self.roundoff.set_roundoff(simd, of.frames, of.frame, &self.gathered_in_scene);
            let (points, roundoff) = (views(&self.gathered.axes), views(&self.roundoff.axes));
            near_edge.forms(simd, points, roundoff, &mut self.forms);
        });
        for (number, &point) in chosen.iter().enumerate() {
            let (form, index) = (self.forms[number] as usize, point as usize);
            if form < NEAR_FORMS {
                of_forms[form].push(point);
                continue;
            }
            let at = LocalPoint {
                coordinates: [x[index], y[index], z[index]],
                roundoff: of.frames.roundoff(of.frame, of.points[index]),
            };
            let own = near_field(block, &at, of.frame, of.kind, || self.edges.entry(index).or_default());
            self.totals.add_one(index, own.to_array());
        }
        for (form, chosen) in of_forms.iter().enumerate().filter(|(_, chosen)| !chosen.is_empty()) {
            self.gathered.gather(of.local, chosen);
            let points = &self.gathered.axes;
            let fields = room(&mut self.fields, points[0].len());
            dispatch!(of.level, simd => near_edge.fields(simd, form, views(points), fields));
            self.totals.add_fields_at(of.level, of.frame.to_scene.rotation(), &mut self.fields, chosen);
        }
        self.near_edge = of_forms;
    }
}
