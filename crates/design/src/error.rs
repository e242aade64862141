//! Why a film cannot be designed.

use std::fmt;

use glam::DVec3;
use magsplice_decouple::DecouplingError;
use magsplice_ideal::ComparisonError;
use magsplice_layout::MemoryError;
use magsplice_magnet::TileBehindPlane;
use magsplice_recoil::RecoilError;
use magsplice_tolerance::SampleError;
use thiserror::Error;

use crate::rule::Rule;
use crate::splice_fault::SpliceFault;
use crate::tolerances::MAX_LISTED;

/// A table of a layout that a design needs.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
pub enum NeededTable {
    /// `[design]`, the brief.
    #[error(
        "the layout has no [design] table, which design needs: add one, at the least the line `design = {{ vary = \
         [\"size\", \"position\", \"direction\"] }}` below the name"
    )]
    Design,
    /// `[ideal]`.
    #[error("the layout has no [ideal] table, which design needs: add one")]
    Ideal,
    /// `[volume]`.
    #[error("the layout has no [volume] table, which design needs: add one")]
    Volume,
    /// `[tolerance]`.
    #[error("the layout has no [tolerance] table, which design needs: add one")]
    Tolerance,
}

/// Why a film cannot be designed. Messages contain the names of tiles, and lengths in millimetres.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum DesignError {
    /// The layout lacks this table.
    #[error("{0}")]
    Missing(NeededTable),
    /// The layout has flat iron.
    #[error("a plane of iron is not parallel to the film and breaks its symmetry: set symmetry = \"none\" in [design]")]
    TiltedIron,
    /// A tile reaches into iron.
    #[error("{0}: change the bounds of [design], or move [[plane]]")]
    InIron(#[source] TileBehindPlane),
    /// The iron near the film is tilted or may reach into it, or recoil or the spacing of a head
    /// counts.
    #[error(
        "films are designed for iron that is parallel to the film, apart from it and beyond the sensor, without \
         recoil and with a head of fixed spacing: change [tolerance.iron], or leave it out"
    )]
    NearIron,
    /// There is not enough memory.
    #[error("{0}")]
    Memory(#[source] MemoryError),
    /// Some tiles have no image under the symmetry of the brief.
    #[error(
        "{}tiles without an image under the symmetry of [design]: {}; add the images (polarizations are mirrored like \
         drawn arrows), or choose a lower symmetry", shown_spans(*off_centre_mm), listed(tiles, ", ")
    )]
    NotSymmetric {
        /// Names of these tiles.
        tiles: Vec<String>,
        /// Ends of the film along x and y, in millimetres; `None` along an axis where it is centred
        /// on 0. Both `None` where other tiles are the cause.
        off_centre_mm: [Option<[f64; 2]>; 2],
    },
    /// The brief counts films as made, and its goal is not the displacement.
    #[error(
        "under = \"tolerance\" of [design] needs goal = \"displacement\": other errors are smallest for films whose \
         parameters hardly change with the displacement"
    )]
    NotDisplacement,
    /// These tiles are rotated, and the brief lets sizes or positions vary or has a symmetry.
    #[error(
        "rotated tiles: {}; sizes, positions and symmetries need tiles along x and y: write these tiles without \
         rotation, or vary only directions and strengths", listed(.0, ", ")
    )]
    Rotated(Vec<String>),
    /// The head is to vary, and the layout has none with a spacing.
    #[error(
        "vary of [design] has head, whose spacing is to change, and [sensor] has no head with a spacing: give head = \
         \"pair-z\", \"pair-xy\" or \"cross\" and spacing_mm, or leave head out of vary"
    )]
    NoSpacing,
    /// No spacing of the head within the bounds has weights and a film.
    #[error(
        "no spacing of the head from {min_mm} to {max_mm} mm, of those tried, has weights that keep the form of the \
         ideal film, and a film with decoupling parameters: change spacing_mm of [design]"
    )]
    NoSpacingBetween {
        /// Least spacing.
        min_mm: f64,
        /// Largest spacing.
        max_mm: f64,
    },
    /// No number is free under the brief and the symmetry.
    #[error("vary and symmetry of [design] leave 0 free parameters in this film, must leave at least 1")]
    NothingFree,
    /// No film near the layout's keeps these rules together.
    #[error("no film was found that satisfies all of these rules of [design]; loosen one of them:\n  {}", listed(.0, "\n  "))]
    Contradiction(Vec<Rule>),
    /// The film found cannot exist when rounded to the resolution of the brief.
    #[error(
        "rounding to resolution_mm = {resolution_mm} and resolution_deg = {resolution_deg} of [design] leaves no valid \
         film: {fault}; choose a finer resolution"
    )]
    Resolution {
        /// The resolution of lengths, in millimetres.
        resolution_mm: f64,
        /// The resolution of angles, in degrees.
        resolution_deg: f64,
        /// The defect of the rounded film.
        fault: RoundingFault,
    },
    /// This point of the working volume, in millimetres, is not below the film.
    #[error(
        "the point ({}, {}, {}) mm of the working volume is not below the film: lower z_mm or reference_mm of [volume]",
        .0.x, .0.y, .0.z
    )]
    NotBelow(DVec3),
    /// The film to start from has no field at some point, which lies on an edge of a tile.
    #[error("a point of the working volume lies on an edge of a tile: lower z_mm of [volume]")]
    NoField,
    /// The film to start from has no decoupling parameters.
    #[error("{0}")]
    Decoupling(#[source] DecouplingError),
    /// The field of a film cannot be compared with the ideal one.
    #[error("{0}")]
    Comparison(#[source] ComparisonError),
    /// The polarization of tiles with a recoil permeability is not known.
    #[error("recoil: {0}")]
    Recoil(#[source] RecoilError),
    /// A film with random errors has no decoupling errors.
    #[error("{0}")]
    Sample(#[source] SampleError),
    /// B_z vanishes at a point of the design grid.
    #[error(
        "B_z vanishes at a point of the working volume, so its decoupling parameters do not exist: start from a film \
         nearer to the ideal one, or design for goal = \"field\" first"
    )]
    Singular,
    /// Numbers of a [`SpliceRequest`](crate::SpliceRequest) are out of range.
    #[error("{}", joined(.0, "\n"))]
    Request(Vec<SpliceFault>),
}

/// Why a film rounded to the resolution cannot exist.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum RoundingFault {
    /// This tile has a side of 0 mm.
    #[error("tile \"{0}\" has a side of 0 mm")]
    NoSide(String),
    /// Two tiles overlap.
    #[error("tiles \"{}\" and \"{}\" overlap by {depth_mm} mm", tiles[0], tiles[1])]
    Overlap {
        /// Their names.
        tiles: [String; 2],
        /// Depth of the overlap, in millimetres.
        depth_mm: f64,
    },
    /// It breaks these rules.
    #[error("the rounded film breaks {}", listed(.0, "; "))]
    Rules(Vec<Rule>),
    /// Its errors do not exist.
    #[error("{0}")]
    NoMetrics(Box<DesignError>),
}

/// Where a film that is not centred on 0 lies, as the beginning of a message.
fn shown_spans(off_centre_mm: [Option<[f64; 2]>; 2]) -> String {
    let spans = ["x", "y"].into_iter().zip(off_centre_mm).filter_map(|(axis, span)| Some((axis, span?)));
    let spans: Vec<String> = spans.map(|(axis, [low, high])| format!("{axis} = {low} .. {high}")).collect();
    match spans.is_empty() {
        true => String::new(),
        false => format!("the film spans {} mm, which is not centred on 0: ", spans.join(" and ")),
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
