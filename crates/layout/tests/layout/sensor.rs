//! `[sensor]` and `[elastomer]`: what is read, what is written again, and what is refused.

use glam::DVec3;
use magsplice_layout::{Layout, LayoutError};

const TILE: &str = "\n[[tile]]\nposition_mm = [0, 0, 0.5]\nsize_mm = [1, 1, 1]\npolarization_t = [0, 0, 0.1]\n";

fn with(tables: &str) -> Result<Layout, LayoutError> {
    Layout::parse(&format!("format = 1\nname = \"film\"\n{tables}{TILE}"), "film.toml")
}

fn refused(tables: &str) -> String {
    with(tables).unwrap_err().to_string()
}

#[test]
fn parts_have_numbers_that_keys_replace() {
    let sensor = with("[sensor]\npart = \"LIS3MDL\"\nrange_mt = [0.4, 0.8, 1.2]").unwrap().sensor.unwrap();
    let element = sensor.element;
    // 3.2 and 4.1 mgauss, 1711 counts per gauss.
    assert_eq!(element.noise_t, DVec3::new(0.32e-6, 0.32e-6, 0.41e-6));
    assert!((element.count_t * 1e4 * 1711.0 - DVec3::ONE).abs().max_element() < 1e-6, "{}", element.count_t);
    assert_eq!(element.range_t, DVec3::new(0.4e-3, 0.8e-3, 1.2e-3));
    assert_eq!((sensor.rate_hz, element.gain, element.active_area), (Some(80.0), DVec3::ONE, [0.0; 2]));
    let whole = with("[sensor]\npart = \"MLX90393\"").unwrap().sensor.unwrap().element;
    // 16 bits with a sign.
    assert!((whole.range_t / whole.count_t - DVec3::splat(32768.0)).abs().max_element() < 1e-6);
    let other = with("[sensor]\nnoise_ut = 2\n").unwrap().sensor.unwrap().element;
    assert_eq!((other.noise_t, other.range_t), (DVec3::splat(2e-6), DVec3::INFINITY));
}

#[test]
fn parts_have_settings() {
    let read = |keys: &str| with(&format!("[sensor]\n{keys}")).unwrap().sensor.unwrap();
    let element = read("part = \"MLX90393\"\ngain_sel = 4\nres = [0, 1, 2]").element;
    assert!((element.count_t - 1e-6 * DVec3::new(0.3, 0.601, 1.936)).length() < 1e-18, "{}", element.count_t);
    let range_mt = DVec3::new(0.3 * 32.768, 0.601 * 32.768, 1.936 * 22.0);
    assert!((1e3 * element.range_t - range_mt).length() < 1e-12, "{}", element.range_t);
    // Keys replace the numbers of a setting; the default setting is the one without keys.
    assert_eq!(read("part = \"MLX90393\"\ngain_sel = 4\nrange_mt = 3").element.range_t, DVec3::splat(3e-3));
    let [default, stated] = ["", "\ngain_sel = 7"].map(|keys| read(&format!("part = \"MLX90393\"{keys}")));
    assert_eq!((default.element, default.setting), (stated.element, None));
    assert_eq!(read("part = \"LIS3MDL\"\nfull_scale_gauss = 4").element.range_t, DVec3::splat(0.4e-3));
    // Readings of 1.5 times the range, and at the range.
    let beyond = default.setting_for(&[1.5 * default.element.range_t, DVec3::NAN]).unwrap();
    assert_eq!((beyond.0.to_string().as_str(), beyond.1.x > 7.3e-3), ("gain_sel = 5, res = 0", true));
    let at_limit = default.setting_for(&[DVec3::new(0.0, -default.element.range_t.y, 1e-4)]).unwrap();
    assert_eq!(at_limit.0.to_string(), "gain_sel = 6, res = 0");
    // Readings far below the range of a coarse setting, along all axes.
    let coarse = read("part = \"MLX90393\"\ngain_sel = 3");
    assert_eq!(coarse.setting_for(&[DVec3::splat(1e-4)]).unwrap().0.to_string(), "gain_sel = 7, res = 0");
    assert_eq!(read("range_mt = 1").setting_for(&[DVec3::ONE]), None);
    // One fault has one line.
    assert_eq!(refused("[sensor]\ngain = 0").lines().count(), 1, "{}", refused("[sensor]\ngain = 0"));
    for (keys, message) in [
        ("part = \"MLX90393\"\ngain_sel = 8", "sensor: gain_sel = 8, must be a whole number from 0 to 7"),
        ("part = \"MLX90393\"\nres = [0, 1.5, 4]", "sensor: res[1] = 1.5, must be a whole number from 0 to 3"),
        ("part = \"LIS3MDL\"\nfull_scale_gauss = 5", "sensor: full_scale_gauss = 5, must be 4, 8, 12 or 16"),
        ("part = \"LIS3MDL\"\ngain_sel = 1", "sensor: gain_sel = 1, is a setting of part = \"MLX90393\" only"),
        ("res = 1", "sensor: res = 1, is a setting of part = \"MLX90393\" only"),
    ] {
        assert!(refused(&format!("[sensor]\n{keys}")).contains(message), "{keys}");
    }
}

#[test]
fn both_tables_are_written_as_they_were_read() {
    for tables in [
        "[sensor]\npart = \"MLX90393\"\ngain_sel = 3\nres = [1, 1, 2]\n",
        "[sensor]\npart = \"LIS3MDL\"\nfull_scale_gauss = 8\n",
        "[sensor]\npart = \"TLV493D\"\noffset_ut = [1, -2, 0.3]\ngain = [1, 0.99, 1.013]\nactive_area_mm = [0.1, 0.2]\n\
         plates_mm = { x = [0.1, 0, 0], z = [0, 0.2, -0.3] }\nrotation = { axis = [0, 0, 1], angle_deg = 2 }\n\
         rate_hz = 12.5\nnoise_ut = 0\ncount_ut = [0.1, 0.2, 0.3]\nrange_mt = 3.3\n\
         [elastomer]\narea_mm2 = 400\nthickness_mm = 7\nyoungs_modulus_mpa = 0.13\npoisson_ratio = 0.45\n\
         scale = [1.1, 1.2, 0.9]\nforce_at_rest_n = 0.02",
        "[sensor]\n[elastomer]\narea_mm2 = 1\nthickness_mm = 1\nyoungs_modulus_mpa = 1\npoisson_ratio = 0.5",
    ] {
        let layout = with(tables).unwrap();
        for text in [layout.to_toml(), layout.to_compact_toml()] {
            let again = Layout::parse(&text, "again").unwrap_or_else(|e| panic!("{e}\n{text}"));
            assert_eq!((&again.sensor, again.elastomer), (&layout.sensor, layout.elastomer), "{text}");
            // Parts have no gain or offset of their own.
            for key in ["gain = ", "offset_ut = "] {
                assert_eq!(text.contains(key), tables.contains(key), "{text}");
            }
        }
    }
    let none = with("").unwrap();
    assert!(none.sensor.is_none() && none.elastomer.is_none() && !none.to_toml().contains("sensor"));
}

/// Dai 2024, Eqs. 16 and 17: F = A G d / h with G = E / (2 (1 + nu)), and F = A E d / h.
#[test]
fn layer_is_an_elastic_one() {
    let tables = "[elastomer]\narea_mm2 = 400\nthickness_mm = 8\nyoungs_modulus_mpa = 0.1\npoisson_ratio = 0.25\n\
                  scale = [1, 2, 3]\nforce_at_rest_n = [0.1, 0, -0.1]";
    let layer = with(tables).unwrap().elastomer.unwrap();
    assert!((layer.hooke_n_per_mm() - DVec3::new(2.0, 2.0, 5.0)).length() < 1e-14);
    let force = layer.force_n(DVec3::new(0.5, 0.5, -1.0));
    assert!((force - DVec3::new(1.1, 2.0, -15.1)).length() < 1e-13, "{force}");
}

#[test]
fn wrong_values_are_named_with_their_rule() {
    assert_eq!(
        refused("[sensor]\npart = \"MLX90394\""),
        "film.toml: line 3: sensor: part = \"MLX90394\", must be one of: LIS3MDL, MLX90393, MMC5983MA, TLV493D; or \
         leave it out"
    );
    let all = refused(
        "[sensor]\nnoise_ut = [1, -1, 1]\ncount_ut = -2\nrange_mt = 0\ngain = [1, 0, 1]\noffset_ut = nan\n\
         active_area_mm = [0.1, -0.2]\nrate_hz = 0\nplates_mm = { y = [0, inf, 0] }\nrotation = { angle_deg = 3 }",
    );
    for message in [
        "noise_ut[1] = -1, must be from 0 to 1e6 (1 T)",
        "count_ut = -2, must be from 0 to 1e6 (1 T)",
        "range_mt = 0, must be a finite number greater than 0",
        "gain[1] = 0, must be from 1e-6 to 1e6, or from -1e6 to -1e-6",
        "offset_ut = NaN, must be at most 1e6 (1 T) in magnitude",
        "active_area_mm[1] = -0.2, must be a finite number of at least 0",
        "rate_hz = 0, must be a finite number greater than 0",
        "plates_mm.y = [0.0, inf, 0.0], must be three finite numbers",
        "rotation has angle_deg without an axis",
    ] {
        assert!(all.contains(message), "{message} is not in\n{all}");
    }
    assert!(refused("[sensor]\nnoise_ut = 1.1e6").contains("noise_ut = 1100000, must be from 0 to 1e6 (1 T)"));
    let layer = refused(
        "[elastomer]\narea_mm2 = -1\nthickness_mm = 0\nyoungs_modulus_mpa = inf\npoisson_ratio = 0.6\nscale = [1, 1, 0]",
    );
    for message in [
        "area_mm2 = -1, must be a finite number greater than 0",
        "thickness_mm = 0, must",
        "youngs_modulus_mpa = inf, must",
        "poisson_ratio = 0.6, must be above -1 and at most 0.5",
        "scale[2] = 0, must",
    ] {
        assert!(layer.contains(message), "{message} is not in\n{layer}");
    }
    let stiff = "[elastomer]\narea_mm2 = 1e100\nthickness_mm = 1e-300\nyoungs_modulus_mpa = 1\npoisson_ratio = 0";
    assert!(refused(stiff).contains("must be a finite number greater than 0"), "{}", refused(stiff));
    let loud = refused("[sensor]\nnoise_ut = 1.1e100");
    assert!(loud.contains("noise_ut = 1.1e100, must be at most 1e100 in magnitude"), "{loud}");
    // A number in quotes, and a list of two.
    assert!(refused("[sensor]\nnoise_ut = \"5\"").contains("noise_ut"));
    assert!(
        refused("[sensor]\nnoise_ut = [1, 2]").contains("one along each axis"),
        "{}",
        refused("[sensor]\nnoise_ut = [1, 2]")
    );
}

const IDEAL: &str = "[ideal]\nwavelength_mm = 10\nthickness_mm = 1\namplitude_t = 0.12\n";

/// Weights of boards are those of least noise, and their default spacing half a wavelength.
#[test]
fn boards_have_places_and_weights() {
    let head = |keys: &str| {
        let sensor = with(&format!("{IDEAL}[sensor]\npart = \"MLX90393\"\n{keys}")).unwrap().sensor.unwrap();
        let head = sensor.head.clone().unwrap();
        assert!(head.sensors.elements.iter().all(|of| of.sensor == sensor.element) && !head.has_stated_weights);
        head
    };
    let cross = head("head = \"cross\"").sensors;
    assert_eq!(cross, head("head = \"cross\"\nspacing_mm = 5").sensors);
    let weights: Vec<f64> = cross.elements.iter().map(|of| of.weight.x).collect();
    let known = [0.5, -0.125, -0.125, -0.125, -0.125];
    assert!(weights.iter().zip(known).all(|(weight, known)| (weight - known).abs() < 1e-12), "{weights:?}");
    assert_eq!(head("head = \"reskin\"").sensors.elements[4].place, DVec3::new(7.594, 7.594, 0.0));
    let places: Vec<DVec3> =
        head("head = \"pair-z\"\nspacing_mm = 1").sensors.elements.iter().map(|of| of.place).collect();
    assert_eq!(places, [DVec3::ZERO, -DVec3::Z]);
}

/// Elements have the numbers of the sensor where they state none, and their own weights.
#[test]
fn elements_replace_numbers_of_the_sensor() {
    let text = "[sensor]\nnoise_ut = 2\ngain = 1.1\n\
        [[sensor.element]]\nposition_mm = [0, 0, 0]\nweight = 2\n\
        [[sensor.element]]\nposition_mm = [0, 0, -1]\nweight = [-1, -2, -2]\nnoise_ut = 3\n\
        [[sensor.element]]\nposition_mm = [0, 1, -1]\nweight = -0.5\npart = \"LIS3MDL\"\n";
    let layout = with(text).unwrap();
    let head = layout.sensor.as_ref().unwrap().head.as_ref().unwrap();
    let [first, second, third] = &head.sensors.elements[..] else { panic!("{head:?}") };
    assert!(head.has_stated_weights && head.board.is_none());
    assert_eq!((first.sensor.noise_t, second.sensor.noise_t), (DVec3::splat(2e-6), DVec3::splat(3e-6)));
    assert_eq!((first.weight, second.weight), (DVec3::splat(2.0), DVec3::new(-1.0, -2.0, -2.0)));
    assert!([first, second, third].iter().all(|of| of.sensor.gain == DVec3::splat(1.1)));
    assert!(third.sensor.range_t.is_finite() && third.sensor.noise_t != first.sensor.noise_t);
    let again = Layout::parse(&layout.to_toml(), "again").unwrap();
    assert_eq!(again.sensor, layout.sensor);
}

#[test]
fn heads_without_sense_are_refused() {
    let element = "[[sensor.element]]\nposition_mm = [0, 0, 0]\n";
    for (text, message) in [
        ("[sensor]\nhead = \"cross\"".to_owned(), "give spacing_mm"),
        (format!("{IDEAL}[sensor]\nhead = \"pair-z\""), "give spacing_mm"),
        (format!("{IDEAL}[sensor]\nhead = \"pair-xy\"\nspacing_mm = 4"), "half a wavelength"),
        (format!("{IDEAL}[sensor]\nhead = \"reskin\"\nspacing_mm = 4"), "must not be given"),
        (format!("{IDEAL}[sensor]\nspacing_mm = 4"), "give head"),
        (format!("{IDEAL}[sensor]\nhead = \"cross\"\n{element}"), "give one of them"),
        (format!("[sensor]\n{element}"), "without [ideal]"),
        (format!("[sensor]\n{element}weight = 1\n{element}"), "some sensors only"),
        (format!("{IDEAL}[sensor]\n{element}noise_ut = -1\n"), "sensor.element 1: noise_ut = -1"),
    ] {
        let error = with(&text).unwrap_err().to_string();
        assert!(error.contains(message), "{text}: {error}");
    }
}
