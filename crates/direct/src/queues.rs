//! Queues of points until whole vectors of them share a method.

use magsplice_cuboid::closed_form::near_edge::NEAR_FORMS;
use magsplice_cuboid::method::{FIRST_FAR, MethodIndex};
use magsplice_cuboid::tolerances::MULTIPOLE_ORDERS;
use magsplice_simd::lanes::{LONGEST_VECTOR, PAIR};

pub use crate::tolerances::STREAMED_POINTS;

/// Number of methods of a single tile.
pub const METHODS: usize = FIRST_FAR as usize + MULTIPOLE_ORDERS.len();
/// Index of the first queue for further methods, defined by the caller.
pub const OWN_QUEUE: MethodIndex = METHODS as MethodIndex;
const QUEUES: usize = METHODS + NEAR_FORMS;

/// Capacity of a queue: the points remaining after an evaluation, one block of points, and padding.
/// One more cache line keeps the queues from starting at addresses that exclude each other in the
/// cache.
const LENGTH: usize = STREAMED_POINTS + 2 * PAIR + LONGEST_VECTOR;
const ROOM: usize = QUEUES * LENGTH;
const _: () = assert!(LENGTH.is_multiple_of(LONGEST_VECTOR));

/// Bits per method in the number that counts a few points of each method. The counts stay in a
/// register, so no point waits for memory.
const DIGITS: usize = 8;
/// Number of points whose counts fit in these bits.
const COUNTED_POINTS: usize = 1 << (DIGITS - 1);
const _: () = assert!(METHODS * DIGITS <= u64::BITS as usize);

/// The queues of all methods, one after the other.
#[derive(Debug)]
pub struct Queues {
    /// Positions in the list of all points.
    places: Box<[u32; ROOM]>,
    axes: Box<Axes>,
    counts: [usize; QUEUES],
    /// Bit position of the count of each point's method.
    shifts: [u8; STREAMED_POINTS],
}

/// Coordinates; each queue starts at a cache line.
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
    /// Empties all queues.
    pub fn clear(&mut self) {
        self.counts = [0; QUEUES];
    }

    /// The number of points in a queue.
    pub fn count(&self, queue: MethodIndex) -> usize {
        self.counts[usize::from(queue)]
    }

    /// Appends points with these methods to their queues; at most [`STREAMED_POINTS`]. Points are
    /// given by axis. The first has the index `place` in the list.
    #[inline(always)]
    pub fn join_all(&mut self, mut place: usize, methods: &[f64], axes: [&[f64]; 3]) {
        /// Adding this number moves an integer into the low bits.
        const LAST_DIGITS: f64 = 4_503_599_627_370_496.0;
        for (shift, method) in self.shifts.iter_mut().zip(methods) {
            *shift = (method * DIGITS as f64 + LAST_DIGITS).to_bits() as u8;
        }
        let Queues { places, axes: queued, counts, shifts } = self;
        let (places, [x_queued, y_queued, z_queued]) = (&mut **places, &mut queued.0);
        let [x, y, z] = axes.map(|axis| axis.chunks(COUNTED_POINTS));
        for (((shifts, x), y), z) in shifts[..methods.len()].chunks(COUNTED_POINTS).zip(x).zip(y).zip(z) {
            let mut ends = [0; u64::BITS as usize];
            for (method, count) in counts[..METHODS].iter().enumerate() {
                ends[method * DIGITS] = method * LENGTH + count;
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
            for (method, count) in counts[..METHODS].iter_mut().enumerate() {
                *count += usize::from((counted >> (method * DIGITS)) as u8);
            }
        }
    }

    /// Adds one point to a queue.
    pub fn join(&mut self, queue: MethodIndex, place: usize, coordinates: [f64; 3]) {
        let queue = usize::from(queue);
        let slot = queue * LENGTH + self.counts[queue];
        self.places[slot] = place as u32;
        for (axis, coordinate) in self.axes.0.iter_mut().zip(coordinates) {
            axis[slot] = coordinate;
        }
        self.counts[queue] += 1;
    }

    /// Position in the list and coordinates of a waiting point.
    pub fn at(&self, queue: MethodIndex, index: usize) -> (usize, [f64; 3]) {
        let slot = usize::from(queue) * LENGTH + index;
        (self.places[slot] as usize, self.axes.0.each_ref().map(|axis| axis[slot]))
    }

    /// Coordinates of all waiting points by axis, padded to whole pairs of vectors.
    #[inline(always)]
    pub fn points(&self, queue: MethodIndex) -> [&[f64]; 3] {
        let (start, count) = (usize::from(queue) * LENGTH, self.count(queue).next_multiple_of(PAIR));
        self.axes.0.each_ref().map(|axis| &axis[start..start + count])
    }

    /// Positions in the list.
    #[inline(always)]
    pub fn places(&self, queue: MethodIndex) -> &[u32] {
        let start = usize::from(queue) * LENGTH;
        &self.places[start..start + self.count(queue)]
    }

    /// Repeats the last point up to whole pairs of vectors.
    pub fn fill_up(&mut self, queue: MethodIndex) {
        let (start, count) = (usize::from(queue) * LENGTH, self.count(queue));
        for axis in &mut self.axes.0 {
            let last = axis[start + count - 1];
            axis[start + count..start + count.next_multiple_of(PAIR)].fill(last);
        }
    }

    /// Removes the first `count` points. Fewer than a [`PAIR`] may remain.
    #[inline(always)]
    pub fn remove(&mut self, queue: MethodIndex, count: usize) {
        let start = usize::from(queue) * LENGTH;
        // Moving a fixed number of points needs no call.
        let rest = start + count..start + count + PAIR;
        self.places.copy_within(rest.clone(), start);
        self.axes.0.iter_mut().for_each(|axis| axis.copy_within(rest.clone(), start));
        self.counts[usize::from(queue)] -= count;
    }

    /// Empties a queue.
    pub fn empty(&mut self, queue: MethodIndex) {
        self.counts[usize::from(queue)] = 0;
    }
}
