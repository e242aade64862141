//! Endless splicing patterns, against very large films and against series in closed form.

use std::f64::consts::{FRAC_1_SQRT_2, TAU};

use glam::{DQuat, DVec2, DVec3};
use magsplice_field::Scene;
use magsplice_ideal::IdealFilm;
use magsplice_layout::Layout;
use magsplice_magnet::{Quantity, Tile};
use magsplice_tolerance::{EndlessPattern, EndlessPatternError, EvaluationGrid};

/// The wavelength in mm.
const WAVELENGTH: f64 = 10.0;

fn published_film() -> Layout {
    Layout::read("../../layouts/published-film.toml").unwrap_or_else(|error| panic!("{error}"))
}

fn ideal() -> IdealFilm {
    IdealFilm::new(WAVELENGTH, 1.0, 0.12).expect("a film")
}

/// Tiles within one period without a net moment, some of them turned about z, one tilted by a
/// quarter turn, of two heights, magnetized in and out of the plane.
fn one_period() -> Vec<Tile> {
    let tile = |x: f64, y: f64, z: f64, size: [f64; 3], j_t: [f64; 3], turn: DQuat| {
        Tile::new(DVec3::new(x, y, z), DVec3::from(size), turn.inverse() * DVec3::from(j_t))
            .and_then(|tile| tile.rotated(turn))
            .expect("a tile")
    };
    let quarter = std::f64::consts::FRAC_PI_2;
    vec![
        tile(-2.5, -2.4, 0.5, [3.0, 3.0, 1.0], [0.1, 0.05, 0.0], DQuat::from_rotation_z(0.3)),
        tile(2.3, -2.5, 0.5, [3.0, 3.0, 1.0], [-0.1, 0.02, 0.06], DQuat::IDENTITY),
        tile(2.6, 2.2, 0.75, [3.0, 2.0, 1.5], [0.03, -0.07, -0.06], DQuat::from_rotation_z(-1.1)),
        tile(-2.2, 2.6, 0.5, [3.0, 1.0, 3.0], [-0.03, 0.0, 0.0], DQuat::from_rotation_x(quarter)),
    ]
}

/// The field of n x n periods, n odd, at points.
fn repeated_t(period: &[Tile], n: i32, points: &[DVec3]) -> Vec<DVec3> {
    let shifts = -(n / 2)..=n / 2;
    let tiles: Vec<Tile> = shifts
        .clone()
        .flat_map(|i| shifts.clone().map(move |j| WAVELENGTH * DVec3::new(f64::from(i), f64::from(j), 0.0)))
        .flat_map(|shift| {
            period.iter().map(move |tile| {
                Tile::new(tile.position() + shift, tile.size(), tile.polarization_t())
                    .and_then(|moved| moved.rotated(tile.rotation()))
                    .expect("a tile")
            })
        })
        .collect();
    let scene = Scene::new(&tiles);
    points.iter().map(|point| scene.field(Quantity::FluxDensity, *point).expect("a field")).collect()
}

/// An upper bound of the field of all periods beyond n x n, at points within 2.5 mm of the centre
/// along x and y and 5 mm along z. A tile at R + s has the field f(R + s - r) of a dipole m dV. The
/// moments of a period have no sum, and periods at R and -R have opposite first moments in f. Only
/// second derivatives remain, at most 24 |m| / (4 pi d^5) at the distance d times half the square
/// of the shift |s| + |r|.
fn beyond_t(period: &[Tile], n: i32) -> f64 {
    let reach = 0.5 * WAVELENGTH * 2.0_f64.sqrt() + DVec3::new(2.5, 2.5, 5.0).length();
    let moment: f64 = period.iter().map(|tile| tile.polarization_t().length() * tile.size().element_product()).sum();
    let half = n / 2;
    let most = 40 * half;
    let mut sum = 0.0;
    for i in -most..=most {
        for j in -most..=most {
            if i.abs().max(j.abs()) > half {
                let distance = WAVELENGTH * DVec2::new(f64::from(i), f64::from(j)).length() - reach;
                sum += 0.5 * moment * reach * reach * 24.0 / (2.0 * TAU * distance.powi(5));
            }
        }
    }
    // Beyond `most`, at most 4 squares of sides 1 per unit of length: an integral of 8 r / r^5.
    sum + 0.5 * moment * reach * reach * 24.0 / (2.0 * TAU) * 8.0
        / (3.0 * WAVELENGTH.powi(5) * f64::from(most - 2).powi(3))
}

#[test]
fn endless_pattern_is_the_limit_of_large_films() {
    let period = one_period();
    let points = [DVec3::new(0.0, 0.0, -3.0), DVec3::new(2.0, -1.0, -3.5), DVec3::new(-1.3, 1.7, -5.0)];
    let endless =
        EndlessPattern::new(&period, &ideal()).and_then(|pattern| pattern.flux_density_t(&points)).expect("a field");
    let films = [15, 31, 63].map(|n| (n, repeated_t(&period, n, &points)));
    for (n, film) in &films {
        let allowed = beyond_t(&period, *n);
        for (film, endless) in film.iter().zip(&endless) {
            assert!((*film - *endless).length() < allowed, "{n}: {film}, not {endless} within {allowed}");
        }
    }
    // The missing field falls as n^-3, then n^-5: the sum over R of even derivatives. Without the
    // first term the remaining difference falls by 32 from one pair of films to the next, to a 31st
    // of the change between them. A tenth is allowed.
    let limit = |(a, of_a): &(i32, Vec<DVec3>), (b, of_b): &(i32, Vec<DVec3>), at: usize| {
        let [a, b] = [a, b].map(|n| f64::from(*n).powi(3));
        (of_b[at] * b - of_a[at] * a) / (b - a)
    };
    for (at, endless) in endless.iter().enumerate() {
        let [first, second] = [limit(&films[0], &films[1], at), limit(&films[1], &films[2], at)];
        let (change, difference) = (second.distance(first), second.distance(*endless));
        assert!(difference < 0.1 * change && change < 1e-9, "{endless}, not {second}, which has changed by {change}");
    }
}

/// The published pattern along x is a wave of strength 1 that is zero in narrow intervals, times 1
/// along narrow intervals of y and 2^-1/2 along wide ones. All harmonics of the field follow.
#[test]
fn field_of_the_published_pattern_is_the_sum_of_its_known_harmonics() {
    let film = published_film();
    let pattern = EndlessPattern::new(&film.bare_tiles(), &ideal()).expect("a pattern");
    let k = TAU / WAVELENGTH;
    // Half of the sine series of the wave, and the cosine series of the weight.
    let wave = |m: i32| {
        let q = f64::from(m) * k;
        if m == 0 { 0.0 } else { 2.0 / WAVELENGTH * ((0.85 * q).cos() - (4.15 * q).cos()) / q }
    };
    let weight = |n: i32| {
        let q = f64::from(n) * k;
        let wide = if n == 0 { 0.66 } else { 2.0 / WAVELENGTH * ((4.15 * q).sin() - (0.85 * q).sin()) / q };
        f64::from(u8::from(n == 0)) - (1.0 - FRAC_1_SQRT_2) * wide
    };
    // At 4 mm and below, harmonics beyond 20 have less than e^(-47) of the first. The pattern
    // neglects at most 1e-13 of mean |J| e^(-kh), 1e-15 T, and rounding is as large.
    let points = [DVec3::new(0.3, -0.7, -4.0), DVec3::new(2.2, 1.9, -4.5), DVec3::new(-4.1, 0.0, -6.0)];
    let found_t = pattern.flux_density_t(&points).expect("a field");
    for (point, found_t) in points.iter().zip(found_t) {
        let mut wanted_t = DVec3::ZERO;
        for (m, n) in (-20..=20_i32).flat_map(|m| (-20..=20_i32).map(move |n| (m, n))) {
            let q = k * DVec2::new(f64::from(m), f64::from(n));
            if q.length() == 0.0 {
                continue;
            }
            // J is -i times these, so -i q J is real.
            let charge = -(q.x * wave(m) * weight(n) + q.y * weight(m) * wave(n)) * 0.12;
            let decay = (q.length() * point.z).exp() * -(-q.length()).exp_m1();
            let potential = charge * decay / (2.0 * q.length_squared());
            // The real part of -(i q_x, i q_y, |q|) times the potential times e^(i q r).
            let (sine, cosine) = q.dot(point.truncate()).sin_cos();
            wanted_t += potential * DVec3::new(q.x * sine, q.y * sine, -q.length() * cosine);
        }
        assert!(found_t.distance(wanted_t) < 2e-15, "{point}: {found_t}, not {wanted_t}");
    }
    // Wide intervals of about two thirds of half a wavelength nearly cancel the third harmonic.
    assert!((wave(3) / wave(1)).abs() < 0.013);
    // The amplitude against the ideal film is the amplitude of the first harmonic, 0.884, except
    // for the effect of harmonics such as (1, 2), which are not orthogonal to it in a volume of
    // less than a wavelength.
    let volume = film.volume.as_ref().expect("stated");
    let volume = EvaluationGrid { grid: volume.grid, reference: volume.reference_mm };
    let errors = pattern.errors(&volume).expect("errors");
    assert!((errors.amplitude - 2.0 * wave(1) * weight(0)).abs() < 5e-3, "{errors:?}");
    // The uniformity RMSE of R_x of the same pattern on a film of 80 mm, and its rounding.
    assert!((errors.uniformity_rmse.r_x.unwrap() - 0.0031).abs() < 1e-4, "{errors:?}");
}

/// Many narrow tiles with the polarization of the ideal film at their centres. Their first
/// harmonics are the ideal film's times sinc(pi / n) twice, for the average over x and over y of
/// one component each, and the next are n - 1 and n + 1.
#[test]
fn pattern_of_narrow_tiles_is_the_ideal_film() {
    let n = 20;
    let width = WAVELENGTH / f64::from(n);
    let k = TAU / WAVELENGTH;
    // They begin off the border, so the border cuts tiles.
    let centres: Vec<f64> = (-1..=n).map(|i| (f64::from(i) + 0.2) * width - 0.5 * WAVELENGTH).collect();
    let tiles: Vec<Tile> = centres
        .iter()
        .flat_map(|&x| centres.iter().map(move |&y| (x, y)))
        .map(|(x, y)| {
            let j_t = 0.12 * DVec3::new((k * x).sin(), (k * y).sin(), 0.0);
            Tile::new(DVec3::new(x, y, 0.5), DVec3::new(width, width, 1.0), j_t).expect("a tile")
        })
        .collect();
    let pattern = EndlessPattern::new(&tiles, &ideal()).expect("a pattern");
    let volume = published_film().volume.expect("stated");
    let errors = pattern.errors(&EvaluationGrid { grid: volume.grid, reference: volume.reference_mm }).expect("errors");
    let half = 0.5 * k * width;
    assert!((errors.amplitude - half.sin() / half).abs() < 1e-12, "{errors:?}");
    // e^(-18 k 3) is below 1e-14.
    assert!(errors.displacement_rmse_mm.to_array().into_iter().all(|error| error < 1e-11), "{errors:?}");
}

#[test]
fn patterns_that_do_not_exist_are_errors() {
    let tilted = one_period()[0].rotated(DQuat::from_rotation_x(0.1)).expect("a tile");
    let found = EndlessPattern::new(&[one_period()[1], tilted], &ideal());
    assert_eq!(found.err(), Some(EndlessPatternError::Tilted(vec![1])));
    let far = Tile::new(DVec3::new(20.0, 0.0, 0.5), DVec3::ONE, DVec3::X).expect("a tile");
    assert_eq!(EndlessPattern::new(&[far], &ideal()).err(), Some(EndlessPatternError::Empty));
    let pattern = EndlessPattern::new(&one_period(), &ideal()).expect("a pattern");
    let at = |z: f64| pattern.flux_density_t(&[DVec3::new(0.0, 0.0, z)]);
    for z in [0.1, 0.0] {
        assert!(matches!(at(z), Err(EndlessPatternError::NotBelow { .. })), "{z}");
    }
    assert!(matches!(at(f64::NAN), Err(EndlessPatternError::NotBelow { .. })));
    let Err(EndlessPatternError::TooNear { least_mm, .. }) = at(-0.01) else { panic!("too near") };
    assert!(least_mm < 0.1 * WAVELENGTH && at(-least_mm).is_ok() && at(-0.9 * least_mm).is_err(), "{least_mm}");
}
