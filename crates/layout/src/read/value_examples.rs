//! Examples of values that are lists or tables, for messages about values of a wrong type.

/// Keys whose values are lists, and an example. Where a key has lists of several lengths, each
/// length has its own entry.
const LISTS: [(&str, &str); 27] = [
    ("position_mm", "[0.0, 0.0, 0.5]"),
    ("size_mm", "[3.3, 1.7, 1.0]"),
    ("size_mm", "[3.3, 1.7]"),
    ("polarization_t", "[0.12, 0.0, 0.0]"),
    ("direction", "[1.0, 1.0, 0.0]"),
    ("at_mm", "[0.0, 0.0, 0.0]"),
    ("count", "[4, 4, 1]"),
    ("pitch_mm", "[5.0, 5.0, 0.0]"),
    ("quaternion", "[0.0, 0.0, 0.5, 0.866]"),
    ("euler_deg", "[10.0, 20.0, 30.0]"),
    ("matrix", "[[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]"),
    ("start_mm", "[-10.0, -10.0, 0.0]"),
    ("x_mm", "[-2.0, 2.0]"),
    ("y_mm", "[-2.0, 2.0]"),
    ("z_mm", "[-5.0, -3.0]"),
    ("reference_mm", "[0.0, 0.0, -5.0]"),
    ("x", "[-10.0, 10.0]"),
    ("y", "[-10.0, 10.0]"),
    ("x", "[{ widths_mm = [3.3, 1.7], pattern = [1, 0] }]"),
    ("y", "[{ widths_mm = [3.3, 1.7], pattern = [1, 0] }]"),
    ("widths_mm", "[3.3, 1.7]"),
    ("pattern", "[1, 0]"),
    ("vary", "[\"size\", \"position\", \"direction\"]"),
    ("stock", "[{ size_mm = [3.3, 1.7], direction_deg = 0.0 }]"),
    ("active_area_mm", "[0.1, 0.1]"),
    ("stock_strengths_t", "[0.06, 0.12]"),
    ("history", "[\"designed by hand\"]"),
];

/// Keys whose values are tables, and an example.
const TABLES: [(&str, &str); 11] = [
    ("uniformity_rmse", "{ r_x = 0.065, r_y = 0.065, s_z = 0.042 }"),
    ("displacement_rmse_mm", "{ x = 0.25, y = 0.25, z = 0.32 }"),
    ("amplitude", "{ min = 0.8 }"),
    ("field", "{ file = \"film.field.csv\", within = 1e-9 }"),
    ("clearance_mm", "{ min = 3.0 }"),
    ("weights", "{ r_x = 1.0, r_y = 1.0, s_z = 1.0 }"),
    ("outline_mm", "{ x = [-10.0, 10.0], y = [-10.0, 10.0] }"),
    ("thickness_mm", "{ min = 0.5, max = 2.0 }"),
    ("strength_t", "{ min = 0.0, max = 0.12 }"),
    ("plates_mm", "{ z = [0.0, 0.0, -0.1] }"),
    ("grid", "{ count = [4, 4, 1], pitch_mm = [5.0, 5.0, 0.0] }"),
];

/// An example of the list that is the value of a key: of as many numbers, or of any length.
pub(crate) fn list_example(key: &str, length: Option<usize>) -> Option<&'static str> {
    let has_length = |example: &str| match length {
        Some(length) => key == "matrix" || example.split(',').count() == length && !example.contains('{'),
        None => true,
    };
    let of_key = LISTS.iter().filter(|(known, _)| *known == key).map(|(_, example)| *example);
    // A list of any length, such as the sections of a lattice, stands after those of two numbers.
    let mut fitting = of_key.filter(|example| has_length(example));
    if length.is_none() { fitting.next_back() } else { fitting.next() }
}

/// An example of the table that is the value of a key.
pub(crate) fn table_example(key: &str) -> Option<&'static str> {
    TABLES.iter().find(|(known, _)| *known == key).map(|(_, example)| *example)
}
