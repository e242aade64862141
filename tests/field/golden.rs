//! B against the reference tables of `tests/reference`.

use glam::DVec3;
use magsplice_field::{Cause, InstructionSet, Quantity, Scene};
use magsplice_tests::reference_tables::{self, ReferenceRow};

/// Allowed relative error of |B| at any row: what `Scene` promises. In the kernel of one point an element of the tensor is off by about twenty
/// roundings of 1.1e-16 in the worst case; in the forms in vectors by that times the distance in sides of the tile, at most 15, or, nearer
/// than that to an edge, times what 1 / (1 - tanh^2) of its logarithm is. Few roundings are at their worst at once: the worst seen is 6e-15.
const WORST: f64 = 2e-14;

/// Allowed median: roundings that add up at random.
const MEDIAN: f64 = 1e-15;

fn relative_error(row: &ReferenceRow, set: InstructionSet) -> f64 {
    let scene = Scene::new(&[row.tile]).with_instruction_set(set).expect("available");
    let b = scene.field(Quantity::FluxDensity, row.point);
    let b = b.unwrap_or_else(|cause| panic!("row {}: {cause}", row.id));
    let reference = row.flux_density_t(0);
    (b - reference).length() / reference.length()
}

/// With the instructions of every kind that the processor has.
fn check(table: &str, rows: usize) {
    let rows = reference_tables::read(table, rows);
    for set in InstructionSet::available() {
        let mut errors: Vec<(f64, &ReferenceRow)> = rows.iter().map(|row| (relative_error(row, set), row)).collect();
        errors.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (worst, row) = errors.last().expect("the table has rows");
        assert!(*worst <= WORST, "{set:?}, {table}: {worst:.1e} at row {} ({} {})", row.id, row.set, row.tag);
        let median = errors[errors.len() / 2].0;
        assert!(median <= MEDIAN, "{set:?}, {table}: median {median:.1e}");
    }
}

#[test]
fn generic_points() {
    check("generic", 1379);
}

#[test]
fn far_points() {
    check("far", 856);
}

#[test]
fn near_edges_corners_faces_and_their_extensions() {
    check("approach", 3016);
}

#[test]
fn plates_and_needles() {
    check("thin", 900);
}

#[test]
fn away_from_the_origin() {
    check("offset", 400);
}

#[test]
fn every_scale() {
    check("scale", 1800);
}

/// A point on a face belongs to the tile on the lower faces and not on the upper ones, and B is the limit from that side.
#[test]
fn on_faces_the_owner_decides_the_side() {
    for row in reference_tables::read("face_points", 36) {
        let from_centre = row.point - row.tile.position();
        let half = 0.5 * row.tile.size();
        let inside = from_centre.cmpge(-half).all() && from_centre.cmplt(half).all();
        let limit = row.flux_density_t(usize::from(!inside));
        let b = Scene::new(&[row.tile]).field(Quantity::FluxDensity, row.point).expect("bounded on a face");
        assert!((b - limit).length() <= WORST * limit.length(), "row {}: {b}, not {limit}", row.id);
    }
}

#[test]
fn on_edges_and_corners_the_field_is_declared_unbounded() {
    for row in reference_tables::read("singular_points", 40) {
        let scene = Scene::new(&[row.tile]);
        assert_eq!(scene.field(Quantity::FluxDensity, row.point), Err(Cause::Unbounded { tile: 0 }), "row {}", row.id);
        assert_eq!(
            scene.field(Quantity::FieldStrength, row.point),
            Err(Cause::Unbounded { tile: 0 }),
            "row {}",
            row.id
        );
        // J is bounded everywhere.
        let j = scene.field(Quantity::Polarization, row.point).expect("J is bounded");
        assert!(j == DVec3::ZERO || j == row.tile.polarization_t());
    }
}
