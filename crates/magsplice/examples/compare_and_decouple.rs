//! A film from a layout file, compared with the ideal film, and how well it decouples.

use std::error::Error;

use magsplice::prelude::*;

fn main() -> Result<(), Box<dyn Error>> {
    // `Layout::read` takes a path instead.
    let film = Film::new(Layout::parse(include_str!("film.toml"), "film.toml")?)?;
    println!("{}: {} tiles", film.layout().name, film.layout().tiles.len());

    // B on the grid of the working volume, which is computed once.
    let field_t = film.volume_field_t()?;
    println!("working volume: {} points", field_t.len());

    // Dai 2024, Eq. 2, is the field of the ideal film.
    let comparison = film.compare()?.comparison;
    println!("RMSE against the ideal film: {:.3} mT", 1e3 * comparison.rmse_t);
    println!("best-fit amplitude: {:.4} of the ideal film", comparison.amplitude);

    // R_x, R_y and S_z (Eqs. 14 and 15) should each follow one displacement only.
    let decoupling = film.decouple()?.decoupling;
    let error = decoupling.uniformity_rmse.map(|error| error.expect("planes of several points"));
    println!("uniformity RMSE: R_x {:.4}, R_y {:.4} rad, S_z {:.4}", error.r_x, error.r_y, error.s_z);
    let error_mm = decoupling.displacement_rmse_mm;
    println!("error of displacement: {:.3}, {:.3}, {:.3} mm", error_mm.x, error_mm.y, error_mm.z);
    Ok(())
}
