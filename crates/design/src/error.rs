//! Why a film cannot be designed.

use std::error::Error;
use std::fmt;

use glam::DVec3;
use magsplice_decouple::DecouplingError;
use magsplice_ideal::ComparisonError;
use magsplice_recoil::RecoilError;

use crate::tolerances::MAX_LISTED;

/// Why a film cannot be designed. Messages name tiles and give lengths in millimetres.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum DesignError {
    /// The layout lacks this table.
    Missing(&'static str),
    /// Some tiles have no image under the symmetry of the brief.
    NotSymmetric {
        /// Names of these tiles.
        tiles: Vec<String>,
        /// Where the film lies, if it is not centred on 0, so that most tiles have no image.
        off_centre: Option<String>,
    },
    /// The brief counts the films that are made, and its goal is not the displacement.
    NotDisplacement,
    /// These tiles are rotated, and the brief lets sizes or positions vary or has a symmetry.
    Rotated(Vec<String>),
    /// The brief and the symmetry leave no number free.
    NothingFree,
    /// No film near the layout's keeps these rules together.
    Contradiction(Vec<String>),
    /// The film found, rounded to the resolution of the brief, is no film.
    Resolution {
        /// The resolution of lengths, in millimetres.
        resolution_mm: f64,
        /// The resolution of angles, in degrees.
        resolution_deg: f64,
        /// Rule that the rounded film breaks.
        reason: String,
    },
    /// This point of the working volume, in millimetres, is not below the film.
    NotBelow(DVec3),
    /// The film to start from has no field at some point, which lies on an edge of a tile.
    NoField,
    /// The film to start from has no decoupling parameters.
    Decoupling(DecouplingError),
    /// The field of a film cannot be compared with the ideal one.
    Comparison(ComparisonError),
    /// The polarization of tiles with a recoil permeability is not known.
    Recoil(RecoilError),
    /// B_z vanishes at a point of the design grid.
    Singular,
    /// Numbers of a [`SpliceRequest`](crate::SpliceRequest) are out of range, each given as value
    /// and rule.
    Request(Vec<String>),
}

impl DesignError {
    pub(crate) fn no_parts() -> DesignError {
        DesignError::Contradiction(vec!["distinct parts must be so few, and tiles keep their distance".to_owned()])
    }
}

impl fmt::Display for DesignError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            DesignError::Missing("design") => f.write_str(
                "the layout has no [design] table, which design needs: add one, at the least the line \
                 `design = { vary = [\"size\", \"position\", \"direction\"] }` below the name",
            ),
            DesignError::Missing(table) => write!(f, "the layout has no [{table}] table, which design needs: add one"),
            DesignError::NotSymmetric { tiles, off_centre } => write!(
                f,
                "{}tiles without an image under the symmetry of [design]: {}; add the images (arrows are mirrored like \
                 drawn ones), or ask for less symmetry",
                off_centre.as_ref().map_or(String::new(), |reason| format!("{reason}: ")),
                listed(tiles, ", ")
            ),
            DesignError::NotDisplacement => f.write_str(
                "under = \"tolerance\" of [design] needs goal = \"displacement\": the films with the smallest errors of \
                 other kinds are those whose parameters change little with the displacement",
            ),
            DesignError::Rotated(tiles) => write!(
                f,
                "rotated tiles: {}; sizes, positions and symmetries are for tiles along x and y: give these unrotated, \
                 or let only directions and strengths vary",
                listed(tiles, ", ")
            ),
            DesignError::NothingFree => {
                f.write_str("0 free numbers in this film under the vary and symmetry of [design], must be at least 1")
            }
            DesignError::Contradiction(rules) => {
                let rules = listed(rules, "\n  ");
                write!(f, "these rules of [design] cannot be kept together by a film like this one:\n  {rules}")
            }
            DesignError::Resolution { resolution_mm, resolution_deg, reason } => write!(
                f,
                "rounding to resolution_mm = {resolution_mm} and resolution_deg = {resolution_deg} of [design] leaves no \
                 film: {reason}; choose a finer resolution"
            ),
            DesignError::NotBelow(p) => write!(
                f,
                "the point ({}, {}, {}) mm of the working volume is not below the film: lower z_mm or reference_mm of \
                 [volume]",
                p.x, p.y, p.z
            ),
            DesignError::NoField => {
                f.write_str("a point of the working volume lies on an edge of a tile: lower z_mm of [volume]")
            }
            DesignError::Decoupling(error) => error.fmt(f),
            DesignError::Comparison(error) => error.fmt(f),
            DesignError::Recoil(error) => write!(f, "recoil: {error}"),
            DesignError::Singular => f.write_str(
                "B_z vanishes at a point of the working volume, so its decoupling parameters do not exist: start from \
                 a film nearer to the ideal one, or design for goal = \"field\" first",
            ),
            DesignError::Request(problems) => f.write_str(&problems.join("\n")),
        }
    }
}

/// The first [`MAX_LISTED`] of the items, and the number of the others.
fn listed(items: &[String], separator: &str) -> String {
    let mut text = items[..items.len().min(MAX_LISTED)].join(separator);
    if items.len() > MAX_LISTED {
        text += &format!("{separator}and {} more", items.len() - MAX_LISTED);
    }
    text
}

impl Error for DesignError {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        match self {
            DesignError::Decoupling(error) => Some(error),
            DesignError::Comparison(error) => Some(error),
            DesignError::Recoil(error) => Some(error),
            _ => None,
        }
    }
}
