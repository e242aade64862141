//! Tiles as VTK poly data.

use std::io::{self, Write};

use magsplice_layout::Layout;

use super::dataset::{ArrayValues, VtkArray, VtkDataset};
use crate::cuboid_faces::{FACES, corner_mm};
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
    let points = tiles.iter().flat_map(|t| (0..8).flat_map(move |corner| corner_mm(&t.tile, corner).to_array()));
    let polarization = tiles.iter().flat_map(|t| [t.tile.scene_polarization_t().to_array(); 6].concat());
    let connectivity = (0..tiles.len()).flat_map(|tile| FACES.into_iter().flatten().map(move |c| 8 * tile + c));
    let scalar = |name, values| VtkArray { name, components: &[], values };
    let vector =
        |name, components, count, values| VtkArray { name, components, values: ArrayValues::Float64(count, values) };
    VtkDataset {
        kind: "PolyData",
        attributes: [String::new(), format!("NumberOfPoints=\"{corners}\" NumberOfPolys=\"{faces}\"")],
        sections: vec![
            (
                "CellData",
                vec![
                    vector("polarization_t", &["jx_t", "jy_t", "jz_t"], 3 * faces, Box::new(polarization)),
                    scalar("tile_index", ArrayValues::Int64(faces, Box::new((0..faces).map(|face| face / 6)))),
                    scalar("tile", ArrayValues::Texts(tiles.iter().flat_map(|t| [&t.name[..]; 6]).collect())),
                ],
            ),
            ("Points", vec![vector("Points", &["x_mm", "y_mm", "z_mm"], 3 * corners, Box::new(points))]),
            (
                "Polys",
                vec![
                    scalar("connectivity", ArrayValues::Int64(4 * faces, Box::new(connectivity))),
                    scalar("offsets", ArrayValues::Int64(faces, Box::new((1..=faces).map(|face| 4 * face)))),
                ],
            ),
        ],
        metadata,
    }
    .write(w)
}
