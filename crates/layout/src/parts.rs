//! The bill of materials: how many identical pieces of magnet a layout needs of each sort.

use glam::DVec3;
use magsplice_magnet::{Piece, pieces};

use crate::layout::Layout;
use crate::units::decimals;

/// One sort of identical pieces: tiles that differ only in position and orientation.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// Number of such pieces in the layout.
    pub count: usize,
    /// Side lengths in millimetres. The third is the z side of the first such tile; of the other
    /// two the longer comes first.
    pub size_mm: DVec3,
    /// Magnitude of the polarization, in tesla.
    pub strength_t: f64,
    /// Unit vector of the polarization along these sides, or zero without polarization.
    pub direction: DVec3,
    /// Name of the first such tile.
    pub example: String,
    /// Indices of all such tiles in the layout, in ascending order.
    pub tiles: Vec<usize>,
}

impl Layout {
    /// The bill of materials, largest pieces first.
    ///
    /// Two tiles are the same part if a rotation maps one onto the other, polarization included. A
    /// tile turned upside down to reverse its polarization is therefore the same part, and its
    /// mirror image is another one.
    ///
    /// # Example
    /// ```
    /// use magsplice_layout::{COMMENTED_LAYOUT, Layout};
    ///
    /// let parts = Layout::parse(COMMENTED_LAYOUT, "commented")?.parts();
    /// let counts: Vec<usize> = parts.iter().map(|part| part.count).collect();
    /// assert_eq!(counts, [16, 24, 16]); // squares, strips, narrow strips at the rim
    /// # Ok::<(), magsplice_layout::LayoutError>(())
    /// ```
    pub fn parts(&self) -> Vec<Part> {
        let part = |Piece { size, strength_t, direction, tiles }| {
            let (count, example) = (tiles.len(), self.tiles[tiles[0]].name.clone());
            Part { count, size_mm: size, strength_t, direction, example, tiles }
        };
        pieces(&self.bare_tiles()).into_iter().map(part).collect()
    }
}

impl Part {
    /// Angle of the polarization in the plane of the first two sides, from the first towards the
    /// second, and out of this plane towards the third, in degrees. `None` without polarization.
    ///
    /// The angles have six decimals, because directions of parts have nine digits.
    pub fn angles_deg(&self) -> Option<[f64; 2]> {
        let DVec3 { x, y, z } = self.direction;
        let in_degrees = |angle: f64| decimals(angle.to_degrees(), ANGLE_DECIMALS);
        (self.direction != DVec3::ZERO).then(|| [in_degrees(y.atan2(x)), in_degrees(z.atan2(x.hypot(y)))])
    }
}

/// Decimals of angles of parts, in degrees.
const ANGLE_DECIMALS: usize = 6;
