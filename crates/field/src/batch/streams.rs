//! A tile that is alone in its scene: each point joins the queue of its form, and a form runs when its queue has some vectors. Nothing is
//! added up, so that the field at a point is written once.

use std::collections::BTreeMap;

use fearless_simd::prelude::*;
use fearless_simd::{Level, dispatch};
use glam::DVec3;

use super::beside::Beside;
use super::lanes::PAIR;
use super::one_tile::OneTile;
use super::points::Coordinates;
use super::range::{FORMS, Form, NEAR};
use super::superposition::near_field;
use crate::arrangement::{Arrangement, Frame};
use crate::block::Local;
use crate::edge_policy::Edges;
use crate::kernel::Part;
use crate::tolerances::{FETCHED_AHEAD, STREAMED_POINTS};

/// What a queue holds at most: what a run leaves, and one stretch of points. A power of two, so that an index masked to it needs no check.
const CAPACITY: usize = 2 * STREAMED_POINTS;

/// Points in a line of a cache, at least.
const POINTS_PER_FETCH: usize = 2;

/// The form of points beside the tile but off the planes of its faces.
const BESIDE: Form = FORMS as Form;

/// Room for the queues; nothing in it grows with the number of points.
#[derive(Debug, Default)]
pub(super) struct Streams {
    points: Coordinates,
    local: Coordinates,
    forms: Vec<f64>,
    queues: Vec<Queue>,
    fields: [Vec<f64>; 3],
    /// Whether all of the field in vectors has been finite.
    finite: bool,
}

/// Points that wait for their form.
#[derive(Debug)]
struct Queue {
    /// Positions in the list.
    places: [u32; CAPACITY],
    axes: [[f64; CAPACITY]; 3],
    count: usize,
}

impl Default for Queue {
    fn default() -> Queue {
        Queue { places: [0; CAPACITY], axes: [[0.0; CAPACITY]; 3], count: 0 }
    }
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
        self.queues.resize_with(FORMS + 1, Queue::default);
        self.queues.iter_mut().for_each(|queue| queue.count = 0);
        let work = Work { arrangement, frame, part, points, tile: &tile, beside: beside.as_ref() };
        self.finite = true;
        dispatch!(level, simd => self.run(simd, work, field, edges));
        self.finite
    }

    #[inline(always)]
    fn run<S: Simd>(&mut self, simd: S, work: Work, field: &mut [DVec3], edges: &mut BTreeMap<usize, Edges>) {
        for values in &mut self.fields {
            values.resize(CAPACITY, 0.0);
        }
        let forms = (NEAR + 1..=work.tile.range().last_form()).chain([BESIDE]);
        let stretches = work.points.len().div_ceil(STREAMED_POINTS);
        // Once more than there are stretches, for what is left.
        for number in 0..=stretches {
            if let Some(start) = (number < stretches).then_some(number * STREAMED_POINTS) {
                let end = (start + STREAMED_POINTS).min(work.points.len());
                self.sort(simd, work, start, &work.points[start..end], field);
                self.divide_near(work, field, edges);
            }
            for form in forms.clone() {
                let queue = &mut self.queues[usize::from(form)];
                let mut count = queue.count / PAIR * PAIR;
                if number == stretches && count < queue.count {
                    queue.fill_up();
                    count = queue.count;
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
        fetch_ahead(work.points, field, start + FETCHED_AHEAD);
        self.points.set(stretch);
        let local = if work.frame.to_scene.rotation().is_some() {
            self.local.set_in_frame(simd, work.arrangement, work.frame, &self.points);
            &self.local
        } else {
            &self.points
        };
        self.forms.resize(STREAMED_POINTS, 0.0);
        let forms = &mut self.forms[..local.padded()];
        work.tile.range().forms(simd, &local.axes, false, forms);
        let [x, y, z] = &local.axes;
        let count = stretch.len();
        let (forms, x, y, z) = (&forms[..count], &x[..count], &y[..count], &z[..count]);
        if self.points.out_of_range().is_empty() {
            for index in 0..count {
                let queue = &mut self.queues[queue_of(forms[index])];
                queue.push((start + index) as u32, [x[index], y[index], z[index]]);
            }
            return;
        }
        self.finite = false;
        for index in 0..count {
            if x[index].is_nan() {
                field[start + index] = DVec3::NAN;
            } else {
                let queue = &mut self.queues[queue_of(forms[index])];
                queue.push((start + index) as u32, [x[index], y[index], z[index]]);
            }
        }
    }

    /// Of the points beside the tile, those off its planes join a queue of their own; the others, which are few, get the kernel of one point.
    #[inline(always)]
    fn divide_near(&mut self, work: Work, field: &mut [DVec3], edges: &mut BTreeMap<usize, Edges>) {
        let (before, others) = self.queues.split_at_mut(usize::from(BESIDE));
        let (near, beside) = (&mut before[usize::from(NEAR)], &mut others[0]);
        for waiting in 0..std::mem::take(&mut near.count) {
            let (place, coordinates) = near.at(waiting);
            let roundoff = work.arrangement.roundoff(work.frame, work.points[place]);
            let at = Local { coordinates, roundoff };
            if work.beside.is_some_and(|beside| beside.serves(&at)) {
                beside.push(place as u32, coordinates);
            } else {
                let block = &work.frame.blocks[0];
                self.finite = false;
                field[place] = near_field(block, &at, work.frame, work.part, || edges.entry(place).or_default());
            }
        }
    }

    /// The first `count` points that wait for a form; what is behind them moves up.
    #[inline(always)]
    fn serve<S: Simd>(&mut self, simd: S, work: Work, form: Form, count: usize, field: &mut [DVec3]) {
        let queue = &mut self.queues[usize::from(form)];
        let whole = count.next_multiple_of(PAIR);
        let [x, y, z] = &queue.axes;
        let points = [&x[..whole], &y[..whole], &z[..whole]];
        let [fx, fy, fz] = &mut self.fields;
        let fields = [&mut fx[..whole], &mut fy[..whole], &mut fz[..whole]];
        match work.beside {
            Some(beside) if form == BESIDE => beside.fields(simd, points, fields),
            _ => work.tile.fields(simd, form, points, fields),
        }
        let (fx, fy, fz) = (&fx[..count], &fy[..count], &fz[..count]);
        // Without a branch, so that it is done in vectors.
        let sums = fx.iter().zip(fy).zip(fz).map(|((x, y), z)| x.abs() + y.abs() + z.abs());
        self.finite &= sums.fold(true, |all, sum| all & (sum < f64::INFINITY));
        let places = queue.places[..count].iter().zip(fx).zip(fy).zip(fz);
        match work.frame.to_scene.rotation() {
            None => places.for_each(|(((&place, x), y), z)| field[place as usize] = DVec3::new(*x, *y, *z)),
            Some(to_scene) => {
                places.for_each(|(((&place, x), y), z)| field[place as usize] = *to_scene * DVec3::new(*x, *y, *z));
            }
        }
        queue.remove(count);
    }
}

/// Asks for the memory of a stretch that will be served later: what the processor asks for by itself ends with each page.
#[inline(always)]
fn fetch_ahead(points: &[DVec3], field: &[DVec3], start: usize) {
    let end = (start + STREAMED_POINTS).min(points.len());
    let mut read = 0;
    for index in (start..end).step_by(POINTS_PER_FETCH) {
        read |= points[index].x.to_bits() | field[index].x.to_bits();
    }
    // Or nothing would be read.
    std::hint::black_box(read);
}

/// A small whole number, read off its digits below 2^52.
#[inline(always)]
fn queue_of(form: f64) -> usize {
    const LAST_DIGITS: f64 = 4_503_599_627_370_496.0;
    (form + LAST_DIGITS).to_bits() as usize & 0xff
}

impl Queue {
    #[inline(always)]
    fn push(&mut self, place: u32, coordinates: [f64; 3]) {
        let end = self.count & (CAPACITY - 1);
        self.places[end] = place;
        for (axis, coordinate) in coordinates.into_iter().enumerate() {
            self.axes[axis][end] = coordinate;
        }
        self.count += 1;
    }

    fn at(&self, index: usize) -> (usize, [f64; 3]) {
        let [x, y, z] = &self.axes;
        (self.places[index] as usize, [x[index], y[index], z[index]])
    }

    /// Repeats the last point up to whole pairs of vectors.
    fn fill_up(&mut self) {
        for axis in &mut self.axes {
            let last = axis[self.count - 1];
            axis[self.count..self.count.next_multiple_of(PAIR)].fill(last);
        }
    }

    /// The first `count` points, when less than a [`PAIR`] are left.
    fn remove(&mut self, count: usize) {
        // A fixed number of them is moved without a call.
        self.places.copy_within(count..count + PAIR, 0);
        self.axes.iter_mut().for_each(|axis| axis.copy_within(count..count + PAIR, 0));
        self.count -= count;
    }
}
