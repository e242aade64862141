//! What speaks against a fitted scan, in words.

use magsplice_scan::{SensorFault, SignedAxes};

use super::placement::ACROSS;
use super::scan::{FilmScan, MOST_OFFSET_T, MOST_SHARE};
use super::significant::{self, number};

impl FilmScan {
    /// Exchanged and reversed axes, those of a rotation too, with remedies, one sentence each.
    pub fn exchanged_axes(&self) -> Vec<String> {
        let of_sensor = (self.sensor_axes != SignedAxes::SAME)
            .then(|| format!("axes of the sensor: {}: {}", self.sensor_axes, self.sensor_axes.remedy_of_scan()));
        let of_stage = (self.stage_axes != SignedAxes::SAME)
            .then(|| format!("axes of the positions: {}: {}", self.stage_axes, self.stage_axes.remedy_of_positions()));
        of_sensor.into_iter().chain(self.fitted.rotated_axes()).chain(of_stage).collect()
    }

    /// Why the fit is hardly the fit of this film, one sentence each.
    pub fn remarks(&self) -> Vec<String> {
        let strength = self.fitted.implausible_strength();
        let offset_t = self.fitted.offset_t.abs().max_element();
        let certain_t = (self.fitted.offset_t.abs() - 2.0 * self.deviation.offset_t).max_element();
        let offset = (self.fit.offset && certain_t > MOST_OFFSET_T).then(|| {
            format!(
                "the fitted offset is {} uT, several times the field of the earth: another magnet is near, the sensor has an \
                 offset that [sensor] does not state, or the scan is of another film, and an offset makes up for its \
                 uniformity",
                number(1e6 * offset_t)
            )
        });
        let outliers = match self.excluded.outliers.is_empty() {
            true => "",
            false => "; the excluded readings may be near faulty tiles, which `diagnose` finds",
        };
        let residual = self.excessive_residual().map(|ratio| {
            format!(
                "the residual is {} times the noise of the sensor: the film differs from the layout, the positions of the \
                 scan are wrong, or the noise is larger than stated; the deviations do not contain this. Errors of tiles \
                 look like another strength and height{}{outliers}",
                significant::ratio(ratio),
                if self.fit.strength { ": a fit of offset, rotation and start alone holds the strength" } else { "" }
            )
        });
        let by = match self.states_errors {
            true => "`diagnose --fit` fits all together",
            false => "`diagnose --fit --preset workshop`, or with another preset, fits all together",
        };
        let held = self.height_of_strength_mm.map(|height_mm| {
            format!(
                "the strength is not fitted, and the deviations do not contain errors of the tiles, which look like another \
                 strength, height, rotation and offset: each 10 % of strength is about {height_mm:.2} mm of height. From \
                 readings near the film, {by}"
            )
        });
        let share = self.residual_t / self.reading_t;
        let unexplained = (self.sensor_noise_t == 0.0 && share > MOST_SHARE).then(|| {
            format!(
                "the residual is {} % of the readings: the film differs from the layout, or the positions of the scan are \
                 wrong",
                number(100.0 * share)
            )
        });
        let smooth = (self.sensor_noise_t == 0.0 && self.height_of_strength_mm.is_none() && self.has_smooth_residuals)
            .then(|| {
                format!(
                    "the residual is smooth along the scan, so it is rather of errors of the tiles than noise: the \
                     deviations do not contain them, and they look like another strength, height, rotation and \
                     offset{outliers}"
                )
            });
        let turn = self.turn.map(|turn| {
            format!(
                "the residual is {} uT if the film was turned by {:.1} deg about z against the positions: turn \
                 positions and readings by {:.1} deg, or the film",
                number(1e6 * turn.residual_t),
                turn.angle_deg,
                -turn.angle_deg
            )
        });
        let sensor_fault = self.sensor_fault.map(sensor_fault_in_words);
        let across = self.is_across.then(|| ACROSS.to_owned());
        let plateau = self.excluded.remark();
        plateau
            .into_iter()
            .chain(strength)
            .chain(across)
            .chain(turn)
            .chain(sensor_fault)
            .chain(offset)
            .chain(residual)
            .chain(unexplained)
            .chain(smooth)
            .chain(held)
            .collect()
    }
}

/// A fault of the sensor with its remedy.
fn sensor_fault_in_words(fault: SensorFault) -> String {
    let residual = number(1e6 * fault.residual_t());
    match fault {
        SensorFault::Gains { gains, .. } => format!(
            "the residual is {residual} uT if the axes of the sensor have gains of {}: state gain in [sensor], or correct \
             the readings",
            gains.to_array().map(|gain| format!("{gain:.3}")).join(", ")
        ),
        SensorFault::Drift { drift_t, .. } => format!(
            "the residual is {residual} uT if the offset drifts by {} uT from the first to the last reading: correct the \
             readings, or repeat the scan with a sensor that has warmed up",
            (1e6 * drift_t).to_array().map(|drift_ut| format!("{drift_ut:.1}")).join(", ")
        ),
    }
}
