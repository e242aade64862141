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
