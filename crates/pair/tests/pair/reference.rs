//! Tables of `tests/reference`, whose README describes their computation.

use std::path::Path;

/// The rows of `tests/reference/<name>.csv`: a text, then numbers. There must be `count` rows, so
/// that no test passes because nothing ran.
pub(crate) fn rows(name: &str, count: usize) -> Vec<(String, Vec<f64>)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/reference");
    let path = folder.join(name).with_extension("csv");
    let mut reader = csv::Reader::from_path(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    let row = |record: Result<csv::StringRecord, csv::Error>| {
        let record = record.expect("a well-formed row");
        let numbers = record.iter().skip(1).map(|text| text.parse().expect("a number")).collect();
        (record[0].to_owned(), numbers)
    };
    let rows: Vec<_> = reader.records().map(row).collect();
    assert_eq!(rows.len(), count, "{} is not the table this test was written for", path.display());
    rows
}
