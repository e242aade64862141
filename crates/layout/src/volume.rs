//! `[volume]`: the region in which the sensor moves, and its grid.

use glam::DVec3;
use magsplice_magnet::{Grid, MAX_LENGTH, MIN_SIZE};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::error::LayoutFault;
use crate::faults::{Faults, POSITIVE, TableFaults};
use crate::finding::FindingSubject;
use crate::limits::{BYTES_PER_POINT, MAX_POINTS, STEP_ROUNDING};
use crate::one_or_three::OneOrThree;
use crate::plausible::{MAX_LENGTH_RATIO, meant_length, typed};

/// The region in which the sensor moves, sampled on a regular grid. It may be a plane, a line or a
/// point.
///
/// All lengths are in millimetres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WorkingVolume {
    /// The sample points. The grid starts at `lower_mm` and ends at `upper_mm`, or at the last step
    /// before it.
    pub grid: Grid,
    /// Lower corner of the region, as written.
    pub lower_mm: DVec3,
    /// Upper corner of the region, as written.
    pub upper_mm: DVec3,
    /// Distance between neighbouring points along x, y, z.
    pub step_mm: DVec3,
    /// The point from which changes of the field are measured. Default: the middle of x and y at
    /// the lowest z.
    pub reference_mm: DVec3,
}

/// The region in which the sensor moves, sampled on a regular grid.
#[derive(Deserialize, JsonSchema, Serialize)]
pub(crate) struct VolumeTable {
    /// Lower and upper end along x, in mm. Both are equal for a plane normal to x.
    #[schemars(extend("example" = "[-2.0, 2.0]"))]
    x_mm: [f64; 2],
    /// Lower and upper end along y, in mm.
    #[schemars(extend("example" = "[-2.0, 2.0]"))]
    y_mm: [f64; 2],
    /// Lower and upper end along z, in mm. Below the film z is negative.
    #[schemars(extend("example" = "[-5.0, -3.0]"))]
    z_mm: [f64; 2],
    /// Distance between neighbouring points, in mm: one number, or one each along x, y, z.
    #[schemars(extend("example" = "0.5"))]
    step_mm: OneOrThree,
    /// The point from which changes of the field are measured, in mm, on the film's axis. Default:
    /// the middle of x and y at the lowest z.
    #[schemars(extend("example" = "[0.0, 0.0, -5.0]"))]
    reference_mm: Option<[f64; 3]>,
}

impl WorkingVolume {
    /// The region between two corners, in millimetres, with points at these steps from the lower
    /// corner on.
    ///
    /// # Errors
    /// Every broken rule of `[volume]`: ends that are not finite or in descending order, steps that
    /// are not greater than 0 or make too many points, a reference that is not finite.
    pub fn new(
        lower_mm: DVec3,
        upper_mm: DVec3,
        step_mm: DVec3,
        reference_mm: DVec3,
    ) -> Result<WorkingVolume, Vec<LayoutFault>> {
        let mut faults = Faults::new("");
        let table = VolumeTable::of(lower_mm, upper_mm, OneOrThree::Each(step_mm.into()), reference_mm);
        let volume = table.resolve(&mut faults.at(0, "volume"));
        volume
            .ok_or_else(|| faults.into_sorted().into_iter().map(|fault| LayoutFault { line: None, ..fault }).collect())
    }

    /// Whether the reference point is the one of a volume that gives none.
    pub fn has_default_reference(&self) -> bool {
        self.reference_mm == default_reference_mm(self.lower_mm, self.upper_mm)
    }
}

impl From<&WorkingVolume> for VolumeTable {
    fn from(volume: &WorkingVolume) -> VolumeTable {
        VolumeTable::of(volume.lower_mm, volume.upper_mm, volume.step_mm.into(), volume.reference_mm)
    }
}

impl VolumeTable {
    fn of(lower_mm: DVec3, upper_mm: DVec3, step_mm: OneOrThree, reference_mm: DVec3) -> VolumeTable {
        let [x_mm, y_mm, z_mm] = [0, 1, 2].map(|axis| [lower_mm[axis], upper_mm[axis]]);
        VolumeTable { x_mm, y_mm, z_mm, step_mm, reference_mm: Some(reference_mm.into()) }
    }

    /// The working volume, or `None` after adding its faults. A step that does not divide a range
    /// is a finding.
    pub(crate) fn resolve(&self, faults: &mut TableFaults) -> Option<WorkingVolume> {
        let before = faults.count();
        let ranges = [("x_mm", self.x_mm), ("y_mm", self.y_mm), ("z_mm", self.z_mm)];
        for (key, range) in ranges {
            check_range(key, range, faults);
        }
        self.step_mm.check("step_mm", POSITIVE, faults);
        faults.point("reference_mm", self.reference_mm);
        if faults.count() > before {
            return None;
        }

        let steps = DVec3::from(self.step_mm);
        let lower = DVec3::from(ranges.map(|(_, [low, _])| low));
        let end = DVec3::from(ranges.map(|(_, [_, high])| high));
        let intervals = ((end - lower) / steps + STEP_ROUNDING).floor();
        let points = (intervals + 1.0).element_product();
        if points > MAX_POINTS {
            return faults.refuse(format!(
                "step_mm = {} makes {points:.3e} points ({:.3e} GB), must make at most {MAX_POINTS:e}: \
                 use a step of at least {} mm along each axis{}",
                self.step_mm,
                points * BYTES_PER_POINT * 1e-9,
                least_step(end - lower, MAX_POINTS),
                meant_step(steps, end - lower).map_or(String::new(), |meant| format!("; {meant}"))
            ));
        }
        let mut upper = lower;
        for axis in 0..3 {
            let reached = lower[axis] + intervals[axis] * steps[axis];
            let reaches_end = (end[axis] - reached).abs() <= STEP_ROUNDING * steps[axis];
            upper[axis] = if reaches_end { end[axis] } else { reached };
            if !reaches_end {
                let message = format!(
                    "volume: a step of {} mm does not divide {} = [{}, {}]; the last points are at {}",
                    steps[axis],
                    ranges[axis].0,
                    lower[axis],
                    end[axis],
                    typed(reached)
                );
                faults.remark(FindingSubject::Volume, message);
            }
        }
        let counts = intervals.to_array().map(|n| n as usize + 1);
        Some(WorkingVolume {
            grid: Grid::new(lower, upper, counts).expect("ranges and steps have been checked"),
            lower_mm: lower,
            upper_mm: end,
            step_mm: steps,
            reference_mm: self.reference_mm.map_or_else(|| default_reference_mm(lower, end), DVec3::from),
        })
    }
}

/// The middle of x and y at the lowest z.
fn default_reference_mm(lower_mm: DVec3, upper_mm: DVec3) -> DVec3 {
    (0.5 * (lower_mm + upper_mm)).with_z(lower_mm.z)
}

fn check_range(key: &str, [low, high]: [f64; 2], faults: &mut TableFaults) {
    if !(low.abs() <= MAX_LENGTH && high.abs() <= MAX_LENGTH) {
        faults.add(format!("{key} = [{low}, {high}], must be two finite numbers"));
    } else if low > high {
        faults.add(format!("{key} = [{low}, {high}] is inverted, the first must not be greater than the second"));
    } else if low < high && high - low < MIN_SIZE {
        faults.add(format!(
            "{key} = [{low:e}, {high:e}] is {:e} long, must be 0 or at least {MIN_SIZE:e} long",
            typed(high - low)
        ));
    }
}

/// Ratio of the steps tried as the smallest. The ends of at most 400 steps are that near.
const FINER: f64 = 1.05;

/// The smallest step, rounded up to two digits, with which a region of these extents has at most so
/// many points. One extent at least is above 0.
pub(crate) fn least_step(extents: DVec3, most_points: f64) -> f64 {
    // By ratios, because products of extents may be too small for a number.
    let points = |step: f64| (extents / step + 1.0).element_product();
    let mut step = extents.max_element();
    while points(step / FINER) <= most_points {
        step /= FINER;
    }
    let digit = 10_f64.powf(step.log10().floor() - 1.0);
    // Through decimal text, which removes the round-off of the product.
    format!("{:.1e}", (step / digit).ceil() * digit).parse().unwrap_or(step)
}

/// What steps in metres were meant to be: a step below a thousandth of the shortest extent, if a
/// thousand times the steps make a grid.
fn meant_step(steps: DVec3, extents: DVec3) -> Option<String> {
    let shortest = steps.min_element();
    let points = (extents / (MAX_LENGTH_RATIO * steps) + 1.0).element_product();
    let shortest_extent = extents.to_array().into_iter().filter(|extent| *extent > 0.0).fold(f64::INFINITY, f64::min);
    let is_likely = shortest * MAX_LENGTH_RATIO < shortest_extent && points <= MAX_POINTS;
    is_likely.then(|| meant_length(shortest))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn volume(reference_mm: DVec3) -> WorkingVolume {
        let (lower, upper) = (DVec3::new(0.0, -1.0, -5.0), DVec3::new(2.0, 3.0, -3.0));
        WorkingVolume::new(lower, upper, DVec3::ONE, reference_mm).unwrap()
    }

    /// The middle of the lower plane.
    #[test]
    fn default_reference_is_known() {
        assert!(volume(DVec3::new(1.0, 1.0, -5.0)).has_default_reference());
        for other in [DVec3::new(1.0, 1.0, -4.0), DVec3::new(0.0, 1.0, -5.0), DVec3::new(1.0, 0.0, -5.0)] {
            assert!(!volume(other).has_default_reference(), "{other}");
        }
    }

    /// A step below a thousandth of the shortest extent that is not 0, if a thousand times the
    /// steps make a grid: 465^3 points are more than 1e8, and 464^3 are not.
    #[test]
    fn steps_in_metres_are_guessed() {
        let meant = |step: [f64; 3], extents: [f64; 3]| meant_step(step.into(), extents.into());
        let guess = Some("did you mean 0.25 mm, which is 0.00025 m?".to_owned());
        assert_eq!(meant([0.000_25; 3], [4.0, 4.0, 2.0]), guess);
        assert_eq!(meant([0.000_25, 0.001, 0.001], [4.0, 4.0, 0.0]), guess);
        assert_eq!(meant([0.002; 3], [4.0, 4.0, 2.0]), None);
        assert!(meant([0.001_999; 3], [4.0, 4.0, 2.0]).is_some());
        let step = |points: f64| meant([0.001; 3], [points - 1.0; 3]);
        assert!(step(464.0).is_some() && step(465.0).is_none());
    }

    #[test]
    fn ranges_have_two_finite_ends_in_order() {
        let refused = |low: f64, high: f64| {
            let volume = WorkingVolume::new(DVec3::ZERO.with_x(low), DVec3::ONE.with_x(high), DVec3::ONE, DVec3::ZERO);
            volume.map(|_| ()).map_err(|faults| faults.into_iter().map(|fault| fault.message).collect::<Vec<_>>())
        };
        for (low, high) in [(f64::NEG_INFINITY, 2.0), (0.0, f64::INFINITY), (f64::NAN, 1.0), (2.0 * MAX_LENGTH, 1.0)] {
            let message = format!("x_mm = [{low}, {high}], must be two finite numbers");
            assert_eq!(refused(low, high), Err(vec![message]));
        }
        assert_eq!(refused(2.0, 2.0), Ok(()));
        assert!(refused(2.0, 1.0).is_err_and(|messages| messages[0].contains("[2, 1] is inverted")));
        assert!(refused(0.0, 0.5 * MIN_SIZE).is_err_and(|messages| messages[0].contains("must be 0 or at least")));
    }
}
