//! Points that wait until there are whole vectors of their form.

use magsplice_cuboid::method::{FIRST_FAR, MethodIndex};
use magsplice_cuboid::tolerances::MULTIPOLE_ORDERS;
use magsplice_simd::lanes::{LONGEST_VECTOR, PAIR};

use crate::tolerances::STREAMED_POINTS;

/// The forms of a tile by itself.
const METHODS: usize = FIRST_FAR as usize + MULTIPOLE_ORDERS.len();
/// One that nothing joins by its number among those.
pub(super) const OWN_QUEUE: MethodIndex = METHODS as MethodIndex;
const QUEUES: usize = METHODS + 1;

/// What a queue holds at most: what a run leaves, one stretch of points, and what it is filled up with or moved by. A line of a cache more, so that
/// queues do not all begin in those that exclude each other.
const LENGTH: usize = STREAMED_POINTS + 2 * PAIR + LONGEST_VECTOR;
const ROOM: usize = QUEUES * LENGTH;
const _: () = assert!(LENGTH.is_multiple_of(LONGEST_VECTOR));

/// How many of a few points have each form is counted in one number, so that no point waits until the one before is counted in memory.
const DIGITS: usize = 8;
/// So few that no count is beyond its digits.
const COUNTED_POINTS: usize = 1 << (DIGITS - 1);
const _: () = assert!(METHODS * DIGITS <= u64::BITS as usize);

/// The queues, one after the other.
#[derive(Debug)]
pub(super) struct Queues {
    /// Positions in the list of all points.
    places: Box<[u32; ROOM]>,
    axes: Box<Axes>,
    counts: [usize; QUEUES],
    /// Where each point's form is counted.
    shifts: [u8; STREAMED_POINTS],
}

/// Coordinates, each queue's from the start of a cache line on.
#[derive(Debug)]
#[repr(align(64))]
struct Axes([[f64; ROOM]; 3]);

impl Default for Queues {
    fn default() -> Queues {
        Queues {
            places: Box::new([0; ROOM]),
            axes: Box::new(Axes([[0.0; ROOM]; 3])),
            counts: [0; QUEUES],
            shifts: [0; STREAMED_POINTS],
        }
    }
}

impl Queues {
    pub(super) fn clear(&mut self) {
        self.counts = [0; QUEUES];
    }

    pub(super) fn count(&self, queue: MethodIndex) -> usize {
        self.counts[usize::from(queue)]
    }

    /// Points of these forms, given by axis, of which the first is at `place` in the list, join their queues; [`STREAMED_POINTS`] at most.
    #[inline(always)]
    pub(super) fn join_all(&mut self, mut place: usize, forms: &[f64], axes: [&[f64]; 3]) {
        /// What is below it is in the last digits of the sum.
        const LAST_DIGITS: f64 = 4_503_599_627_370_496.0;
        for (shift, form) in self.shifts.iter_mut().zip(forms) {
            *shift = (form * DIGITS as f64 + LAST_DIGITS).to_bits() as u8;
        }
        let Queues { places, axes: queued, counts, shifts } = self;
        let (places, [x_queued, y_queued, z_queued]) = (&mut **places, &mut queued.0);
        let [x, y, z] = axes.map(|axis| axis.chunks(COUNTED_POINTS));
        for (((shifts, x), y), z) in shifts[..forms.len()].chunks(COUNTED_POINTS).zip(x).zip(y).zip(z) {
            let mut ends = [0; u64::BITS as usize];
            for (form, count) in counts[..METHODS].iter().enumerate() {
                ends[form * DIGITS] = form * LENGTH + count;
            }
            let mut counted = 0u64;
            for (((shift, x), y), z) in shifts.iter().zip(x).zip(y).zip(z) {
                let shift = usize::from(*shift) % u64::BITS as usize;
                let slot = ends[shift] + usize::from((counted >> shift) as u8);
                counted += 1 << shift;
                places[slot] = place as u32;
                x_queued[slot] = *x;
                y_queued[slot] = *y;
                z_queued[slot] = *z;
                place += 1;
            }
            for (form, count) in counts[..METHODS].iter_mut().enumerate() {
                *count += usize::from((counted >> (form * DIGITS)) as u8);
            }
        }
    }

    pub(super) fn join(&mut self, queue: MethodIndex, place: usize, coordinates: [f64; 3]) {
        let queue = usize::from(queue);
        let slot = queue * LENGTH + self.counts[queue];
        self.places[slot] = place as u32;
        for (axis, coordinate) in self.axes.0.iter_mut().zip(coordinates) {
            axis[slot] = coordinate;
        }
        self.counts[queue] += 1;
    }

    /// Position in the list, and coordinates.
    pub(super) fn at(&self, queue: MethodIndex, index: usize) -> (usize, [f64; 3]) {
        let slot = usize::from(queue) * LENGTH + index;
        (self.places[slot] as usize, self.axes.0.each_ref().map(|axis| axis[slot]))
    }

    /// By axis, all that wait and what follows them up to whole pairs of vectors.
    #[inline(always)]
    pub(super) fn points(&self, queue: MethodIndex) -> [&[f64]; 3] {
        let (start, count) = (usize::from(queue) * LENGTH, self.count(queue).next_multiple_of(PAIR));
        self.axes.0.each_ref().map(|axis| &axis[start..start + count])
    }

    /// Positions in the list.
    #[inline(always)]
    pub(super) fn places(&self, queue: MethodIndex) -> &[u32] {
        let start = usize::from(queue) * LENGTH;
        &self.places[start..start + self.count(queue)]
    }

    /// Repeats the last point up to whole pairs of vectors.
    pub(super) fn fill_up(&mut self, queue: MethodIndex) {
        let (start, count) = (usize::from(queue) * LENGTH, self.count(queue));
        for axis in &mut self.axes.0 {
            let last = axis[start + count - 1];
            axis[start + count..start + count.next_multiple_of(PAIR)].fill(last);
        }
    }

    /// The first `count` points, when less than a [`PAIR`] are left.
    #[inline(always)]
    pub(super) fn remove(&mut self, queue: MethodIndex, count: usize) {
        let start = usize::from(queue) * LENGTH;
        // A fixed number of them is moved without a call.
        let rest = start + count..start + count + PAIR;
        self.places.copy_within(rest.clone(), start);
        self.axes.0.iter_mut().for_each(|axis| axis.copy_within(rest.clone(), start));
        self.counts[usize::from(queue)] -= count;
    }

    pub(super) fn empty(&mut self, queue: MethodIndex) {
        self.counts[usize::from(queue)] = 0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Coordinates that tell which point they are of.
    fn coordinates(place: usize) -> [f64; 3] {
        [place as f64, 0.5 + place as f64, -(place as f64)]
    }

    /// Runs of one form as long as a stretch, and forms that change with each point.
    fn form(place: usize) -> MethodIndex {
        let (stretch, within) = (place / STREAMED_POINTS, place % STREAMED_POINTS);
        match stretch % 3 {
            0 => (stretch % METHODS) as MethodIndex,
            1 => (within % METHODS) as MethodIndex,
            _ => (within * within % METHODS) as MethodIndex,
        }
    }

    #[test]
    fn points_wait_in_the_order_in_which_they_came_and_what_is_removed_makes_room() {
        let mut queues = Queues::default();
        let mut left = vec![Vec::new(); METHODS];
        let mut seen = 0;
        // The last stretch is not a whole one.
        for start in (0..8 * STREAMED_POINTS + 37).step_by(STREAMED_POINTS) {
            let places = start..(start + STREAMED_POINTS).min(8 * STREAMED_POINTS + 37);
            let forms: Vec<f64> = places.clone().map(|place| f64::from(form(place))).collect();
            let axes = [0, 1, 2].map(|axis| places.clone().map(|place| coordinates(place)[axis]).collect::<Vec<_>>());
            queues.join_all(start, &forms, axes.each_ref().map(|axis| &axis[..]));
            places.for_each(|place| left[usize::from(form(place))].push(place));
            for (queue, expected) in (0..).zip(&mut left) {
                assert_eq!(queues.count(queue), expected.len());
                for (index, (&place, expected)) in queues.places(queue).iter().zip(&*expected).enumerate() {
                    assert_eq!(place as usize, *expected, "place {index} of queue {queue}");
                    assert_eq!(queues.at(queue, index), (*expected, coordinates(*expected)));
                    assert_eq!(queues.points(queue).map(|axis| axis[index]), coordinates(*expected));
                }
                let served = expected.len() / PAIR * PAIR;
                queues.remove(queue, served);
                expected.drain(..served);
                seen += served;
            }
        }
        for (queue, expected) in (0..).zip(&left).filter(|(_, expected)| !expected.is_empty()) {
            queues.fill_up(queue);
            let [x, ..] = queues.points(queue);
            assert_eq!(x.len(), PAIR);
            let last = *expected.last().expect("not empty") as f64;
            assert!(x[expected.len()..].iter().all(|x| *x == last));
            seen += expected.len();
        }
        assert_eq!(seen, 8 * STREAMED_POINTS + 37);
    }
}
