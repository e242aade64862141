//! The plan as a file.

use magsplice::making::PlanRow;
use magsplice::results::twelve_digits;

/// Names of the columns of a plan.
const COLUMNS: [&str; 9] = ["place", "tile", "x_mm", "y_mm", "z_mm", "up", "mark", "mark_deg", "laid"];

/// The plan as CSV, which `--placed` reads.
pub(crate) fn csv(rows: &[PlanRow]) -> String {
    let mut writer = csv::Writer::from_writer(Vec::new());
    let mut write = |row: &[String]| writer.write_record(row).expect("memory takes every row");
    write(&COLUMNS.map(str::to_owned));
    for row in rows {
        let mut cells = vec![row.place.clone(), row.tile.clone()];
        cells.extend(row.centre_mm.to_array().map(|value| twelve_digits(value).to_string()));
        cells.extend([row.up.to_owned(), row.mark.to_owned(), row.mark_deg.to_string()]);
        cells.push(if row.is_laid { "yes" } else { "no" }.to_owned());
        write(&cells);
    }
    let bytes = writer.into_inner().expect("memory takes every row");
    String::from_utf8(bytes).expect("text is written as text")
}
