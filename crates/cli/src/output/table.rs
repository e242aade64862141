//! Tables of points: their columns, their metadata, and writing them.

use magsplice::Film;
use magsplice::layout::Layout;
use magsplice_export::{ColumnQuantity, Metadata, MetadataValue, Table, csv, json, numpy, vtk};
use serde::Serialize;

use super::destination::Output;
use crate::args::evaluate::QuantityArg;
use crate::args::formats::TableFormat;
use crate::failure::Failure;

/// The columns of a quantity, named with their units; `values` point by point.
pub(crate) fn columns(quantity: QuantityArg, values: Vec<f64>) -> ColumnQuantity {
    let (name, components): (_, &[_]) = match quantity {
        QuantityArg::B => ("b_t", &["bx_t", "by_t", "bz_t"]),
        QuantityArg::H => ("h_a_per_m", &["hx_a_per_m", "hy_a_per_m", "hz_a_per_m"]),
        QuantityArg::J => ("j_t", &["jx_t", "jy_t", "jz_t"]),
        QuantityArg::Gradient => (
            "gradient_b_t_per_mm",
            &[
                "dbx_dx_t_per_mm",
                "dbx_dy_t_per_mm",
                "dbx_dz_t_per_mm",
                "dby_dx_t_per_mm",
                "dby_dy_t_per_mm",
                "dby_dz_t_per_mm",
                "dbz_dx_t_per_mm",
                "dbz_dy_t_per_mm",
                "dbz_dz_t_per_mm",
            ],
        ),
    };
    ColumnQuantity { name, components, values }
}

/// Metadata of a table of a film: its layout, the program, and the accuracy of its field.
pub(crate) fn film_metadata(film: &Film) -> Metadata {
    let mut metadata = layout_metadata(film.layout());
    metadata.push(("accuracy", MetadataValue::Text(film.scene().accuracy().to_string())));
    if let Some(recoil) = film.recoil() {
        metadata.push(("recoil_cells", MetadataValue::Count(recoil.magnetization().cells().len())));
        metadata.push(("recoil_error_t", MetadataValue::Numbers(vec![recoil.error_t()])));
    }
    metadata
}

/// Metadata of a layout: its name and hash, the program's version, the number of tiles.
pub(crate) fn layout_metadata(layout: &Layout) -> Metadata {
    vec![
        ("layout", MetadataValue::Text(layout.name.clone())),
        ("sha256", MetadataValue::Text(layout.sha256.clone())),
        ("version", MetadataValue::Text(env!("CARGO_PKG_VERSION").to_owned())),
        ("tiles", MetadataValue::Count(layout.tiles.len())),
    ]
}

/// Writes a table; as JSON the `document` that holds it.
pub(crate) fn write(
    table: &Table,
    document: &impl Serialize,
    format: TableFormat,
    output: &mut Output,
) -> Result<(), Failure> {
    output.write(|w| match format {
        TableFormat::Csv => csv::write(table, w),
        TableFormat::Json => json::write(document, w),
        TableFormat::Npy => numpy::npy(table, w),
        TableFormat::Npz => numpy::npz(table, w),
        TableFormat::Vtk => vtk::table(table, w),
        #[cfg(feature = "parquet")]
        TableFormat::Parquet => magsplice_export::parquet::write(table, w),
        #[cfg(not(feature = "parquet"))]
        TableFormat::Parquet => Err(std::io::Error::other(super::choice::WITHOUT_PARQUET)),
    })
}
