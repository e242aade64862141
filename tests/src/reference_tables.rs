//! The tables in `tests/reference`: fields of one cuboid to 40 digits.
//!
//! The README in that folder describes their computation.

use std::path::Path;

use glam::DVec3;
use magsplice_field::Tile;

/// One cuboid, one point, and B at this point.
#[derive(Clone, Debug)]
pub struct ReferenceRow {
    /// Group of rows, e.g. `b_far`.
    pub set: String,
    /// Position within the group, e.g. the distance in sizes.
    pub tag: String,
    /// Row number over all tables.
    pub id: u32,
    /// The cuboid.
    pub tile: Tile,
    /// The point.
    pub point: DVec3,
    /// `in`, `out`, `ext`, `face` or `edge`.
    pub region: String,
    /// The remaining columns as text: B, both limits of B, or `singular`.
    values: Vec<String>,
}

impl ReferenceRow {
    /// B in tesla. On a face, limit 0 is from inside and limit 1 from outside; elsewhere there is
    /// only limit 0.
    pub fn flux_density_t(&self, limit: usize) -> DVec3 {
        let component = |i: usize| self.values[3 * limit + i].parse().expect("a number");
        DVec3::new(component(0), component(1), component(2))
    }
}

/// The rows of `tests/reference/<name>.csv`.
///
/// # Panics
/// If the table is missing or malformed, or does not have `rows` rows; a test must not pass without
/// cases.
pub fn read(name: &str, rows: usize) -> Vec<ReferenceRow> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("reference").join(name).with_extension("csv");
    let mut reader = csv::Reader::from_path(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    let table: Vec<ReferenceRow> = reader.records().map(|record| row(&record.expect("a well-formed row"))).collect();
    assert_eq!(table.len(), rows, "{} is not the table this test was written for", path.display());
    table
}

fn row(record: &csv::StringRecord) -> ReferenceRow {
    let number = |i: usize| record[i].parse::<f64>().expect("a number");
    let vector = |i: usize| DVec3::new(number(i), number(i + 1), number(i + 2));
    ReferenceRow {
        set: record[0].to_owned(),
        tag: record[1].to_owned(),
        id: record[2].parse().expect("an id"),
        tile: Tile::new(vector(9), vector(3), vector(6)).expect("a valid tile"),
        point: vector(12),
        region: record[15].to_owned(),
        values: record.iter().skip(16).map(str::to_owned).collect(),
    }
}
