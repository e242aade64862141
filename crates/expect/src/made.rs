//! Expectations of films as made: bounds that each sample keeps or breaks.

use magsplice_decouple::{Figure, Figures};
use magsplice_layout::{FigureBounds, MadeExpectations};
use magsplice_tolerance::probability_of_at_least;

use crate::outcome::{Bound, Expectation, Location, Outcome};

/// Whether a film keeps the bounds of its figures. An undefined uniformity keeps no bound. `None`
/// without bounds.
pub fn keeps_bounds(bounds: &FigureBounds, figures: &Figures) -> Option<bool> {
    let is_kept = |(figure, value): (Figure, Option<&f64>)| {
        let bound = Bound::of(bounds, figure)?;
        Some(value.is_some_and(|value| bound.is_kept_by(*value)))
    };
    figures.iter().filter_map(is_kept).reduce(|all, one| all && one)
}

impl Outcome {
    /// The outcome for a figure of films as made, from the figures of samples. `None` if the layout
    /// does not bound the figure, or too few samples have it to break any bound with the confidence
    /// of the layout.
    ///
    /// The value is a confidence limit of the percentile by the exact binomial distribution: the
    /// percentile is beyond this value with the confidence of the layout, so a film at its bound
    /// fails by chance only with a probability of 1 minus the confidence. The location has the
    /// percentile.
    ///
    /// # Panics
    /// Without samples.
    pub fn from_made(expected: &MadeExpectations, figure: Figure, errors: &[Figures]) -> Option<Outcome> {
        let bound = Bound::of(&expected.bounds, figure)?;
        // Films beyond the percentile come first.
        let mut sorted: Vec<f64> = errors.iter().filter_map(|errors| errors.get(figure).copied()).collect();
        match bound {
            Bound::AtMost(_) => sorted.sort_by(|a, b| b.total_cmp(a)),
            Bound::AtLeast(_) => sorted.sort_by(f64::total_cmp),
        }
        let (count, beyond) = (sorted.len(), 1.0 - expected.percentile / 100.0);
        let excluded = |found: usize| probability_of_at_least(found, count, beyond) < 1.0 - expected.confidence;
        // The probability falls with the number.
        let fewest = 1 + (1..=count).collect::<Vec<_>>().partition_point(|found| !excluded(*found));
        let value = *sorted.get(fewest - 1)?;
        let place = beyond * (count - 1) as f64;
        let (before, after) = (sorted[place as usize], sorted[(place as usize + 1).min(count - 1)]);
        let percentile = Location::Percentile {
            per_cent: match bound {
                Bound::AtMost(_) => expected.percentile,
                Bound::AtLeast(_) => 100.0 - expected.percentile,
            },
            value: before + (place - place.floor()) * (after - before),
            samples: count,
        };
        Some(Outcome { expectation: Expectation::Made(figure), value, bound, location: Some(percentile) })
    }
}

#[cfg(test)]
mod tests {
    use magsplice_decouple::{Parameter, PerAxis, PerParameter};
    use magsplice_magnet::Axis;

    use super::*;

    #[test]
    fn a_film_keeps_all_bounds_or_breaks_them() {
        let errors = Figures {
            uniformity_rmse: PerParameter { r_x: Some(0.1), r_y: None, s_z: Some(0.3) },
            displacement_rmse_mm: PerAxis { x: 0.01, y: 0.02, z: 0.03 },
            amplitude: 0.8,
        };
        assert_eq!(keeps_bounds(&FigureBounds::default(), &errors), None);
        let loose = FigureBounds {
            uniformity_rmse: [Some(0.1), None, Some(0.3)].into(),
            displacement_rmse_mm: [None, Some(0.02), None].into(),
            least_amplitude: Some(0.8),
        };
        assert_eq!(keeps_bounds(&loose, &errors), Some(true));
        for broken in [
            FigureBounds { uniformity_rmse: [None, None, Some(0.29)].into(), ..loose },
            FigureBounds { uniformity_rmse: [None, Some(1.0), None].into(), ..loose },
            FigureBounds { displacement_rmse_mm: [Some(0.009), None, None].into(), ..loose },
            FigureBounds { least_amplitude: Some(0.81), ..loose },
        ] {
            assert_eq!(keeps_bounds(&broken, &errors), Some(false));
        }
    }

    fn with_displacement(x: f64) -> Figures {
        Figures { displacement_rmse_mm: PerAxis { x, y: 0.0, z: 0.0 }, amplitude: x, ..Figures::default() }
    }

    /// On average 5 of 100 films are beyond the 95th percentile. 10 or more are beyond it with a
    /// probability of 0.028, 9 or more with 0.063. The tenth largest value is therefore the limit.
    #[test]
    fn a_bound_fails_only_if_samples_exclude_it() {
        let errors: Vec<Figures> = (1..=100).map(|n| with_displacement(f64::from(n))).collect();
        let at = |bound: f64| MadeExpectations {
            bounds: FigureBounds {
                displacement_rmse_mm: [Some(bound), None, None].into(),
                least_amplitude: Some(bound),
                ..FigureBounds::default()
            },
            ..MadeExpectations::default()
        };
        let outcome = |bound, figure| Outcome::from_made(&at(bound), figure, &errors).expect("bounded");
        let most = outcome(91.0, Figure::Displacement(Axis::X));
        assert_eq!((most.value, most.bound, most.is_met()), (91.0, Bound::AtMost(91.0), true));
        assert!(!outcome(90.9, Figure::Displacement(Axis::X)).is_met());
        let Some(Location::Percentile { per_cent, value, samples }) = most.location else { panic!("{most:?}") };
        assert!((value - 95.05).abs() < 1e-9 && (per_cent, samples) == (95.0, 100), "{most:?}");
        let least = outcome(10.0, Figure::Amplitude);
        assert_eq!((least.value, least.is_met()), (10.0, true));
        assert!(!outcome(10.1, Figure::Amplitude).is_met());
        assert_eq!(Outcome::from_made(&at(1.0), Figure::Uniformity(Parameter::Rx), &errors), None);
        // Two films cannot exclude a percentile of 50 with a confidence of 95 %.
        let half = MadeExpectations { percentile: 50.0, ..at(0.5) };
        assert_eq!(Outcome::from_made(&half, Figure::Displacement(Axis::X), &errors[..2]), None);
    }
}
