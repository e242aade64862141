//! A film cut along lines: one tile for each cell of a lattice whose pattern does not vanish.

use glam::DVec3;

use crate::layout::NamedTile;
use crate::resolve::{MAX_TILES, checked_tile};
use crate::written::{Lattice, Stretch};

/// One interval of a lattice along one axis.
struct Cell {
    centre: f64,
    width: f64,
    pattern: f64,
}

pub(crate) fn tiles(lattice: &Lattice, name: &str, tiles: &mut Vec<NamedTile>, report: &mut dyn FnMut(String)) {
    let strength = match (lattice.strength_t, lattice.component_t) {
        (Some(strength), None) => Strength::Magnitude(strength),
        (None, Some(component)) => Strength::Component(component),
        _ => {
            return report(
                "must give one of strength_t (|J| of every tile) and component_t (times the pattern)".to_owned(),
            );
        }
    };
    let (key, value) = match strength {
        Strength::Magnitude(value) => ("strength_t", value),
        Strength::Component(value) => ("component_t", value),
    };
    if !(value.is_finite() && value >= 0.0) {
        report(format!("{key} = {value}, must be a finite number of at least 0"));
    }
    let x = cells(&lattice.x, lattice.start_mm[0], "x", report);
    let y = match &lattice.y {
        Some(y) => cells(y, lattice.start_mm[1], "y", report),
        // The same cut along both axes; what is wrong with it has been said once.
        None => cells(&lattice.x, lattice.start_mm[1], "x", &mut |_| {}),
    };
    if !(lattice.height_mm > 0.0) {
        report(format!("height_mm = {}, must be greater than 0", lattice.height_mm));
        return;
    }
    let (Some(x), Some(y)) = (x, y) else { return };
    if x.len().saturating_mul(y.len()) > MAX_TILES {
        report(format!("has {} x {} cells, must have at most {MAX_TILES}", x.len(), y.len()));
        return;
    }
    if x.iter().chain(&y).all(|cell| cell.pattern == 0.0) {
        report("has no tiles: pattern is zero everywhere".to_owned());
        return;
    }
    let z = lattice.start_mm[2] + 0.5 * lattice.height_mm;
    for (i, column) in x.iter().enumerate() {
        for (j, row) in y.iter().enumerate() {
            let pattern = DVec3::new(column.pattern, row.pattern, 0.0);
            if pattern == DVec3::ZERO {
                continue;
            }
            let polarization = match strength {
                Strength::Magnitude(strength) => (pattern / pattern.abs().max_element()).normalize() * strength,
                Strength::Component(component) => pattern * component,
            };
            let position = DVec3::new(column.centre, row.centre, z);
            let size = DVec3::new(column.width, row.width, lattice.height_mm);
            let Some(tile) = checked_tile(position, size, polarization, report) else { return };
            tiles.push(NamedTile { name: format!("{name}-x{}-y{}", i + 1, j + 1), kind: None, rotation: None, tile });
        }
    }
}

#[derive(Clone, Copy)]
enum Strength {
    /// |J|, along the pattern.
    Magnitude(f64),
    /// J is this times the pattern.
    Component(f64),
}

/// Reads one axis; reports what is wrong with it and returns nothing then.
fn cells(stretches: &[Stretch], start: f64, axis: &str, report: &mut dyn FnMut(String)) -> Option<Vec<Cell>> {
    let mut sound = true;
    let mut complain = |message: String| {
        sound = false;
        report(message);
    };
    for (index, stretch) in stretches.iter().enumerate() {
        let key = format!("{axis}[{index}]");
        let (widths, pattern) = (stretch.widths_mm.len(), stretch.pattern.len());
        if widths != pattern {
            complain(format!("{key} has {widths} widths_mm and {pattern} pattern entries, must have as many of each"));
        }
        for (n, width) in stretch.widths_mm.iter().enumerate() {
            if !(width.is_finite() && *width > 0.0) {
                complain(format!("{key}.widths_mm[{n}] = {width}, must be a finite number greater than 0"));
            }
        }
        for (n, pattern) in stretch.pattern.iter().enumerate().filter(|(_, p)| !p.is_finite()) {
            complain(format!("{key}.pattern[{n}] = {pattern}, must be a finite number"));
        }
        if stretch.times.is_some_and(|times| times == 0 || times.saturating_mul(widths) > MAX_TILES) {
            complain(format!("{key}.times = {}, must be between 1 and {MAX_TILES} cells", stretch.times.unwrap_or(0)));
        }
    }
    if !start.is_finite() {
        complain(format!("start_mm of {axis} = {start}, must be a finite number"));
    }
    if stretches.iter().all(|stretch| stretch.widths_mm.is_empty()) {
        complain(format!("{axis} has no cells"));
    }
    if !sound {
        return None;
    }
    let mut edge = Edge { at: start, carry: 0.0 };
    let repeated = stretches.iter().flat_map(|stretch| std::iter::repeat_n(stretch, stretch.times.unwrap_or(1)));
    let mut cells = Vec::new();
    for stretch in repeated {
        for (&width, &pattern) in stretch.widths_mm.iter().zip(&stretch.pattern) {
            let low = edge.value();
            edge.advance(width);
            cells.push(Cell { centre: 0.5 * (low + edge.value()), width, pattern });
        }
    }
    Some(cells)
}

/// A cut line reached by adding widths. Compensated (Neumaier), so that decimal widths add up to the decimal cut.
struct Edge {
    at: f64,
    carry: f64,
}

impl Edge {
    fn value(&self) -> f64 {
        self.at + self.carry
    }

    fn advance(&mut self, width: f64) {
        let next = self.at + width;
        let width_part = next - self.at;
        self.carry += (self.at - (next - width_part)) + (width - width_part);
        self.at = next;
    }
}
