//! The tiles of a scene added up at a batch of points.

use std::cell::RefCell;
use std::collections::BTreeMap;

use fearless_simd::{Level, dispatch};
use glam::DVec3;

use super::ahead::Ahead;
use super::assignment::{Assigned, Assignment, Near, Nearest};
use super::beside::Beside;
use super::closed_form::KeptTables;
use super::cluster::Cluster;
use super::column::{Column, room, views};
use super::lanes::LONGEST_VECTOR;
use super::multipole::Distributed;
use super::one_tile::{OneTile, series};
use super::pairwise::fields_of;
use super::points::{Chosen, Coordinates};
use super::range::{BEYOND, FarForm, Form, MIDDLE, NEAR, OUTER};
use super::streams::Streams;
use super::stretches::Stretches;
use super::table::Together;
use super::totals::Totals;
use super::translation::translated;
use super::tree::{Degrees, Tree};
use crate::arrangement::{Arrangement, Frame};
use crate::block::{Block, Local};
use crate::edge_policy::Edges;
use crate::kernel::{Part, cuboid_field};
use crate::tolerances::POINTS_PER_DEGREE;

/// Room for a batch of points; nothing in it grows with the number of tiles.
#[derive(Default)]
pub(crate) struct Superposition {
    points: Coordinates,
    /// The points in the frame at work.
    local: Coordinates,
    totals: Totals,
    /// Sums over the tiles of a cluster, at all points or at chosen ones.
    partial: Totals,
    /// The points on edge lines, with the edges they are on.
    edges: BTreeMap<usize, Edges>,
    chosen: Chosen,
    chosen_by_tile: Chosen,
    gathered: Coordinates,
    /// The points near a cluster.
    gathered_near: Coordinates,
    /// Those beside a tile.
    chosen_beside: Vec<u32>,
    /// Of what is at work, in its frame.
    fields: [Column; 3],
    stretches: Stretches,
    near: Vec<u32>,
    streams: Streams,
    finite: bool,
    /// Those of an expansion.
    degrees: Degrees,
    /// At most what is left out at each of the points, in tesla.
    left_out_t: Vec<f64>,
    tables: KeptTables,
}

/// What stays the same for a frame.
#[derive(Clone, Copy)]
struct Work<'a> {
    level: Level,
    arrangement: &'a Arrangement,
    frame: &'a Frame,
    part: Part,
    points: &'a [DVec3],
    local: &'a Coordinates,
    /// Whether the closed form may go farther, for a tolerance.
    stretched: bool,
}

impl Superposition {
    /// The room of the calling thread.
    pub(crate) fn of_this_thread<R>(work: impl FnOnce(&mut Superposition) -> R) -> R {
        thread_local! {
            static ROOM: RefCell<Superposition> = RefCell::default();
        }
        ROOM.with_borrow_mut(work)
    }

    /// The tiles added up at all `points`, or those parts of a tree that have been assigned to them; not a number where a point is out of
    /// range.
    pub(crate) fn add_up(
        &mut self,
        level: Level,
        arrangement: &Arrangement,
        assigned: Option<(&Tree, Assigned)>,
        part: Part,
        points: &[DVec3],
        field: &mut [DVec3],
    ) {
        self.edges.clear();
        self.finite = false;
        if let (Some(frame), None) = (arrangement.only_tile(), &assigned) {
            self.finite = self.streams.evaluate(level, (arrangement, frame), part, points, field, &mut self.edges);
            return;
        }
        dispatch!(level, simd => self.points.set(simd, points));
        self.totals.start(self.points.padded());
        if !points.is_empty() {
            let assignment = assigned.as_ref().map(|(tree, assigned)| (*tree, assigned.assignment));
            self.add_frames(level, arrangement, assignment, part, points);
        }
        self.totals.write(field);
        if let Some((_, assigned)) = assigned {
            assigned.left_out_t.copy_from_slice(&self.left_out_t[..points.len()]);
        }
        for &index in self.points.out_of_range() {
            field[index] = DVec3::NAN;
        }
    }

    /// The points on edge lines, in order, and the edges they lie on.
    pub(crate) fn edges(&self) -> impl Iterator<Item = (usize, &Edges)> {
        self.edges.iter().map(|(index, edges)| (*index, edges))
    }

    /// Whether all values are known to be finite.
    pub(crate) fn is_finite(&self) -> bool {
        self.finite
    }

    /// Whether the field is unbounded at a point.
    pub(crate) fn is_exposed(&self, index: usize) -> bool {
        self.edges.get(&index).is_some_and(Edges::exposed)
    }

    fn add_frames(
        &mut self,
        level: Level,
        arrangement: &Arrangement,
        assigned: Option<(&Tree, &Assignment)>,
        part: Part,
        points: &[DVec3],
    ) {
        if let Some((tree, assignment)) = assigned {
            self.add_expansions(level, tree, assignment);
        }
        for (frame, wanted) in parts(arrangement, assigned) {
            let mut local = std::mem::take(&mut self.local);
            let (low, high) = dispatch!(level, simd => {
                local.set_in_frame(simd, arrangement, frame, &self.points);
                local.reach(simd)
            });
            let work = Work { level, arrangement, frame, part, points, local: &local, stretched: assigned.is_some() };
            for (together, beyond) in wanted {
                let form = together.range.form_of_box(low, high, work.stretched).filter(|_| beyond.is_none());
                match (form, &together.cluster) {
                    (Some(form), Some(cluster)) => self.add_together(work, together, cluster, form, None),
                    (form, None) if beyond.is_none() && self.divide(work, together, form) => {
                        self.add_in_place(work, together.blocks.start);
                    }
                    _ => self.add_by_form(work, together, beyond),
                }
            }
            self.local = local;
        }
    }

    /// What a tree's nodes far away have at all points.
    fn add_expansions(&mut self, level: Level, tree: &Tree, assignment: &Assignment) {
        let points = &self.points.axes;
        self.left_out_t.clear();
        self.left_out_t.resize(points[0].len(), assignment.ignored_t);
        for what in &assignment.expanded {
            tree.set_degrees(what, views(points), &mut self.degrees);
            let (expansion, fields) = (tree.expansion(what.node), room(&mut self.fields, points[0].len()));
            dispatch!(level, simd => expansion.fields(simd, &self.degrees.highest, views(points), fields));
            self.totals.add_fields(level, None, &self.fields);
            for (points, own_t) in self.left_out_t.chunks_mut(POINTS_PER_DEGREE).zip(&self.degrees.left_out_t) {
                points.iter_mut().for_each(|sum_t| *sum_t += own_t);
            }
        }
        let own = dispatch!(level, simd => {
            translated(simd, tree, &assignment.translated, assignment.middle, assignment.reach)
        });
        let far = assignment.far.as_ref();
        let nodes = assignment.translated.iter().chain(far.into_iter().flat_map(|far| &far.assignment.translated));
        for of in nodes {
            tree.add_left_out(of, views(points), &mut self.left_out_t);
        }
        for local in own.iter().chain(far.and_then(|far| far.local.as_ref())) {
            let fields = room(&mut self.fields, points[0].len());
            dispatch!(level, simd => fields_of(simd, local, views(points), fields, &mut Ahead::nothing()));
            self.totals.add_fields(level, None, &self.fields);
        }
    }

    /// Divides the points, as they lie, into stretches of one form of a tile by itself: all of them, if it is given. Returns whether that is worth while.
    fn divide(&mut self, work: Work, together: &Together, form: Option<Form>) -> bool {
        if let Some(form) = form {
            self.stretches.set_all(form, work.local.padded());
            return true;
        }
        self.stretches.divide(work.level, &together.range, &work.local.axes, work.stretched)
    }

    /// A tile by itself, in its stretches.
    fn add_in_place(&mut self, work: Work, index: usize) {
        let mut made = None;
        let tile = OneTile::of(work.frame, index, &mut made);
        let points = &work.local.axes;
        let mut near = std::mem::take(&mut self.near);
        near.clear();
        self.stretches.fields(work.level, &tile, points, &mut self.fields, &mut near);
        self.totals.add_fields(work.level, work.frame.to_scene.rotation(), &self.fields);
        near.retain(|&index| (index as usize) < work.points.len() && !points[0][index as usize].is_nan());
        if !near.is_empty() {
            self.add_near(work, index, &near);
        }
        self.near = near;
    }

    /// Tiles together in one form, at all points or at the chosen ones, which have been gathered.
    fn add_together(&mut self, work: Work, together: &Together, cluster: &Cluster, form: Form, chosen: Option<&[u32]>) {
        let points = if chosen.is_some() { &self.gathered.axes } else { &work.local.axes };
        let (level, rotation, count) = (work.level, work.frame.to_scene.rotation(), points[0].len());
        let fields = room(&mut self.fields, count);
        if let MIDDLE | OUTER = form {
            let (tables, small) = (&mut self.tables, form == OUTER);
            // Not those that only fill a pair of vectors.
            let used = chosen.map_or(count, |chosen| chosen.len().next_multiple_of(LONGEST_VECTOR));
            let points = views(points).map(|axis| &axis[..used]);
            dispatch!(level, simd => tables.fields(simd, cluster, small, points, fields));
        } else {
            match together.range.far(form) {
                FarForm::Expansion { degree } => {
                    let expansion = together.expansion(level, &work.frame.blocks);
                    let degrees = &mut self.degrees.highest;
                    degrees.clear();
                    degrees.resize(count.div_ceil(POINTS_PER_DEGREE), degree);
                    dispatch!(level, simd => expansion.fields(simd, degrees, views(points), fields));
                }
                FarForm::Series { order } => {
                    self.partial.start(count);
                    for index in together.blocks.clone() {
                        let mut made = None;
                        let (tile, series) = (&work.frame.table.tiles[index].far, series(work.frame, index, &mut made));
                        let what = Distributed { tile, series, order };
                        let fields = room(&mut self.fields, count);
                        dispatch!(level, simd => fields_of(simd, &what, views(points), fields, &mut Ahead::nothing()));
                        self.partial.add_fields(level, rotation, &self.fields);
                    }
                    return match chosen {
                        None => self.totals.add_totals(level, &self.partial),
                        Some(chosen) => self.totals.add_totals_at(&self.partial, chosen),
                    };
                }
            }
        }
        match chosen {
            None => self.totals.add_fields(level, rotation, &self.fields),
            Some(chosen) => self.totals.add_fields_at(level, rotation, &mut self.fields, chosen),
        }
    }

    /// Tiles that need different forms at different points.
    fn add_by_form(&mut self, work: Work, together: &Together, beyond: Option<Beyond>) {
        let mut chosen = std::mem::take(&mut self.chosen);
        let sphere = beyond.map(|of| (&self.points, of.sphere));
        chosen.sort_all(work.level, &together.range, work.local, work.points.len(), work.stretched, sphere);
        for form in chosen.forms() {
            let points = chosen.points(form);
            match (form, &together.cluster) {
                (BEYOND, _) => self.add_beyond(work, beyond.expect("only then there are such points"), points),
                (_, None) => self.add_tile(work, together.blocks.start, form, points),
                (NEAR, Some(_)) => {
                    let mut chosen_by_tile = std::mem::take(&mut self.chosen_by_tile);
                    self.gathered_near.gather(work.local, points);
                    for index in together.blocks.clone() {
                        let range = &work.frame.table.tiles[index].range;
                        chosen_by_tile.sort(work.level, range, &self.gathered_near, points);
                        for form in chosen_by_tile.forms() {
                            self.add_tile(work, index, form, chosen_by_tile.points(form));
                        }
                    }
                    self.chosen_by_tile = chosen_by_tile;
                }
                (_, Some(cluster)) => {
                    self.gathered.gather(work.local, points);
                    self.add_together(work, together, cluster, form, Some(points));
                }
            }
        }
        self.chosen = chosen;
    }

    /// A part of a tree by its expansion at the chosen points.
    fn add_beyond(&mut self, work: Work, of: Beyond, chosen: &[u32]) {
        self.gathered.gather(&self.points, chosen);
        let points = &self.gathered.axes;
        of.tree.set_degrees(&of.what, views(points), &mut self.degrees);
        let (expansion, fields) = (of.tree.expansion(of.what.node), room(&mut self.fields, points[0].len()));
        dispatch!(work.level, simd => expansion.fields(simd, &self.degrees.highest, views(points), fields));
        self.totals.add_fields_at(work.level, None, &mut self.fields, chosen);
        for (chosen, own_t) in chosen.chunks(POINTS_PER_DEGREE).zip(&self.degrees.left_out_t) {
            chosen.iter().for_each(|&index| self.left_out_t[index as usize] += own_t);
        }
    }

    /// One tile at the chosen points.
    fn add_tile(&mut self, work: Work, index: usize, form: Form, chosen: &[u32]) {
        if form == NEAR {
            return self.add_near(work, index, chosen);
        }
        let mut made = None;
        let tile = OneTile::of(work.frame, index, &mut made);
        self.gathered.gather(work.local, chosen);
        let points = &self.gathered.axes;
        let fields = room(&mut self.fields, points[0].len());
        dispatch!(work.level, simd => tile.fields(simd, form, views(points), fields, &mut Ahead::nothing()));
        self.totals.add_fields_at(work.level, work.frame.to_scene.rotation(), &mut self.fields, chosen);
    }

    /// Points beside a tile: in vectors if they are off its planes, else the kernel of one point.
    fn add_near(&mut self, work: Work, index: usize, chosen: &[u32]) {
        let block = &work.frame.blocks[index];
        let beside = Beside::of(block, work.part);
        let [x, y, z] = &work.local.axes;
        self.chosen_beside.clear();
        for &point in chosen {
            let index = point as usize;
            let at = Local {
                coordinates: [x[index], y[index], z[index]],
                roundoff: work.arrangement.roundoff(work.frame, work.points[index]),
            };
            if beside.as_ref().is_some_and(|beside| beside.serves(&at)) {
                self.chosen_beside.push(point);
            } else {
                let own = near_field(block, &at, work.frame, work.part, || self.edges.entry(index).or_default());
                self.totals.add_one(index, own.to_array());
            }
        }
        if let (Some(beside), false) = (beside, self.chosen_beside.is_empty()) {
            self.gathered.gather(work.local, &self.chosen_beside);
            let points = &self.gathered.axes;
            let fields = room(&mut self.fields, points[0].len());
            dispatch!(work.level, simd => beside.fields(simd, views(points), fields));
            self.totals.add_fields_at(
                work.level,
                work.frame.to_scene.rotation(),
                &mut self.fields,
                &self.chosen_beside,
            );
        }
    }
}

/// B or mu0 H of a block by the kernel of one point, in the scene's frame. If the point is on the line of an edge, that is added to what `edges` gives.
pub(super) fn near_field<'a>(
    block: &Block,
    at: &Local,
    frame: &Frame,
    part: Part,
    edges: impl FnOnce() -> &'a mut Edges,
) -> DVec3 {
    let Some(placed) = block.place(at) else { return DVec3::ZERO };
    let own = cuboid_field(&placed.offsets, block.polarization_t.to_array(), part);
    if placed.on_edge_line() {
        edges().add(block, &placed, &frame.to_scene);
    }
    frame.to_scene.vector(DVec3::from_array(own))
}

/// A part of a tree that is taken by its expansion outside a sphere around its centre.
#[derive(Clone, Copy)]
struct Beyond<'a> {
    sphere: ([f64; 3], f64),
    tree: &'a Tree,
    what: Nearest,
}

type Wanted<'a> = (&'a Frame, Vec<(&'a Together, Option<Beyond<'a>>)>);

/// All frames with their tiles, or with those that are assigned.
fn parts<'a>(arrangement: &'a Arrangement, assigned: Option<(&'a Tree, &'a Assignment)>) -> Vec<Wanted<'a>> {
    let frames = arrangement.frames();
    let Some((tree, assignment)) = assigned else {
        return frames
            .iter()
            .map(|f| (f, f.table.clusters.iter().map(|together| (together, None)).collect()))
            .collect();
    };
    let frame_of = |near: &Near| tree.items[near.item].frame;
    let of_frames = assignment.near.chunk_by(|a, b| frame_of(a) == frame_of(b));
    let with_clusters = of_frames.map(|parts| {
        let frame = &frames[frame_of(&parts[0])];
        let part = |near: &Near| {
            let beyond = near.beyond.map(|(distance, what)| Beyond {
                sphere: (tree.nodes[what.node].centre.to_array(), distance * distance),
                tree,
                what,
            });
            (tree.items[near.item].together(frame), beyond)
        };
        (frame, parts.iter().map(part).collect())
    });
    with_clusters.collect()
}
