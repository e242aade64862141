//! Decoupling parameters at points.

use glam::DVec3;
use magsplice_decouple::{PerAxis, PerParameter, PointDecoupling};
use magsplice_ideal::Comparison;
use serde::Serialize;

use super::decoupling::parameter_columns;
use super::source::Source;
use super::table::{ColumnQuantity, MetadataValue, Points, Table};
use crate::film::Film;
use crate::film_error::FilmError;
use crate::stage::Stage;

/// The decoupling parameters of a film at points (Dai 2024, Eq. 15), and their errors.
#[derive(Clone, Debug, Serialize)]
pub struct FilmPointDecoupling {
    /// The film.
    #[serde(flatten)]
    pub source: Source,
    /// Number of points.
    pub points: usize,
    /// The point from which changes are measured.
    pub reference_mm: DVec3,
    /// Parameters and their errors.
    #[serde(flatten)]
    pub decoupling: PointDecoupling,
    /// The longest error of the displacement, and the point where it occurs.
    pub worst_displacement_error_mm: Option<PerAxis>,
    /// The point where it occurs.
    pub worst_displacement_at_mm: Option<DVec3>,
    /// Results that only a grid has, each with the reason.
    pub omitted: Omitted,
    /// The points.
    #[serde(skip)]
    pub points_mm: Vec<DVec3>,
    /// B at the points.
    #[serde(skip)]
    pub field_t: Vec<DVec3>,
    /// B at the reference point, exact for any accuracy of the film.
    #[serde(skip)]
    pub reference_field_t: DVec3,
    /// The film.
    #[serde(skip)]
    pub film: Film,
    /// The error of the displacement at each point. `None` at singular points.
    #[serde(skip)]
    pub displacement_errors_mm: Vec<Option<DVec3>>,
}

/// Reasons for omitted results.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Omitted {
    /// Why there is no uniformity RMSE.
    pub uniformity_rmse: &'static str,
}

/// The decoupling parameters of a film at points, and its comparison with the ideal film.
#[derive(Clone, Debug, Serialize)]
pub struct FilmPointEvaluation {
    /// Parameters and their errors.
    #[serde(flatten)]
    pub decoupling: FilmPointDecoupling,
    /// The difference from the ideal film.
    pub comparison: Comparison,
}

impl Film {
    /// The decoupling parameters at points in millimetres (Dai 2024, Eq. 15). Changes are measured
    /// from the reference point of the working volume.
    ///
    /// # Errors
    /// If the layout has no ideal film or no working volume, the field does not exist at some of
    /// the points, or the parameters do not exist there.
    pub fn decouple_at(&self, points_mm: Vec<DVec3>) -> Result<FilmPointDecoupling, FilmError> {
        let field_t = self.field_at_t(&points_mm)?;
        self.decoupling_of(points_mm, field_t)
    }

    /// The decoupling parameters at points in millimetres, and the comparison with the ideal film.
    ///
    /// # Errors
    /// As [`Film::decouple_at`] and [`Film::compare_at`].
    pub fn evaluate_at(&self, points_mm: Vec<DVec3>) -> Result<FilmPointEvaluation, FilmError> {
        let field_t = self.field_at_t(&points_mm)?;
        let comparison = self.comparison_of(&points_mm, &field_t)?;
        Ok(FilmPointEvaluation { decoupling: self.decoupling_of(points_mm, field_t)?, comparison })
    }

    fn decoupling_of(&self, points_mm: Vec<DVec3>, field_t: Vec<DVec3>) -> Result<FilmPointDecoupling, FilmError> {
        let (ideal, reference) = (self.ideal()?, self.decoupling_reference()?);
        self.tell(Stage::uncounted("decoupling parameters"));
        let decoupling = PointDecoupling::from_field(&points_mm, &field_t, reference, ideal);
        let decoupling = decoupling.map_err(FilmError::Decoupling)?;
        let error_mm = |index| decoupling.displacement_error(index, ideal.wavenumber());
        let displacement_errors_mm: Vec<Option<DVec3>> = (0..points_mm.len()).map(error_mm).collect();
        let errors = points_mm.iter().zip(&displacement_errors_mm).filter_map(|(at, error)| Some((*at, (*error)?)));
        let worst = errors.max_by(|(_, one), (_, other)| one.length().total_cmp(&other.length()));
        Ok(FilmPointDecoupling {
            source: Source::of(self),
            points: points_mm.len(),
            reference_mm: reference.0,
            reference_field_t: reference.1,
            film: self.clone(),
            worst_displacement_error_mm: worst.map(|(_, error)| error.into()),
            worst_displacement_at_mm: worst.map(|(at, _)| at),
            omitted: Omitted { uniformity_rmse: "needs the planes of a grid" },
            decoupling,
            points_mm,
            field_t,
            displacement_errors_mm,
        })
    }
}

impl FilmPointDecoupling {
    /// B, R_x, R_y, S_z, their errors and that of the displacement at every point; NaN at singular
    /// points.
    pub fn table(&self) -> Table {
        let error = |name, of: fn(&PerParameter) -> f64| {
            ColumnQuantity::of_numbers(name, self.decoupling.errors.iter().map(|e| e.as_ref().map_or(f64::NAN, of)))
        };
        let displacement: Vec<DVec3> =
            self.displacement_errors_mm.iter().map(|error| error.unwrap_or(DVec3::NAN)).collect();
        let axes = &["displacement_error_x_mm", "displacement_error_y_mm", "displacement_error_z_mm"];
        let displacement = ColumnQuantity::of_vectors("displacement_error_mm", axes, &displacement);
        let mut metadata = self.source.metadata();
        metadata.extend([
            ("reference_mm", self.reference_mm.to_array().into()),
            ("ideal_rmse", self.decoupling.ideal_rmse.to_array().into()),
            ("singular_points", MetadataValue::Count(self.decoupling.singular.len())),
        ]);
        let mut quantities = vec![ColumnQuantity::flux_density(&self.field_t)];
        quantities.extend(parameter_columns(&self.decoupling.parameters));
        quantities.extend([
            error(&["r_x_error_rad"], |e| e.r_x),
            error(&["r_y_error_rad"], |e| e.r_y),
            error(&["s_z_error"], |e| e.s_z),
            displacement,
        ]);
        Table::new(Points::Scattered(self.points_mm.clone()), quantities, metadata)
    }
}
