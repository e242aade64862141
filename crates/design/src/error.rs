//! Why there is no design.

use std::fmt;

use glam::DVec3;
use magsplice_decouple::DecouplingError;

/// Why a film cannot be designed. Messages speak of tiles by name and lengths in millimetres.
#[derive(Clone, Debug, PartialEq)]
pub enum DesignError {
    /// The layout lacks a table.
    Missing(&'static str),
    /// These tiles have no image under the symmetry that is to be kept.
    NotSymmetric(Vec<String>),
    /// These tiles are rotated, and their sizes or positions are to change.
    Rotated(Vec<String>),
    /// Nothing that may change is left free.
    NothingFree,
    /// These rules cannot be kept together.
    Contradiction(Vec<String>),
    /// A point of the working volume is not below the film.
    NotBelow(DVec3),
    /// The film to start from has no field at some point: it lies on an edge of a tile.
    NoField,
    /// The film to start from has no decoupling parameters.
    Decoupling(DecouplingError),
    /// B_z vanishes at a point that the film is designed on.
    Singular,
    /// What was asked for a film from nothing.
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
            DesignError::Missing(table) => write!(f, "the layout has no [{table}] table, which design needs: add one"),
            DesignError::NotSymmetric(tiles) => write!(
                f,
                "tiles without an image under the symmetry of [design]: {}; add the images (arrows are mirrored like drawn ones), or ask for less \
                 symmetry",
                tiles.join(", ")
            ),
            DesignError::Rotated(tiles) => write!(
                f,
                "rotated tiles: {}; sizes, positions and symmetries are for tiles along x and y: give these unrotated, or let only directions and \
                 strengths vary",
                tiles.join(", ")
            ),
            DesignError::NothingFree => {
                f.write_str("nothing of what [design] lets vary is free in this film, must be at least one number")
            }
            DesignError::Contradiction(rules) => {
                f.write_str("these rules of [design] cannot be kept together by a film like this one:")?;
                for rule in rules {
                    write!(f, "\n  {rule}")?;
                }
                Ok(())
            }
            DesignError::NotBelow(p) => write!(
                f,
                "the point ({}, {}, {}) mm of the working volume is not below the film: lower z_mm or reference_mm of [volume]",
                p.x, p.y, p.z
            ),
            DesignError::NoField => {
                f.write_str("a point of the working volume lies on an edge of a tile: lower z_mm of [volume]")
            }
            DesignError::Decoupling(error) => error.fmt(f),
            DesignError::Singular => f.write_str(
                "B_z vanishes at a point of the working volume, so its decoupling parameters do not exist: start from a film nearer to the ideal one, \
                 or design for goal = \"field\" first",
            ),
            DesignError::Request(problems) => f.write_str(&problems.join("\n")),
        }
    }
}

impl std::error::Error for DesignError {}
