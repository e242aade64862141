//! Two touching cubes of one polarization against the block they form.

use glam::DVec3;
use magsplice::field::Tile;
use magsplice_tests::oracle::Oracle;

use crate::peers::{Peers, error};

/// Errors at one place on or beside the seam.
pub(crate) struct Seam {
    pub(crate) place: &'static str,
    /// magsplice, magba and, if it was run, magpylib; infinite where no finite number came back.
    pub(crate) errors: Vec<f64>,
}

pub(crate) fn measure(peers: &Peers) -> Result<Vec<Seam>, String> {
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
    let answers = peers.ask(&cases)?;
    let mut oracle = Oracle::new();
    let seam = |(index, (place, point)): (usize, &(&'static str, DVec3))| {
        let exact = oracle.field(&whole, *point).flux_density_t;
        let programs = [Some(&answers.magsplice), Some(&answers.magba), answers.magpylib.as_ref()];
        let errors = programs.into_iter().flatten().map(|found| error(found[index], exact)).collect();
        Seam { place, errors }
    };
    Ok(places.iter().enumerate().map(seam).collect())
}
