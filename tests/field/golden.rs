//! B against the tables of `tests/reference`.

use glam::DVec3;
use magsplice_field::{InstructionSet, PointErrorCause, Quantity, Scene};
use magsplice_tests::reference_tables::{self, ReferenceRow};

/// Largest relative error of |B| at any row, a fifth of the bound of `Scene`.
///
/// In the scalar kernel the error of an element of the tensor is about twenty roundings of 1.1e-16
/// in the worst case. The vector kernels multiply it by the distance in sides of the tile, at most
/// 15, or near an edge by 1 / (1 - tanh^2) of its logarithm. Few roundings are at their worst at
/// once: the largest error seen is 6e-15.
const WORST: f64 = 2e-14;

/// Largest median of the relative errors, for roundings that add up at random.
const MEDIAN: f64 = 1e-15;

fn relative_error(row: &ReferenceRow, set: InstructionSet) -> f64 {
    let scene = Scene::new(&[row.tile]).with_instruction_set(set).expect("available");
    let b = scene.field(Quantity::FluxDensity, row.point);
    let b = b.unwrap_or_else(|cause| panic!("row {}: {cause}", row.id));
    let reference = row.flux_density_t(0);
    (b - reference).length() / reference.length()
}

/// Checks a table of `rows` rows with every instruction set of the processor.
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
fn points_near_and_inside() {
    check("generic", 1379);
}

#[test]
fn distant_points() {
    check("far", 856);
}

#[test]
fn points_near_edges_corners_faces_and_their_extensions() {
    check("approach", 3016);
}

#[test]
fn plates_and_needles() {
    check("thin", 900);
}

#[test]
fn tiles_far_from_the_origin() {
    check("offset", 400);
}

#[test]
fn lengths_of_every_scale() {
    check("scale", 1800);
}

/// A tile owns its lower faces, not its upper faces. B on a face is the limit from the owner's
/// side.
#[test]
fn face_points_take_the_limit_from_the_owner() {
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
fn edges_and_corners_are_reported_unbounded() {
    for row in reference_tables::read("singular_points", 40) {
        let scene = Scene::new(&[row.tile]);
        assert_eq!(
            scene.field(Quantity::FluxDensity, row.point),
            Err(PointErrorCause::Unbounded { tile: 0 }),
            "row {}",
            row.id
        );
        assert_eq!(
            scene.field(Quantity::FieldStrength, row.point),
            Err(PointErrorCause::Unbounded { tile: 0 }),
            "row {}",
            row.id
        );
        // J is bounded everywhere.
        let j = scene.field(Quantity::Polarization, row.point).expect("J is bounded");
        assert!(j == DVec3::ZERO || j == row.tile.polarization_t());
    }
}
