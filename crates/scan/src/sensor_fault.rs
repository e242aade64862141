//! Faults of a sensor that the parameters of a scan do not contain: gains that differ from axis to
//! axis, and an offset that drifts.

use glam::{DMat3, DVec3};
use magsplice_magnet::Axis;
use magsplice_sensor::SensedField;
use nalgebra::DMatrix;

use crate::exclusion::Exclusion;
use crate::fit::fit_from;
use crate::least_squares::ScanFit;
use crate::parameters::FreeParameters;
use crate::scan_columns::{ScanColumns, column};

/// Residual with the fault over the residual without it, above which the fault is not named. Errors
/// of the tiles of ten films made by hand look like no fault at this share.
const EXPLAINED: f64 = 0.5;

/// Largest number of fits. Each takes the fault from the first order about the fit before.
const MOST_FITS: usize = 10;

/// Change of the fault, in units of the readings, at which the fits end.
const LEAST_CHANGE: f64 = 1e-6;

/// Singular value of the changes by a fault, over the largest, above which the readings tell the
/// fault from the parameters of the scan. A common gain looks like another strength.
const DETERMINED: f64 = 1e-6;

/// A fault of a sensor that explains most of the residual of a scan.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SensorFault {
    /// The axes have these gains, of which the middle one is 1.
    Gains {
        /// Reading over field along each axis.
        gains: DVec3,
        /// Standard deviation of the residuals of one component with them.
        residual_t: f64,
    },
    /// The offset drifts evenly from the first reading to the last.
    Drift {
        /// Its change along each axis, in tesla.
        drift_t: DVec3,
        /// Standard deviation of the residuals of one component with it.
        residual_t: f64,
    },
}

impl SensorFault {
    /// Standard deviation of the residuals of one component, in tesla.
    pub fn residual_t(&self) -> f64 {
        match self {
            SensorFault::Gains { residual_t, .. } | SensorFault::Drift { residual_t, .. } => *residual_t,
        }
    }

    /// The fault that leaves less than half of the residual of `fit`, the fit of a scan with these
    /// parameters free. `None` where there is none.
    pub fn of_scan(
        field: &SensedField,
        points: &[DVec3],
        readings_t: &[DVec3],
        fit: &ScanFit,
        free: FreeParameters,
    ) -> Option<SensorFault> {
        let sensor = *field.sensor();
        let unusable = readings_t.iter().map(|reading_t| Exclusion::of_reading(&sensor, *reading_t)).collect();
        let readings_t = readings_t.iter().map(|reading_t| (*reading_t - sensor.offset_t) / sensor.gain).collect();
        let scan = FaultyScan { field: &field.without_gain_and_offset(), points, readings_t, unusable, fit, free };
        let faults = [scan.gains(), scan.drift()].into_iter().flatten();
        let explaining = faults.filter(|fault| fault.residual_t() < EXPLAINED * fit.noise_t);
        explaining.min_by(|a, b| a.residual_t().total_cmp(&b.residual_t()))
    }
}

/// A scan with its fit.
struct FaultyScan<'a> {
    field: &'a SensedField<'a>,
    points: &'a [DVec3],
    readings_t: Vec<DVec3>,
    unusable: Vec<Option<Exclusion>>,
    fit: &'a ScanFit,
    free: FreeParameters,
}

impl FaultyScan<'_> {
    fn gains(&self) -> Option<SensorFault> {
        let without = |gains: DVec3, reading_t: DVec3, _: usize| reading_t / gains;
        let change = |fit: &ScanFit, without_t: &[DVec3], index: usize| {
            without_t[index] - fit.residuals_t[index] - fit.offset_t()
        };
        let (gains, residual_t) =
            self.converged(DVec3::ONE, 1.0, without, change, |gains, step| gains * (1.0 + step))?;
        let mut sorted = gains.to_array();
        sorted.sort_by(f64::total_cmp);
        (sorted[0] > 0.0).then(|| SensorFault::Gains { gains: gains / sorted[1], residual_t })
    }

    fn drift(&self) -> Option<SensorFault> {
        let last = self.points.len().saturating_sub(1).max(1) as f64;
        let time = |index: usize| index as f64 / last - 0.5;
        let squares: f64 = self.used(self.fit).map(|index| self.readings_t[index].length_squared()).sum();
        let scale_t = (squares / self.points.len() as f64).sqrt();
        let without = |drift_t: DVec3, reading_t: DVec3, index: usize| reading_t - time(index) * drift_t;
        let change = |_: &ScanFit, _: &[DVec3], index: usize| DVec3::splat(time(index));
        let (drift_t, residual_t) =
            self.converged(DVec3::ZERO, scale_t, without, change, |drift_t, step| drift_t + step)?;
        Some(SensorFault::Drift { drift_t, residual_t })
    }

    /// The fault with which the fit leaves least, and the residual then. `without` gives a reading
    /// without the fault, `change` its changes along the axes by one more unit of the fault, and
    /// `scale` is the unit of its steps.
    fn converged(
        &self,
        none: DVec3,
        scale: f64,
        without: impl Fn(DVec3, DVec3, usize) -> DVec3,
        change: impl Fn(&ScanFit, &[DVec3], usize) -> DVec3,
        stepped: impl Fn(DVec3, DVec3) -> DVec3,
    ) -> Option<(DVec3, f64)> {
        let (mut fit, mut without_t) = (self.fit.clone(), self.readings_t.clone());
        let mut fault = none;
        for _ in 0..MOST_FITS {
            let step = self.step(&fit, |index| change(&fit, &without_t, index))?;
            fault = stepped(fault, step);
            without_t =
                self.readings_t.iter().enumerate().map(|(index, reading)| without(fault, *reading, index)).collect();
            fit = fit_from(self.field, self.points, &without_t, &self.unusable, self.free, &fit.start()).ok()?;
            if step.abs().max_element() < LEAST_CHANGE * scale {
                break;
            }
        }
        Some((fault, fit.noise_t))
    }

    /// The step of the fault that explains the residuals best, beside the parameters of the scan.
    fn step(&self, fit: &ScanFit, change: impl Fn(usize) -> DVec3) -> Option<DVec3> {
        let used: Vec<usize> = self.used(fit).collect();
        let places: Vec<DVec3> = used.iter().map(|index| fit.place(self.points[*index])).collect();
        let field_t = self.field.readings_t(&places).ok()?;
        let gradients = self.field.gradients(&places).ok()?;
        let reading =
            fit.sensor_axes.matrix() * DMat3::from_quat(fit.parameters.turn().inverse()) * fit.parameters.strength;
        let scan = ScanColumns::new(&field_t, &gradients, reading, self.free);
        let changes =
            Axis::ALL.map(|axis| scan.unexplained(column(used.iter().map(|index| change(*index) * axis.unit()))));
        let residuals = scan.unexplained(column(used.iter().map(|index| fit.residuals_t[*index])));
        let changes = DMatrix::from_columns(&changes).svd(true, true);
        let step = changes.solve(&residuals, DETERMINED * changes.singular_values.max()).ok()?;
        let step = DVec3::new(step[0], step[1], step[2]);
        step.is_finite().then_some(step)
    }

    fn used(&self, fit: &ScanFit) -> impl Iterator<Item = usize> {
        (0..self.points.len()).filter(|index| fit.exclusions[*index].is_none())
    }
}
