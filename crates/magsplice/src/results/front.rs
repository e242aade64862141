//! The films of a trade-off.

use magsplice_design::{ParetoFront, SearchResult};
use magsplice_layout::Layout;
use serde::Serialize;

use super::source::LayoutSource;

/// The films of a Pareto front.
#[derive(Clone, Debug, Serialize)]
pub struct FilmFront {
    /// The layout whose design was searched.
    #[serde(flatten)]
    pub source: LayoutSource,
    /// The films, those by amplitude first.
    pub films: Vec<FrontFilm>,
}

/// A film of a front.
#[derive(Clone, Debug, Serialize)]
pub struct FrontFilm {
    /// Name of the file for its layout.
    pub file: String,
    /// The film.
    #[serde(flatten)]
    pub film: SearchResult,
}

impl FilmFront {
    /// The front of a layout.
    pub fn new(layout: &Layout, front: &ParetoFront) -> FilmFront {
        let by_amplitude = front.by_amplitude.iter().map(|(least, film)| (format!("amplitude-{least}.toml"), film));
        let by_parts =
            front.by_parts.iter().zip(1..).map(|(film, number)| (format!("parts-{}-{number}.toml", film.parts), film));
        let films = by_amplitude.chain(by_parts).map(|(file, film)| FrontFilm { file, film: film.clone() });
        FilmFront { source: LayoutSource::of(layout), films: films.collect() }
    }
}
