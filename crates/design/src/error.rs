//! Why a film cannot be designed.

use std::error::Error;
use std::fmt;

use glam::DVec3;
use magsplice_decouple::DecouplingError;
use magsplice_ideal::ComparisonError;
use magsplice_recoil::RecoilError;
use magsplice_tolerance::SampleError;

use crate::rule::Rule;
use crate::splice_fault::SpliceFault;
use crate::tolerances::MAX_LISTED;

/// A table of a layout that a design needs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Table {
    /// `[design]`, the brief.
    Design,
    /// `[ideal]`.
    Ideal,
    /// `[volume]`.
    Volume,
    /// `[tolerance]`.
    Tolerance,
}

/// Why a film cannot be designed. Messages name tiles and give lengths in millimetres.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum DesignError {
    /// The layout lacks this table.
    Missing(Table),
    /// Some tiles have no image under the symmetry of the brief.
    NotSymmetric {
        /// Names of these tiles.
        tiles: Vec<String>,
        /// Where the film lies along x and y, in millimetres, along the axes along which it is not
        /// centred on 0. Both `None` where other tiles are the cause.
        off_centre_mm: [Option<[f64; 2]>; 2],
    },
    /// The brief counts the films that are made, and its goal is not the displacement.
    NotDisplacement,
    /// These tiles are rotated, and the brief lets sizes or positions vary or has a symmetry.
    Rotated(Vec<String>),
    /// The brief and the symmetry leave no number free.
    NothingFree,
    /// No film near the layout's keeps these rules together.
    Contradiction(Vec<Rule>),
    /// The film found, rounded to the resolution of the brief, is no film.
    Resolution {
        /// The resolution of lengths, in millimetres.
        resolution_mm: f64,
        /// The resolution of angles, in degrees.
        resolution_deg: f64,
        /// What the rounded film lacks.
        fault: RoundingFault,
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
    /// A film with random errors has no decoupling errors.
    Sample(SampleError),
    /// B_z vanishes at a point of the design grid.
    Singular,
    /// Numbers of a [`SpliceRequest`](crate::SpliceRequest) are out of range.
    Request(Vec<SpliceFault>),
}

/// Why a film rounded to the resolution is no film.
#[derive(Clone, Debug, PartialEq)]
pub enum RoundingFault {
    /// This tile has a side of 0 mm.
    NoSide(String),
    /// Two tiles overlap.
    Overlap {
        /// Their names.
        tiles: [String; 2],
        /// Depth of the overlap, in millimetres.
        depth_mm: f64,
    },
    /// Its errors do not exist.
    NoMetrics(Box<DesignError>),
}

impl fmt::Display for RoundingFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            RoundingFault::NoSide(tile) => write!(f, "tile \"{tile}\" has a side of 0 mm"),
            RoundingFault::Overlap { tiles: [first, second], depth_mm } => {
                write!(f, "tiles \"{first}\" and \"{second}\" overlap by {depth_mm} mm")
            }
            RoundingFault::NoMetrics(error) => error.fmt(f),
        }
    }
}

impl Table {
    fn name(self) -> &'static str {
        match self {
            Table::Design => "design",
            Table::Ideal => "ideal",
            Table::Volume => "volume",
            Table::Tolerance => "tolerance",
        }
    }
}

impl fmt::Display for DesignError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            DesignError::Missing(Table::Design) => f.write_str(
                "the layout has no [design] table, which design needs: add one, at the least the line \
                 `design = { vary = [\"size\", \"position\", \"direction\"] }` below the name",
            ),
            DesignError::Missing(table) => {
                write!(f, "the layout has no [{}] table, which design needs: add one", table.name())
            }
            DesignError::NotSymmetric { tiles, off_centre_mm } => {
                let spans = ["x", "y"].into_iter().zip(off_centre_mm).filter_map(|(axis, span)| Some((axis, (*span)?)));
                let spans: Vec<String> =
                    spans.map(|(axis, [low, high])| format!("{axis} = {low} .. {high}")).collect();
                if !spans.is_empty() {
                    write!(f, "the film spans {} mm, which is not centred on 0: ", spans.join(" and "))?;
                }
                write!(
                    f,
                    "tiles without an image under the symmetry of [design]: {}; add the images (arrows are mirrored like \
                     drawn ones), or ask for less symmetry",
                    listed(tiles, ", ")
                )
            }
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
            DesignError::Resolution { resolution_mm, resolution_deg, fault } => write!(
                f,
                "rounding to resolution_mm = {resolution_mm} and resolution_deg = {resolution_deg} of [design] leaves no \
                 film: {fault}; choose a finer resolution"
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
            DesignError::Sample(error) => error.fmt(f),
            DesignError::Singular => f.write_str(
                "B_z vanishes at a point of the working volume, so its decoupling parameters do not exist: start from \
                 a film nearer to the ideal one, or design for goal = \"field\" first",
            ),
            DesignError::Request(faults) => f.write_str(&joined(faults, "\n")),
        }
    }
}

/// The first [`MAX_LISTED`] of the items, and the number of the others.
fn listed(items: &[impl fmt::Display], separator: &str) -> String {
    let mut text = joined(&items[..items.len().min(MAX_LISTED)], separator);
    if items.len() > MAX_LISTED {
        text += &format!("{separator}and {} more", items.len() - MAX_LISTED);
    }
    text
}

fn joined(items: &[impl fmt::Display], separator: &str) -> String {
    items.iter().map(ToString::to_string).collect::<Vec<_>>().join(separator)
}

impl Error for DesignError {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        match self {
            DesignError::Decoupling(error) => Some(error),
            DesignError::Comparison(error) => Some(error),
            DesignError::Recoil(error) => Some(error),
            DesignError::Sample(error) => Some(error),
            _ => None,
        }
    }
}
