//! The parts of a layout, and the material that they need.

use glam::DVec3;
use magsplice_layout::{Layout, Part, PlainLayout};
use magsplice_making::Orientation;
use serde::Serialize;

/// Largest kerf in millimetres. No saw removes more, and areas stay within the range of numbers.
pub const MAX_KERF_MM: f64 = 100.0;

/// A layout with one `tile` for each tile, and `parts` beside the keys of the layout file.
#[derive(Serialize)]
pub struct BillOfMaterials<'a> {
    /// The layout.
    #[serde(flatten)]
    pub plain: PlainLayout,
    /// The parts, largest first.
    pub parts: Vec<PartItem>,
    /// The layout.
    #[serde(skip)]
    pub layout: &'a Layout,
    /// Width of material that a cut removes, if the material is asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub kerf_mm: Option<f64>,
}

/// Identical pieces of a film.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PartItem {
    /// Number of the part, from 1.
    pub part: usize,
    /// Number of pieces.
    pub count: usize,
    /// Sides.
    pub size_mm: DVec3,
    /// Magnitude of the polarization.
    pub strength_t: f64,
    /// Angle of the polarization from the first side towards the second. `None` without
    /// polarization.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub direction_deg: Option<f64>,
    /// Angle of the polarization out of the plane of these sides. `None` without polarization.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tilt_deg: Option<f64>,
    /// Names of the tiles that are made of the part, in the order of the layout.
    pub tiles: Vec<String>,
    /// Names of those of them whose piece lies upside down, with the upper side of the others down.
    pub turned_over: Vec<String>,
    /// Area of a sheet, as thick as the third side, for all pieces. Each piece takes its first two
    /// sides with one kerf each.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sheet_area_mm2: Option<f64>,
    /// Length of a bar with the second and third side as its section, for all pieces. Each piece
    /// takes its first side with one kerf.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bar_length_mm: Option<f64>,
    /// Indices of the tiles.
    #[serde(skip)]
    pub indices: Vec<usize>,
}

impl<'a> BillOfMaterials<'a> {
    /// The parts of a layout, with the material if the kerf is known.
    pub fn new(layout: &'a Layout, kerf_mm: Option<f64>) -> BillOfMaterials<'a> {
        let parts = layout.parts().into_iter().enumerate();
        let parts = parts.map(|(index, part)| PartItem::new(layout, index + 1, part, kerf_mm)).collect();
        BillOfMaterials { plain: layout.plain(), parts, layout, kerf_mm }
    }

    /// The number of the part of each tile.
    pub fn part_numbers(&self) -> Vec<usize> {
        let mut numbers = vec![0; self.layout.tiles.len()];
        for item in &self.parts {
            item.indices.iter().for_each(|&tile| numbers[tile] = item.part);
        }
        numbers
    }
}

impl PartItem {
    fn new(layout: &Layout, number: usize, part: Part, kerf_mm: Option<f64>) -> PartItem {
        let (angles, count, size) = (part.angles_deg(), part.count as f64, part.size_mm);
        let name = |tile: &usize| layout.tiles[*tile].name.clone();
        let is_turned_over = |tile: &&usize| {
            let orientation = Orientation::between(part.direction, size, &layout.tiles[**tile].tile);
            orientation.is_some_and(|orientation| !orientation.keeps_upper_side())
        };
        PartItem {
            part: number,
            count: part.count,
            size_mm: size,
            strength_t: part.strength_t,
            direction_deg: angles.map(|[direction, _]| direction),
            tilt_deg: angles.map(|[_, tilt]| tilt),
            tiles: part.tiles.iter().map(name).collect(),
            turned_over: part.tiles.iter().filter(is_turned_over).map(name).collect(),
            sheet_area_mm2: kerf_mm.map(|kerf| count * (size.x + kerf) * (size.y + kerf)),
            bar_length_mm: kerf_mm.map(|kerf| count * (size.x + kerf)),
            indices: part.tiles,
        }
    }
}
