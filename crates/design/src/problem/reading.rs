//! The reading below a film: the field at a point, or the weighted sum of the sensors of a head.

use glam::{DVec3, Vec3Swizzles};
use magsplice_head::{HeadElement, SensorHead};

use crate::problem::symmetry::SymmetryOperation;

/// Places on a board and weights that differ by less than this fraction of the largest are equal.
/// Places have few decimals, and weights are computed with a round-off of 1e-15.
const SAME_SENSOR: f64 = 1e-9;

/// A sensor of a board, whose reading counts with a weight for each axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct WeightedSensor {
    pub(crate) place: DVec3,
    pub(crate) weight: DVec3,
}

impl WeightedSensor {
    /// A single sensor.
    const SINGLE: WeightedSensor = WeightedSensor { place: DVec3::ZERO, weight: DVec3::ONE };

    fn apply(self, operation: SymmetryOperation) -> WeightedSensor {
        let weight = if operation.exchange { self.weight.yxz() } else { self.weight };
        WeightedSensor { place: operation.apply(self.place), weight }
    }
}

/// The sensors that are read as one weighted sum.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Reading {
    sensors: Vec<WeightedSensor>,
}

impl Reading {
    /// The reading of a head; of a single sensor without one.
    pub(crate) fn new(head: Option<&SensorHead>) -> Reading {
        let Some(head) = head else { return Reading { sensors: vec![WeightedSensor::SINGLE] } };
        let sensor = |of: &HeadElement| WeightedSensor { place: of.place, weight: of.weight };
        Reading { sensors: head.elements.iter().map(sensor).collect() }
    }

    /// Whether the reading is the field at the point itself.
    pub(crate) fn is_single(&self) -> bool {
        self.sensors == [WeightedSensor::SINGLE]
    }

    pub(crate) fn sensors(&self) -> &[WeightedSensor] {
        &self.sensors
    }

    /// The reading of one of the sensors alone, times its weight.
    pub(crate) fn alone(&self, sensor: usize) -> Reading {
        Reading { sensors: vec![self.sensors[sensor]] }
    }

    /// The reading as a tile sees it whose image is below the board.
    pub(crate) fn seen_by(&self, operation: SymmetryOperation) -> Reading {
        Reading { sensors: self.sensors.iter().map(|sensor| sensor.apply(operation.inverse())).collect() }
    }

    /// The sensor that an operation maps a sensor to; `None` if it maps it to no other one.
    pub(crate) fn image(&self, sensor: usize, operation: SymmetryOperation) -> Option<usize> {
        let extent = |of: &dyn Fn(&WeightedSensor) -> DVec3| {
            self.sensors.iter().map(|sensor| of(sensor).abs().max_element()).fold(0.0, f64::max)
        };
        let [place, weight] = [extent(&|sensor| sensor.place), extent(&|sensor| sensor.weight)];
        let mapped = self.sensors[sensor].apply(operation);
        self.sensors.iter().position(|other| {
            other.place.distance(mapped.place) <= SAME_SENSOR * place
                && other.weight.distance(mapped.weight) <= SAME_SENSOR * weight
        })
    }

    /// Whether an operation maps the board onto itself.
    pub(crate) fn is_kept_by(&self, operation: SymmetryOperation) -> bool {
        (0..self.sensors.len()).all(|sensor| self.image(sensor, operation).is_some())
    }

    /// The reading of a board whose mirror image in its own plane is this one.
    pub(crate) fn upside_down(&self) -> Reading {
        let place = |of: DVec3| DVec3::new(of.x, of.y, -of.z);
        let turned = |of: &WeightedSensor| WeightedSensor { place: place(of.place), weight: of.weight };
        Reading { sensors: self.sensors.iter().map(turned).collect() }
    }

    /// The places of the sensors at each point, sensor fastest.
    pub(crate) fn places(&self, points: &[DVec3]) -> Vec<DVec3> {
        points.iter().flat_map(|point| self.sensors.iter().map(|sensor| *point + sensor.place)).collect()
    }

    /// The weighted sum of one value of each sensor.
    pub(crate) fn sum(&self, values: impl IntoIterator<Item = DVec3>) -> DVec3 {
        self.sensors.iter().zip(values).map(|(sensor, value)| sensor.weight * value).sum()
    }

    /// The reading of a uniform field of 1 along each axis.
    pub(crate) fn uniform(&self) -> DVec3 {
        self.sensors.iter().map(|sensor| sensor.weight).sum()
    }

    /// The mean square along each axis of the sum of independent errors, each with a mean square of
    /// 1.
    pub(crate) fn mean_squares(&self) -> DVec3 {
        self.sensors.iter().map(|sensor| sensor.weight * sensor.weight).sum()
    }
}

#[cfg(test)]
mod tests {
    use magsplice_head::Board;
    use magsplice_layout::Symmetry;

    use super::*;

    fn reading(places: &[DVec3], weights: &[DVec3]) -> Reading {
        let sensor = |(place, weight): (&DVec3, &DVec3)| WeightedSensor { place: *place, weight: *weight };
        Reading { sensors: places.iter().zip(weights).map(sensor).collect() }
    }

    /// A pair above each other is kept by all symmetries, and so are the corners of a square. A
    /// pair aside is kept by the exchange of x and y alone, unless its weights differ along x and
    /// y.
    #[test]
    fn boards_are_kept_by_their_symmetries() {
        let kept = |reading: &Reading| {
            let all = SymmetryOperation::all(Symmetry::FourFold).into_iter();
            all.filter(|operation| reading.is_kept_by(*operation)).count()
        };
        let of = |board: Board, weight: DVec3| {
            let places = board.places(5.0);
            reading(&places, &vec![weight; places.len()])
        };
        let (equal, other) = (DVec3::splat(0.5), DVec3::new(0.5, 0.4, 0.5));
        assert_eq!([Board::PairZ, Board::Cross, Board::PairXy].map(|board| kept(&of(board, equal))), [8, 8, 2]);
        assert_eq!([Board::PairZ, Board::Cross, Board::PairXy].map(|board| kept(&of(board, other))), [4, 4, 1]);
        assert!(Reading::new(None).is_single() && kept(&Reading::new(None)) == 8);
    }

    /// The image of the reading that a tile sees is the reading of the image of its field.
    #[test]
    fn a_tile_sees_the_board_turned_back() {
        let places = [DVec3::new(0.3, -1.0, 0.2), DVec3::new(2.0, 0.5, -1.0)];
        let weights = [DVec3::new(1.0, -2.0, 3.0), DVec3::new(-0.5, 0.25, 4.0)];
        let board = reading(&places, &weights);
        let field = |at: DVec3| DVec3::new(at.x * at.y + 1.0, at.y - at.z, at.x * at.x + at.z);
        let read = |reading: &Reading, at: DVec3, field: &dyn Fn(DVec3) -> DVec3| {
            reading.sum(reading.places(&[at]).into_iter().map(field))
        };
        let at = DVec3::new(0.7, -0.4, -3.0);
        for operation in SymmetryOperation::all(Symmetry::FourFold) {
            let of_image = |place: DVec3| operation.apply(field(operation.inverse().apply(place)));
            let seen = read(&board.seen_by(operation), operation.inverse().apply(at), &field);
            assert!(operation.apply(seen).distance(read(&board, at, &of_image)) < 1e-12, "{operation:?}");
        }
    }

    #[test]
    fn sums_have_the_weights_of_the_sensors() {
        let board = reading(&[DVec3::ZERO, DVec3::X], &[DVec3::new(1.0, 2.0, 3.0), DVec3::new(-1.0, -1.0, 2.0)]);
        assert_eq!(board.sum([DVec3::ONE, DVec3::splat(2.0)]), DVec3::new(-1.0, 0.0, 7.0));
        assert_eq!(board.uniform(), DVec3::new(0.0, 1.0, 5.0));
        assert_eq!(board.mean_squares(), DVec3::new(2.0, 5.0, 13.0));
        assert_eq!(board.alone(1).sum([DVec3::ONE]), DVec3::new(-1.0, -1.0, 2.0));
        assert_eq!(board.places(&[DVec3::Z, DVec3::Y])[3], DVec3::new(1.0, 1.0, 0.0));
    }
}
