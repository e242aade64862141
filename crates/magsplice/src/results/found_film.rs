//! A film that a search found.

use magsplice_design::{SearchResult, SpliceTrial};
use magsplice_layout::Layout;
use serde::Serialize;

use super::out_of_range::OutOfRange;
use crate::film::Film;
use crate::film_error::FilmError;

/// A film that a search found, and what its sensor reads.
#[derive(Clone, Debug, Serialize)]
pub struct FoundFilm {
    /// The film.
    #[serde(flatten)]
    pub search: SearchResult,
    /// Readings beyond the range of the layout's sensor. `None` if all are within it, or the layout
    /// has no range.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub out_of_range: Option<OutOfRange>,
    /// Searches with one number of the request changed, if a film designed without an initial
    /// layout is useless.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub trials: Vec<SpliceTrial>,
}

impl FoundFilm {
    /// The film of a search, whose layout is `layout`, without trials.
    ///
    /// # Errors
    /// If the sensor of the layout cannot read the field.
    pub fn new(search: SearchResult, layout: Layout) -> Result<FoundFilm, FilmError> {
        let out_of_range = match layout.sensor {
            Some(_) => Film::new(layout)?.out_of_range()?,
            None => None,
        };
        Ok(FoundFilm { search, out_of_range, trials: Vec::new() })
    }
}
