//! The flat iron of a layout in words.

use std::fmt;

use magsplice_layout::Layout;
use magsplice_magnet::{Axis, IronPlane};

/// The flat iron of a layout. Displayed as "z > 1.5 mm" for a plane normal to an axis, by a point
/// and the normal for any other, each with its permeability if it is finite.
#[derive(Clone, Debug, PartialEq)]
pub struct IronSummary {
    planes: Vec<IronPlane>,
}

impl IronSummary {
    /// The iron of a layout. `None` without planes.
    pub fn of(layout: &Layout) -> Option<IronSummary> {
        (!layout.iron.is_empty()).then(|| IronSummary { planes: layout.iron.planes().to_vec() })
    }

    /// Each plane in words.
    pub fn planes(&self) -> impl Iterator<Item = String> {
        self.planes.iter().map(|plane| {
            let (point, normal) = (plane.point(), plane.normal());
            let is_along = |axis: &Axis| normal.abs() == axis.unit();
            let place = match Axis::ALL.into_iter().find(is_along) {
                Some(axis) => {
                    let side = if normal[axis.index()] < 0.0 { ">" } else { "<" };
                    format!("{axis} {side} {} mm", point[axis.index()])
                }
                None => format!(
                    "behind ({}, {}, {}) mm, normal ({:.3}, {:.3}, {:.3})",
                    point.x, point.y, point.z, normal.x, normal.y, normal.z
                ),
            };
            match plane.relative_permeability() {
                f64::INFINITY => place,
                mu_r => format!("{place}, mu_r {mu_r}"),
            }
        })
    }
}

impl fmt::Display for IronSummary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.planes().collect::<Vec<_>>().join("; "))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn planes_are_named_by_their_place() {
        let plane = |rest: &str| format!("[[plane]]\n{rest}\n");
        let words = |planes: &str| {
            let tile = "[[tile]]\nposition_mm = [0, 0, 0]\nsize_mm = [1, 1, 1]\npolarization_t = [1, 0, 0]\n";
            let text = format!("format = 1\nname = \"plated\"\n{tile}{planes}");
            IronSummary::of(&Layout::parse(&text, "layout").unwrap()).map(|iron| iron.to_string())
        };
        let above = plane("point_mm = [0, 0, 1.5]\nnormal = [0, 0, -2]");
        let below = plane("point_mm = [7, 0, -9]\nnormal = [0, 0, 1]\nrelative_permeability = 100");
        assert_eq!(words(""), None);
        assert_eq!(words(&(above + &below)).as_deref(), Some("z > 1.5 mm; z < -9 mm, mu_r 100"));
        let tilted = plane("point_mm = [0, 1, 2]\nnormal = [0, -0.6, -0.8]");
        assert_eq!(words(&tilted).as_deref(), Some("behind (0, 1, 2) mm, normal (0.000, -0.600, -0.800)"));
    }
}
