//! Results of `decouple`: a film with its field, comparison and decoupling.

use magsplice::decouple::PerParameter;
use magsplice::ideal::{Comparison, IdealFilm};
use magsplice::layout::WorkingVolume;
use magsplice::prelude::{DVec3, Decoupling, Parameters};
use magsplice::{Film, FilmError};
use magsplice_export::{ColumnQuantity, MetadataValue, Points, Table};

use crate::args::evaluate::QuantityArg;
use crate::output::table;

/// A film with its field over the working volume, compared with the ideal film and decoupled.
pub(crate) struct Evaluation<'a> {
    pub(crate) film: &'a Film<'a>,
    pub(crate) ideal: &'a IdealFilm,
    pub(crate) volume: &'a WorkingVolume,
    pub(crate) field_t: Vec<DVec3>,
    /// B in tesla at the reference point, always exact.
    pub(crate) reference_field_t: DVec3,
    pub(crate) comparison: Comparison,
    pub(crate) decoupling: Decoupling,
}

impl<'a> Evaluation<'a> {
    pub(crate) fn new(film: &'a Film<'a>) -> Result<Evaluation<'a>, FilmError> {
        let ideal = film.ideal()?;
        let volume = film.volume()?;
        let field_t = film.volume_field_t()?;
        let comparison = film.compare(&field_t)?;
        let decoupling = film.decouple(&field_t)?;
        let reference_field_t = film.reference_field_t()?;
        Ok(Evaluation { film, ideal, volume, field_t, reference_field_t, comparison, decoupling })
    }

    /// B, R_x, R_y and S_z at every point of the volume; the parameters are NaN at singular points.
    pub(crate) fn table(&self) -> Table {
        let Evaluation { film, volume, field_t, decoupling, .. } = self;
        let parameter = |components: &'static [&'static str; 1], of: fn(&Parameters) -> f64| {
            let values = decoupling.parameters.iter().map(|p| p.as_ref().map_or(f64::NAN, of)).collect();
            ColumnQuantity { name: components[0], components, values }
        };
        let all = |p: PerParameter| MetadataValue::Numbers(vec![p.r_x, p.r_y, p.s_z]);
        let mut metadata = table::film_metadata(film);
        metadata.extend([
            ("reference_mm", MetadataValue::Numbers(volume.reference_mm.to_array().to_vec())),
            ("uniformity_rmse", all(decoupling.uniformity_rmse.map(|rmse| rmse.unwrap_or(f64::NAN)))),
            ("ideal_rmse", all(decoupling.ideal_rmse)),
            ("singular_points", MetadataValue::Count(decoupling.singular.len())),
        ]);
        let quantities = vec![
            table::columns(QuantityArg::B, field_t.iter().flat_map(DVec3::to_array).collect()),
            parameter(&["r_x_rad"], |p| p.r_x),
            parameter(&["r_y_rad"], |p| p.r_y),
            parameter(&["s_z"], |p| p.s_z),
        ];
        Table::new(Points::Grid(volume.grid), quantities, metadata).expect("every point has a value")
    }
}
