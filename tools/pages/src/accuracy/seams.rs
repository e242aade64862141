//! Errors at the seam of two touching cubes of one polarization.

use std::path::Path;

use glam::DVec3;
use magsplice::field::Tile;
use magsplice_tests::oracle::Oracle;

use super::peers::{PeerFields, relative_error};

/// Errors at one place on or beside the seam.
pub(crate) struct SeamErrors {
    pub(crate) place: &'static str,
    /// Relative errors of |B| by magsplice, magba and, if it was run, magpylib. Infinite where the
    /// result is not finite.
    pub(crate) errors: Vec<f64>,
}

/// Errors of two cubes against their merged block.
pub(crate) fn measure(python: Option<&Path>) -> Result<Vec<SeamErrors>, String> {
    let j = DVec3::new(0.2, 0.3, 1.0);
    let tile =
        |x: f64, width: f64| Tile::new(DVec3::new(x, 0.0, 0.0), DVec3::new(width, 1.0, 1.0), j).expect("a valid tile");
    let (parts, whole) = (vec![tile(-0.5, 1.0), tile(0.5, 1.0)], tile(0.0, 2.0));
    let places = [
        ("on the seam, inside", DVec3::new(0.0, 0.1, 0.2)),
        ("1e-9 beside the seam, inside", DVec3::new(1e-9, 0.1, 0.2)),
        ("1e-16 beside the seam, inside", DVec3::new(1e-16, 0.1, 0.2)),
        ("on the seam, on the top face", DVec3::new(0.0, 0.1, 0.5)),
        ("on the seam, 1e-9 above the top face", DVec3::new(0.0, 0.1, 0.5 + 1e-9)),
        ("1e-9 beside the seam, 1e-9 above the top face", DVec3::new(1e-9, 0.1, 0.5 + 1e-9)),
        ("above the seam by half a size", DVec3::new(0.0, 0.1, 1.0)),
    ];
    let cases: Vec<_> = places.iter().map(|(_, point)| (parts.clone(), *point)).collect();
    let fields = PeerFields::compute(python, &cases)?;
    let mut oracle = Oracle::new();
    let seam = |(index, (place, point)): (usize, &(&'static str, DVec3))| {
        let exact = oracle.field(&whole, *point).flux_density_t;
        let errors = fields.by_program().map(|found| relative_error(found[index], exact)).collect();
        SeamErrors { place, errors }
    };
    Ok(places.iter().enumerate().map(seam).collect())
}
