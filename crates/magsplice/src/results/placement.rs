//! Where the sensor of a scan was, and how it was turned.

use std::fmt;

use glam::{DMat3, DQuat, DVec3};
use magsplice_magnet::Tile;
use magsplice_scan::{PLAUSIBLE_STRENGTHS, ScanFit, ScanParameters, SignedAxes};
use serde::Serialize;

use super::significant::number;

/// Angle from a rotation to the nearest exchange of axes up to which axes are likely exchanged:
/// sensors are soldered and clamped to a few degrees.
const MOST_MOUNTING_DEG: f64 = 15.0;

/// What is not known of a scan beforehand.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FittedScan {
    /// Strength of all tiles over the strength of the layout.
    pub strength: f64,
    /// Offset of the sensor and uniform stray field together.
    pub offset_t: DVec3,
    /// Rotation vector of the sensor.
    pub rotation_deg: DVec3,
    /// Position of the sensor where the scan has its origin.
    pub start_mm: DVec3,
}

impl FittedScan {
    pub(crate) fn new(of: &ScanParameters, offset_t: DVec3) -> FittedScan {
        FittedScan {
            strength: of.strength,
            offset_t,
            rotation_deg: of.rotation_rad.map(f64::to_degrees),
            start_mm: of.start,
        }
    }

    /// The parameters as words.
    pub(crate) fn in_words(&self) -> String {
        let FittedScan { strength, offset_t, start_mm, rotation_deg } = *self;
        let [start, rotation, offset] = [rounded(start_mm, 3), rounded(rotation_deg, 2), rounded(1e6 * offset_t, 1)];
        format!("strength {strength:.3}, offset ({offset}) uT, start ({start}) mm, rotation ({rotation}) deg")
    }

    /// Words for a strength that this film hardly has: below half of that of the layout, or above
    /// twice.
    pub(crate) fn implausible_strength(&self) -> Option<String> {
        let strength = number(self.strength);
        (!PLAUSIBLE_STRENGTHS.contains(&self.strength)).then(|| {
            format!(
                "the fitted strength is {strength} times the strength of the layout: the scan is of another film, or its \
                 columns have another unit, or its positions are far off"
            )
        })
    }

    /// The exchange of axes that the rotation of the sensor is but for errors of mounting, as
    /// words, with its remedy. `None` if no axis is another one.
    pub(crate) fn rotated_axes(&self) -> Option<String> {
        let turn = DQuat::from_scaled_axis(self.rotation_deg.map(f64::to_radians));
        let axes = SignedAxes::nearest(DMat3::from_quat(turn.inverse()));
        let difference = turn * DQuat::from_mat3(&axes.matrix());
        let angle_deg = 2.0 * difference.w.abs().min(1.0).acos().to_degrees();
        let is_exchange = axes != SignedAxes::SAME && angle_deg <= MOST_MOUNTING_DEG;
        is_exchange.then(|| {
            let remedy = axes.remedy_of_scan();
            format!(
                "axes of the sensor: its rotation is that of exchanged axes: {axes}: if it was not mounted so, {remedy}; \
                 if it was, state its rotation in [sensor]"
            )
        })
    }
}

/// Axes and place of a sensor whose readings the film as ordered explains, as words: what is
/// otherwise than stated, and what to do.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SensorPlacement {
    /// Exchanged or reversed axes of the sensor that no rotation explains.
    pub sensor_axes: SignedAxes,
    /// Exchanged or reversed axes of the positions.
    pub stage_axes: SignedAxes,
    /// The parameters of the scan.
    pub fitted: FittedScan,
    /// Standard deviation of the residuals of one component.
    pub residual_t: f64,
    /// Noise of a component.
    #[serde(skip)]
    pub noise_t: f64,
    /// Whether the sensor was on the other side of the film than the working volume.
    #[serde(skip)]
    pub is_across: bool,
}

/// Residual over the noise above which more than the placement of the sensor is wrong.
const MUCH_NOISE: f64 = 10.0;

/// What a sensor on the other side of the film than the working volume means.
pub(super) const ACROSS: &str = "the sensor was on the other side of the film than [volume]: the film is turned over, or z \
    of the positions is counted downwards and the z axis of the sensor is reversed (gain = [1, 1, -1] in [sensor])";

impl SensorPlacement {
    pub(crate) fn new(fit: &ScanFit, noise_t: f64, is_across: bool) -> SensorPlacement {
        SensorPlacement {
            is_across,
            noise_t,
            sensor_axes: fit.sensor_axes,
            stage_axes: fit.stage_axes,
            fitted: FittedScan::new(&fit.parameters, fit.offset_t()),
            residual_t: fit.noise_t,
        }
    }
}

impl fmt::Display for SensorPlacement {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let residual_ut = 1e6 * self.residual_t;
        write!(f, "the film as ordered explains the scan to {residual_ut:.1} uT")?;
        let ratio = self.residual_t / self.noise_t;
        if ratio > MUCH_NOISE {
            write!(
                f,
                " (not to its noise, which is {ratio:.0} times smaller: tiles have errors too, or a nearer scan is needed)"
            )?;
        }
        write!(f, " with {}", self.fitted.in_words())?;
        if self.is_across {
            write!(f, "; {ACROSS}")?;
        }
        if let Some(rotated) = self.fitted.rotated_axes() {
            write!(f, "; {rotated}")?;
        } else if self.is_across {
            return Ok(());
        } else if let Some(implausible) = self.fitted.implausible_strength() {
            return write!(f, "; {implausible}");
        } else if [self.sensor_axes, self.stage_axes] == [SignedAxes::SAME; 2] {
            return f.write_str(": fit them with the errors of tiles");
        }
        if self.sensor_axes != SignedAxes::SAME {
            write!(f, "; axes of the sensor: {}: {}", self.sensor_axes, self.sensor_axes.remedy_of_scan())?;
        }
        if self.stage_axes != SignedAxes::SAME {
            write!(f, "; axes of the positions: {}: {}", self.stage_axes, self.stage_axes.remedy_of_positions())?;
        }
        Ok(())
    }
}

/// Whether places and the centre of the volume are on different sides of the film along z, by their
/// means.
pub(super) fn is_across(tiles: &[Tile], centre_mm: Option<DVec3>, places_mm: &[DVec3]) -> bool {
    let mean = |sum: f64, count: usize| sum / count.max(1) as f64;
    let film_mm = mean(tiles.iter().map(|tile| tile.position().z).sum(), tiles.len());
    let scan_mm = mean(places_mm.iter().map(|place| place.z).sum(), places_mm.len());
    centre_mm.is_some_and(|centre_mm| (centre_mm.z - film_mm) * (scan_mm - film_mm) < 0.0)
}

/// Three components with this number of decimals; a negative zero has no sign.
fn rounded(vector: DVec3, decimals: usize) -> String {
    let scale = 10f64.powi(decimals as i32);
    let components = vector.to_array().map(|value| format!("{:.decimals$}", (value * scale).round() / scale + 0.0));
    components.join(", ")
}
