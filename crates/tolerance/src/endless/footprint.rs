//! Footprints of tiles within one period, and their Fourier transforms.

use glam::{DVec2, DVec3};
use magsplice_magnet::Tile;

/// The largest sine of the angle between the normal of the film and an axis of a tile whose faces
/// are taken as parallel to the film: rounding of a rotation of many steps.
const LARGEST_TILT: f64 = 1e-9;

/// A part of a tile: a convex polygon in the plane of the film, of uniform thickness and
/// polarization.
#[derive(Clone, Debug)]
pub(super) struct Footprint {
    /// Corners, counterclockwise.
    corners: Vec<DVec2>,
    /// Ends along z.
    pub(super) ends: [f64; 2],
    /// Polarization in the frame of the film.
    pub(super) j_t: DVec3,
}

impl Footprint {
    /// The footprint of a tile; `None` if no axis of the tile is normal to the film.
    pub(super) fn new(tile: &Tile) -> Option<Footprint> {
        let axes = DVec3::AXES.map(|axis| tile.rotation() * axis);
        let upright = (0..3).find(|&axis| axes[axis].truncate().length() <= LARGEST_TILT)?;
        let (first, second) = ((upright + 1) % 3, (upright + 2) % 3);
        let half = |axis: usize| 0.5 * tile.size()[axis] * axes[axis].truncate();
        let (u, v) = (half(first), half(second));
        // Counterclockwise seen from above.
        let v = if u.perp_dot(v) < 0.0 { -v } else { v };
        let centre = tile.position();
        let corners = [-u - v, u - v, u + v, v - u].map(|corner| centre.truncate() + corner).to_vec();
        let height = 0.5 * tile.size()[upright];
        Some(Footprint { corners, ends: [centre.z - height, centre.z + height], j_t: tile.scene_polarization_t() })
    }

    /// The part within a square about the origin; `None` if none has an area.
    pub(super) fn within(mut self, half_side: f64) -> Option<Footprint> {
        for (axis, sign) in [(0, 1.0), (0, -1.0), (1, 1.0), (1, -1.0)] {
            let inside = |corner: &DVec2| half_side - sign * corner[axis];
            let mut kept = Vec::with_capacity(self.corners.len() + 1);
            for (from, to) in self.edges() {
                let (d_from, d_to) = (inside(&from), inside(&to));
                if d_from >= 0.0 {
                    kept.push(from);
                }
                if (d_from > 0.0 && d_to < 0.0) || (d_from < 0.0 && d_to > 0.0) {
                    kept.push(from + (to - from) * (d_from / (d_from - d_to)));
                }
            }
            self.corners = kept;
        }
        (self.area() > 0.0).then_some(self)
    }

    /// Area.
    pub(super) fn area(&self) -> f64 {
        0.5 * self.edges().map(|(from, to)| from.perp_dot(to)).sum::<f64>()
    }

    /// The integral of e^(-i q r) over the polygon, real and imaginary part, for q other than 0: by
    /// the divergence theorem a sum over its edges (docs/physics.md, Eq. P60).
    pub(super) fn transform(&self, q: DVec2) -> [f64; 2] {
        let (mut real, mut imaginary) = (0.0, 0.0);
        for (from, to) in self.edges() {
            let along = to - from;
            let half_phase = 0.5 * q.dot(along);
            let sinc = if half_phase == 0.0 { 1.0 } else { half_phase.sin() / half_phase };
            let flux = q.perp_dot(along) * sinc;
            let (sine, cosine) = (0.5 * q.dot(from + to)).sin_cos();
            // i e^(-i phase) = sin + i cos.
            real += flux * sine;
            imaginary += flux * cosine;
        }
        let square = q.length_squared();
        [real / square, imaginary / square]
    }

    fn edges(&self) -> impl Iterator<Item = (DVec2, DVec2)> {
        let next = self.corners.iter().cycle().skip(1);
        self.corners.iter().zip(next).map(|(from, to)| (*from, *to))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DQuat;

    fn footprint(position: DVec3, size: DVec3, rotation: DQuat) -> Option<Footprint> {
        Footprint::new(&Tile::new(position, size, DVec3::X).and_then(|tile| tile.rotated(rotation)).expect("a tile"))
    }

    /// The transform of a rectangle is its area, times a phase, times two sincs.
    #[test]
    fn transform_of_a_rectangle_is_a_product_of_sincs() {
        let turn = DQuat::from_rotation_x(std::f64::consts::FRAC_PI_2);
        // On its side: its own y is upright.
        let found = footprint(DVec3::new(0.3, -0.7, 0.5), DVec3::new(2.0, 1.0, 3.0), turn).expect("upright");
        assert!((found.area() - 6.0).abs() < 1e-12 && found.ends == [0.0, 1.0], "{found:?}");
        for q in [DVec2::new(0.6, 0.0), DVec2::new(-1.3, 2.1), DVec2::new(0.0, -5.0)] {
            let sinc = |x: f64| if x == 0.0 { 1.0 } else { x.sin() / x };
            let magnitude = 6.0 * sinc(q.x) * sinc(1.5 * q.y);
            let phase = q.dot(DVec2::new(0.3, -0.7));
            let [real, imaginary] = found.transform(q);
            assert!(
                (real - magnitude * phase.cos()).abs() < 1e-13 && (imaginary + magnitude * phase.sin()).abs() < 1e-13
            );
        }
    }

    #[test]
    fn footprints_are_cut_at_the_border_of_the_square() {
        let area = |position, rotation: f64, half_side| {
            footprint(position, DVec3::new(2.0, 2.0, 1.0), DQuat::from_rotation_z(rotation))
                .and_then(|found| found.within(half_side))
                .map(|found| found.area())
        };
        let eighth = std::f64::consts::FRAC_PI_4;
        assert_eq!(area(DVec3::new(5.0, 0.0, 0.0), 0.0, 5.0), Some(2.0));
        assert_eq!(area(DVec3::new(-5.0, 5.0, 0.0), 0.0, 5.0), Some(1.0));
        assert_eq!(area(DVec3::new(6.0, 0.0, 0.0), 0.0, 5.0), None);
        assert_eq!(area(DVec3::new(9.0, 0.0, 0.0), 0.0, 5.0), None);
        // Half of a square that stands on its corner, and all but one corner of it.
        let half = area(DVec3::new(5.0, 0.0, 0.0), eighth, 5.0).expect("a triangle");
        assert!((half - 2.0).abs() < 1e-12, "{half}");
        let most = area(DVec3::new(4.0, 0.0, 0.0), eighth, 5.0).expect("five corners");
        assert!((most - (4.0 - (2.0_f64.sqrt() - 1.0).powi(2))).abs() < 1e-12, "{most}");
        let whole = area(DVec3::new(0.0, 0.0, 0.0), eighth, 5.0).expect("inside");
        assert!((whole - 4.0).abs() < 1e-12, "{whole}");
    }

    #[test]
    fn tilted_tiles_have_no_footprint() {
        assert!(footprint(DVec3::ZERO, DVec3::ONE, DQuat::from_rotation_x(1e-4)).is_none());
        assert!(
            footprint(
                DVec3::ZERO,
                DVec3::ONE,
                DQuat::from_rotation_z(1.0) * DQuat::from_rotation_y(std::f64::consts::PI)
            )
            .is_some()
        );
    }
}
