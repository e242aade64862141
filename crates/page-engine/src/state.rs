//! A layout as a page shows it.

use magsplice::layout::{Brief, Layout, NamedTile, document_of};
use magsplice::prelude::DVec3;
use serde::Serialize;
use serde_json::Value;

/// A layout that was read: its text, and what the text says.
#[derive(Serialize)]
pub(crate) struct State {
    /// The text, TOML.
    text: String,
    /// The tables of the text as they are written.
    document: Value,
    name: String,
    description: Option<String>,
    tiles: Vec<ShownTile>,
    /// Places of the sensors on the board of a head; one at the origin without a head.
    sensors_mm: Vec<DVec3>,
    head_spacing_mm: Option<f64>,
    volume: Option<ShownVolume>,
    brief: Option<Brief>,
    findings: Vec<String>,
}

/// A tile in the frame of the film.
#[derive(Serialize)]
struct ShownTile {
    name: String,
    position_mm: DVec3,
    size_mm: DVec3,
    /// Polarization in its own frame.
    polarization_t: DVec3,
    /// Its own axes.
    axes: [DVec3; 3],
    /// Whether it is a strip of a disc, which moves as a whole.
    is_strip: bool,
}

/// The working volume.
#[derive(Serialize)]
struct ShownVolume {
    lower_mm: DVec3,
    upper_mm: DVec3,
    reference_mm: DVec3,
}

impl State {
    /// The state of a layout with its text.
    pub(crate) fn of(layout: &Layout, text: &str) -> State {
        let tile = |named: &NamedTile| ShownTile {
            name: named.name.clone(),
            position_mm: named.tile.position(),
            size_mm: named.tile.size(),
            polarization_t: named.tile.polarization_t(),
            axes: [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| named.tile.rotation() * axis),
            is_strip: named.disc.is_some(),
        };
        let places = layout.head().map(|head| head.elements.iter().map(|of| of.place).collect());
        State {
            text: text.to_owned(),
            // The text was read.
            document: document_of(text).unwrap_or(Value::Null),
            name: layout.name.clone(),
            description: layout.description.clone(),
            tiles: layout.tiles.iter().map(tile).collect(),
            sensors_mm: places.unwrap_or_else(|| vec![DVec3::ZERO]),
            head_spacing_mm: layout.head_spacing_mm(),
            volume: layout.volume.as_ref().map(|volume| ShownVolume {
                lower_mm: volume.lower_mm,
                upper_mm: volume.upper_mm,
                reference_mm: volume.reference_mm,
            }),
            brief: layout.brief.clone(),
            findings: layout.findings.iter().map(ToString::to_string).collect(),
        }
    }
}
