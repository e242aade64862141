//! The same field from magsplice, magba and magpylib.

use std::fmt::Write as _;
use std::io::Write;
use std::path::Path;
use std::process::Command;

use glam::DVec3;
use magsplice::field::{Quantity, Scene, Tile};
use nalgebra::{Point3, UnitQuaternion, Vector3};

/// The tiles of a scene, and a point.
pub(crate) type FieldCase = (Vec<Tile>, DVec3);

/// B in tesla of each case by every program; `None` where a program reports an unbounded field.
pub(crate) struct PeerFields {
    magsplice: Vec<Option<DVec3>>,
    magba: Vec<Option<DVec3>>,
    magpylib: Option<Vec<Option<DVec3>>>,
}

impl PeerFields {
    /// The fields of all cases; without `python` magpylib is omitted.
    pub(crate) fn compute(python: Option<&Path>, cases: &[FieldCase]) -> Result<PeerFields, String> {
        let magsplice = |(tiles, point): &FieldCase| Scene::new(tiles).field(Quantity::FluxDensity, *point).ok();
        let magba = |(tiles, point): &FieldCase| Some(tiles.iter().map(|t| magba_field(t, *point)).sum());
        Ok(PeerFields {
            magsplice: cases.iter().map(magsplice).collect(),
            magba: cases.iter().map(magba).collect(),
            magpylib: python.map(|python| magpylib_fields(python, cases)).transpose()?,
        })
    }

    /// The fields by magsplice, magba and, if it was run, magpylib.
    pub(crate) fn by_program(&self) -> impl Iterator<Item = &Vec<Option<DVec3>>> {
        [Some(&self.magsplice), Some(&self.magba), self.magpylib.as_ref()].into_iter().flatten()
    }
}

fn magba_field(tile: &Tile, point: DVec3) -> DVec3 {
    let at = |v: DVec3| Point3::new(v.x, v.y, v.z);
    let vector = |v: DVec3| Vector3::new(v.x, v.y, v.z);
    let b = magba::fields::cuboid_B(
        at(point),
        at(tile.position()),
        UnitQuaternion::identity(),
        vector(tile.polarization_t()),
        vector(tile.size()),
    );
    DVec3::new(b.x, b.y, b.z)
}

/// B by magpylib, from a script that reads all cases as CSV.
///
/// Rust and Python print the shortest digits that read back to the same number, so no digit is
/// lost.
fn magpylib_fields(python: &Path, cases: &[FieldCase]) -> Result<Vec<Option<DVec3>>, String> {
    let mut table = String::new();
    for (index, (tiles, point)) in cases.iter().enumerate() {
        for tile in tiles {
            let numbers = [tile.size(), tile.polarization_t(), tile.position(), *point];
            let _ = write!(table, "{index}");
            numbers.iter().flat_map(DVec3::to_array).for_each(|n| write!(table, ",{n:?}").expect("a string grows"));
            table.push('\n');
        }
    }
    let mut file = tempfile::NamedTempFile::new().map_err(|e| e.to_string())?;
    file.write_all(table.as_bytes()).map_err(|e| e.to_string())?;
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/accuracy/magpylib_fields.py");
    let output = Command::new(python).arg(script).arg(file.path()).output();
    let output = output.map_err(|e| format!("cannot run {}: {e}", python.display()))?;
    if !output.status.success() {
        let reason = String::from_utf8_lossy(&output.stderr);
        return Err(format!("{} failed (pip install magpylib, or --without-magpylib):\n{reason}", python.display()));
    }
    let mut fields = vec![DVec3::ZERO; cases.len()];
    for line in String::from_utf8_lossy(&output.stdout).lines() {
        let fault = || format!("magpylib's script printed {line:?}");
        let numbers: Vec<f64> = line.split(',').map(str::parse).collect::<Result<_, _>>().map_err(|_| fault())?;
        let [index, x, y, z] = numbers[..] else { return Err(fault()) };
        fields[index as usize] += DVec3::new(x, y, z);
    }
    Ok(fields.into_iter().map(Some).collect())
}

/// |found - exact| / |exact|; infinite if `found` is not finite.
pub(crate) fn relative_error(found: Option<DVec3>, exact: DVec3) -> f64 {
    let error = found.map_or(f64::INFINITY, |found| (found - exact).length() / exact.length());
    if error.is_nan() { f64::INFINITY } else { error }
}
