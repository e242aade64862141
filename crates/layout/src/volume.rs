//! The working volume: from ranges and a step to a grid.

use std::ops::Range;

use glam::DVec3;
use magsplice_field::{Grid, MAX_LENGTH};

use crate::layout::WorkingVolume;
use crate::resolve::Problems;
use crate::written::{Step, Volume};

/// More points than this are refused: comparing and decoupling hold about 80 bytes a point.
const MAX_POINTS: f64 = 1e8;
const BYTES_PER_POINT: f64 = 80.0;

/// A step that misses the upper end by less than this fraction of itself reaches it: decimal steps are not exact in binary.
const STEP_ROUNDING: f64 = 1e-6;

pub(crate) fn resolve(
    written: &Volume,
    span: &Range<usize>,
    problems: &mut Problems,
    findings: &mut Vec<String>,
) -> Option<WorkingVolume> {
    let steps = match written.step_mm {
        Step::Same(step) => [step; 3],
        Step::PerAxis(steps) => steps,
    };
    let before = problems.count();
    let mut report = |message: String| problems.add(Some(span), "volume", message);
    let ranges = [("x_mm", written.x_mm), ("y_mm", written.y_mm), ("z_mm", written.z_mm)];
    for (key, [low, high]) in ranges {
        if !(low.abs() <= MAX_LENGTH && high.abs() <= MAX_LENGTH) {
            report(format!("{key} = [{low}, {high}], must be two finite numbers"));
        } else if low == high {
            report(format!("{key} = [{low}, {high}] is empty, the first must be less than the second"));
        } else if low > high {
            report(format!("{key} = [{low}, {high}] is inverted, the first must be less than the second"));
        }
    }
    for step in steps.iter().take(if matches!(written.step_mm, Step::Same(_)) { 1 } else { 3 }) {
        if !(step.is_finite() && *step > 0.0) {
            report(format!("step_mm = {step}, must be a finite number greater than 0"));
        }
    }
    if let Some(reference) = written.reference_mm.filter(|r| !r.iter().all(|c| c.abs() <= MAX_LENGTH)) {
        report(format!("reference_mm = {reference:?}, must be three finite numbers"));
    }
    if problems.count() > before {
        return None;
    }

    let lower = DVec3::new(ranges[0].1[0], ranges[1].1[0], ranges[2].1[0]);
    let end = DVec3::new(ranges[0].1[1], ranges[1].1[1], ranges[2].1[1]);
    let intervals = [0, 1, 2].map(|axis| ((end[axis] - lower[axis]) / steps[axis] + STEP_ROUNDING).floor());
    let points: f64 = intervals.iter().map(|n| n + 1.0).product();
    if points > MAX_POINTS {
        let least = least_step(end - lower);
        let message = format!(
            "step_mm = {} makes {points:.3e} points ({:.3e} GB), more than the {MAX_POINTS:e} that are supported; \
             a step of {least} mm in each direction would do",
            written_step(written.step_mm),
            points * BYTES_PER_POINT * 1e-9
        );
        problems.add(Some(span), "volume", message);
        return None;
    }
    let mut upper = lower;
    for axis in 0..3 {
        let reached = lower[axis] + intervals[axis] * steps[axis];
        let reaches_end = (end[axis] - reached).abs() <= STEP_ROUNDING * steps[axis];
        upper[axis] = if reaches_end { end[axis] } else { reached };
        if !reaches_end {
            let key = ranges[axis].0;
            findings.push(format!(
                "volume: a step of {} mm does not divide {key} = [{}, {}]; the last points are at {reached}",
                steps[axis], lower[axis], end[axis]
            ));
        }
    }
    let counts = intervals.map(|n| n as usize + 1);
    let middle = 0.5 * (lower + end);
    let reference_mm = written.reference_mm.map_or(DVec3::new(middle.x, middle.y, lower.z), DVec3::from);
    Some(WorkingVolume {
        grid: Grid::new(lower, upper, counts).expect("ranges and steps have been checked"),
        lower_mm: lower,
        upper_mm: end,
        step_mm: steps.into(),
        reference_mm,
    })
}

/// A step, rounded to two digits, with which a region of these extents has few enough points.
fn least_step(extents: DVec3) -> f64 {
    let points = |step: f64| (extents / step + 1.0).element_product();
    let mut step = (extents.element_product() / MAX_POINTS).cbrt();
    while points(step) > MAX_POINTS {
        step *= 1.05;
    }
    let digit = 10_f64.powf(step.log10().floor() - 1.0);
    // Up to a number with two digits, as a person would write it.
    format!("{:.1e}", (step / digit).ceil() * digit).parse().unwrap_or(step)
}

fn written_step(step: Step) -> String {
    match step {
        Step::Same(step) => step.to_string(),
        Step::PerAxis(steps) => format!("{steps:?}"),
    }
}
