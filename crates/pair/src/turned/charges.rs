//! Force and torque of two cuboids turned against each other.
//!
//! Gauss-Legendre rules integrate the charges J . n of the faces of the smaller cuboid in the exact
//! field of the larger cuboid, on panels that are halved until the integral does not change. Fields
//! have logarithmic singularities on edges, so panels are halved across the direction of the
//! largest change of the integral.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use glam::DVec3;
use magsplice_field::Scene;
use magsplice_magnet::{MU_0, Quantity, Tile};

use super::{TurnedBox, scene_of};
use crate::gauss::LEGENDRE_8;
use crate::load::Load;
use crate::not_converged::{NotConverged, PairIntegral};
use crate::tolerances::{MOST_PANELS, OUTSIDE};

/// The load on `first` by `second`, in the frame of the scene.
pub(crate) fn load(first: &Tile, second: &Tile, tolerance: f64) -> Result<Load, NotConverged> {
    if first.size().element_product() <= second.size().element_product() {
        load_in_field(first, second, tolerance)
    } else {
        let on_second = load_in_field(second, first, tolerance)?;
        Ok(on_second.reaction(second.position() - first.position()))
    }
}

/// The load on `charged` in the field of `source`.
fn load_in_field(charged: &Tile, source: &Tile, tolerance: f64) -> Result<Load, NotConverged> {
    let field = SourceField::new(source);
    let TurnedBox { centre: offset, sides } = TurnedBox::in_frame_of(source, charged);
    let arm = 0.5 * charged.size().length();
    let mut panels = BinaryHeap::new();
    for axis in 0..3 {
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        for sign in [-1.0, 1.0] {
            let charge_t = sign * charged.polarization_t()[axis];
            if charge_t == 0.0 {
                continue;
            }
            let area = Area { charge_t, lever: sign * sides[axis], sides: [sides[u], sides[v]] };
            panels.push(Panel::new(area, offset, arm, &field));
        }
    }
    let (mut error, mut magnitude) = totals(panels.iter());
    while !panels.is_empty() && !(error <= tolerance * magnitude) {
        if panels.len() >= MOST_PANELS || !error.is_finite() {
            return Err(NotConverged { integral: PairIntegral::Load, reached: error / magnitude, tolerance });
        }
        if let Some(panel) = panels.pop() {
            let halves = panel.area.halves(panel.across).map(|area| Panel::new(area, offset, arm, &field));
            let (halves_error, halves_magnitude) = totals(halves.iter());
            error += halves_error - panel.error;
            magnitude += halves_magnitude - panel.magnitude;
            panels.extend(halves);
        }
    }
    // Summed in an order independent of the arrangement of the heap.
    let sum = panels.into_sorted_vec().iter().fold(Load::ZERO, |sum, panel| sum + panel.load);
    let to_scene = |vector: DVec3| source.rotation() * vector / MU_0;
    Ok(Load { force: to_scene(sum.force), torque: to_scene(sum.torque) })
}

/// Sums of errors and of magnitudes.
fn totals<'a>(panels: impl Iterator<Item = &'a Panel>) -> (f64, f64) {
    panels.fold((0.0, 0.0), |(error, magnitude), panel| (error + panel.error, magnitude + panel.magnitude))
}

/// A rectangle with a uniform charge, in the frame of the source.
#[derive(Clone, Copy)]
struct Area {
    charge_t: f64,
    /// Vector from the centre of the tile to the centre of the rectangle.
    lever: DVec3,
    /// Vectors from the centre of the rectangle to the middle of two of its edges.
    sides: [DVec3; 2],
}

impl Area {
    fn halves(&self, across: usize) -> [Area; 2] {
        let mut sides = self.sides;
        sides[across] *= 0.5;
        [-1.0, 1.0].map(|sign| Area { lever: self.lever + sign * sides[across], sides, ..*self })
    }

    fn levers(&self) -> impl Iterator<Item = (DVec3, f64)> {
        let area = 4.0 * self.sides[0].length() * self.sides[1].length();
        LEGENDRE_8.iter().flat_map(move |(u, weight_u)| {
            LEGENDRE_8.iter().map(move |(v, weight_v)| {
                (self.lever + *u * self.sides[0] + *v * self.sides[1], area * weight_u * weight_v)
            })
        })
    }
}

/// A rectangle, and the load on it.
struct Panel {
    area: Area,
    /// mu0 times force and torque.
    load: Load,
    /// Change of the load by halving the rectangle, both ways; torques are divided by half the
    /// diagonal of the tile.
    error: f64,
    /// Integral of |J . n| mu0 |H|.
    magnitude: f64,
    /// The side whose halving changes the load most.
    across: usize,
}

impl Panel {
    fn new(area: Area, offset: DVec3, arm: f64, field: &SourceField) -> Panel {
        let (whole, magnitude) = field.load_on(&[area], offset);
        let changes = [0, 1].map(|across| field.load_on(&area.halves(across), offset).0 + -whole);
        let errors = changes.map(|change| change.force.length() + change.torque.length() / arm);
        Panel {
            area,
            load: whole + changes[0] + changes[1],
            error: errors[0] + errors[1],
            magnitude,
            across: usize::from(errors[1] > errors[0]),
        }
    }
}

impl PartialEq for Panel {
    fn eq(&self, other: &Panel) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Panel {}

impl PartialOrd for Panel {
    fn partial_cmp(&self, other: &Panel) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Panel {
    /// Ordered by error, then by position.
    fn cmp(&self, other: &Panel) -> Ordering {
        let key = |panel: &Panel| [panel.error, panel.area.lever.x, panel.area.lever.y, panel.area.lever.z];
        let pairs = key(self).into_iter().zip(key(other));
        pairs.fold(Ordering::Equal, |order, (a, b)| order.then(a.total_cmp(&b)))
    }
}

/// mu0 H of the source in its own frame, outside it.
struct SourceField {
    scene: Scene,
    half: DVec3,
    outside: f64,
}

impl SourceField {
    fn new(source: &Tile) -> SourceField {
        let half = 0.5 * source.size();
        SourceField { scene: scene_of(source, source.polarization_t()), half, outside: OUTSIDE * half.max_element() }
    }

    /// mu0 times force and torque on charged rectangles, and the integral of magnitudes.
    fn load_on(&self, areas: &[Area], offset: DVec3) -> (Load, f64) {
        let (mut load, mut magnitude) = (Load::ZERO, 0.0);
        for area in areas {
            let points: Vec<DVec3> = area.levers().map(|(lever, _)| self.outwards(offset + lever)).collect();
            let Ok(field) = self.scene.field_at(Quantity::FluxDensity, &points) else {
                return (Load { force: DVec3::NAN, torque: DVec3::NAN }, f64::NAN);
            };
            for ((lever, weight), b_t) in area.levers().zip(field) {
                let force = area.charge_t * weight * b_t;
                load += Load { force, torque: lever.cross(force) };
                magnitude += force.length();
            }
        }
        (load, magnitude)
    }

    /// Moves a point that is on a face up to round-off out of the tile.
    fn outwards(&self, point: DVec3) -> DVec3 {
        let beyond = point.abs() - self.half;
        let axis = beyond.max_position();
        let mut moved = point;
        if beyond[axis].abs() < self.outside {
            moved[axis] = (self.half[axis] + self.outside).copysign(point[axis]);
        }
        moved
    }
}

#[cfg(test)]
mod tests {
    use glam::{DQuat, EulerRot};

    use super::*;
    use crate::aligned_pair::AlignedPair;
    use crate::closed_form;
    use crate::double_double::DoubleDouble;

    const TOLERANCE: f64 = 1e-10;

    fn tile(size: [f64; 3], polarization_t: [f64; 3], position: [f64; 3]) -> Tile {
        Tile::new(position.into(), size.into(), polarization_t.into()).unwrap()
    }

    fn assert_close(a: Load, b: Load, what: &str) {
        let change = a + -b;
        let error = change.force.length().max(change.torque.length()) / b.force.length().max(b.torque.length());
        assert!(error < 10.0 * TOLERANCE, "{what}: {error:e}, {a:?} {b:?}");
    }

    /// The integral over charges agrees with the closed form for tiles with parallel edges, apart
    /// and side by side.
    #[test]
    fn integral_agrees_with_the_closed_form() {
        let first = tile([1.0, 1.5, 1.0], [0.4, -0.3, 0.9], [0.0; 3]);
        for position in [[2.0, 0.5, 0.25], [1.25, 0.25, 0.0], [1.25, 0.25, 0.125]] {
            let second = tile([1.5, 2.0, 1.0], [-0.2, 0.8, 0.5], position);
            let pair = AlignedPair::new(&first, &second).unwrap();
            let exact = closed_form::load::<DoubleDouble>(&pair);
            let length = 1.0 / pair.scale;
            let exact = Load { force: exact.force * length.powi(2), torque: exact.torque * length.powi(3) };
            assert_close(load(&first, &second, TOLERANCE).unwrap(), exact, "closed form");
        }
    }

    /// The charges of either tile in the field of the other give the same pair of forces.
    #[test]
    fn either_tile_may_be_the_source() {
        let rotation = DQuat::from_euler(EulerRot::XYZ, 0.3, -0.7, 1.1);
        let first = tile([1.0, 1.5, 0.75], [0.4, -0.3, 0.9], [0.0; 3]);
        for position in [[1.6, 1.0, 0.25], [-20.0, 30.0, 5.0]] {
            let second = tile([1.5, 2.0, 1.0], [-0.2, 0.8, 0.5], position).rotated(rotation).unwrap();
            let direct = load_in_field(&first, &second, TOLERANCE).unwrap();
            let reaction = load_in_field(&second, &first, TOLERANCE).unwrap().reaction(second.position());
            assert_close(direct, reaction, "reaction");
        }
    }
}
