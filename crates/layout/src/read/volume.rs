//! `[volume]`: from ranges and a step to a grid.

use glam::DVec3;
use magsplice_magnet::{Grid, MAX_LENGTH, MIN_SIZE};

use crate::error::LayoutFault;
use crate::finding::{Finding, FindingSubject};
use crate::layout::WorkingVolume;
use crate::limits::{BYTES_PER_POINT, MAX_POINTS, STEP_ROUNDING};
use crate::plausible::{MAX_LENGTH_RATIO, meant_length, typed};
use crate::read::faults::{Faults, TableFaults};
use crate::read::number_rules::check_positive;
use crate::tables::volume::{Step, VolumeTable};

impl WorkingVolume {
    /// The region between two corners, in millimetres, with points at these steps from the lower
    /// corner on.
    ///
    /// # Errors
    /// Every broken rule of `[volume]`: ends that are not finite or not in ascending order, steps
    /// that are not greater than 0 or make too many points, a reference that is not finite.
    pub fn new(
        lower_mm: DVec3,
        upper_mm: DVec3,
        step_mm: DVec3,
        reference_mm: DVec3,
    ) -> Result<WorkingVolume, Vec<LayoutFault>> {
        let [x_mm, y_mm, z_mm] = [0, 1, 2].map(|axis| [lower_mm[axis], upper_mm[axis]]);
        let (step_mm, reference_mm) = (Step::PerAxis(step_mm.to_array()), Some(reference_mm.to_array()));
        let table = VolumeTable { x_mm, y_mm, z_mm, step_mm, reference_mm };
        let mut faults = Faults::new("");
        let volume = resolve(&table, &mut faults.at(&(0..0), "volume"), &mut Vec::new());
        volume
            .ok_or_else(|| faults.into_sorted().into_iter().map(|fault| LayoutFault { line: None, ..fault }).collect())
    }
}

/// The working volume, or `None` after adding its faults. A step that does not divide a range is a
/// finding.
pub(crate) fn resolve(
    table: &VolumeTable,
    faults: &mut TableFaults,
    findings: &mut Vec<Finding>,
) -> Option<WorkingVolume> {
    let before = faults.count();
    let ranges = [("x_mm", table.x_mm), ("y_mm", table.y_mm), ("z_mm", table.z_mm)];
    for (key, range) in ranges {
        check_range(key, range, faults);
    }
    let steps = checked_steps(table.step_mm, faults);
    if let Some(reference) = table.reference_mm.filter(|r| !r.iter().all(|c| c.abs() <= MAX_LENGTH)) {
        faults.add(format!("reference_mm = {reference:?}, must be three finite numbers"));
    }
    if faults.count() > before {
        return None;
    }

    let lower = DVec3::from(ranges.map(|(_, [low, _])| low));
    let end = DVec3::from(ranges.map(|(_, [_, high])| high));
    let intervals = [0, 1, 2].map(|axis| ((end[axis] - lower[axis]) / steps[axis] + STEP_ROUNDING).floor());
    let points: f64 = intervals.iter().map(|n| n + 1.0).product();
    if points > MAX_POINTS {
        faults.add(format!(
            "step_mm = {} makes {points:.3e} points ({:.3e} GB), must make at most {MAX_POINTS:e}: \
             use a step of at least {} mm along each axis{}",
            as_written(table.step_mm),
            points * BYTES_PER_POINT * 1e-9,
            least_step(end - lower),
            meant_step(steps.into(), end - lower).map_or(String::new(), |meant| format!("; {meant}"))
        ));
        return None;
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
            findings.push(Finding::new(FindingSubject::Volume, message));
        }
    }
    let counts = intervals.map(|n| n as usize + 1);
    let middle = 0.5 * (lower + end);
    Some(WorkingVolume {
        grid: Grid::new(lower, upper, counts).expect("ranges and steps have been checked"),
        lower_mm: lower,
        upper_mm: end,
        step_mm: steps.into(),
        reference_mm: table.reference_mm.map_or(DVec3::new(middle.x, middle.y, lower.z), DVec3::from),
    })
}

fn check_range(key: &str, [low, high]: [f64; 2], faults: &mut TableFaults) {
    if !(low.abs() <= MAX_LENGTH && high.abs() <= MAX_LENGTH) {
        faults.add(format!("{key} = [{low}, {high}], must be two finite numbers"));
    } else if low == high {
        faults.add(format!("{key} = [{low}, {high}] is empty, the first must be less than the second"));
    } else if low > high {
        faults.add(format!("{key} = [{low}, {high}] is inverted, the first must be less than the second"));
    } else if high - low < MIN_SIZE {
        faults.add(format!(
            "{key} = [{low:e}, {high:e}] is {:e} long, must be at least {MIN_SIZE:e} long",
            typed(high - low)
        ));
    }
}

fn checked_steps(step: Step, faults: &mut TableFaults) -> [f64; 3] {
    match step {
        Step::Same(step) => {
            check_positive("step_mm", step, faults);
            [step; 3]
        }
        Step::PerAxis(steps) => {
            for (axis, step) in steps.into_iter().enumerate() {
                check_positive(&format!("step_mm[{axis}]"), step, faults);
            }
            steps
        }
    }
}

/// Ratio of the steps tried as the smallest. The ends of at most 400 steps are that near.
const FINER: f64 = 1.05;

/// The smallest step, rounded up to two digits, with which a region of these extents has at most
/// [`MAX_POINTS`] points.
fn least_step(extents: DVec3) -> f64 {
    // By ratios, because products of extents may be too small for a number.
    let points = |step: f64| (extents / step + 1.0).element_product();
    let mut step = extents.max_element();
    while points(step / FINER) <= MAX_POINTS {
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
    let is_likely = shortest * MAX_LENGTH_RATIO < extents.min_element() && points <= MAX_POINTS;
    is_likely.then(|| meant_length(shortest))
}

fn as_written(step: Step) -> String {
    match step {
        Step::Same(step) => step.to_string(),
        Step::PerAxis(steps) => format!("{steps:?}"),
    }
}
