//! `[[plane]]`: flat iron near the film.

use glam::DVec3;
use magsplice_magnet::{IronPlane, IronPlanes, IronPlanesFault, Tile};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::faults::{FINITE, Faults, Rule, TableFaults};
use crate::finding::{Finding, FindingSubject};
use crate::layout::NamedTile;
use crate::names::shown;
use crate::places::Place;
use crate::plausible::short;
use crate::volume::WorkingVolume;

/// Flat iron that fills the half space behind a plane, such as a back plate. It moves with the
/// film, and does not saturate.
#[derive(Clone, Copy, Deserialize, JsonSchema, Serialize)]
#[schemars(rename = "Plane")]
pub(crate) struct PlaneTable {
    /// A point of its surface, in mm.
    #[schemars(extend("example" = "[0.0, 0.0, 2.0]"))]
    point_mm: [f64; 3],
    /// Direction out of the iron, of any length.
    #[schemars(extend("example" = "[0, 0, -1]"))]
    normal: [f64; 3],
    /// Relative permeability of the iron: 1 or more, or inf. Default: inf.
    #[serde(skip_serializing_if = "Option::is_none")]
    relative_permeability: Option<f64>,
}

const PERMEABILITY: Rule = Rule { is_kept: |mu_r| mu_r >= 1.0, words: "must be at least 1, or inf" };

/// Adds the fault of a working volume that is not before a plane.
pub(crate) fn check_volume(plane: &IronPlane, volume: &WorkingVolume, faults: &mut TableFaults) {
    let ends = [volume.lower_mm, volume.upper_mm];
    let corners = (0..8).map(|corner| DVec3::from([0, 1, 2].map(|axis| ends[corner >> axis & 1][axis])));
    let depths_mm = corners.chain([volume.reference_mm]).map(|place| -plane.distance(place));
    let depth_mm = depths_mm.fold(f64::NEG_INFINITY, f64::max);
    if depth_mm >= 0.0 {
        faults.add(format!("[volume] reaches {} mm into the iron, must be before it", short(depth_mm)));
    }
}

/// Permeability of ideal iron. Soft iron in weak fields has some thousands, which changes the field
/// of the images by less than 0.1 %.
pub(crate) const DEFAULT_PERMEABILITY: f64 = f64::INFINITY;

/// Adds the fault of a permeability, of which infinity is one.
pub(crate) fn resolve_permeability(mu_r: f64, faults: &mut TableFaults) {
    if mu_r != f64::INFINITY {
        faults.number("relative_permeability", mu_r, PERMEABILITY);
    }
}

/// Adds the faults of the direction out of iron.
pub(crate) fn resolve_normal(normal: [f64; 3], faults: &mut TableFaults) {
    faults.numbers("normal", &normal, FINITE);
    if normal == [0.0; 3] {
        faults.add("normal = [0, 0, 0] has no direction, must point out of the iron");
    }
}

/// The permeability as it is written: nothing for the default.
pub(crate) fn written_permeability(mu_r: f64) -> Option<f64> {
    (mu_r != DEFAULT_PERMEABILITY).then_some(mu_r)
}

impl PlaneTable {
    /// The planes of a layout, or none after adding their faults. `tiles` are all its tiles, which
    /// may reach by `overlap_mm` into the iron.
    pub(crate) fn resolve(
        tables: &[PlaneTable],
        (tiles, overlap_mm): (&[NamedTile], f64),
        place: &Place,
        faults: &mut Faults,
    ) -> IronPlanes {
        let before = faults.count();
        let mut planes = Vec::with_capacity(tables.len());
        for (index, table) in tables.iter().enumerate() {
            let faults = &mut faults.at(place.item(index).start, format!("plane {}", index + 1));
            faults.point("point_mm", table.point_mm);
            resolve_normal(table.normal, faults);
            let mu_r = table.relative_permeability.unwrap_or(DEFAULT_PERMEABILITY);
            resolve_permeability(mu_r, faults);
            // What breaks a rule of planes has been refused above.
            planes.extend(IronPlane::new(table.point_mm.into(), table.normal.into(), mu_r));
        }
        if faults.count() > before {
            return IronPlanes::default();
        }
        let mut at = |index: usize, message: String| {
            faults.at(place.item(index).start, format!("plane {}", index + 1)).add(message);
            IronPlanes::default()
        };
        let planes = match IronPlanes::new(planes) {
            Ok(planes) => planes.with_allowed_depth(overlap_mm),
            Err(fault) => {
                let (IronPlanesFault::NotParallel(_, index)
                | IronPlanesFault::Behind(_, index)
                | IronPlanesFault::NoSpace(_, index)) = fault
                else {
                    unreachable!("all faults of planes are known")
                };
                return at(index, fault.to_string());
            }
        };
        let bare: Vec<_> = tiles.iter().map(|named| named.tile).collect();
        match planes.check(&bare) {
            Ok(()) => {
                let omitted_ut = 1e6 * planes.truncation_error_t(&bare);
                if omitted_ut > 0.0 {
                    faults.findings.push(Finding::new(
                        FindingSubject::Tiles,
                        format!(
                            "tiles have images without end between two planes of iron; the omitted ones have at most \
                             {omitted_ut:.2} uT"
                        ),
                    ));
                }
                planes
            }
            Err(behind) => {
                let name = shown(&tiles[behind.tile].name);
                let plane = &planes.planes()[behind.plane];
                let corners = bare.iter().flat_map(Tile::corners_mm);
                let is_reversed = corners.into_iter().all(|corner| plane.distance(corner) <= 0.0);
                let remedy = match is_reversed {
                    true => "all tiles are behind the plane: reverse normal, which points out of the iron",
                    false => "move the plane or the tile; overlap_mm allows the depth, as for films as made",
                };
                let depth_mm = short(behind.depth);
                at(
                    behind.plane,
                    format!("tile \"{name}\" reaches {depth_mm} mm into the iron, must be before it: {remedy}"),
                )
            }
        }
    }
}

impl From<&IronPlane> for PlaneTable {
    fn from(plane: &IronPlane) -> PlaneTable {
        PlaneTable {
            point_mm: plane.point().to_array(),
            normal: plane.normal().to_array(),
            relative_permeability: written_permeability(plane.relative_permeability()),
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::layout::Layout;

    const FILM: &str = "format = 1\nname = \"plate\"\n[[tile]]\nname = \"a\"\nposition_mm = [0, 0, 0.5]\n\
                        size_mm = [3, 3, 1]\npolarization_t = [0, 0, 0.1]\n";

    fn refused(planes: &str) -> String {
        Layout::parse(&format!("{FILM}{planes}"), "film.toml").expect_err("a fault").to_string()
    }

    #[test]
    fn planes_are_read_and_written() {
        let planes = "[[plane]]\npoint_mm = [0, 0, 2]\nnormal = [0.1, -0.3, -2]\n[[plane]]\npoint_mm = [0, 0, -9]\n\
                      normal = [-0.1, 0.3, 2]\nrelative_permeability = 1000\n";
        let layout = Layout::parse(&format!("{FILM}{planes}"), "film.toml").expect("a layout");
        let read: Vec<(f64, bool, f64)> = layout
            .iron
            .planes()
            .iter()
            .map(|of| (of.point().z, of.normal().z > 0.0, of.relative_permeability()))
            .collect();
        assert_eq!(read, [(2.0, false, f64::INFINITY), (-9.0, true, 1000.0)]);
        let again = Layout::parse(&layout.to_toml(), "again").expect("a layout");
        assert_eq!(again.iron, layout.iron);
        let without = Layout::parse(FILM, "film.toml").expect("a layout");
        assert_ne!(without.sample_fingerprint(&()), layout.sample_fingerprint(&()));
    }

    #[test]
    fn faults_of_planes_have_their_lines() {
        let message = refused("[[plane]]\npoint_mm = [0, inf, 2]\nnormal = [0, 0, 0]\nrelative_permeability = 0.5\n");
        for fault in [
            "line 8: plane 1: point_mm = [0.0, inf, 2.0], must be three finite numbers",
            "line 8: plane 1: relative_permeability = 0.5, must be at least 1, or inf",
        ] {
            assert!(message.contains(fault), "{fault} is not in {message}");
        }
        assert!(
            refused("[[plane]]\npoint_mm = [0, 0, 2]\nnormal = [0, 0, 0]\n").contains("plane 1: normal = [0, 0, 0]")
        );
        let plane = |z: f64, normal: &str| format!("[[plane]]\npoint_mm = [0, 0, {z}]\nnormal = {normal}\n");
        let tilted = refused(&(plane(2.0, "[0, 0, -1]") + &plane(-2.0, "[0, 0.1, 1]")));
        assert!(tilted.contains("line 11: plane 2: planes 1 and 2 are not parallel"), "{tilted}");
        let volume = "[volume]\nx_mm = [-1, 1]\ny_mm = [-1, 1]\nz_mm = [-5, -3]\nstep_mm = 1\n";
        let in_volume = refused(&(volume.to_owned() + &plane(-4.0, "[0, 0, 1]")));
        assert!(in_volume.contains("plane 1: [volume] reaches 1 mm into the iron, must be before it"), "{in_volume}");
        let behind = refused(&plane(0.75, "[0, 0, -1]"));
        assert!(behind.contains("line 8: plane 1: tile \"a\" reaches 0.25 mm into the iron"), "{behind}");
    }
}
