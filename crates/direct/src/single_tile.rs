//! The only tile of a scene. Each point joins the queue of its method, and a method is evaluated
//! when its queue has some vectors. Without a sum, the field at a point is written once.

use std::collections::BTreeMap;

use fearless_simd::prelude::*;
use fearless_simd::{Level, dispatch};
use glam::DVec3;
use magsplice_cuboid::block::LocalPoint;
use magsplice_cuboid::closed_form::near_edge::{NEAR_FORMS, NearEdges};
use magsplice_cuboid::evaluator::Evaluator;
use magsplice_cuboid::method::{MethodIndex, SCALAR};
use magsplice_cuboid::scalar::kernel::FieldKind;
use magsplice_simd::column::{Column, room, views};
use magsplice_simd::lanes::PAIR;
use magsplice_simd::prefetch::Prefetch;

use super::coordinates::Coordinates;
use super::edges::EdgesAtPoint;
use super::near_field::near_field;
use super::queues::{OWN_QUEUE, Queues};
use super::weak_points::WeakPoints;
use crate::prepare::frames::{Frame, Frames};
use crate::tolerances::{FETCHED_AHEAD, STREAMED_POINTS};

/// Index of the first form of [`NearEdges`], for points close to the tile but off the planes of its
/// faces.
const NEAR_EDGE: MethodIndex = OWN_QUEUE;

/// Buffers for the current points. They do not grow with the number of points.
#[derive(Debug, Default)]
pub(super) struct SingleTile {
    points: Coordinates,
    local: Coordinates,
    methods: Column,
    /// The form of each point close to the tile.
    forms: Column,
    /// Bounds of the errors of the coordinates of these points.
    roundoff: Coordinates,
    queues: Queues,
    fields: [Column; 3],
    magnitudes_t: Column,
    /// Whether all values so far are finite.
    finite: bool,
    /// Index of the first point whose memory has not been requested.
    asked: usize,
}

/// The arguments shared by all points.
#[derive(Clone, Copy)]
struct Work<'a> {
    frames: &'a Frames,
    frame: &'a Frame,
    kind: FieldKind,
    points: &'a [DVec3],
    tile: &'a Evaluator<'a>,
    near_edge: &'a NearEdges,
}

impl SingleTile {
    /// Writes the field of the only tile of `frame`; NaN where a point is out of range. Points on
    /// edge lines go to `edges`. `weak`, if given, receives the points whose field may be too weak
    /// for a tolerance. Returns whether all values are known to be finite.
    pub(super) fn evaluate(
        &mut self,
        level: Level,
        (frames, frame): (&Frames, &Frame),
        kind: FieldKind,
        points: &[DVec3],
        (field, weak): (&mut [DVec3], Option<&mut WeakPoints>),
        edges: &mut BTreeMap<usize, EdgesAtPoint>,
    ) -> bool {
        let mut made = None;
        let tile = frame.clusters.evaluator(&frame.blocks, 0, &mut made);
        let near_edge = NearEdges::new(&frame.blocks[0], kind);
        self.queues.clear();
        let work = Work { frames, frame, kind, points, tile: &tile, near_edge: &near_edge };
        (self.finite, self.asked) = (true, 0);
        dispatch!(level, simd => self.run(simd, work, field, weak, edges));
        self.finite
    }

    #[inline(always)]
    fn run<S: Simd>(
        &mut self,
        simd: S,
        work: Work,
        field: &mut [DVec3],
        mut weak: Option<&mut WeakPoints>,
        edges: &mut BTreeMap<usize, EdgesAtPoint>,
    ) {
        room(&mut self.fields, STREAMED_POINTS + PAIR);
        self.magnitudes_t.set_len(STREAMED_POINTS + PAIR);
        let methods =
            (SCALAR + 1..=work.tile.ranges().last_index()).chain(NEAR_EDGE..NEAR_EDGE + NEAR_FORMS as MethodIndex);
        let stretches = work.points.len().div_ceil(STREAMED_POINTS);
        // One more pass than there are blocks empties the queues.
        for number in 0..=stretches {
            if let Some(start) = (number < stretches).then_some(number * STREAMED_POINTS) {
                let end = (start + STREAMED_POINTS).min(work.points.len());
                self.asked = self.asked.max(start + FETCHED_AHEAD);
                self.sort(simd, work, start, &work.points[start..end], field);
                self.divide_near(simd, work, field, weak.as_deref_mut(), edges);
            }
            for method in methods.clone() {
                let mut count = self.queues.count(method) / PAIR * PAIR;
                if number == stretches && count < self.queues.count(method) {
                    self.queues.fill_up(method);
                    count = self.queues.count(method);
                }
                if count > 0 {
                    self.evaluate_queue(simd, work, method, count, field, weak.as_deref_mut());
                }
            }
        }
    }

    /// Appends each point of the block that begins at `start` to the queue of its method.
    #[inline(always)]
    fn sort<S: Simd>(&mut self, simd: S, work: Work, start: usize, stretch: &[DVec3], field: &mut [DVec3]) {
        self.points.set(simd, stretch);
        let local = if work.frame.to_scene.rotation().is_some() {
            self.local.set_in_frame(simd, work.frames, work.frame, &self.points);
            &self.local
        } else {
            &self.points
        };
        self.methods.set_len(STREAMED_POINTS);
        let methods = &mut self.methods[..local.padded()];
        work.tile.ranges().methods(simd, views(&local.axes), false, methods);
        let count = stretch.len();
        let axes = local.axes.each_ref().map(|axis| &axis[..count]);
        if self.points.out_of_range().is_empty() {
            self.queues.join_all(start, &methods[..count], axes);
            return;
        }
        self.finite = false;
        for index in 0..count {
            let coordinates = axes.map(|axis| axis[index]);
            if coordinates[0].is_nan() {
                field[start + index] = DVec3::NAN;
            } else {
                self.queues.join(methods[index] as MethodIndex, start + index, coordinates);
            }
        }
    }

    /// Moves points close to the tile and off the planes of its faces to a queue of their own. The
    /// scalar kernel evaluates the few others.
    #[inline(always)]
    fn divide_near<S: Simd>(
        &mut self,
        simd: S,
        work: Work,
        field: &mut [DVec3],
        mut weak: Option<&mut WeakPoints>,
        edges: &mut BTreeMap<usize, EdgesAtPoint>,
    ) {
        let count = self.queues.count(SCALAR);
        if count == 0 {
            return;
        }
        self.queues.fill_up(SCALAR);
        let waiting = self.queues.points(SCALAR);
        if work.frame.to_scene.rotation().is_some() {
            self.points.set_chosen(work.points, self.queues.places(SCALAR));
            self.roundoff.set_roundoff(simd, work.frames, work.frame, &self.points);
        } else {
            self.roundoff.axes.iter_mut().for_each(|bounds| bounds.fill_with(0.0, waiting[0].len()));
        }
        self.forms.set_len(waiting[0].len());
        work.near_edge.forms(simd, waiting, views(&self.roundoff.axes), &mut self.forms);
        for waiting in 0..count {
            let (place, coordinates) = self.queues.at(SCALAR, waiting);
            let form = self.forms[waiting] as MethodIndex;
            if usize::from(form) < NEAR_FORMS {
                self.queues.join(NEAR_EDGE + form, place, coordinates);
            } else {
                let at = LocalPoint { coordinates, roundoff: work.frames.roundoff(work.frame, work.points[place]) };
                let block = &work.frame.blocks[0];
                self.finite = false;
                field[place] = near_field(block, &at, work.frame, work.kind, || edges.entry(place).or_default());
                if let Some(weak) = weak.as_deref_mut() {
                    weak.check_one(place as u32, field[place]);
                }
            }
        }
        self.queues.empty(SCALAR);
    }

    /// Evaluates the first `count` points in the queue of a method, and moves the rest forward.
    #[inline(always)]
    fn evaluate_queue<S: Simd>(
        &mut self,
        simd: S,
        work: Work,
        method: MethodIndex,
        count: usize,
        field: &mut [DVec3],
        weak: Option<&mut WeakPoints>,
    ) {
        let points = self.queues.points(method).map(|axis| &axis[..count.next_multiple_of(PAIR)]);
        let [fx, fy, fz] = self.fields.each_mut().map(|values| &mut values[..points[0].len()]);
        let mut ahead = Prefetch::new(work.points, field, self.asked);
        match method.checked_sub(NEAR_EDGE) {
            Some(form) => {
                work.near_edge.fields(simd, usize::from(form), points, [&mut *fx, &mut *fy, &mut *fz]);
            }
            None => {
                let fields = [&mut *fx, &mut *fy, &mut *fz];
                if weak.as_deref().is_some_and(|weak| weak.needs_magnitudes(method)) {
                    let own_t = &mut self.magnitudes_t[..points[0].len()];
                    work.tile.fields_and_magnitudes(simd, method, points, fields, own_t, &mut ahead);
                } else {
                    work.tile.fields(simd, method, points, fields, &mut ahead);
                }
            }
        }
        self.asked = ahead.next();
        let (fx, fy, fz) = (&fx[..count], &fy[..count], &fz[..count]);
        // Computed in vectors, because it has no branch.
        let sums = fx.iter().zip(fy).zip(fz).map(|((x, y), z)| x.abs() + y.abs() + z.abs());
        self.finite &= sums.fold(true, |all, sum| all & (sum < f64::INFINITY));
        if let Some(weak) = weak {
            let waiting = (points, &self.queues.places(method)[..count]);
            weak.check(simd, method, waiting, [fx, fy, fz], &mut self.magnitudes_t[..points[0].len()]);
        }
        let places = self.queues.places(method)[..count].iter().zip(fx).zip(fy).zip(fz);
        match work.frame.to_scene.rotation() {
            None => places.for_each(|(((&place, x), y), z)| field[place as usize] = DVec3::new(*x, *y, *z)),
            Some(to_scene) => {
                places.for_each(|(((&place, x), y), z)| field[place as usize] = *to_scene * DVec3::new(*x, *y, *z));
            }
        }
        self.queues.remove(method, count);
    }
}
