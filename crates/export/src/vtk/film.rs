//! Tiles as VTK poly data.

use std::io::{self, Write};

use magsplice_layout::Layout;

use super::dataset::{ArrayValues, VtkArray, VtkDataset};
use crate::cuboid_faces::FACES;
use magsplice::results::Metadata;

/// Writes the faces of all tiles as poly data (`.vtp`), in millimetres.
///
/// Each face has the cell data `polarization_t` (in tesla, in the frame of the film), `tile` (the
/// name of its tile) and `tile_index`.
///
/// # Errors
/// Errors of the writer.
pub fn film(layout: &Layout, metadata: &Metadata, w: &mut dyn Write) -> io::Result<()> {
    let tiles = &layout.tiles;
    let (corners, faces) = (8 * tiles.len(), 6 * tiles.len());
    let points = tiles.iter().flat_map(|t| t.tile.corners_mm()).flat_map(|corner| corner.to_array());
    let polarization = tiles.iter().flat_map(|t| [t.tile.scene_polarization_t().to_array(); 6].concat());
    let connectivity = (0..tiles.len()).flat_map(|tile| FACES.into_iter().flatten().map(move |c| 8 * tile + c));
    VtkDataset {
        kind: "PolyData",
        attributes: [String::new(), format!("NumberOfPoints=\"{corners}\" NumberOfPolys=\"{faces}\"")],
        sections: vec![
            (
                "CellData",
                vec![
                    VtkArray::floats("polarization_t", &["jx_t", "jy_t", "jz_t"], 3 * faces, polarization),
                    VtkArray::integers("tile_index", faces, (0..faces).map(|face| face / 6)),
                    VtkArray {
                        name: "tile",
                        components: &[],
                        values: ArrayValues::Texts(tiles.iter().flat_map(|t| [&t.name[..]; 6]).collect()),
                    },
                ],
            ),
            ("Points", vec![VtkArray::floats("Points", &["x_mm", "y_mm", "z_mm"], 3 * corners, points)]),
            (
                "Polys",
                vec![
                    VtkArray::integers("connectivity", 4 * faces, connectivity),
                    VtkArray::integers("offsets", faces, (1..=faces).map(|face| 4 * face)),
                ],
            ),
        ],
        metadata,
    }
    .write(w)
}
