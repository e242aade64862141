//! `[design]`: the brief of a search.

use crate::brief::{Brief, Goal, Under, Variables};
use crate::layout::WorkingVolume;
use crate::limits::{MAX_DESIGN_POINTS, MAX_STARTS};
use crate::read::faults::TableFaults;
use crate::read::number_rules::{check_finite, check_not_negative, check_positive};
use crate::read::strength_rules::check_material;
use crate::read::tables_present::TablesPresent;
use crate::tables::design::{DesignTable, MinMax, Variable};

/// The brief with its defaults filled in, or `None` after adding its faults.
pub(crate) fn resolve(
    table: DesignTable,
    present: TablesPresent,
    volume: Option<&WorkingVolume>,
    faults: &mut TableFaults,
) -> Option<Brief> {
    let before = faults.count();
    let vary = checked_variables(&table.vary, faults);
    present.check("", true, faults);
    let weights = table.weights.as_ref().map_or([1.0; 3], |w| [w.r_x, w.r_y, w.s_z]);
    check_weights(weights, faults);
    let outline_mm = table.outline_mm.as_ref().map_or([None; 2], |outline| [outline.x, outline.y]);
    check_lengths(&table, outline_mm, faults);
    check_bounds(&table, vary, faults);
    check_parts(&table, vary, faults);
    if let (Some(step), Some(volume)) = (table.step_mm.filter(|step| *step > 0.0), volume) {
        check_points(step, volume, faults);
    }
    let one_point = volume.is_some_and(|volume| (0..3).any(|axis| volume.grid.plane_len(axis) == 1));
    if table.goal == Goal::Uniformity && table.step_mm.is_none() && one_point {
        faults.add(
            "goal = \"uniformity\" needs at least two points in each plane of the grid of [volume], and some planes have \
             one: use a smaller step_mm",
        );
    }
    check_under(&table, present, faults);
    let defaults = Brief::default();
    let starts = table.starts.unwrap_or(defaults.starts);
    if !(1..=MAX_STARTS).contains(&starts) {
        faults.add(format!("starts = {starts}, must be from 1 to {MAX_STARTS}"));
    }
    if faults.count() > before {
        return None;
    }
    let min_and_max = |bounds: Option<MinMax>| bounds.map_or([0.0; 2], |b| [b.min, b.max]);
    Some(Brief {
        vary,
        symmetry: table.symmetry,
        goal: table.goal,
        under: table.under,
        weights,
        least_amplitude: table.amplitude.map(|bound| bound.min),
        outline_mm,
        smallest_cut_mm: table.smallest_cut_mm,
        gap_mm: table.gap_mm,
        thickness_mm: min_and_max(table.thickness_mm),
        strength_t: min_and_max(table.strength_t),
        resolution_mm: table.resolution_mm.unwrap_or(defaults.resolution_mm),
        resolution_deg: table.resolution_deg.unwrap_or(defaults.resolution_deg),
        step_mm: table.step_mm,
        parts: table.parts,
        stock: table.stock,
        stock_strengths_t: table.stock_strengths_t,
        starts,
        seed: table.seed.unwrap_or(defaults.seed),
    })
}

/// Requires errors and a goal in millimetres if the films that are made count.
fn check_under(table: &DesignTable, present: TablesPresent, faults: &mut TableFaults) {
    if table.under == Under::Nominal {
        return;
    }
    if !present.tolerance {
        faults.add(
            "under = \"tolerance\" needs the table [tolerance], which the layout does not have: it states the errors of \
             the films that are made",
        );
    }
    if table.goal != Goal::Displacement {
        faults.add(format!(
            "goal = {:?} with under = \"tolerance\", must be \"displacement\": the films with the smallest errors of other \
             kinds are those whose parameters change little with the displacement",
            format!("{:?}", table.goal).to_lowercase()
        ));
    }
}

fn checked_variables(names: &[Variable], faults: &mut TableFaults) -> Variables {
    let has = |variable: Variable| names.contains(&variable);
    let vary = Variables {
        size: has(Variable::Size),
        position: has(Variable::Position),
        cut: has(Variable::Cut),
        thickness: has(Variable::Thickness),
        direction: has(Variable::Direction),
        tilt: has(Variable::Tilt),
        strength: has(Variable::Strength),
    };
    if names.is_empty() {
        faults.add("vary = [], must name at least one of size, position, cut, thickness, direction, tilt, strength");
    }
    if vary.cut && (vary.size || vary.position) {
        faults.add(
            "vary names cut, which moves all faces on a line together, and size or position, which move faces \
             separately, must name only one of the two",
        );
    }
    vary
}

/// Requires that the design grid has not too many points.
fn check_points(step_mm: f64, volume: &WorkingVolume, faults: &mut TableFaults) {
    let points = ((volume.upper_mm - volume.lower_mm) / step_mm + 1.0).element_product();
    if points > MAX_DESIGN_POINTS {
        faults.add(format!(
            "step_mm = {step_mm} makes {points:.3e} points in the working volume, must make at most {MAX_DESIGN_POINTS:e}"
        ));
    }
}

fn check_weights(weights: [f64; 3], faults: &mut TableFaults) {
    for (key, weight) in ["weights.r_x", "weights.r_y", "weights.s_z"].into_iter().zip(weights) {
        check_not_negative(key, weight, faults);
    }
    if weights == [0.0; 3] {
        faults.add("weights are all 0, at least one must be greater than 0");
    }
}

fn check_lengths(table: &DesignTable, outline_mm: [Option<[f64; 2]>; 2], faults: &mut TableFaults) {
    let positive = [
        ("resolution_mm", table.resolution_mm),
        ("resolution_deg", table.resolution_deg),
        ("step_mm", table.step_mm),
        ("smallest_cut_mm", table.smallest_cut_mm),
        ("amplitude.min", table.amplitude.as_ref().map(|bound| bound.min)),
    ];
    for (key, value) in positive {
        if let Some(value) = value {
            check_positive(key, value, faults);
        }
    }
    check_not_negative("gap_mm", table.gap_mm, faults);
    for (key, range) in ["x", "y"].into_iter().zip(outline_mm) {
        if let Some([low, high]) = range.filter(|[low, high]| !(low.is_finite() && high.is_finite() && low < high)) {
            faults.add(format!(
                "outline_mm.{key} = [{low}, {high}], must be two finite numbers, the first less than the second"
            ));
        }
    }
}

fn check_bounds(table: &DesignTable, vary: Variables, faults: &mut TableFaults) {
    let ranges = [
        ("thickness_mm", "thickness", vary.thickness, table.thickness_mm, f64::MIN_POSITIVE, "0 < min <= max"),
        ("strength_t", "strength", vary.strength, table.strength_t, 0.0, "0 <= min <= max"),
    ];
    for (key, variable, varies, bounds, least, rule) in ranges {
        match bounds {
            Some(MinMax { min, max }) if !(min >= least && min <= max && max.is_finite()) => {
                faults.add(format!("{key} = {{ min = {min}, max = {max} }}, must be finite with {rule}"));
            }
            None if varies => {
                faults.add(format!("vary names {variable}, so {key} = {{ min = ..., max = ... }} must be given"));
            }
            _ => {}
        }
    }
    if let Some(MinMax { max, .. }) = table.strength_t {
        check_material("strength_t.max", max, faults);
    }
}

fn check_parts(table: &DesignTable, vary: Variables, faults: &mut TableFaults) {
    if table.parts.is_some() || !table.stock.is_empty() {
        if !(vary.size && vary.position) {
            faults.add("parts or stock is given, so vary must name size and position: the search exchanges sizes");
        }
        if vary.tilt {
            faults.add("parts or stock is given, so vary must not name tilt: parts are polarized in the film plane");
        }
    }
    if table.parts == Some(0) {
        faults.add("parts = 0, must be at least 1");
    }
    if let Some(parts) = table.parts.filter(|parts| *parts < table.stock.len()) {
        faults.add(format!("parts = {parts}, must not be less than the {} parts of the stock", table.stock.len()));
    }
    for (index, part) in table.stock.iter().enumerate() {
        if !part.size_mm.iter().all(|side| side.is_finite() && *side > 0.0) {
            faults
                .add(format!("stock[{index}].size_mm = {:?}, must be two finite numbers greater than 0", part.size_mm));
        }
        check_finite(&format!("stock[{index}].direction_deg"), part.direction_deg, faults);
    }
    for (index, strength) in table.stock_strengths_t.iter().enumerate() {
        let key = format!("stock_strengths_t[{index}]");
        check_not_negative(&key, *strength, faults);
        check_material(&key, *strength, faults);
    }
    if !table.stock_strengths_t.is_empty() && !vary.strength {
        faults.add("stock_strengths_t is given, so vary must name strength");
    }
}
