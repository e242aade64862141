//! The tiles of a scene added up at a batch of points.

use std::any::Any;
use std::cell::RefCell;
use std::collections::BTreeMap;

use fearless_simd::prelude::*;
use fearless_simd::{Level, dispatch};
use glam::DVec3;

use super::assignment::{Assignment, Near, Nearest};
use super::beside::Beside;
use super::closed_form::Tables;
use super::cluster::Cluster;
use super::expansion::Expansion;
use super::lanes::{Lanes, PAIR};
use super::one_tile::{Distributed, OneTile, Pairwise};
use super::points::{Chosen, Coordinates};
use super::range::{BEYOND, FORMS, FarForm, Form, MIDDLE, NEAR, OUTER};
use super::streams::Streams;
use super::table::Together;
use super::totals::Totals;
use super::translation::translated;
use super::tree::Tree;
use crate::arrangement::{Arrangement, Frame};
use crate::block::{Block, Local};
use crate::edge_policy::Edges;
use crate::kernel::{Part, cuboid_field};
use crate::tolerances::{MIXED_SHARE, POINTS_PER_DEGREE};

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
    /// Of a tile by itself.
    fields: [Vec<f64>; 3],
    forms: Vec<f64>,
    stretches: Vec<Stretch>,
    near: Vec<u32>,
    streams: Streams,
    finite: bool,
    /// Those of an expansion, by points.
    degrees: Vec<usize>,
    /// The [`Tables`] of the instruction set last used.
    tables: Option<Box<dyn Any + Send>>,
}

/// Points of a batch that lie together, whole pairs of vectors, and a form of a tile that serves all of them, or some.
#[derive(Clone, Debug)]
struct Stretch {
    form: Form,
    range: std::ops::Range<usize>,
    /// Whether some have another form.
    mixed: bool,
}

/// What stays the same for a frame.
#[derive(Clone, Copy)]
struct Work<'a> {
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
        assigned: Option<(&Tree, &Assignment)>,
        part: Part,
        points: &[DVec3],
        field: &mut [DVec3],
    ) {
        self.edges.clear();
        self.finite = false;
        if let (Some(frame), None) = (arrangement.only_tile(), assigned) {
            self.finite = self.streams.evaluate(level, (arrangement, frame), part, points, field, &mut self.edges);
            return;
        }
        self.points.set(points);
        self.totals.start(self.points.padded());
        if !points.is_empty() {
            dispatch!(level, simd => self.add_frames(simd, arrangement, assigned, part, points));
        }
        self.totals.write(field);
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

    #[inline(always)]
    fn add_frames<S: Simd>(
        &mut self,
        simd: S,
        arrangement: &Arrangement,
        assigned: Option<(&Tree, &Assignment)>,
        part: Part,
        points: &[DVec3],
    ) {
        let kept = self.tables.take().and_then(|tables| tables.downcast::<Tables<S>>().ok());
        let mut tables = kept.unwrap_or_else(|| Box::new(Tables::new(simd)));
        if let Some((tree, assignment)) = assigned {
            for what in &assignment.expanded {
                let (expansion, points) = (tree.expansion(what.node), &self.points.axes);
                tree.set_degrees(what, points, &mut self.degrees);
                let degree = |index: usize| self.degrees[index / POINTS_PER_DEGREE];
                self.totals.add_varied_pairs(simd, None, points, |index| Expanded { expansion, degree: degree(index) });
            }
            if let Some(local) = translated(simd, tree, &assignment.translated, assignment.middle, assignment.reach) {
                self.totals.add_pairs(simd, None, &self.points.axes, &local);
            }
        }
        for (frame, wanted) in parts(arrangement, assigned) {
            let mut local = std::mem::take(&mut self.local);
            local.set_in_frame(simd, arrangement, frame, &self.points);
            let work = Work { arrangement, frame, part, points, local: &local, stretched: assigned.is_some() };
            let (low, high) = local.reach(simd);
            for (together, beyond) in wanted {
                let form = together.range.form_of_box(low, high, work.stretched).filter(|_| beyond.is_none());
                match (form, &together.cluster) {
                    (form, None) if self.find_stretches(simd, work, together, form, beyond.is_some()) => {
                        self.add_in_place(simd, work, together.blocks.start);
                    }
                    (Some(form), Some(cluster)) => self.add_at_all(simd, &mut tables, work, together, cluster, form),
                    _ => self.add_by_form(simd, &mut tables, work, together, beyond),
                }
            }
            self.local = local;
        }
        self.tables = Some(tables);
    }

    /// Divides the points, as they lie, into stretches of one form of a tile by itself: all of them, if it is given. Returns whether that is worth while.
    #[inline(always)]
    fn find_stretches<S: Simd>(
        &mut self,
        simd: S,
        work: Work,
        together: &Together,
        form: Option<Form>,
        beyond: bool,
    ) -> bool {
        let pair = 2 * Lanes::<S>::LEN;
        let count = work.local.padded();
        self.stretches.clear();
        if let Some(form) = form {
            self.stretches.push(Stretch { form, range: 0..count, mixed: false });
            return true;
        }
        if beyond {
            return false;
        }
        self.forms.resize(count, 0.0);
        together.range.forms(simd, &work.local.axes, work.stretched, &mut self.forms);
        let most_mixed = count / pair / MIXED_SHARE;
        let mut mixed = 0;
        for (number, forms) in self.forms.chunks_exact(pair).enumerate() {
            let (start, end) = (number * pair, (number + 1) * pair);
            let form = forms[0] as Form;
            if forms.iter().fold(true, |all, other| all & (*other == forms[0])) {
                match self.stretches.last_mut() {
                    Some(last) if last.form == form && !last.mixed => last.range.end = end,
                    _ => self.stretches.push(Stretch { form, range: start..end, mixed: false }),
                }
                continue;
            }
            mixed += 1;
            if mixed > most_mixed {
                return false;
            }
            let present = forms.iter().fold(0_u64, |present, form| present | 1 << (*form as u64));
            let forms = (0..FORMS as Form).filter(|form| present >> form & 1 == 1);
            self.stretches.extend(forms.map(|form| Stretch { form, range: start..end, mixed: true }));
        }
        true
    }

    /// A tile by itself, in its stretches.
    #[inline(always)]
    fn add_in_place<S: Simd>(&mut self, simd: S, work: Work, index: usize) {
        let mut made = None;
        let tile = OneTile::of(work.frame, index, &mut made);
        let points = &work.local.axes;
        let mut near = std::mem::take(&mut self.near);
        near.clear();
        let mut mixed = [[0.0; PAIR]; 3];
        self.fields.iter_mut().for_each(|values| values.resize(points[0].len(), 0.0));
        for stretch in &self.stretches {
            let range = stretch.range.clone();
            let is_served = |index: &usize| self.forms[*index] == f64::from(stretch.form);
            if stretch.form == NEAR {
                let served = range.clone().filter(|index| !stretch.mixed || is_served(index));
                let known = served.filter(|&index| index < work.points.len() && !points[0][index].is_nan());
                near.extend(known.map(|index| index as u32));
                for values in &mut self.fields {
                    values[range.clone()].fill(0.0);
                }
                continue;
            }
            let [x, y, z] = points.each_ref().map(|axis| &axis[range.clone()]);
            let fields = if stretch.mixed {
                mixed.each_mut().map(|axis| &mut axis[..range.len()])
            } else {
                self.fields.each_mut().map(|axis| &mut axis[range.clone()])
            };
            tile.fields(simd, stretch.form, [x, y, z], fields);
            if stretch.mixed {
                for (values, mixed) in self.fields.iter_mut().zip(&mixed) {
                    for (index, value) in range.clone().zip(mixed) {
                        if is_served(&index) {
                            values[index] = *value;
                        }
                    }
                }
            }
        }
        self.totals.add_fields(simd, work.frame.to_scene.rotation(), &self.fields);
        if !near.is_empty() {
            self.add_near(simd, work, index, &near);
        }
        self.near = near;
    }

    /// Tiles that one form serves at all points.
    #[inline(always)]
    fn add_at_all<S: Simd>(
        &mut self,
        simd: S,
        tables: &mut Tables<S>,
        work: Work,
        together: &Together,
        cluster: &Cluster,
        form: Form,
    ) {
        let (rotation, points) = (work.frame.to_scene.rotation(), &work.local.axes);
        if let MIDDLE | OUTER = form {
            let source = Middle { tables, cluster, small: form == OUTER, next: None };
            self.totals.add(simd, rotation, points, source);
            return;
        }
        match together.range.far(form) {
            FarForm::Series { order } => {
                self.add_series(simd, work, together, order, false);
                self.totals.add_totals(simd, &self.partial);
            }
            FarForm::Expansion { degree } => {
                let what = Expanded { expansion: together.expansion(simd.level(), &work.frame.blocks), degree };
                self.totals.add_pairs(simd, rotation, points, &what);
            }
        }
    }

    /// The series of all tiles of a cluster, at all points or at gathered ones, into the partial sums.
    #[inline(always)]
    fn add_series<S: Simd>(&mut self, simd: S, work: Work, together: &Together, order: usize, gathered: bool) {
        let points = if gathered { &self.gathered.axes } else { &work.local.axes };
        self.partial.start(points[0].len());
        for index in together.blocks.clone() {
            let mut made = None;
            let source = Distributed::of(work.frame, index, order, &mut made);
            self.partial.add_pairs(simd, work.frame.to_scene.rotation(), points, &source);
        }
    }

    /// Tiles that need different forms at different points.
    #[inline(always)]
    fn add_by_form<S: Simd>(
        &mut self,
        simd: S,
        tables: &mut Tables<S>,
        work: Work,
        together: &Together,
        beyond: Option<Beyond>,
    ) {
        let mut chosen = std::mem::take(&mut self.chosen);
        let sphere = beyond.map(|of| (&self.points, of.sphere));
        chosen.sort_all(simd, &together.range, work.local, work.points.len(), work.stretched, sphere);
        for form in chosen.forms() {
            let points = chosen.points(form);
            match (form, &together.cluster) {
                (BEYOND, _) => {
                    let of = beyond.expect("only then there are such points");
                    self.gathered.gather(&self.points, points);
                    let (expansion, gathered) = (of.tree.expansion(of.what.node), &self.gathered.axes);
                    of.tree.set_degrees(&of.what, gathered, &mut self.degrees);
                    let degree = |index: usize| self.degrees[index / POINTS_PER_DEGREE];
                    let what = |index| Expanded { expansion, degree: degree(index) };
                    self.totals.add_some_varied_pairs(simd, None, gathered, points, what);
                }
                (_, None) => {
                    self.gathered.gather(work.local, points);
                    self.add_tile(simd, work, together.blocks.start, form, points);
                }
                (NEAR, Some(_)) => {
                    let mut chosen_by_tile = std::mem::take(&mut self.chosen_by_tile);
                    self.gathered_near.gather(work.local, points);
                    for index in together.blocks.clone() {
                        chosen_by_tile.sort(simd, &work.frame.table.tiles[index].range, &self.gathered_near, points);
                        for form in chosen_by_tile.forms() {
                            let points = chosen_by_tile.points(form);
                            self.gathered.gather(work.local, points);
                            self.add_tile(simd, work, index, form, points);
                        }
                    }
                    self.chosen_by_tile = chosen_by_tile;
                }
                (MIDDLE | OUTER, Some(cluster)) => {
                    self.gathered.gather(work.local, points);
                    let source = Middle { tables, cluster, small: form == OUTER, next: None };
                    self.add_gathered(simd, work, points, source);
                }
                _ => {
                    self.gathered.gather(work.local, points);
                    match together.range.far(form) {
                        FarForm::Series { order } => {
                            self.add_series(simd, work, together, order, true);
                            self.totals.add_totals_at(&self.partial, points);
                        }
                        FarForm::Expansion { degree } => {
                            let what =
                                Expanded { expansion: together.expansion(simd.level(), &work.frame.blocks), degree };
                            self.add_gathered_pairs(simd, work, points, &what);
                        }
                    }
                }
            }
        }
        self.chosen = chosen;
    }

    /// One tile at the chosen points, which have been gathered.
    #[inline(always)]
    fn add_tile<S: Simd>(&mut self, simd: S, work: Work, index: usize, form: Form, chosen: &[u32]) {
        match form {
            NEAR => self.add_near(simd, work, index, chosen),
            _ => {
                let mut made = None;
                let tile = OneTile::of(work.frame, index, &mut made);
                let points = &self.gathered.axes;
                tile.fields(simd, form, views(points), room(&mut self.fields, points[0].len()));
                self.totals.add_fields_at(simd, work.frame.to_scene.rotation(), &mut self.fields, chosen);
            }
        }
    }

    #[inline(always)]
    fn add_gathered<S: Simd>(&mut self, simd: S, work: Work, chosen: &[u32], source: impl Source<S>) {
        let rotation = work.frame.to_scene.rotation();
        self.totals.add_some(simd, rotation, &self.gathered.axes, chosen, source);
    }

    #[inline(always)]
    fn add_gathered_pairs<S: Simd>(&mut self, simd: S, work: Work, chosen: &[u32], what: &impl Pairwise<S>) {
        let rotation = work.frame.to_scene.rotation();
        self.totals.add_some_pairs(simd, rotation, &self.gathered.axes, chosen, what);
    }

    /// Points beside a tile: in vectors if they are off its planes, else the kernel of one point.
    #[inline(always)]
    fn add_near<S: Simd>(&mut self, simd: S, work: Work, index: usize, chosen: &[u32]) {
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
            beside.fields(simd, views(points), room(&mut self.fields, points[0].len()));
            self.totals.add_fields_at(simd, work.frame.to_scene.rotation(), &mut self.fields, &self.chosen_beside);
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

fn views(points: &[Vec<f64>; 3]) -> [&[f64]; 3] {
    let [x, y, z] = points;
    [x, y, z]
}

fn room(fields: &mut [Vec<f64>; 3], count: usize) -> [&mut [f64]; 3] {
    fields.iter_mut().for_each(|values| values.resize(count, 0.0));
    let [x, y, z] = fields;
    [x, y, z]
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
            (&frame.table.clusters[tree.items[near.item].together], beyond)
        };
        (frame, parts.iter().map(part).collect())
    });
    with_clusters.collect()
}

/// What has a field, mu0 H in its own frame, at vector after vector of points. It is told of them two vectors ahead, so that it can prepare
/// them while it waits for quotients.
pub(super) trait Source<S: Simd> {
    /// Begins with the first two vectors of points.
    fn start(&mut self, simd: S, first: [[Lanes<S>; 3]; 2]);

    /// The field at the first of the vectors handed over that it has not yet been given for. `ahead` is the third of them.
    fn field(&mut self, simd: S, ahead: [Lanes<S>; 3]) -> [Lanes<S>; 3];
}

/// Tiles together.
struct Middle<'a, S: Simd> {
    tables: &'a mut Tables<S>,
    cluster: &'a Cluster,
    /// Whether all elements are small.
    small: bool,
    next: Option<[Lanes<S>; 3]>,
}

impl<S: Simd> Source<S> for Middle<'_, S> {
    #[inline(always)]
    fn start(&mut self, _: S, first: [[Lanes<S>; 3]; 2]) {
        self.tables.start(self.cluster, first[0]);
        self.next = Some(first[1]);
    }

    #[inline(always)]
    fn field(&mut self, simd: S, ahead: [Lanes<S>; 3]) -> [Lanes<S>; 3] {
        let next = self.next.replace(ahead).expect("started");
        self.tables.field(simd, self.cluster, next, self.small)
    }
}

/// Tiles together, radii of the sphere around them away.
pub(super) struct Expanded<'a> {
    pub(super) expansion: &'a Expansion,
    pub(super) degree: usize,
}

impl<S: Simd> Pairwise<S> for Expanded<'_> {
    #[inline(always)]
    fn fields(&self, simd: S, points: [[Lanes<S>; 3]; 2]) -> [[Lanes<S>; 3]; 2] {
        self.expansion.fields(simd, self.degree, points)
    }
}
