//! Findings about lengths and about bounds: each where it is just made, and just not.

use magsplice_layout::Layout;

const VOLUME: &str = "x_mm = [-2, 2]\ny_mm = [-2, 2]\nz_mm = [-5, -3]\nstep_mm = 1";

/// A tile with its lower face at this height.
fn tile(size_mm: [f64; 3], lower_mm: f64) -> String {
    let z_mm = lower_mm + 0.5 * size_mm[2];
    format!("[[tile]]\nposition_mm = [0, 0, {z_mm}]\nsize_mm = {size_mm:?}\npolarization_t = [0.1, 0, 0]\n")
}

/// The findings about a film with these ideal film, volume, other tables and tiles.
fn found(ideal: [f64; 2], volume: &str, others: &str, tiles: &str) -> Vec<String> {
    let [wavelength_mm, thickness_mm] = ideal;
    let layout = Layout::parse(
        &format!(
            "format = 1\nname = \"film\"\n[ideal]\nwavelength_mm = {wavelength_mm}\nthickness_mm = {thickness_mm}\n\
             amplitude_t = 0.12\n[volume]\n{volume}\n{others}{tiles}"
        ),
        "film.toml",
    );
    layout.unwrap_or_else(|error| panic!("{error}")).findings.iter().map(ToString::to_string).collect()
}

/// Whether one of the findings begins so, and whether there is none with its first four words.
#[track_caller]
fn assert_found(findings: &[String], beginning: &str, is_made: bool) {
    let words: Vec<&str> = beginning.split(' ').take(4).collect();
    let wanted = if is_made { beginning.to_owned() } else { words.join(" ") };
    let number = findings.iter().filter(|finding| finding.starts_with(&wanted)).count();
    assert_eq!(number, usize::from(is_made), "{beginning:?} of {findings:?}");
}

#[test]
fn films_beside_the_ideal_film_are_findings() {
    let of = |tiles: &str| found([10.0, 1.0], VOLUME, "", tiles);
    assert_eq!(of(&tile([8.0, 8.0, 1.0], 0.0)), [""; 0]);
    // A thousandth of the wavelength, 0.01 mm, above and below.
    let at = |lower: f64| of(&tile([8.0, 8.0, 1.0], lower));
    let message = "the film is at z = 0.011 .. 1.011 mm, and the ideal film fills 0 <= z <= 1 mm with the sensor below, \
                   at z < 0: move the tiles and the volume by -0.011 mm along z";
    assert_found(&at(0.011), message, true);
    assert_found(&at(-0.011), "the film is at z = -0.011 .. 0.989 mm", true);
    assert!([0.009, -0.009].into_iter().all(|lower| at(lower).is_empty()));
    // Three standard deviations of two lower faces count too, 12 um of faces 8 um apart. A tile
    // upon the others has no lower face of the film.
    let beside = |lower: f64| tile([2.0, 2.0, 1.0], lower).replace("[0, 0,", "[6, 0,");
    let two = |lower: f64, other: f64| of(&(tile([8.0, 8.0, 1.0], lower) + &beside(other)));
    assert_eq!(two(0.017, 0.025), [""; 0]);
    assert_found(&two(0.019, 0.027), "the film is at z = 0.019 .. 1.027 mm", true);
    // The mean face counts: one tile that was laid too low is no other place of the film.
    assert_eq!(two(-0.4, 0.3), [""; 0]);
    assert_found(&two(0.021, 1.5), "the film is at z = 0.021 .. 2.5 mm", true);
    // Upside down, with the volume above.
    let above = VOLUME.replace("[-5, -3]", "[3, 5]");
    let turned = found([10.0, 1.0], &above, "", &tile([8.0, 8.0, 1.0], -1.0));
    assert!(turned[0].ends_with("turn the film and the volume over, so that the film stands on z = 0"), "{turned:?}");
    assert_found(&turned, "volume: z_mm = [3, 5] is not below the film: the ideal film fills 0 <= z <= 1 mm", true);
    let between = found([10.0, 1.0], &above, "", &tile([8.0, 8.0, 1.0], -0.5));
    assert!(between[0].ends_with("move the tiles and the volume by 0.5 mm along z"), "{between:?}");
    let below = found([10.0, 1.0], VOLUME, "", &tile([8.0, 8.0, 1.0], -1.0));
    assert!(below[0].ends_with("move the tiles and the volume by 1 mm along z"), "{below:?}");
    let touching = found([10.0, 1.0], &VOLUME.replace("[-5, -3]", "[-5, 0]"), "", &tile([8.0, 8.0, 1.0], 0.0));
    assert_found(&touching, "volume: z_mm = [-5, 0] is not below the film", true);
    assert_eq!(touching.len(), 1, "{touching:?}");
}

#[test]
fn lengths_of_another_magnitude_are_findings() {
    let plain = |ideal: [f64; 2], size_mm: [f64; 3]| found(ideal, VOLUME, "", &tile(size_mm, 0.0));
    // 3 % of the wavelength.
    let small = "the film measures 0.299 mm along y, a small fraction of the wavelength of [ideal], 10 mm";
    assert_found(&plain([10.0, 1.0], [0.2, 0.299, 1.0]), small, true);
    assert_found(&plain([10.0, 1.0], [0.299, 0.2, 1.0]), &small.replace("along y", "along x"), true);
    assert_found(&plain([10.0, 1.0], [0.301, 0.2, 1.0]), small, false);
    // 30 times as high, or as low.
    for (height, is_made) in [(30.1, true), (29.9, false), (0.0333, true), (0.0334, false)] {
        let message = format!("the tiles are {height} mm high and the film of [ideal] 1 mm: is one of them in m?");
        assert_found(&plain([10.0, 1.0], [8.0, 8.0, height]), &message, is_made);
    }
    for (thickness, is_made) in [(0.0099, true), (0.0101, false)] {
        let message = format!("ideal: thickness_mm = {thickness} is less than a thousandth of the wavelength, 10 mm; ");
        assert_found(&plain([10.0, thickness], [8.0, 8.0, 1.0]), &message, is_made);
    }
    for (wavelength, is_made) in [(0.099, true), (0.101, false)] {
        let message = format!("ideal: wavelength_mm = {wavelength} is below 0.1 mm, too short for a spliced film; ");
        assert_found(&plain([wavelength, 1.0], [8.0, 8.0, 1.0]), &message, is_made);
    }
    // Of 8 mm, 150 times as much and a thousandth.
    let film = tile([7.0, 8.0, 1.0], 0.0);
    for (half, is_made) in [(605.0, true), (600.0, false)] {
        let volume = VOLUME.replacen("[-2, 2]", &format!("[-{half}, {half}]"), 1).replace("step_mm = 1", "step_mm = 2");
        let message = format!(
            "the film measures 8 mm along y, and the working volume {} mm along x, more than 150 times as much: are the \
             tiles in m, not mm?",
            2.0 * half
        );
        assert_found(&found([10.0, 1.0], &volume, "", &film), &message, is_made);
    }
    for (x, is_made) in [("0.0039", true), ("0.0041", false)] {
        let volume = format!("x_mm = [-{x}, {x}]\ny_mm = [0, 0]\nz_mm = [-4, -4]\nstep_mm = {x}");
        let message = "the working volume measures 0.0078 mm along x, and the film 8 mm along y, more than 1000 times as \
                       much: is the volume in m, not mm?";
        assert_found(&found([10.0, 1.0], &volume, "", &film), message, is_made);
    }
    let point = "x_mm = [0, 0]\ny_mm = [0, 0]\nz_mm = [-4, -4]\nstep_mm = 1";
    assert_found(&found([10.0, 1.0], point, "", &film), "the working volume measures 0 mm", false);
}

#[test]
fn volumes_beside_the_axis_and_the_film_are_findings() {
    let of = |volume: &str| found([10.0, 1.0], volume, "", &tile([8.0, 6.0, 1.0], 0.0));
    for (axis, range, film) in
        [("x", "[-4.5, 2]", "-4 to 4"), ("x", "[-2, 4.5]", "-4 to 4"), ("y", "[-3.5, 2]", "-3 to 3")]
    {
        let volume = VOLUME.replace(&format!("{axis}_mm = [-2, 2]"), &format!("{axis}_mm = {range}"));
        let volume = format!("{}\nreference_mm = [0, 0, -4]", volume.replace("step_mm = 1", "step_mm = 0.5"));
        let message = format!("volume: {axis}_mm = {range} reaches beyond the film, which fills {film} mm: ");
        let findings = of(&volume);
        assert!(findings.len() == 1 && findings[0].starts_with(&message), "{findings:?}");
    }
    assert_eq!(of("x_mm = [-4, 4]\ny_mm = [-3, 3]\nz_mm = [-5, -3]\nstep_mm = 1"), [""; 0]);
    // A twentieth of half the wavelength, 0.25 mm, beside multiples of it.
    for (x, y, is_made) in [
        (0.25, 0.0, false),
        (0.0, -0.24, false),
        (-4.76, 5.24, false),
        (0.26, 0.0, true),
        (0.0, -0.26, true),
        (4.74, 0.0, true),
        (2.5, 0.1, true),
    ] {
        let findings = of(&format!("{VOLUME}\nreference_mm = [{x}, {y}, -4]"));
        let message = format!(
            "volume: reference_mm = [{x}, {y}, ...] is not on the axis of the film, nor half wavelengths, 5 mm, beside it"
        );
        assert_eq!(findings.len(), usize::from(is_made), "{findings:?}");
        assert!(findings.iter().all(|finding| finding.starts_with(&message)), "{findings:?}");
    }
    // Three points along z, and one in each plane normal to z although the planes have an extent.
    let thin = of("x_mm = [-1, 1]\ny_mm = [0, 0]\nz_mm = [-5, -3]\nstep_mm = [3, 1, 1]\nreference_mm = [0, 0, -4]");
    let message = "volume: the grid has 1 x 1 x 3 points, only one in each plane normal to z: the uniformity RMSE";
    assert_found(&thin, message, true);
    // A line along z, whose planes are points.
    let line = of("x_mm = [0, 0]\ny_mm = [0, 0]\nz_mm = [-5, -3]\nstep_mm = 1");
    assert_found(&line, message, false);
}

/// Volumes nearer than a hundredth of the wavelength, 0.1 mm, to a film with its lower face at 0.
/// In metres are volumes that lie there with both ends, and that are at 0.1 mm or more in mm.
#[test]
fn volumes_near_the_film_are_findings() {
    let of = |range: &str| {
        let volume = VOLUME.replace("[-5, -3]", range).replace("step_mm = 1", "step_mm = [1, 1, 0.0001]");
        found([10.0, 1.0], &volume, "", &tile([8.0, 8.0, 1.0], 0.0))
    };
    let near = |range: &str, distance: &str| {
        format!(
            "volume: z_mm = {range} begins {distance} mm from the film, nearer than a hundredth of the wavelength, 10 mm"
        )
    };
    let in_metres = "; did you mean -5 .. -3 mm, which is -0.005 .. -0.003 m?";
    assert_eq!(of("[-0.005, -0.003]"), [near("[-0.005, -0.003]", "0.003") + in_metres]);
    // At 0.1 mm in mm and just below it.
    assert!(of("[-0.005, -0.0001]")[0].ends_with("which is -0.005 .. -0.0001 m?"));
    assert_eq!(of("[-0.00509, -0.00009]"), [near("[-0.00509, -0.00009]", "0.00009")]);
    // With the lower end at 0.1 mm.
    assert_eq!(of("[-0.1, -0.05]"), [near("[-0.1, -0.05]", "0.05")]);
    assert_eq!(of("[-0.2, -0.1]"), [""; 0]);
    // Beside the film along x, as far as below it.
    let beside = "x_mm = [4.08, 5]\ny_mm = [0, 0]\nz_mm = [-0.05, -0.05]\nstep_mm = 1\nreference_mm = [0, 0, -1]";
    let of_beside = |volume: &str| {
        let findings = found([10.0, 1.0], volume, "", &tile([8.0, 8.0, 1.0], 0.0));
        findings.iter().any(|finding| finding.contains(" begins 0.05 mm from the film"))
    };
    assert!(of_beside(beside) && !of_beside(&beside.replace("4.08", "4.09")));
}

/// Tiles without a field, and stronger ones than magnets by more than the round-off of components.
#[test]
fn tiles_of_unusual_strength_are_findings() {
    let of = |j_t: [f64; 3]| {
        let tile = tile([8.0, 8.0, 1.0], 0.0).replace("[0.1, 0, 0]", &format!("{j_t:?}"));
        found([10.0, 1.0], VOLUME, "", &tile)
    };
    assert_eq!(of([0.0; 3]), ["tile \"tile-1\" has no polarization, so no field"]);
    let strong = "tile \"tile-1\": a polarization of 2.1 T is above 2 T, more than any permanent magnet has";
    assert_eq!(of([0.0, -2.1, 0.0]), [strong]);
    assert_eq!(of([0.0, 0.0, 2.0]), [""; 0]);
    // 2 T in 6 and 8 parts of ten, whose squares have round-off.
    assert_eq!(of([1.2, 1.6, 0.0]), [""; 0]);
}

#[test]
fn coefficients_of_temperature_above_zero_are_findings() {
    let of = |strength_per_k: f64| {
        let table = format!("[tolerance.temperature]\nchange_k = 10\nstrength_per_k = {strength_per_k}\n");
        found([10.0, 1.0], VOLUME, &table, &tile([8.0, 8.0, 1.0], 0.0))
    };
    let positive = of(0.001);
    let message = ": strength_per_k = 0.001 is positive, and magnets become weaker as they get warmer";
    assert!(positive.len() == 1 && positive[0].ends_with(message), "{positive:?}");
    assert_eq!(of(-0.001), [""; 0]);
    let none = of(0.0);
    assert!(none.len() == 1 && !none[0].contains("positive"), "{none:?}");
}

/// Overlaps of at most a fiftieth of the longest side may come from rounded numbers.
#[test]
fn shallow_overlaps_may_be_allowed() {
    let of = |depth_mm: f64| {
        let tile = |x: f64| {
            format!("[[tile]]\nposition_mm = [{x}, 0, 0.5]\nsize_mm = [10, 4, 1]\npolarization_t = [0.1, 0, 0]\n")
        };
        let text = format!("format = 1\nname = \"film\"\n{}{}", tile(0.0), tile(10.0 - depth_mm));
        Layout::parse(&text, "film.toml").expect_err("an overlap").to_string()
    };
    let shallow = of(0.19);
    assert!(shallow.contains("overlaps tile \"tile-1\" before it by 0.19 mm"), "{shallow}");
    assert!(shallow.contains("perhaps because their numbers are rounded: overlap_mm = 0.19 allows it"), "{shallow}");
    assert!(!of(0.21).contains("rounded"), "{}", of(0.21));
}

/// At most twenty lines. The advice to allow shallow overlaps is one of them, and so is the line
/// about further pairs.
#[test]
fn overlaps_are_listed_up_to_a_limit() {
    let of = |pairs: usize, depth_mm: f64| {
        let tile = |x: f64, y: usize| {
            let y = 2 * y;
            format!("[[tile]]\nposition_mm = [{x}, {y}, 0.5]\nsize_mm = [1, 1, 1]\npolarization_t = [0.1, 0, 0]\n")
        };
        let tiles: String = (0..pairs).map(|y| tile(0.0, y) + &tile(1.0 - depth_mm, y)).collect();
        let message = Layout::parse(&format!("format = 1\nname = \"film\"\n{tiles}"), "film.toml");
        let message = message.expect_err("overlaps").to_string();
        let lines: Vec<&str> = message.lines().collect();
        let count = |text: &str| lines.iter().filter(|line| line.contains(text)).count();
        [count("before it by"), count("more pairs of tiles overlap"), count("perhaps because")]
    };
    for (pairs, depth_mm, known) in [
        (18, 0.5, [18, 0, 0]),
        (19, 0.5, [19, 0, 0]),
        (20, 0.5, [19, 1, 0]),
        (30, 0.5, [19, 1, 0]),
        (18, 0.01, [18, 0, 1]),
        (19, 0.01, [18, 1, 1]),
        (30, 0.01, [18, 1, 1]),
    ] {
        assert_eq!(of(pairs, depth_mm), known, "{pairs} {depth_mm}");
    }
}

/// Bounds that every film keeps, or in another unit, and bounds just beside them.
#[test]
fn bounds_without_a_meaning_are_findings() {
    let of = |keys: &str| found([10.0, 1.0], VOLUME, &format!("[expect]\n{keys}\n"), &tile([8.0, 8.0, 1.0], 0.0));
    for (keys, messages) in [
        (
            "uniformity_rmse = { r_x = 3.2, r_y = 3.1, s_z = 3.2 }",
            &[
                "uniformity_rmse.r_x = 3.2 is met by every film: it bounds an angle in rad, not in mrad or degrees",
                "uniformity_rmse.s_z = 3.2 is met by almost every film: S_z is a natural logarithm, so that a flux \
                 density may vary by a factor of exp(3.2) at equal z; it is no percentage",
            ][..],
        ),
        (
            "displacement_rmse_mm = { x = 250, y = 4.9, z = 5000 }",
            &[
                "displacement_rmse_mm.x = 250 is met by every film: it is not below half the wavelength, 5 mm; did you \
                 mean 0.25 mm, which is 250 um?",
                "displacement_rmse_mm.z = 5000 is met by almost every film: it is not below half the wavelength, 5 mm",
            ],
        ),
        (
            "displacement_rmse_mm = { y = 5 }",
            &[
                "displacement_rmse_mm.y = 5 is met by every film: it is not below half the wavelength, 5 mm; did you mean \
               0.005 mm, which is 5 um?",
            ],
        ),
        (
            "clearance_mm = { min = -0.5 }",
            &[
                "clearance_mm.min = -0.5 lets tiles reach 0.5 mm into the working volume, in the way of the sensor: give at \
               least 0",
            ],
        ),
        ("clearance_mm = { min = 0 }", &[]),
        (
            "amplitude = { min = 0 }",
            &[
                "amplitude.min = 0 is also met by a film that is reversed or has no field: give a fraction of the ideal \
               film's field, such as 0.8",
            ],
        ),
        (
            "amplitude = { min = 82.5 }",
            &["amplitude.min = 82.5 is a fraction of the ideal film's field, so 8250 %: did you mean 0.825?"],
        ),
        ("amplitude = { min = 10 }", &[]),
        (
            "field = { file = \"a.csv\", within = 0.1 }",
            &["field.within = 0.1 is a fraction of |B|, 10 %, and accepts a film that is far from its baseline"],
        ),
        ("field = { file = \"a.csv\", within = 0.09 }", &[]),
    ] {
        let wanted: Vec<String> = messages.iter().map(|message| format!("expect: {message}")).collect();
        assert_eq!(of(keys), wanted, "{keys}");
    }
}
