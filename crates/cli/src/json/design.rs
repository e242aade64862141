//! `design --front`: the films of a front. `design` and `splice` print a [`SearchResult`] itself.

use magsplice::design::SearchResult;
use magsplice::layout::Layout;
use serde::Serialize;

/// The result of `design --front`.
#[derive(Serialize)]
pub(crate) struct FrontJson<'a> {
    program: &'a str,
    layout: &'a str,
    sha256: &'a str,
    films: Vec<FrontFilmJson<'a>>,
}

impl<'a> FrontJson<'a> {
    pub(crate) fn new(program: &'a str, layout: &'a Layout, films: Vec<FrontFilmJson<'a>>) -> FrontJson<'a> {
        FrontJson { program, layout: &layout.name, sha256: &layout.sha256, films }
    }
}

/// A film of a front, and the file in the folder that holds its layout.
#[derive(Serialize)]
pub(crate) struct FrontFilmJson<'a> {
    pub(crate) file: String,
    #[serde(flatten)]
    pub(crate) film: &'a SearchResult,
}
