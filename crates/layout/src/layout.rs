//! A layout as it is meant: tiles with names, the ideal film, the working volume.

use std::fs;
use std::path::Path;

use glam::DVec3;
use magsplice_field::{Grid, IdealFilm, Tile};
use sha2::{Digest, Sha256};

use crate::brief::Brief;
use crate::error::LayoutError;
use crate::expectations::Expectations;
use crate::resolve;
use crate::written::{Design, Expect, Ideal, LayoutFile, Rotation, Step, TileEntry, Volume};

/// A spliced film or any other arrangement of block magnets, and what it is to be judged by.
///
/// # Units
/// All lengths in millimetres, polarization in tesla.
#[derive(Clone, Debug)]
pub struct Layout {
    /// Name of the layout.
    pub name: String,
    /// What it is, in the author's words.
    pub description: Option<String>,
    /// The film it stands in for.
    pub ideal: Option<IdealFilm>,
    /// Where its field is used.
    pub volume: Option<WorkingVolume>,
    /// What it must meet.
    pub expectations: Expectations,
    /// What may change to make it better, and what is wanted.
    pub brief: Option<Brief>,
    /// How it came about, one line for each step.
    pub history: Vec<String>,
    /// Its tiles, repetition written out, none overlapping another.
    pub tiles: Vec<NamedTile>,
    /// SHA-256 of the file's bytes in hexadecimal.
    pub sha256: String,
    /// What is allowed but rarely meant, in words for the author.
    pub findings: Vec<String>,
}

/// A tile with what its layout says about it.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedTile {
    /// Unique within the layout.
    pub name: String,
    /// Name of its kind, if it was declared by one.
    pub kind: Option<String>,
    /// The rotation as written; that of `tile` follows from it.
    pub rotation: Option<Rotation>,
    /// The tile, in millimetres and tesla.
    pub tile: Tile,
}

/// The region in which the sensor moves, sampled on a regular grid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WorkingVolume {
    /// The points, in millimetres.
    pub grid: Grid,
    /// The region as written, in millimetres; the grid starts at `lower_mm` and ends at or before `upper_mm`.
    pub lower_mm: DVec3,
    /// Upper end of the region.
    pub upper_mm: DVec3,
    /// Distance of neighbouring points along x, y, z.
    pub step_mm: DVec3,
    /// The point from which changes of the field are measured: as written, else the middle of x and y at the lowest z.
    pub reference_mm: DVec3,
}

impl Layout {
    /// Reads a layout file.
    ///
    /// # Errors
    /// See [`LayoutError`]: one for the file or its syntax, or all broken rules at once.
    pub fn read(path: &Path) -> Result<Layout, LayoutError> {
        let bytes = fs::read(path).map_err(|error| LayoutError::Read { path: path.to_owned(), error })?;
        let origin = path.display().to_string();
        let text = String::from_utf8(bytes).map_err(|error| LayoutError::Syntax {
            origin: origin.clone(),
            message: format!("not UTF-8 text: {error}"),
        })?;
        Layout::parse(&text, &origin)
    }

    /// Reads a layout from text; `origin` says in errors where it came from.
    ///
    /// # Errors
    /// As [`Layout::read`].
    pub fn parse(text: &str, origin: &str) -> Result<Layout, LayoutError> {
        let syntax = |message: String| LayoutError::Syntax { origin: origin.to_owned(), message };
        let file: LayoutFile = toml::from_str(text).map_err(|e| syntax(e.to_string()))?;
        let sha256 = Sha256::digest(text.as_bytes()).iter().map(|byte| format!("{byte:02x}")).collect();
        resolve::layout(file, text, sha256)
            .map_err(|problems| LayoutError::Invalid { origin: origin.to_owned(), problems })
    }

    /// The tiles without their names, in the same order.
    pub fn bare_tiles(&self) -> Vec<Tile> {
        self.tiles.iter().map(|t| t.tile).collect()
    }

    /// The layout in the plain form, one `[[tile]]` per tile: parsing it gives the same tiles, bit by bit.
    pub fn to_toml(&self) -> String {
        toml::to_string(&self.plain()).expect("numbers and strings can always be written as TOML")
    }

    /// The same for any other format: an object with the keys of a layout file.
    pub fn plain(&self) -> Plain<'_> {
        Plain {
            format: resolve::FORMAT,
            name: &self.name,
            description: self.description.as_deref(),
            history: &self.history,
            ideal: self.ideal.map(|film| Ideal {
                wavelength_mm: film.wavelength(),
                thickness_mm: film.thickness(),
                amplitude_t: film.amplitude_t(),
            }),
            volume: self.volume.as_ref().map(written_volume),
            expect: self.expectations.written(),
            design: self.brief.as_ref().map(Brief::written),
            tile: self.tiles.iter().map(written_tile).collect(),
        }
    }
}

/// A layout in the plain form, ready to be written.
#[derive(serde::Serialize)]
pub struct Plain<'a> {
    format: i64,
    name: &'a str,
    #[serde(skip_serializing_if = "Option::is_none")]
    description: Option<&'a str>,
    #[serde(skip_serializing_if = "<[_]>::is_empty")]
    history: &'a [String],
    #[serde(skip_serializing_if = "Option::is_none")]
    ideal: Option<Ideal>,
    #[serde(skip_serializing_if = "Option::is_none")]
    volume: Option<Volume>,
    #[serde(skip_serializing_if = "Option::is_none")]
    expect: Option<Expect>,
    #[serde(skip_serializing_if = "Option::is_none")]
    design: Option<Design>,
    tile: Vec<TileEntry>,
}

fn written_volume(volume: &WorkingVolume) -> Volume {
    let range = |axis: usize| [volume.lower_mm[axis], volume.upper_mm[axis]];
    let step = volume.step_mm;
    let same = step.x == step.y && step.x == step.z;
    Volume {
        x_mm: range(0),
        y_mm: range(1),
        z_mm: range(2),
        step_mm: if same { Step::Same(step.x) } else { Step::PerAxis(step.to_array()) },
        reference_mm: Some(volume.reference_mm.to_array()),
    }
}

fn written_tile(named: &NamedTile) -> TileEntry {
    TileEntry {
        name: Some(named.name.clone()),
        kind: None,
        position_mm: named.tile.position().to_array(),
        size_mm: Some(named.tile.size().to_array()),
        polarization_t: Some(named.tile.polarization_t().to_array()),
        strength_t: None,
        direction: None,
        rotation: named.rotation,
        grid: None,
        mirror: None,
    }
}
