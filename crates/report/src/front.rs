//! The front of a design: films that are better, and what they cost.

use crate::figure::Figure;
use crate::figures::front;
use crate::report::ReportError;
use crate::typeset;

/// Films along a front.
#[derive(Clone, Debug)]
pub struct Front {
    /// What the films pay with.
    pub axis: Axis,
    /// The films found, in order.
    pub films: Vec<FrontFilm>,
    /// The film the design began with.
    pub before: Option<FrontFilm>,
}

/// What better films cost.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axis {
    /// Best-fit amplitude against the ideal film.
    Amplitude,
    /// The number of distinct parts.
    Parts,
}

/// A film of a front. Errors along x, y, z.
#[derive(Clone, Copy, Debug)]
pub struct FrontFilm {
    /// Where on the axis it is.
    pub at: f64,
    /// RMSE of displacement against the true one.
    pub displacement_rmse_mm: [f64; 3],
    /// Uniformity RMSE of the parameters over k.
    pub uniformity_rmse_mm: [f64; 3],
}

impl Front {
    /// Errors against the axis, as a figure.
    ///
    /// # Errors
    /// If it cannot be drawn: without films, for one.
    pub fn figure(&self) -> Result<Figure, ReportError> {
        let (name, against) = match self.axis {
            Axis::Amplitude => ("front-amplitude", "the amplitude of its field, of the ideal film's"),
            Axis::Parts => ("front-parts", "the number of distinct parts it is made of"),
        };
        let caption =
            format!("How far a film is from decoupling, against {against}. Shear is the larger error of x and y.");
        let failed = |message: String| ReportError::Drawing { figure: name.to_owned(), message };
        let svg = front::draw(self).map_err(failed)?;
        Figure::new(name, caption, &svg, &typeset::options()).map_err(failed)
    }
}
