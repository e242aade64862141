//! A tile that is alone in its scene: each point joins the queue of its form, and a form runs when its queue has some vectors. Nothing is
//! added up, so that the field at a point is written once.

use std::collections::BTreeMap;

use fearless_simd::prelude::*;
use fearless_simd::{Level, dispatch};
use glam::DVec3;

use super::ahead::Ahead;
use super::beside::Beside;
use super::column::{Column, room, views};
use super::lanes::PAIR;
use super::one_tile::OneTile;
use super::points::Coordinates;
use super::queues::{OWN_QUEUE, Queues};
use super::range::{Form, NEAR};
use super::superposition::near_field;
use crate::arrangement::{Arrangement, Frame};
use crate::block::Local;
use crate::edge_policy::Edges;
use crate::kernel::Part;
use crate::tolerances::{FETCHED_AHEAD, STREAMED_POINTS};

/// The form of points beside the tile but off the planes of its faces.
const BESIDE: Form = OWN_QUEUE;

/// Room for the points at work; nothing in it grows with their number.
#[derive(Debug, Default)]
pub(super) struct Streams {
    points: Coordinates,
    local: Coordinates,
    forms: Column,
    queues: Queues,
    fields: [Column; 3],
    /// Whether all of the field in vectors has been finite.
    finite: bool,
    /// Memory has been asked for up to this point.
    asked: usize,
}

/// What stays the same for all points.
#[derive(Clone, Copy)]
struct Work<'a> {
    arrangement: &'a Arrangement,
    frame: &'a Frame,
    part: Part,
    points: &'a [DVec3],
    tile: &'a OneTile<'a>,
    beside: Option<&'a Beside>,
}

impl Streams {
    /// The field of the only tile of `frame`; not a number where a point is out of range. Points on edge lines go to `edges`. Returns whether all values are
    /// known to be finite.
    pub(super) fn evaluate(
        &mut self,
        level: Level,
        (arrangement, frame): (&Arrangement, &Frame),
        part: Part,
        points: &[DVec3],
        field: &mut [DVec3],
        edges: &mut BTreeMap<usize, Edges>,
    ) -> bool {
        let mut made = None;
        let tile = OneTile::of(frame, 0, &mut made);
        let beside = Beside::of(&frame.blocks[0], part);
        self.queues.clear();
        let work = Work { arrangement, frame, part, points, tile: &tile, beside: beside.as_ref() };
        (self.finite, self.asked) = (true, 0);
        dispatch!(level, simd => self.run(simd, work, field, edges));
        self.finite
    }

    #[inline(always)]
    fn run<S: Simd>(&mut self, simd: S, work: Work, field: &mut [DVec3], edges: &mut BTreeMap<usize, Edges>) {
        room(&mut self.fields, STREAMED_POINTS + PAIR);
        let forms = (NEAR + 1..=work.tile.range().last_form()).chain([BESIDE]);
        let stretches = work.points.len().div_ceil(STREAMED_POINTS);
        // Once more than there are stretches, for what is left.
        for number in 0..=stretches {
            if let Some(start) = (number < stretches).then_some(number * STREAMED_POINTS) {
                let end = (start + STREAMED_POINTS).min(work.points.len());
                self.asked = self.asked.max(start + FETCHED_AHEAD);
                self.sort(simd, work, start, &work.points[start..end], field);
                self.divide_near(work, field, edges);
            }
            for form in forms.clone() {
                let mut count = self.queues.count(form) / PAIR * PAIR;
                if number == stretches && count < self.queues.count(form) {
                    self.queues.fill_up(form);
                    count = self.queues.count(form);
                }
                if count > 0 {
                    self.serve(simd, work, form, count, field);
                }
            }
        }
    }

    /// Brings each point of a stretch that begins at `start` into the queue of its form.
    #[inline(always)]
    fn sort<S: Simd>(&mut self, simd: S, work: Work, start: usize, stretch: &[DVec3], field: &mut [DVec3]) {
        self.points.set(simd, stretch);
        let local = if work.frame.to_scene.rotation().is_some() {
            self.local.set_in_frame(simd, work.arrangement, work.frame, &self.points);
            &self.local
        } else {
            &self.points
        };
        self.forms.set_len(STREAMED_POINTS);
        let forms = &mut self.forms[..local.padded()];
        work.tile.range().forms(simd, views(&local.axes), false, forms);
        let count = stretch.len();
        let axes = local.axes.each_ref().map(|axis| &axis[..count]);
        if self.points.out_of_range().is_empty() {
            self.queues.join_all(start, &forms[..count], axes);
            return;
        }
        self.finite = false;
        for index in 0..count {
            let coordinates = axes.map(|axis| axis[index]);
            if coordinates[0].is_nan() {
                field[start + index] = DVec3::NAN;
            } else {
                self.queues.join(forms[index] as Form, start + index, coordinates);
            }
        }
    }

    /// Of the points beside the tile, those off its planes join a queue of their own; the others, which are few, get the kernel of one point.
    #[inline(always)]
    fn divide_near(&mut self, work: Work, field: &mut [DVec3], edges: &mut BTreeMap<usize, Edges>) {
        for waiting in 0..self.queues.count(NEAR) {
            let (place, coordinates) = self.queues.at(NEAR, waiting);
            let roundoff = work.arrangement.roundoff(work.frame, work.points[place]);
            let at = Local { coordinates, roundoff };
            if work.beside.is_some_and(|beside| beside.serves(&at)) {
                self.queues.join(BESIDE, place, coordinates);
            } else {
                let block = &work.frame.blocks[0];
                self.finite = false;
                field[place] = near_field(block, &at, work.frame, work.part, || edges.entry(place).or_default());
            }
        }
        self.queues.empty(NEAR);
    }

    /// The first `count` points that wait for a form; what is behind them moves up.
    #[inline(always)]
    fn serve<S: Simd>(&mut self, simd: S, work: Work, form: Form, count: usize, field: &mut [DVec3]) {
        let points = self.queues.points(form).map(|axis| &axis[..count.next_multiple_of(PAIR)]);
        let [fx, fy, fz] = self.fields.each_mut().map(|values| &mut values[..points[0].len()]);
        let mut ahead = Ahead::of(work.points, field, self.asked);
        match work.beside {
            Some(beside) if form == BESIDE => beside.fields(simd, points, [&mut *fx, &mut *fy, &mut *fz]),
            _ => work.tile.fields(simd, form, points, [&mut *fx, &mut *fy, &mut *fz], &mut ahead),
        }
        self.asked = ahead.next();
        let (fx, fy, fz) = (&fx[..count], &fy[..count], &fz[..count]);
        // Without a branch, so that it is done in vectors.
        let sums = fx.iter().zip(fy).zip(fz).map(|((x, y), z)| x.abs() + y.abs() + z.abs());
        self.finite &= sums.fold(true, |all, sum| all & (sum < f64::INFINITY));
        let places = self.queues.places(form)[..count].iter().zip(fx).zip(fy).zip(fz);
        match work.frame.to_scene.rotation() {
            None => places.for_each(|(((&place, x), y), z)| field[place as usize] = DVec3::new(*x, *y, *z)),
            Some(to_scene) => {
                places.for_each(|(((&place, x), y), z)| field[place as usize] = *to_scene * DVec3::new(*x, *y, *z));
            }
        }
        self.queues.remove(form, count);
    }
}
