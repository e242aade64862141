//! Discs as strips and waves in slices, against other computations.

use std::f64::consts::TAU;

use magsplice::prelude::*;

/// The field of a layout at points.
fn field_t(text: &str, points: &[DVec3]) -> Vec<DVec3> {
    let layout = Layout::parse(text, "layout").unwrap_or_else(|error| panic!("{error}"));
    Film::rigid(layout).scene().field_at(Quantity::FluxDensity, points).unwrap_or_else(|error| panic!("{error}"))
}

/// Discs of 5 mm in diameter one radius away, from magpylib's closed form of the cylinder
/// (reference/README.md). The stated error is kept, and strips have one: a tenth of it at least, at
/// one of the points.
#[test]
fn discs_keep_their_stated_error() {
    let rows: Vec<Vec<f64>> = include_str!("../reference/discs.csv")
        .lines()
        .skip(1)
        .map(|line| line.split(',').map(|cell| cell.parse().expect("a number")).collect())
        .collect();
    for of_disc in rows.chunk_by(|a, b| a[..4] == b[..4]) {
        let [height_mm, x, y, z] = of_disc[0][..4] else { unreachable!("four numbers") };
        let points: Vec<DVec3> = of_disc.iter().map(|row| DVec3::from_slice(&row[4..7])).collect();
        let known_t: Vec<DVec3> = of_disc.iter().map(|row| DVec3::from_slice(&row[7..])).collect();
        let largest_t = known_t.iter().map(|b| b.length()).fold(0.0, f64::max);
        for error in [0.05, 0.01, 0.001] {
            let text = format!(
                "format = 1\nname = \"disc\"\n[[tile]]\nshape = \"disc\"\ndiameter_mm = 5\nheight_mm = {height_mm}\n\
                 shape_error = {error}\nposition_mm = [0, 0, 0]\npolarization_t = [{x}, {y}, {z}]\n"
            );
            let found_t = field_t(&text, &points);
            let errors = found_t.iter().zip(&known_t).map(|(found, known)| (*found - *known).length() / largest_t);
            let largest = errors.fold(0.0, f64::max);
            assert!(largest < error && largest > 0.1 * error, "{height_mm} mm, {error}: {largest}");
        }
    }
}

fn wave(direction: &str, slices: usize, length_mm: [f64; 2], axes: &str) -> String {
    let start = length_mm.map(|length| -0.5 * length);
    format!(
        "format = 1\nname = \"wave\"\n[[lattice]]\nstart_mm = [{:?}, {:?}, 0]\nheight_mm = 1\ncomponent_t = 0.12\n\
         wave = {{ wavelength_mm = 10, slices = {slices}, direction = \"{direction}\", length_mm = {length_mm:?}, \
         axes = {axes} }}\n",
        start[0], start[1]
    )
}

/// A film whose ends are far away: slices cut them differently.
const LONG_MM: [f64; 2] = [1000.0, 100.0];

/// N slices against forty, whose error is exp(-38 k z): the difference is below the stated error,
/// and not far below. Below a one-sided film the wave of order N - 1 cancels, as the film's field
/// does above it.
#[test]
fn slices_keep_their_stated_error() {
    for direction in ["in-plane", "upright", "one-sided"] {
        for (slices, z) in [(4, -3.0), (5, -3.0), (6, -3.0), (4, -5.0), (6, -2.0)] {
            let points: Vec<DVec3> = (0..20).map(|n| DVec3::new(0.5 * f64::from(n), 1.3, z)).collect();
            let [few, many] = [slices, 40].map(|slices| field_t(&wave(direction, slices, LONG_MM, "[\"x\"]"), &points));
            let largest_t = many.iter().map(|b| b.length()).fold(0.0, f64::max);
            let error =
                few.iter().zip(&many).map(|(few, many)| (*few - *many).length()).fold(0.0, f64::max) / largest_t;
            let stated = ((slices as f64 - 2.0) * TAU / 10.0 * z).exp();
            let least = if direction == "one-sided" { 0.0 } else { 0.1 * stated };
            assert!(error < stated && error > least, "{direction}, {slices} at {z}: {error}, stated {stated}");
        }
    }
}

/// The wave in the plane is that of the ideal film, whose field is (1, 1, 1) times its own in the
/// middle of a large film. A one-sided film has twice its field below, and hardly any above.
#[test]
fn waves_are_those_of_the_ideal_film() {
    let ideal = IdealFilm::new(10.0, 1.0, 0.12).expect("a film");
    let points: Vec<DVec3> = (0..10).map(|n| DVec3::new(0.5 * f64::from(n) - 2.0, 0.7, -3.0)).collect();
    let in_plane = field_t(&wave("in-plane", 20, [60.0; 2], "[\"x\", \"y\"]"), &points);
    let largest_t =
        points.iter().map(|point| ideal.flux_density_t(*point).expect("below").length()).fold(0.0, f64::max);
    for (point, found) in points.iter().zip(&in_plane) {
        let known = ideal.flux_density_t(*point).expect("below");
        assert!((*found - known).length() < 0.02 * largest_t, "{point}: {found}, not {known}");
    }
    let above: Vec<DVec3> = points.iter().map(|point| DVec3::new(point.x, point.y, 4.0)).collect();
    let one_sided = wave("one-sided", 20, [60.0; 2], "[\"x\", \"y\"]");
    let length = |of: &[DVec3]| of.iter().map(|b| b.length()).fold(0.0, f64::max);
    assert!(length(&field_t(&one_sided, &points)) > 1.9 * largest_t);
    assert!(length(&field_t(&one_sided, &above)) < 0.1 * largest_t);
}
