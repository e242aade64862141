//! Decoupling parameters over the working volume.

use glam::DVec3;
use magsplice_decouple::{Decoupling, Parameters, PerAxis};
use magsplice_ideal::Comparison;
use serde::Serialize;

use super::comparison::remark_about_amplitude;
use super::source::Source;
use super::table::{ColumnQuantity, MetadataValue, Points, Table};
use crate::film::Film;
use crate::film_error::FilmError;
use crate::stage::Stage;

/// The decoupling parameters of a film over its working volume (Dai 2024, Eq. 15), and their
/// errors.
#[derive(Clone, Debug, Serialize)]
pub struct FilmDecoupling {
    /// The film.
    #[serde(flatten)]
    pub source: Source,
    /// Number of points.
    pub points: usize,
    /// The point from which changes are measured.
    pub reference_mm: DVec3,
    /// Parameters and their errors.
    #[serde(flatten)]
    pub decoupling: Decoupling,
    /// The uniformity RMSE as displacements along x, y, z.
    pub uniformity_rmse_mm: PerAxis<Option<f64>>,
    /// B at the reference point, exact for any accuracy of the film.
    #[serde(skip)]
    pub reference_field_t: DVec3,
    /// The film, which knows the field of its working volume.
    #[serde(skip)]
    pub film: Film,
}

/// The decoupling parameters of a film over its working volume, and its comparison with the ideal
/// film.
#[derive(Clone, Debug, Serialize)]
pub struct FilmEvaluation {
    /// Parameters and their errors.
    #[serde(flatten)]
    pub decoupling: FilmDecoupling,
    /// The difference from the ideal film.
    pub comparison: Comparison,
    /// What an unusual result means.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub remark: Option<&'static str>,
}

impl Film {
    /// The decoupling parameters over the working volume (Dai 2024, Eq. 15).
    ///
    /// # Errors
    /// If the layout has no ideal film or no working volume, the field does not exist at some of
    /// its points, or the parameters do not exist there.
    pub fn decouple(&self) -> Result<FilmDecoupling, FilmError> {
        let (decoupling, (reference_mm, reference_field_t)) = (self.volume_decoupling()?, self.decoupling_reference()?);
        let wavenumber = self.ideal()?.wavenumber();
        Ok(FilmDecoupling {
            source: Source::of(self),
            points: self.volume()?.grid.len(),
            reference_mm,
            reference_field_t,
            uniformity_rmse_mm: decoupling.uniformity_rmse.map(|rmse| Some(rmse? / wavenumber)).to_array().into(),
            decoupling,
            film: self.clone(),
        })
    }

    /// The decoupling parameters over the working volume, and the comparison with the ideal film.
    ///
    /// # Errors
    /// As [`Film::decouple`] and [`Film::compare`].
    pub fn evaluate(&self) -> Result<FilmEvaluation, FilmError> {
        let comparison = self.volume_comparison()?;
        let remark = remark_about_amplitude(comparison.amplitude);
        Ok(FilmEvaluation { decoupling: self.decouple()?, comparison, remark })
    }

    pub(crate) fn volume_decoupling(&self) -> Result<Decoupling, FilmError> {
        let (ideal, grid, field_t) = (self.ideal()?, self.volume()?.grid, self.volume_field_t()?);
        let reference = self.decoupling_reference()?;
        self.tell(Stage::uncounted("decoupling parameters"));
        Decoupling::from_field(&grid, field_t, reference, ideal).map_err(FilmError::Decoupling)
    }

    /// The reference point of the working volume, and B there.
    pub(crate) fn decoupling_reference(&self) -> Result<(DVec3, DVec3), FilmError> {
        let reference_mm = self.volume()?.reference_mm;
        if self.ideal()?.flux_density_t(reference_mm).is_none() {
            return Err(FilmError::NotBelow(reference_mm));
        }
        Ok((reference_mm, self.reference_field_t()?))
    }
}

impl FilmDecoupling {
    /// B, R_x, R_y and S_z at every point of the volume; the parameters are NaN at singular points.
    ///
    /// # Errors
    /// None after [`Film::decouple`].
    pub fn table(&self) -> Result<Table, FilmError> {
        let field_t = self.film.volume_field_t()?;
        let mut metadata = self.source.metadata();
        metadata.extend([
            ("reference_mm", self.reference_mm.to_array().into()),
            ("uniformity_rmse", self.decoupling.uniformity_rmse.map(|rmse| rmse.unwrap_or(f64::NAN)).to_array().into()),
            ("ideal_rmse", self.decoupling.ideal_rmse.to_array().into()),
            ("singular_points", MetadataValue::Count(self.decoupling.singular.len())),
        ]);
        let mut quantities = vec![ColumnQuantity::flux_density(field_t)];
        quantities.extend(parameter_columns(&self.decoupling.parameters));
        let points = Points::Grid(self.film.volume()?.grid);
        Ok(Table::new(points, quantities, metadata))
    }
}

/// Columns of R_x, R_y and S_z; NaN at singular points.
pub(super) fn parameter_columns<'a>(
    parameters: impl IntoIterator<Item = &'a Option<Parameters>> + Copy,
) -> [ColumnQuantity; 3] {
    let column = |name, of: fn(&Parameters) -> f64| {
        ColumnQuantity::of_numbers(name, parameters.into_iter().map(|p| p.as_ref().map_or(f64::NAN, of)))
    };
    [column(&["r_x_rad"], |p| p.r_x), column(&["r_y_rad"], |p| p.r_y), column(&["s_z"], |p| p.s_z)]
}
