//! The position of a tile's corners and planes in the tables of its cluster, and the groups of its
//! elements.

use magsplice_cuboid::closed_form::terms::Terms;

/// Where a tile's corners and planes are in the tables, and the groups its elements belong to.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TileTerms {
    /// Bits 2, 1, 0: low or high along a, b, c.
    pub(crate) corners: [u16; 8],
    /// Low and high plane along a, b, c.
    pub(crate) planes: [u16; 6],
    /// By element; [`NO_GROUP`] where it is not needed, [`OWN`] where no other tile's has its strength.
    pub(crate) groups: [u16; 6],
    /// Whether there is such an element.
    pub(crate) has_own: bool,
    /// The axes a, b, c.
    pub(crate) axes: [usize; 3],
    /// By element: what one unit of half of 4 pi T adds to mu0 H, in tesla.
    pub(crate) coefficients: [[f64; 3]; 6],
    /// Off the diagonal the length of the edges times the size across, on it the area of the faces. Scaled, with the sign of the term.
    pub(crate) factors: [f64; 6],
    /// Squares of the sizes along a, b, c, scaled.
    pub(crate) squares: [f64; 3],
}

/// See [`TileTerms::groups`].
pub(crate) const NO_GROUP: u16 = u16::MAX;
/// See [`TileTerms::groups`].
pub(crate) const OWN: u16 = u16::MAX - 1;

impl TileTerms {
    /// With planes low and high along x, y, z, and corners whose bits 2, 1, 0 are set if high along x, y, z.
    pub(super) fn new(terms: &Terms, planes: [[u16; 2]; 3], corners: [u16; 8], groups: [u16; 6]) -> TileTerms {
        let [a, b, c] = terms.axes;
        TileTerms {
            corners: [0, 1, 2, 3, 4, 5, 6, 7].map(|bits: usize| {
                corners[(bits >> 2) << (2 - a) | (bits >> 1 & 1) << (2 - b) | (bits & 1) << (2 - c)]
            }),
            planes: [0, 1, 2, 3, 4, 5].map(|n: usize| planes[terms.axes[n / 2]][n % 2]),
            groups,
            has_own: false,
            axes: terms.axes,
            coefficients: [0, 1, 2, 3, 4, 5].map(|element| terms.group(element).coefficient),
            factors: terms.factors,
            squares: terms.squares,
        }
    }
}
