//! Messages about arguments: the value, the rule, and what to write.

use crate::{Sandbox, shipped};

#[test]
fn wrong_arguments_are_answered_with_an_example() {
    let sandbox = Sandbox::new();
    let film = shipped("published-film");
    for (arguments, told) in [
        (&["splice", "--wavelength", "10", "--film", "20"][..], "is one length, must be two"),
        (&["splice", "--wavelength", "10", "--film", "20"], "write 20x20"),
        (&["splice", "--wavelength", "10", "--film", "20x20", "--distance", "3-5"], "write 3..5"),
        (&["splice", "--wavelength", "10", "--film", "20x20", "--parts", "0"], "a whole number from 1 to "),
        (&["splice", "--wavelength", "10", "--film", "20x20", "--sensor", "MLX"], "possible values: LIS3MDL, MLX90393"),
        (&["resolution", &film, "--noise", "5"], "5 T, must be above 0 and at most 1 T, such as 5uT"),
        (&["budget", &film, "--samples", "3"], "must be a whole number from 20 to 1000000"),
        (&["assign", &film, "--measured", "x.csv", "--seed", "x"], "must be a whole number from 0 to "),
    ] {
        sandbox.run(arguments).refuses_arguments(told);
    }
    sandbox
        .run(&["forces", &film, "--order", "best"])
        .refuses("--order best: must be given, least, or a CSV file with the column tile, such as order.csv");
    sandbox.run(&["tiles", &film, "--page", "page.pdf"]).refuses("use one of .html, .htm, such as page.html");
}

#[test]
fn layouts_and_tables_in_each_others_place_are_recognized() {
    let sandbox = Sandbox::new();
    let film = shipped("published-film");
    sandbox.write("scan.csv", "x_mm,y_mm,z_mm,bx_mt,by_mt,bz_mt\n0,0,-4,0,0,1\n");
    let layout = "is a layout (TOML), must be a table (CSV) that begins with a line such as ";
    for arguments in [
        &["scan", &film, &film][..],
        &["read", &film, &film],
        &["calibrate", &film, &film],
        &["diagnose", &film, "--scan", &film, "--noise", "5uT"],
        &["assign", &film, "--measured", &film],
        &["field", &film, "--points", &film],
        &["import", &film],
        &["forces", &film, "--order", &film],
    ] {
        sandbox.run(arguments).refuses(layout);
    }
    for arguments in [&["scan", "scan.csv", &film][..], &["field", "scan.csv"]] {
        sandbox.run(arguments).refuses("scan.csv: is a table, must be a layout (TOML), such as film.toml");
    }
}

#[test]
fn tables_follow_the_layout_and_the_earlier_form_is_read() {
    let sandbox = Sandbox::new();
    let film = shipped("published-film");
    sandbox.write("readings.csv", "bx_mt,by_mt,bz_mt\n0,0,1.2\n");
    let now = sandbox.run(&["read", &film, "readings.csv"]);
    assert_eq!(now.status, 0, "{}", now.stderr);
    assert_eq!(sandbox.run(&["read", "readings.csv", "--layout", &film]).stdout, now.stdout);
}

/// Three samples show neither end of a percentile.
#[test]
fn ends_of_intervals_that_few_samples_leave_open_are_explained() {
    let sandbox = Sandbox::new();
    let film = shipped("published-film");
    let few = sandbox.run(&["tolerance", &film, "--preset", "jig", "--samples", "3"]).stdout;
    assert!(few.contains(" .. unknown\n") && few.contains(" unknown .. ") && !few.contains('?'), "{few}");
    assert!(few.contains("\nunknown: 3 samples are too few for this end; at least 110 are needed"), "{few}");
    let enough = sandbox.run(&["tolerance", &film, "--preset", "jig", "--samples", "110"]).stdout;
    assert!(!enough.contains("unknown"), "{enough}");
}

/// Centres of mirrored tiles are at 0 to within round-off.
#[test]
fn round_off_is_not_printed() {
    let sandbox = Sandbox::new();
    for layout in ["published-film", "designed-tilted", "film-40mm"] {
        let text = sandbox.run(&["tiles", &shipped(layout)]).stdout;
        assert!(text.contains(", 0, 0.5)") && !text.contains("e-1"), "{text}");
    }
}
