//! Results of `decouple --points`: a film with its field, comparison and decoupling at points.

use std::path::Path;

use magsplice::decouple::{Parameters, PerParameter, PointDecoupling};
use magsplice::ideal::{Comparison, IdealFilm};
use magsplice::layout::{Layout, WorkingVolume};
use magsplice::prelude::DVec3;
use magsplice::{Film, FilmError};
use magsplice_export::{ColumnQuantity, MetadataValue, Points, Table};

use crate::args::evaluate::QuantityArg;
use crate::failure::Failure;
use crate::inputs::points_below_film::GivenPoints;
use crate::output::table;
use crate::words::film_failure;

/// A film with its field at points, compared with the ideal film and decoupled.
pub(crate) struct PointEvaluation<'a> {
    pub(crate) film: &'a Film<'a>,
    pub(crate) ideal: &'a IdealFilm,
    pub(crate) volume: &'a WorkingVolume,
    pub(crate) given: GivenPoints<'a>,
    pub(crate) field_t: Vec<DVec3>,
    /// B in tesla at the reference point, always exact.
    pub(crate) reference_field_t: DVec3,
    pub(crate) comparison: Comparison,
    pub(crate) decoupling: PointDecoupling,
}

impl<'a> PointEvaluation<'a> {
    pub(crate) fn new(
        film: &'a Film<'a>,
        given: GivenPoints<'a>,
        layout_path: &Path,
        layout: &Layout,
    ) -> Result<PointEvaluation<'a>, Failure> {
        let at_points = |error: FilmError| given.failure(layout_path, layout, error);
        let of_film = |error: FilmError| film_failure(layout_path, layout, error);
        let (ideal, volume) = (film.ideal().map_err(of_film)?, film.volume().map_err(of_film)?);
        let field_t = film.field_at_t(&given.points).map_err(at_points)?;
        let comparison = film.compare_at(&given.points, &field_t).map_err(of_film)?;
        let reference_field_t = film.reference_field_t().map_err(of_film)?;
        let decoupling = film.decouple_at(&given.points, &field_t).map_err(of_film)?;
        Ok(PointEvaluation { film, ideal, volume, given, field_t, reference_field_t, comparison, decoupling })
    }

    /// The displacement that Eq. 14 finds from the reference to a point, minus the true one, in mm.
    pub(crate) fn displacement_error_mm(&self, index: usize) -> Option<DVec3> {
        self.decoupling.displacement_error(index, self.ideal.wavenumber())
    }

    /// The point with the longest error of the displacement, and this error in mm.
    pub(crate) fn worst_mm(&self) -> Option<(DVec3, DVec3)> {
        let errors = self.given.points.iter().enumerate();
        let errors = errors.filter_map(|(index, point)| Some((*point, self.displacement_error_mm(index)?)));
        errors.max_by(|(_, one), (_, other)| one.length().total_cmp(&other.length()))
    }

    /// B, R_x, R_y, S_z, their errors and that of the displacement at every point; NaN at singular
    /// points.
    pub(crate) fn table(&self) -> Table {
        let PointEvaluation { film, volume, given, field_t, decoupling, .. } = self;
        let parameter = |components: &'static [&'static str; 1], of: fn(&Parameters) -> f64| ColumnQuantity {
            name: components[0],
            components,
            values: decoupling.parameters.iter().map(|p| p.as_ref().map_or(f64::NAN, of)).collect(),
        };
        let error = |components: &'static [&'static str; 1], of: fn(&PerParameter) -> f64| ColumnQuantity {
            name: components[0],
            components,
            values: decoupling.errors.iter().map(|e| e.as_ref().map_or(f64::NAN, of)).collect(),
        };
        let displacement = (0..given.points.len()).map(|index| self.displacement_error_mm(index));
        let displacement = ColumnQuantity {
            name: "displacement_error_mm",
            components: &["displacement_error_x_mm", "displacement_error_y_mm", "displacement_error_z_mm"],
            values: displacement.flat_map(|error| error.unwrap_or(DVec3::NAN).to_array()).collect(),
        };
        let rmse = decoupling.ideal_rmse;
        let mut metadata = table::film_metadata(film);
        metadata.extend([
            ("reference_mm", MetadataValue::Numbers(volume.reference_mm.to_array().to_vec())),
            ("ideal_rmse", MetadataValue::Numbers(rmse.to_array().to_vec())),
            ("singular_points", MetadataValue::Count(decoupling.singular.len())),
        ]);
        let quantities = vec![
            table::columns(QuantityArg::B, field_t.iter().flat_map(DVec3::to_array).collect()),
            parameter(&["r_x_rad"], |p| p.r_x),
            parameter(&["r_y_rad"], |p| p.r_y),
            parameter(&["s_z"], |p| p.s_z),
            error(&["r_x_error_rad"], |e| e.r_x),
            error(&["r_y_error_rad"], |e| e.r_y),
            error(&["s_z_error"], |e| e.s_z),
            displacement,
        ];
        Table::new(Points::Scattered(given.points.clone()), quantities, metadata).expect("every point has a value")
    }
}
