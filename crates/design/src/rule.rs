//! Rules of a brief, with the names of their tiles.

use std::fmt;

/// A rule that no film near the one of the layout keeps together with the others.
#[derive(Clone, Debug, PartialEq)]
pub struct Rule {
    /// Names of its tiles.
    pub tiles: Vec<String>,
    /// The demand on them.
    pub demand: Demand,
}

/// A demand on tiles. Lengths in millimetres, polarization in tesla.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Demand {
    /// Least length of each side.
    Side(f64),
    /// Ends of the outline along x and y.
    Outline([[f64; 2]; 2]),
    /// Bounds of the thickness.
    Thickness([f64; 2]),
    /// Bounds of the strength.
    Strength([f64; 2]),
    /// Least distance of two tiles.
    Apart(Gap),
    /// Distinct parts are as few as the brief asks for, while tiles keep their distance.
    FewParts,
}

/// Least distance of neighbouring tiles, in millimetres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gap {
    /// The distance, with an allowance for the rounding of positions.
    pub least_mm: f64,
    /// The gap of the brief.
    pub gap_mm: f64,
    /// The resolution of the brief.
    pub resolution_mm: f64,
}

impl fmt::Display for Rule {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.tiles[..] {
            [] => {}
            [tile] => write!(f, "tile \"{tile}\": ")?,
            tiles => write!(f, "tiles \"{}\": ", tiles.join("\" and \""))?,
        }
        match self.demand {
            Demand::Side(least_mm) => write!(f, "a side must be at least {least_mm} mm"),
            Demand::Outline([x, y]) => write!(f, "must stay within outline_mm, x = {x:?}, y = {y:?}"),
            Demand::Thickness(within_mm) => write!(f, "its thickness must be within {within_mm:?} mm"),
            Demand::Strength(within_t) => write!(f, "its strength must be within {within_t:?} T"),
            Demand::Apart(Gap { least_mm, gap_mm, resolution_mm }) => {
                write!(f, "must be at least {least_mm} mm apart")?;
                if least_mm == gap_mm {
                    return Ok(());
                }
                write!(f, ": gap_mm = {gap_mm}, and resolution_mm = {resolution_mm} for the rounding of positions")
            }
            Demand::FewParts => f.write_str("distinct parts must be so few, and tiles keep their distance"),
        }
    }
}
