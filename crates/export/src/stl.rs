//! Tiles as STL bodies.

use std::io::{self, Write};

use magsplice_layout::Layout;

use crate::cuboid_faces::FACES;

/// Number of triangles of a tile.
const TRIANGLES: usize = 2 * FACES.len();

/// Writes the tiles as binary STL, in millimetres: twelve triangles for each tile, with normals
/// that point outwards. Each tile is a closed body. Polarizations are lost.
///
/// # Accuracy
/// STL has coordinates in single precision, 7 digits.
///
/// # Errors
/// Errors of the writer, and too many triangles for the format.
pub fn film(layout: &Layout, w: &mut dyn Write) -> io::Result<()> {
    // Readers interpret a header that begins with "solid" as text.
    let mut header = [b' '; 80];
    let title = b"film of block magnets, in mm, by magsplice";
    header[..title.len()].copy_from_slice(title);
    w.write_all(&header)?;
    let count = u32::try_from(TRIANGLES * layout.tiles.len()).map_err(io::Error::other)?;
    w.write_all(&count.to_le_bytes())?;
    for named in &layout.tiles {
        let corners = named.tile.corners_mm();
        for [a, b, c, d] in FACES.map(|face| face.map(|corner| corners[corner])) {
            let normal = (b - a).cross(c - a).normalize_or_zero();
            for triangle in [[a, b, c], [a, c, d]] {
                for vector in [normal].into_iter().chain(triangle) {
                    for value in vector.to_array() {
                        w.write_all(&(value as f32).to_le_bytes())?;
                    }
                }
                // Attributes, which the format does not define.
                w.write_all(&[0, 0])?;
            }
        }
    }
    Ok(())
}
