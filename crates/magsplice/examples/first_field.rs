//! The field of two magnets at a point, at many points, and where it does not exist.

use std::error::Error;

use magsplice::prelude::*;

fn main() -> Result<(), Box<dyn Error>> {
    // Two cubes with sides of 5 mm, magnetized along z with 1.2 T, their centres 8 mm apart.
    // Any unit of length may be used, as long as it is the same everywhere.
    let (size_mm, polarization_t) = (DVec3::splat(5.0), DVec3::new(0.0, 0.0, 1.2));
    let left = Tile::new(DVec3::new(-4.0, 0.0, 0.0), size_mm, polarization_t)?;
    let right = Tile::new(DVec3::new(4.0, 0.0, 0.0), size_mm, -polarization_t)?;
    let scene = Scene::new(&[left, right]);

    let point_mm = DVec3::new(-4.0, 0.0, 6.0);
    let b_t = scene.field(Quantity::FluxDensity, point_mm)?;
    println!("B at {point_mm} mm: ({:.6}, {:.6}, {:.6}) mT", 1e3 * b_t.x, 1e3 * b_t.y, 1e3 * b_t.z);
    let h_a_per_m = scene.field(Quantity::FieldStrength, point_mm)?;
    println!("|H| there: {:.1} A/m", h_a_per_m.length());

    // Many points at once are computed in parallel and in vectors, with the same digits.
    let points_mm: Vec<DVec3> = (0..5).map(|i| DVec3::new(f64::from(i) - 2.0, 0.0, 6.0)).collect();
    let field_t = scene.field_at(Quantity::FluxDensity, &points_mm)?;
    for (point_mm, b_t) in points_mm.iter().zip(&field_t) {
        println!("B_x at x = {:4.1} mm: {:9.6} mT", point_mm.x, 1e3 * b_t.x);
    }

    // On an edge of a magnet B is unbounded. The answer is an error that names the tile.
    let on_edge_mm = DVec3::new(-1.5, 0.0, 2.5);
    match scene.field(Quantity::FluxDensity, on_edge_mm) {
        Ok(b_t) => println!("B at {on_edge_mm} mm: {b_t} T"),
        Err(error) => println!("no field at {on_edge_mm} mm: {error}"),
    }
    Ok(())
}
