//! The comparison of the field with the ideal film.

use glam::DVec3;
use magsplice_ideal::Comparison;
use serde::Serialize;

use super::source::Source;
use crate::film::Film;
use crate::film_error::FilmError;
use crate::stage::Stage;

/// The comparison of a film with the ideal film (Dai 2024, Eq. 2).
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FilmComparison {
    /// The film.
    #[serde(flatten)]
    pub source: Source,
    /// The difference of the fields; points in millimetres.
    #[serde(flatten)]
    pub comparison: Comparison,
    /// What an unusual result means.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub remark: Option<&'static str>,
}

impl Film {
    /// The comparison with the ideal film (Dai 2024, Eq. 2) over the working volume.
    ///
    /// # Errors
    /// If the layout has no ideal film or no working volume, the volume is not below the film, or
    /// the field does not exist at some of its points.
    pub fn compare(&self) -> Result<FilmComparison, FilmError> {
        Ok(self.named_comparison(self.volume_comparison()?))
    }

    /// The comparison with the ideal film (Dai 2024, Eq. 2) at points in millimetres.
    ///
    /// # Errors
    /// If the layout has no ideal film, a point is not below the film, or the field does not exist
    /// at some of the points.
    pub fn compare_at(&self, points_mm: &[DVec3]) -> Result<FilmComparison, FilmError> {
        let field_t = self.field_at_t(points_mm)?;
        Ok(self.named_comparison(self.comparison_of(points_mm, &field_t)?))
    }

    pub(crate) fn volume_comparison(&self) -> Result<Comparison, FilmError> {
        // The field first: it asks for memory for the points too.
        let field_t = self.volume_field_t()?;
        let points: Vec<DVec3> = self.volume()?.grid.points().collect();
        self.comparison_of(&points, field_t)
    }

    /// The comparison of the field that the film has at points.
    pub(crate) fn comparison_of(&self, points_mm: &[DVec3], field_t: &[DVec3]) -> Result<Comparison, FilmError> {
        let ideal = self.ideal()?;
        self.tell(Stage::uncounted("comparison with the ideal film"));
        let reference = points_mm
            .iter()
            .map(|&p| self.seen_t(p, |place| ideal.flux_density_t(place).ok_or(FilmError::NotBelow(place))))
            .collect::<Result<Vec<DVec3>, _>>()?;
        Comparison::new(points_mm, field_t, &reference).map_err(FilmError::Comparison)
    }

    fn named_comparison(&self, comparison: Comparison) -> FilmComparison {
        let remark = remark_about_amplitude(comparison.amplitude);
        FilmComparison { source: Source::of(self), comparison, remark }
    }
}

/// What a best-fit amplitude below zero means.
pub fn remark_about_amplitude(amplitude: f64) -> Option<&'static str> {
    (amplitude < 0.0).then_some(
        "the amplitude is negative: the field is opposite to the field of the ideal film. The film is reversed (every J \
         points the other way), or shifted by half a wavelength along x and y",
    )
}
