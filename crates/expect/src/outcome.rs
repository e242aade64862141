//! Expectations, and their outcomes: computed values compared with bounds.

use std::fmt;

use glam::DVec3;
use magsplice_decouple::Figure;
use magsplice_layout::{Expectations, FigureBounds};

use crate::baseline::BaselineDifference;
use crate::clearance::Clearance;

/// A quantity that a layout can bound, named by its key in the file; see [`fmt::Display`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Expectation {
    /// A figure of the film.
    Figure(Figure),
    /// The largest difference from the baseline, as a fraction of |B|.
    Field,
    /// The distance of the tiles from the working volume, in millimetres.
    Clearance,
    /// A figure of films as made, at a percentile.
    Made(Figure),
}

/// A bound of a value. A value equal to the bound keeps it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize), serde(rename_all = "snake_case"))]
pub enum Bound {
    /// The value must not be greater.
    AtMost(f64),
    /// The value must not be less.
    AtLeast(f64),
}

/// The location of a worst value.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize), serde(rename_all = "snake_case"))]
#[non_exhaustive]
pub enum Location {
    /// At this point, in millimetres.
    #[cfg_attr(feature = "serde", serde(rename = "at_mm"))]
    Point(DVec3),
    /// At the tile with this index.
    Tile(usize),
    /// The percentile of samples of films as made. The value of the outcome is a limit of it; see
    /// [`Outcome::from_made`].
    Percentile {
        /// The percentile.
        per_cent: f64,
        /// The estimated value.
        value: f64,
        /// Number of samples.
        samples: usize,
    },
}

/// An expectation with the computed value and its bound.
///
/// It is serialized as `expectation`, `value`, `at_most` or `at_least`, `margin`, and `at_mm` or
/// `tile` if there is a location.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outcome {
    /// The quantity.
    pub expectation: Expectation,
    /// The computed value, in the unit of the expectation.
    pub value: f64,
    /// The bound of the layout, in the same unit.
    pub bound: Bound,
    /// The location of the value, if it is the worst of many.
    pub location: Option<Location>,
}

impl Outcome {
    /// The outcome for a figure of the film. `None` if the layout does not bound it.
    pub fn from_figure(expected: &FigureBounds, figure: Figure, value: f64) -> Option<Outcome> {
        let bound = Bound::of(expected, figure)?;
        Some(Outcome { expectation: Expectation::Figure(figure), value, bound, location: None })
    }

    /// The outcome for the difference of the field from the baseline. `None` if the layout has no
    /// baseline.
    pub fn from_field(expected: &Expectations, found: &BaselineDifference) -> Option<Outcome> {
        let bound = Bound::AtMost(expected.field.as_ref()?.within);
        let location = (found.relative > 0.0).then_some(Location::Point(found.at));
        Some(Outcome { expectation: Expectation::Field, value: found.relative, bound, location })
    }

    /// The outcome for the clearance. `None` if the layout does not bound it.
    pub fn from_clearance(expected: &Expectations, found: &Clearance) -> Option<Outcome> {
        let bound = Bound::AtLeast(expected.least_clearance_mm?);
        let location = Some(Location::Tile(found.tile));
        Some(Outcome { expectation: Expectation::Clearance, value: found.distance, bound, location })
    }

    /// The distance of the value from its bound. Negative if the value breaks the bound.
    pub fn margin(&self) -> f64 {
        match self.bound {
            Bound::AtMost(most) => most - self.value,
            Bound::AtLeast(least) => self.value - least,
        }
    }

    /// Whether the value keeps its bound. NaN does not.
    pub fn is_met(&self) -> bool {
        self.bound.is_kept_by(self.value)
    }
}

impl Bound {
    /// The bound of a figure, if any.
    pub(crate) fn of(bounds: &FigureBounds, figure: Figure) -> Option<Bound> {
        let bound = bounds.get(figure)?;
        Some(if figure == Figure::Amplitude { Bound::AtLeast(bound) } else { Bound::AtMost(bound) })
    }

    pub(crate) fn is_kept_by(self, value: f64) -> bool {
        match self {
            Bound::AtMost(most) => value <= most,
            Bound::AtLeast(least) => value >= least,
        }
    }
}

impl Expectation {
    /// All quantities bounded by these expectations, in the order of reports.
    pub fn stated_in(expected: &Expectations) -> Vec<Expectation> {
        let bounded =
            |bounds: FigureBounds| Figure::ALL.into_iter().filter(move |figure| bounds.get(*figure).is_some());
        let field = expected.field.as_ref().map(|_| Expectation::Field);
        let clearance = expected.least_clearance_mm.map(|_| Expectation::Clearance);
        let made = expected.made.iter().flat_map(|made| bounded(made.bounds)).map(Expectation::Made);
        bounded(expected.bounds).map(Expectation::Figure).chain(field).chain(clearance).chain(made).collect()
    }
}

impl fmt::Display for Expectation {
    /// Writes the key, such as `uniformity_rmse.r_x`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Expectation::Figure(figure) => f.write_str(figure.key()),
            Expectation::Field => f.write_str("field"),
            Expectation::Clearance => f.write_str("clearance_mm"),
            Expectation::Made(figure) => write!(f, "made.{}", figure.key()),
        }
    }
}

/// An expectation is serialized as its key.
#[cfg(feature = "serde")]
impl serde::Serialize for Expectation {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

#[cfg(feature = "serde")]
impl serde::Serialize for Outcome {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        #[derive(serde::Serialize)]
        struct WithMargin {
            expectation: Expectation,
            value: f64,
            #[serde(flatten)]
            bound: Bound,
            margin: f64,
            #[serde(flatten)]
            location: Option<Location>,
        }
        let Outcome { expectation, value, bound, location } = *self;
        WithMargin { expectation, value, bound, margin: self.margin(), location }.serialize(serializer)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use magsplice_decouple::{Parameter, PerAxis, PerParameter};
    use magsplice_layout::ExpectedField;
    use magsplice_magnet::Axis;

    #[test]
    fn bounds_are_inclusive_and_broken_ones_have_negative_margins() {
        let outcome =
            |value: f64, bound: Bound| Outcome { expectation: Expectation::Field, value, bound, location: None };
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
    fn each_figure_has_its_own_bound() {
        let bounds = FigureBounds {
            uniformity_rmse: PerParameter { r_x: Some(1.0), r_y: None, s_z: Some(3.0) },
            displacement_rmse_mm: PerAxis { x: Some(1.0), y: None, z: Some(3.0) },
            least_amplitude: None,
        };
        for (figure, value, wanted) in [
            (Figure::Uniformity(Parameter::Rx), 10.0, Some((Bound::AtMost(1.0), false))),
            (Figure::Uniformity(Parameter::Ry), 20.0, None),
            (Figure::Uniformity(Parameter::Sz), 30.0, Some((Bound::AtMost(3.0), false))),
            (Figure::Displacement(Axis::X), 0.5, Some((Bound::AtMost(1.0), true))),
            (Figure::Displacement(Axis::Y), 20.0, None),
            (Figure::Displacement(Axis::Z), 30.0, Some((Bound::AtMost(3.0), false))),
            (Figure::Amplitude, 1.0, None),
        ] {
            let outcome = Outcome::from_figure(&bounds, figure, value);
            assert!(outcome.is_none_or(|of| (of.expectation, of.value) == (Expectation::Figure(figure), value)));
            assert_eq!(outcome.map(|of| (of.bound, of.is_met())), wanted, "{figure:?}");
        }
        let stated = Expectation::stated_in(&Expectations { bounds, ..Expectations::default() });
        let names: Vec<String> = stated.iter().map(Expectation::to_string).collect();
        let wanted = ["uniformity_rmse.r_x", "uniformity_rmse.s_z", "displacement_rmse_mm.x", "displacement_rmse_mm.z"];
        assert_eq!(names, wanted);
    }

    #[test]
    fn amplitude_field_and_clearance_have_their_bounds_and_locations() {
        let none = Expectations::default();
        let field = Some(ExpectedField { file: "field.csv".into(), within: 1e-3 });
        let stated = Expectations {
            bounds: FigureBounds { least_amplitude: Some(0.9), ..FigureBounds::default() },
            field,
            least_clearance_mm: Some(2.0),
            ..Expectations::default()
        };
        let at = DVec3::new(1.0, 2.0, -3.0);
        let difference = |relative: f64| BaselineDifference { relative, at };
        let clearance = Clearance { distance: 3.0, tile: 7 };
        let found = |expected: &Expectations| {
            [
                Outcome::from_figure(&expected.bounds, Figure::Amplitude, 0.8),
                Outcome::from_field(expected, &difference(0.0)),
                Outcome::from_field(expected, &difference(1e-2)),
                Outcome::from_clearance(expected, &clearance),
            ]
        };
        assert_eq!(found(&none), [None; 4]);
        let (within, point) = (Bound::AtMost(1e-3), Some(Location::Point(at)));
        assert_eq!(
            found(&stated).map(|outcome| outcome.map(|o| (o.expectation.to_string(), o.value, o.bound, o.location))),
            [
                Some(("amplitude".to_owned(), 0.8, Bound::AtLeast(0.9), None)),
                // A field without a difference has no worst point.
                Some(("field".to_owned(), 0.0, within, None)),
                Some(("field".to_owned(), 1e-2, within, point)),
                Some(("clearance_mm".to_owned(), 3.0, Bound::AtLeast(2.0), Some(Location::Tile(7)))),
            ]
        );
    }

    #[cfg(feature = "serde")]
    #[test]
    fn outcome_is_serialized_with_its_bound_margin_and_location() {
        let json = |outcome: &Outcome| serde_json::to_string(outcome).unwrap();
        let expectation = Expectation::Figure(Figure::Uniformity(Parameter::Rx));
        let outcome = Outcome { expectation, value: 0.25, bound: Bound::AtMost(1.0), location: None };
        assert_eq!(json(&outcome), r#"{"expectation":"uniformity_rmse.r_x","value":0.25,"at_most":1.0,"margin":0.75}"#);
        let (expectation, bound) = (Expectation::Clearance, Bound::AtLeast(2.0));
        let tile = Outcome { expectation, value: 3.0, bound, location: Some(Location::Tile(7)) };
        let written = r#"{"expectation":"clearance_mm","value":3.0,"at_least":2.0,"margin":1.0,"tile":7}"#;
        assert_eq!(json(&tile), written);
        let point = Outcome { location: Some(Location::Point(DVec3::new(1.0, 2.0, -3.0))), ..tile };
        assert_eq!(json(&point), written.replace(r#""tile":7"#, r#""at_mm":[1.0,2.0,-3.0]"#));
    }
}
