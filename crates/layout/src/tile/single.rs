//! One `[[tile]]` before it is repeated, and `[kind.NAME]`.

// Descriptions of the JSON Schema, which are no links, write tables in brackets.
#![allow(rustdoc::broken_intra_doc_links)]

use std::collections::BTreeMap;

use glam::DVec3;
use magsplice_magnet::Tile;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::faults::TableFaults;
use crate::layout::NamedTile;
use crate::limits::MAX_LISTED;
use crate::material::RecoilPermeability;
use crate::names::shown;
use crate::plausible::{check_polarization, check_strength};
use crate::rotation::RotationTable;
use crate::tile::checked_tile;
use crate::tile::disc::{Disc, DiscKeys};
use crate::tile::repeat::{GridTable, MirrorTable};
use crate::units::{direction_from_degrees, unit_vector};

/// The properties that tiles of one kind have in common.
#[derive(Deserialize, JsonSchema, Serialize)]
pub(crate) struct KindTable {
    /// Full side lengths along the tile's own axes, in mm. Required unless it is a disc.
    #[schemars(extend("example" = "[3.3, 1.7, 1.0]"))]
    size_mm: Option<[f64; 3]>,
    #[serde(flatten)]
    disc: DiscKeys,
    /// Magnitude of the polarization, in T. Each tile gives its direction.
    strength_t: Option<f64>,
    /// Polarization J = mu0 M in the tile's own frame, in T.
    #[schemars(extend("example" = "[0.12, 0.0, 0.0]"))]
    polarization_t: Option<[f64; 3]>,
    /// Relative recoil permeability. Default: that of [material].
    recoil_permeability: Option<RecoilPermeability>,
}

/// A tile, single or repeated. Its polarization is given once: as polarization_t, as strength_t and
/// direction, or by its kind.
#[derive(Default, Deserialize, JsonSchema, Serialize)]
pub(crate) struct TileTable {
    /// Unique name. Default: tile-1, tile-2 and so on, numbered in the order of the file.
    pub(crate) name: Option<String>,
    /// Name of the kind that gives the size.
    pub(crate) kind: Option<String>,
    /// Centre, in mm.
    #[schemars(extend("example" = "[0.0, 0.0, 0.5]"))]
    position_mm: [f64; 3],
    /// Full side lengths along the tile's own axes, in mm. Required unless a kind gives them, or
    /// the tile is a disc.
    #[schemars(extend("example" = "[3.3, 1.7, 1.0]"))]
    size_mm: Option<[f64; 3]>,
    #[serde(flatten)]
    disc: DiscKeys,
    /// Polarization J = mu0 M in the tile's own frame, in T. Or give its magnitude as strength_t,
    /// with a direction.
    #[schemars(extend("example" = "[0.12, 0.0, 0.0]"))]
    polarization_t: Option<[f64; 3]>,
    /// Magnitude of the polarization, in T. Needs a direction.
    #[schemars(extend("example" = "0.12"))]
    strength_t: Option<f64>,
    /// Direction of the polarization in the tile's own frame, a vector of any length but zero.
    #[schemars(extend("example" = "[1.0, 1.0, 0.0]"))]
    direction: Option<[f64; 3]>,
    /// Angle of the polarization in the tile's own xy plane, from x towards y, in degrees. Goes
    /// with strength_t, instead of direction.
    pub(crate) direction_deg: Option<f64>,
    /// Angle of the polarization out of the tile's own xy plane towards z, in degrees. Goes with
    /// direction_deg. Default: 0.
    pub(crate) tilt_deg: Option<f64>,
    /// Relative recoil permeability. Default: that of its kind or of [material].
    recoil_permeability: Option<RecoilPermeability>,
    /// Rotation about the tile's centre, given once: as axis and angle_deg, as quaternion, as
    /// euler_deg and order, or as matrix.
    pub(crate) rotation: Option<RotationTable>,
    /// Copies on a regular grid.
    pub(crate) grid: Option<GridTable>,
    /// Mirror images of the tile and of all its copies on the grid.
    pub(crate) mirror: Option<MirrorTable>,
}

impl From<&NamedTile> for TileTable {
    /// A tile without its kind, which writes its polarization in components.
    fn from(named: &NamedTile) -> TileTable {
        TileTable {
            name: Some(named.name.clone()),
            position_mm: named.tile.position().to_array(),
            size_mm: Some(named.tile.size().to_array()),
            polarization_t: Some(named.tile.polarization_t().to_array()),
            recoil_permeability: named.permeability.map(Into::into),
            rotation: named.rotation.map(Into::into),
            ..TileTable::default()
        }
    }
}

impl KindTable {
    /// Checks a kind by itself, so that its faults are not repeated for every tile that names it.
    pub(crate) fn check(&self, faults: &mut TableFaults) {
        if self.strength_t.is_some() && self.polarization_t.is_some() {
            faults.add("gives both strength_t and polarization_t, must give only one of them");
        }
        check_strength(self.strength_t, faults);
        check_polarization(self.polarization_t, faults);
        if let Some(written) = self.recoil_permeability {
            written.resolve(faults);
        }
        let size_mm = self.size_mm(faults).unwrap_or([1.0; 3]);
        checked_tile(DVec3::ZERO, size_mm.into(), self.polarization_t.unwrap_or_default().into(), faults);
    }

    /// The sides, of the block around a disc, or `None` after adding a fault.
    fn size_mm(&self, faults: &mut TableFaults) -> Option<[f64; 3]> {
        let before = faults.count();
        let disc = self.disc.resolve(self.size_mm.is_some(), faults);
        match disc.map(|disc| disc.block_mm().to_array()).or(self.size_mm) {
            Some(size_mm) => Some(size_mm),
            None if faults.count() > before => None,
            None => faults.refuse("has no size_mm"),
        }
    }
}

/// The tile of one table with its kind resolved, and the disc within it, or `None` after adding its
/// faults.
pub(crate) fn resolve(
    table: &TileTable,
    name: String,
    kinds: &BTreeMap<String, KindTable>,
    faults: &mut TableFaults,
) -> Option<(NamedTile, Option<Disc>)> {
    let before = faults.count();
    let kind = match &table.kind {
        None => None,
        Some(wanted) => Some(declared_kind(wanted, kinds, faults)?),
    };
    let (size, disc) = size(table, kind, faults);
    let polarization = polarization(table, kind, faults).unwrap_or(DVec3::ZERO);
    let rotation = table.rotation.as_ref().and_then(|table| table.resolve(faults));
    // The size of a kind has been checked with the kind.
    let is_own = table.size_mm.is_some() || table.disc.shape.is_some();
    let own_size = if is_own { size? } else { [1.0; 3] };
    checked_tile(table.position_mm.into(), own_size.into(), polarization, faults)?;
    let own_permeability = table.recoil_permeability.and_then(|written| written.resolve(faults));
    if faults.count() > before {
        return None;
    }
    let mut tile = Tile::new(table.position_mm.into(), size?.into(), polarization).ok()?;
    if let Some(rotation) = rotation {
        tile = tile.rotated(rotation.quaternion()).ok()?;
    }
    // Faults of a kind have been added with the kind.
    let of_kind = || kind?.recoil_permeability?.resolve(faults);
    let permeability = own_permeability.or_else(of_kind);
    Some((NamedTile { name, kind: table.kind.clone(), rotation, tile, permeability, disc: None }, disc))
}

fn declared_kind<'k>(
    wanted: &str,
    kinds: &'k BTreeMap<String, KindTable>,
    faults: &mut TableFaults,
) -> Option<&'k KindTable> {
    let kind = kinds.get(wanted);
    if kind.is_none() {
        let mut declared: Vec<String> = kinds.keys().take(MAX_LISTED).map(|name| shown(name)).collect();
        match kinds.len() {
            0 => declared.push("none".to_owned()),
            n if n > MAX_LISTED => declared.push(format!("and {} more", n - MAX_LISTED)),
            _ => {}
        }
        let (wanted, declared) = (shown(wanted), declared.join(", "));
        faults.add(format!("kind = \"{wanted}\", must be declared as [kind.{wanted}] (declared: {declared})"));
    }
    kind
}

/// The sides, and the disc within them. No sides after adding a fault.
fn size(table: &TileTable, kind: Option<&KindTable>, faults: &mut TableFaults) -> (Option<[f64; 3]>, Option<Disc>) {
    let before = faults.count();
    let own = table.disc.resolve(table.size_mm.is_some(), faults);
    if faults.count() > before {
        return (None, None);
    }
    // Faults of a kind have been added with the kind.
    let of_kind = kind.and_then(|kind| kind.disc.resolve(false, faults).map(|disc| (disc, kind)));
    let is_twice = kind.is_some() && (table.size_mm.is_some() || own.is_some());
    match (own.or(of_kind.map(|(disc, _)| disc)), table.size_mm.or(kind.and_then(|kind| kind.size_mm))) {
        _ if is_twice => {
            let key = if table.size_mm.is_some() { "size_mm" } else { "shape" };
            (faults.refuse(format!("gives {key}, which its kind already gives")), None)
        }
        (Some(disc), _) => (Some(disc.block_mm().to_array()), Some(disc)),
        (None, Some(size_mm)) => (Some(size_mm), None),
        (None, None) if kind.is_some() => (None, None),
        (None, None) => (faults.refuse("has no size_mm and no kind that gives it"), None),
    }
}

fn polarization(table: &TileTable, kind: Option<&KindTable>, faults: &mut TableFaults) -> Option<DVec3> {
    let kind_strength = kind.and_then(|k| k.strength_t);
    let kind_polarization = kind.and_then(|k| k.polarization_t);
    let given = [
        table.polarization_t.is_some(),
        table.strength_t.is_some(),
        kind_polarization.is_some(),
        kind_strength.is_some(),
    ];
    if given.into_iter().filter(|given| *given).count() > 1 {
        return faults.refuse(
            "gives its polarization twice, must give one of polarization_t and strength_t, in the tile or in its kind",
        );
    }
    check_strength(table.strength_t, faults);
    check_polarization(table.polarization_t, faults);
    let direction = direction(table, faults)?;
    match (table.polarization_t.or(kind_polarization), table.strength_t.or(kind_strength), direction) {
        (Some(polarization), _, None) => Some(polarization.into()),
        (Some(_), _, Some(_)) => {
            faults.refuse("gives a direction, which goes with strength_t and not with polarization_t")
        }
        (None, Some(strength), Some(unit)) => Some(unit * strength),
        (None, Some(_), None) => faults.refuse("has a strength_t and no direction or direction_deg"),
        (None, None, _) => faults.refuse("has no polarization: give polarization_t, or strength_t and direction"),
    }
}

/// The direction as a unit vector. The outer option is `None` after adding a fault, the inner one
/// where the tile gives no direction.
fn direction(table: &TileTable, faults: &mut TableFaults) -> Option<Option<DVec3>> {
    if table.direction.is_some() && table.direction_deg.is_some() {
        return faults.refuse("gives both direction and direction_deg, must give only one of them");
    }
    if table.tilt_deg.is_some() && table.direction_deg.is_none() {
        return faults.refuse("gives a tilt_deg, which goes with direction_deg");
    }
    if let Some(direction) = table.direction {
        let unit = unit_vector(direction);
        if unit.is_none() {
            faults.add(format!("direction = {direction:?}, must be finite and not zero"));
        }
        return unit.map(Some);
    }
    let Some(direction_deg) = table.direction_deg else { return Some(None) };
    let angles = [("direction_deg", direction_deg), ("tilt_deg", table.tilt_deg.unwrap_or(0.0))];
    let wrong = angles.iter().find(|(_, angle)| !angle.is_finite());
    if let Some((key, angle)) = wrong {
        return faults.refuse(format!("{key} = {angle}, must be a finite number"));
    }
    Some(Some(direction_from_degrees(angles.map(|(_, angle)| angle))))
}
