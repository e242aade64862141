//! Expectations of films that are made: bounds that each sample keeps or breaks.

use magsplice_layout::Expectations;
use magsplice_tolerance::{Figure, FilmErrors};

/// Whether a film keeps the bounds of `[expect]` on its uniformity RMSE, its displacement RMSE and its
/// amplitude. `None` if there are no such bounds.
pub fn keeps_bounds(expected: &Expectations, errors: &FilmErrors) -> Option<bool> {
    let at_most = (0..3).flat_map(|axis| {
        [
            (Figure::Uniformity(axis), expected.uniformity_rmse[axis]),
            (Figure::Displacement(axis), expected.displacement_rmse_mm[axis]),
        ]
    });
    let kept = at_most.filter_map(|(figure, bound)| Some(errors.get(figure) <= bound?));
    let strong = expected.least_amplitude.map(|least| errors.amplitude >= least);
    kept.chain(strong).reduce(|all, one| all && one)
}

#[cfg(test)]
mod tests {
    use magsplice_decouple::PerParameter;

    use super::*;

    #[test]
    fn a_film_keeps_all_bounds_or_breaks_them() {
        let errors = FilmErrors {
            uniformity_rmse: PerParameter { r_x: 0.1, r_y: 0.2, s_z: 0.3 },
            displacement_rmse_mm: [0.01, 0.02, 0.03],
            amplitude: 0.8,
        };
        assert_eq!(keeps_bounds(&Expectations::default(), &errors), None);
        let loose = Expectations {
            uniformity_rmse: [Some(0.1), None, Some(0.3)],
            displacement_rmse_mm: [None, Some(0.02), None],
            least_amplitude: Some(0.8),
            ..Expectations::default()
        };
        assert_eq!(keeps_bounds(&loose, &errors), Some(true));
        for broken in [
            Expectations { uniformity_rmse: [None, None, Some(0.29)], ..loose.clone() },
            Expectations { displacement_rmse_mm: [Some(0.009), None, None], ..loose.clone() },
            Expectations { least_amplitude: Some(0.81), ..loose.clone() },
        ] {
            assert_eq!(keeps_bounds(&broken, &errors), Some(false));
        }
    }
}
