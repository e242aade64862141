//! Units that are given by mistake.

/// Units of positions, and their lengths in the unit of the tiles.
pub(crate) const LENGTHS: [(&str, f64); 4] =
    [("inches", 25.4), ("centimetres", 10.0), ("metres", 1e3), ("micrometres", 1e-3)];

/// Units of flux densities over the stated one, with an example.
pub const FLUX_DENSITIES: [(f64, &str); 8] = [
    (1e-3, "uT in a column of mT"),
    (1e3, "mT in a column of uT, or T in one of mT"),
    (0.1, "gauss in a column of mT"),
    (10.0, "mT in a column of gauss"),
    (1e-4, "gauss in a column of T"),
    (1e4, "T in a column of gauss"),
    (1e-6, "uT in a column of T"),
    (1e6, "T in a column of uT"),
];
