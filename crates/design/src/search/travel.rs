//! The displacement error of a film, compared with the travel of its sensor.

use magsplice_decouple::{Figure, Parameter};
use magsplice_layout::Goal;

use crate::problem::design_problem::DesignProblem;
use crate::search::metrics::Metrics;
use crate::search::shortfall::Shortfall;
use crate::tolerances::LARGEST_SHARE_OF_TRAVEL;

impl DesignProblem<'_> {
    /// The axes along which the film is useless for its goal, by the larger of its errors over two
    /// grids.
    ///
    /// With `goal = "uniformity"`, the error is the uniformity RMSE divided by the wavenumber: the
    /// displacement error that remains after calibration of each parameter. Axes of weight 0, and
    /// axes without travel, are not counted.
    pub(crate) fn useless_axes(&self, metrics: &[Metrics; 2]) -> Vec<Shortfall> {
        let travel = self.volume.upper_mm - self.volume.lower_mm;
        let of_parameter = |parameter: Parameter| {
            let axis = parameter.axis();
            let (figure, to_mm) = match self.brief.goal {
                Goal::Uniformity => (Figure::Uniformity(parameter), 1.0 / self.ideal.wavenumber()),
                Goal::Displacement | Goal::Field => (Figure::Displacement(axis), 1.0),
            };
            let errors = metrics.iter().filter_map(|metrics| metrics.figures.get(figure));
            let error_mm = to_mm * errors.fold(0.0, |most: f64, error| most.max(*error));
            let travel_mm = travel[axis.index()];
            let counts = self.brief.weights[axis.index()] > 0.0 && travel_mm > 0.0;
            (counts && !(error_mm <= LARGEST_SHARE_OF_TRAVEL * travel_mm)).then_some(Shortfall::Travel {
                figure,
                axis,
                error_mm,
                travel_mm,
            })
        };
        Parameter::ALL.into_iter().filter_map(of_parameter).collect()
    }
}

#[cfg(test)]
mod tests {
    use magsplice_decouple::Figures;
    use magsplice_layout::Layout;

    use super::*;

    /// A tenth of the travel, 4, 3 and 2 mm, by the larger error of two grids.
    #[test]
    fn axes_with_errors_above_a_tenth_of_the_travel_are_useless() {
        let useless = |goal: &str, weights: [f64; 3], errors: [[f64; 3]; 2]| -> Vec<(usize, f64, f64)> {
            let [x, y, z] = weights;
            let text = format!(
                "format = 1\nname = \"film\"\n[ideal]\nwavelength_mm = 10.0\nthickness_mm = 1.0\namplitude_t = 0.12\n\
                 [volume]\nx_mm = [-2.0, 2.0]\ny_mm = [-1.0, 2.0]\nz_mm = [-5.0, -3.0]\nstep_mm = 1.0\n\
                 [design]\nvary = [\"size\"]\ngoal = \"{goal}\"\nweights = {{ r_x = {x}, r_y = {y}, s_z = {z} }}\n\
                 [[tile]]\nposition_mm = [0, 0, 0.5]\nsize_mm = [3, 2, 1]\npolarization_t = [0.1, 0, 0]\n"
            );
            let layout = Layout::parse(&text, "film").unwrap_or_else(|e| panic!("{e}"));
            let problem = DesignProblem::new(&layout).unwrap_or_else(|e| panic!("{e}"));
            let k = std::f64::consts::TAU / 10.0;
            let metrics = errors.map(|errors_mm| Metrics {
                points: 9,
                figures: Figures {
                    uniformity_rmse: errors_mm.map(|error_mm| Some(k * error_mm)).into(),
                    displacement_rmse_mm: errors_mm
                        .map(|error_mm| if goal == "uniformity" { 9.0 } else { error_mm })
                        .into(),
                    amplitude: 0.5,
                },
                ideal_rmse: [7.0; 3].into(),
                scaled_relative_rmse: None,
            });
            let of_axis = |short| match short {
                Shortfall::Travel { axis, error_mm, travel_mm, .. } => (axis.index(), error_mm, travel_mm),
                other => panic!("{other}"),
            };
            problem.useless_axes(&metrics).into_iter().map(of_axis).collect()
        };
        let (good, bad) = ([0.39, 0.29, 0.19], [0.41, 0.31, 0.21]);
        for goal in ["displacement", "field", "uniformity"] {
            assert_eq!(useless(goal, [1.0; 3], [good, good]), []);
            for errors in [[good, bad], [bad, good]] {
                let found = useless(goal, [1.0; 3], errors);
                assert_eq!(found.len(), 3, "{goal}");
                for ((axis, error_mm, travel_mm), known) in found.into_iter().zip([0, 1, 2]) {
                    assert!(
                        axis == known && (error_mm - bad[axis]).abs() < 1e-12 && travel_mm == [4.0, 3.0, 2.0][axis]
                    );
                }
            }
            let weighted = useless(goal, [1.0, 0.0, 2.0], [bad, bad]);
            assert_eq!(weighted.iter().map(|(axis, ..)| *axis).collect::<Vec<_>>(), [0, 2], "{goal}");
        }
        assert_eq!(useless("displacement", [1.0; 3], [[f64::NAN, 0.0, 0.0], good]).len(), 0);
    }
}
