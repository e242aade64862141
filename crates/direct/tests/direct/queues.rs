//! Queues of points that share a method.

use magsplice_cuboid::method::MethodIndex;
use magsplice_direct::queues::{METHODS, Queues, STREAMED_POINTS};
use magsplice_simd::lanes::PAIR;

/// Coordinates that identify their point.
fn coordinates(place: usize) -> [f64; 3] {
    [place as f64, 0.5 + place as f64, -(place as f64)]
}

/// A method for each point: runs as long as a block, and methods that change with each point.
fn method(place: usize) -> MethodIndex {
    let (stretch, within) = (place / STREAMED_POINTS, place % STREAMED_POINTS);
    match stretch % 3 {
        0 => (stretch % METHODS) as MethodIndex,
        1 => (within % METHODS) as MethodIndex,
        _ => (within * within % METHODS) as MethodIndex,
    }
}

#[test]
fn queue_is_fifo_and_removal_frees_space() {
    let mut queues = Queues::default();
    let mut left = vec![Vec::new(); METHODS];
    let mut seen = 0;
    // The last block is shorter.
    for start in (0..8 * STREAMED_POINTS + 37).step_by(STREAMED_POINTS) {
        let places = start..(start + STREAMED_POINTS).min(8 * STREAMED_POINTS + 37);
        let methods: Vec<f64> = places.clone().map(|place| f64::from(method(place))).collect();
        let axes = [0, 1, 2].map(|axis| places.clone().map(|place| coordinates(place)[axis]).collect::<Vec<_>>());
        queues.join_all(start, &methods, axes.each_ref().map(|axis| &axis[..]));
        places.for_each(|place| left[usize::from(method(place))].push(place));
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
