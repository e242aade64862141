//! Expectations and what became of them.

use std::fmt;

use glam::DVec3;
use magsplice_decouple::PerParameter;
use magsplice_layout::Expectations;

use crate::baseline::Difference;
use crate::clearance::Clearance;

/// What can be expected, by the keys of the layout file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Expectation {
    /// Uniformity RMSE of one decoupling parameter.
    UniformityRmse(Parameter),
    /// RMSE of the displacement along one axis (0, 1, 2 for x, y, z), in millimetres.
    DisplacementRmse(usize),
    /// Best-fit amplitude against the ideal film.
    Amplitude,
    /// The largest difference from the baseline, as a fraction of |B|.
    Field,
    /// The distance of the tiles from the working volume, in millimetres.
    Clearance,
}

/// A decoupling parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Parameter {
    /// R_x.
    Rx,
    /// R_y.
    Ry,
    /// S_z.
    Sz,
}

impl Parameter {
    /// All of them, in the order of [`Expectations::uniformity_rmse`].
    pub const ALL: [Parameter; 3] = [Parameter::Rx, Parameter::Ry, Parameter::Sz];
}

/// What a value must not pass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Bound {
    /// The value must not be greater.
    AtMost(f64),
    /// The value must not be less.
    AtLeast(f64),
}

/// Where the value was found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Place {
    /// At this point, in millimetres.
    Point(DVec3),
    /// At the tile with this index.
    Tile(usize),
}

/// An expectation held against a computed value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outcome {
    /// What was expected.
    pub expectation: Expectation,
    /// What was found.
    pub value: f64,
    /// What it was held against.
    pub bound: Bound,
    /// Where, for a value that is the worst of many.
    pub place: Option<Place>,
}

impl Outcome {
    /// How far the value is on the right side of its bound; negative on the wrong one.
    pub fn margin(&self) -> f64 {
        match self.bound {
            Bound::AtMost(most) => most - self.value,
            Bound::AtLeast(least) => self.value - least,
        }
    }

    /// Whether the value keeps its bound. One that is not a number does not.
    pub fn is_met(&self) -> bool {
        match self.bound {
            Bound::AtMost(most) => self.value <= most,
            Bound::AtLeast(least) => self.value >= least,
        }
    }
}

impl Expectation {
    /// Everything these expectations speak of, in the order in which it is reported.
    pub fn all_of(expected: &Expectations) -> Vec<Expectation> {
        let uniformity = Parameter::ALL.into_iter().zip(expected.uniformity_rmse);
        let uniformity = uniformity.filter(|(_, bound)| bound.is_some()).map(|(p, _)| Expectation::UniformityRmse(p));
        let displacement = (0..3).filter(|&axis| expected.displacement_rmse_mm[axis].is_some());
        let displacement = displacement.map(Expectation::DisplacementRmse);
        let amplitude = expected.least_amplitude.map(|_| Expectation::Amplitude);
        let field = expected.field.as_ref().map(|_| Expectation::Field);
        let clearance = expected.least_clearance_mm.map(|_| Expectation::Clearance);
        uniformity.chain(displacement).chain(amplitude).chain(field).chain(clearance).collect()
    }
}

/// The uniformity RMSE of `parameter`; `None` if nothing is expected of it.
pub fn uniformity(expected: &Expectations, parameter: Parameter, found: &PerParameter) -> Option<Outcome> {
    let [r_x, r_y, s_z] = expected.uniformity_rmse;
    let (most, value) = match parameter {
        Parameter::Rx => (r_x, found.r_x),
        Parameter::Ry => (r_y, found.r_y),
        Parameter::Sz => (s_z, found.s_z),
    };
    let expectation = Expectation::UniformityRmse(parameter);
    Some(Outcome { expectation, value, bound: Bound::AtMost(most?), place: None })
}

/// The RMSE of the displacement along an axis, in millimetres; `None` if nothing is expected of it.
///
/// # Panics
/// If `axis` is above 2.
pub fn displacement(expected: &Expectations, axis: usize, found_mm: DVec3) -> Option<Outcome> {
    let bound = Bound::AtMost(expected.displacement_rmse_mm[axis]?);
    Some(Outcome { expectation: Expectation::DisplacementRmse(axis), value: found_mm[axis], bound, place: None })
}

/// The best-fit amplitude; `None` if nothing is expected of it.
pub fn amplitude(expected: &Expectations, value: f64) -> Option<Outcome> {
    let bound = Bound::AtLeast(expected.least_amplitude?);
    Some(Outcome { expectation: Expectation::Amplitude, value, bound, place: None })
}

/// The difference from the baseline; `None` if nothing is expected of it.
pub fn field(expected: &Expectations, found: &Difference) -> Option<Outcome> {
    let bound = Bound::AtMost(expected.field.as_ref()?.within);
    let place = (found.relative > 0.0).then_some(Place::Point(found.at));
    Some(Outcome { expectation: Expectation::Field, value: found.relative, bound, place })
}

/// The clearance; `None` if nothing is expected of it.
pub fn clearance(expected: &Expectations, found: &Clearance) -> Option<Outcome> {
    let bound = Bound::AtLeast(expected.least_clearance_mm?);
    let place = Some(Place::Tile(found.tile));
    Some(Outcome { expectation: Expectation::Clearance, value: found.distance, bound, place })
}

impl fmt::Display for Expectation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Expectation::UniformityRmse(Parameter::Rx) => "uniformity_rmse.r_x",
            Expectation::UniformityRmse(Parameter::Ry) => "uniformity_rmse.r_y",
            Expectation::UniformityRmse(Parameter::Sz) => "uniformity_rmse.s_z",
            Expectation::DisplacementRmse(0) => "displacement_rmse_mm.x",
            Expectation::DisplacementRmse(1) => "displacement_rmse_mm.y",
            Expectation::DisplacementRmse(_) => "displacement_rmse_mm.z",
            Expectation::Amplitude => "amplitude",
            Expectation::Field => "field",
            Expectation::Clearance => "clearance_mm",
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_are_inclusive_and_margins_have_a_side() {
        let outcome = |value: f64, bound: Bound| Outcome { expectation: Expectation::Field, value, bound, place: None };
        for (value, bound, met, margin) in [
            (1.0, Bound::AtMost(1.0), true, 0.0),
            (1.0, Bound::AtLeast(1.0), true, 0.0),
            (1.5, Bound::AtMost(1.0), false, -0.5),
            (1.5, Bound::AtLeast(1.0), true, 0.5),
            (0.5, Bound::AtLeast(1.0), false, -0.5),
        ] {
            assert_eq!(
                (outcome(value, bound).is_met(), outcome(value, bound).margin()),
                (met, margin),
                "{value} {bound:?}"
            );
        }
        assert!(!outcome(f64::NAN, Bound::AtMost(1.0)).is_met() && !outcome(f64::NAN, Bound::AtLeast(1.0)).is_met());
    }

    #[test]
    fn each_axis_has_its_own_bound() {
        let expected = Expectations { displacement_rmse_mm: [Some(1.0), None, Some(3.0)], ..Expectations::default() };
        let found = [0, 1, 2].map(|axis| displacement(&expected, axis, DVec3::new(0.5, 20.0, 30.0)));
        assert_eq!(found.map(|o| o.map(|o| (o.value, o.is_met()))), [Some((0.5, true)), None, Some((30.0, false))]);
        let names: Vec<String> = Expectation::all_of(&expected).iter().map(Expectation::to_string).collect();
        assert_eq!(names, ["displacement_rmse_mm.x", "displacement_rmse_mm.z"]);
    }

    #[test]
    fn each_parameter_has_its_own_bound() {
        let expected = Expectations { uniformity_rmse: [Some(1.0), None, Some(3.0)], ..Expectations::default() };
        let found = PerParameter { r_x: 10.0, r_y: 20.0, s_z: 30.0 };
        let [x, y, z] = Parameter::ALL.map(|p| uniformity(&expected, p, &found).map(|o| (o.value, o.bound)));
        assert_eq!([x, y, z], [Some((10.0, Bound::AtMost(1.0))), None, Some((30.0, Bound::AtMost(3.0)))]);
        let all = [Expectation::UniformityRmse(Parameter::Rx), Expectation::UniformityRmse(Parameter::Sz)];
        assert_eq!(Expectation::all_of(&expected), all);
    }
}
