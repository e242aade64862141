//! What the readings of all sensors of a head tell beside its position.

use glam::DVec3;
use magsplice_sensor::{HeadFit, HeadUnknowns};

use super::scan::MOST_OFFSET_T;
use super::table::ColumnQuantity;

/// Probability that the residual of a right reading is called too large.
pub const RESIDUAL_ALARM: f64 = 1e-3;

/// Share of the readings up to which too large residuals are chance.
const MOST_ALARMS: f64 = 10.0 * RESIDUAL_ALARM;

/// What all sensors of a head tell beside the position.
#[derive(Clone, Debug)]
pub struct HeadFits {
    /// What was fitted beside the position.
    pub unknowns: HeadUnknowns,
    /// The fit of each reading; `None` without a position.
    pub fits: Vec<Option<HeadFit>>,
    /// Whether deviations and residuals count in the noise of the sensors.
    pub has_noise: bool,
    /// The index of the only sensor without which the others agree, where too many residuals are
    /// too large.
    pub contradicting: Option<usize>,
}

impl HeadFits {
    /// A value of each fit; NaN without a position.
    pub fn of_each(&self, value: impl Fn(&HeadFit) -> DVec3) -> Vec<DVec3> {
        self.fits.iter().map(|fit| fit.as_ref().map_or(DVec3::NAN, &value)).collect()
    }

    /// Whether the residual of a reading is larger than the noise allows, but for one in
    /// 1 / [`RESIDUAL_ALARM`].
    pub fn is_residual_too_large(&self, reading: usize) -> bool {
        let probability = self.fits[reading].as_ref().and_then(HeadFit::probability);
        self.has_noise && probability.is_some_and(|probability| probability < RESIDUAL_ALARM)
    }

    /// The readings with too large a residual. Empty if they are as rare as chance makes them.
    pub(super) fn contradictory(&self) -> Vec<usize> {
        let large: Vec<usize> = (0..self.fits.len()).filter(|reading| self.is_residual_too_large(*reading)).collect();
        let located = self.fits.iter().flatten().count();
        if (large.len() as f64) < MOST_ALARMS * located as f64 { Vec::new() } else { large }
    }

    /// Words for readings that the film, a uniform stray field and noise do not explain, and for a
    /// stray field that is hardly that of the earth.
    pub fn remarks(&self) -> Vec<String> {
        let located = self.fits.iter().flatten().count();
        let large = self.contradictory();
        let residual = (!large.is_empty()).then(|| {
            let chip = self.contradicting.map_or(String::new(), |sensor| {
                format!("; without sensor {} the others agree: that sensor is suspect", sensor + 1)
            });
            let stray = if self.unknowns.has_stray_field() { "" } else { "a stray field is there, " };
            format!(
                "the residual of {} of {located} readings is larger than the noise allows (in 1 of {} by chance): \
                 {stray}iron or a magnet is near, the film differs from the layout, or sensors have another order, \
                 other axes, another unit or other errors than stated; the deviations do not contain this{chip}",
                large.len(),
                (1.0 / RESIDUAL_ALARM).round()
            )
        });
        let mut strays_t: Vec<f64> = self.fits.iter().flatten().map(|fit| fit.stray_t.length()).collect();
        strays_t.sort_by(f64::total_cmp);
        let stray = strays_t.get(strays_t.len() / 2).filter(|stray_t| **stray_t > MOST_OFFSET_T).map(|stray_t| {
            format!(
                "the fitted stray field is {:.0} uT in the median, several times the field of the earth: another magnet \
                 is near, or a sensor has an offset or is broken",
                1e6 * stray_t
            )
        });
        residual.into_iter().chain(stray).collect()
    }

    /// Stray field, rotation, deviations and chi squared of each reading, as columns.
    pub fn columns(&self) -> Vec<ColumnQuantity> {
        let degrees = |rotation_rad: DVec3| rotation_rad.map(f64::to_degrees);
        let (stray, turn) = (self.unknowns.has_stray_field(), self.unknowns.has_rotation());
        let mut columns: Vec<ColumnQuantity> = Vec::new();
        let mut add = |is_known: bool, name, components, value: &dyn Fn(&HeadFit) -> DVec3| {
            if is_known {
                columns.push(ColumnQuantity::of_vectors(name, components, &self.of_each(value)));
            }
        };
        add(stray, "stray_t", &["stray_x_t", "stray_y_t", "stray_z_t"], &|fit| fit.stray_t);
        add(
            stray && self.has_noise,
            "stray_deviation_t",
            &["stray_deviation_x_t", "stray_deviation_y_t", "stray_deviation_z_t"],
            &|fit| fit.stray_deviation_t,
        );
        add(turn, "rotation_deg", &["rotation_x_deg", "rotation_y_deg", "rotation_z_deg"], &|fit| {
            degrees(fit.rotation_rad)
        });
        add(
            turn && self.has_noise,
            "rotation_deviation_deg",
            &["rotation_deviation_x_deg", "rotation_deviation_y_deg", "rotation_deviation_z_deg"],
            &|fit| degrees(fit.rotation_deviation_rad),
        );
        let freedom = self.fits.iter().flatten().next().map_or(0, |fit| fit.degrees_of_freedom);
        if self.has_noise && freedom > 0 {
            let ratio = |fit: &Option<HeadFit>| fit.as_ref().map_or(f64::NAN, |fit| fit.chi_squared / freedom as f64);
            columns.push(ColumnQuantity::of_numbers(&["chi_squared_over_freedom"], self.fits.iter().map(ratio)));
        }
        columns
    }
}
