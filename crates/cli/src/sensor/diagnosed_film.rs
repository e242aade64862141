//! Results of `diagnose`: a film with what a scan tells of its tiles.

use magsplice::FilmRecoil;
use magsplice::layout::{FilmTolerance, Layout};
use magsplice::magnet::TileError;
use magsplice::prelude::DVec3;
use magsplice::scan::{Candidate, Diagnosis, ErrorKind, NamedError, NarrowedError, SimilarErrors};

/// A layout with the diagnosis of a scan.
pub(crate) struct DiagnosedFilm<'a> {
    /// The film as ordered, with the ordinary errors.
    pub(crate) layout: &'a Layout,
    pub(crate) recoil: Option<FilmRecoil>,
    pub(crate) diagnosis: Diagnosis,
    pub(crate) readings: usize,
    pub(crate) noise_t: DVec3,
    pub(crate) has_ordinary: bool,
    pub(crate) false_alarm: f64,
}

/// Cosine of the angle between J and an axis of rotation from which on a turn is about J.
const ABOUT_J: f64 = 0.99;

/// What is wrong in one word.
pub(crate) fn kind(kind: ErrorKind) -> &'static str {
    match kind {
        ErrorKind::Strength => "strength",
        ErrorKind::Turn => "turn",
        ErrorKind::Direction => "direction",
        ErrorKind::Displacement => "displacement",
        _ => "error",
    }
}

/// What is wrong in words, with its magnitude.
pub(crate) fn in_words(named: &NamedError) -> String {
    let magnitude = named.magnitude();
    match named.candidate.kind {
        ErrorKind::Strength if magnitude < 0.0 => format!("{:.2} % too weak", -100.0 * magnitude),
        ErrorKind::Strength => format!("{:.2} % too strong", 100.0 * magnitude),
        ErrorKind::Turn => format!("turned by {:.2} deg", magnitude.to_degrees()),
        ErrorKind::Direction => format!("J turned by {:.2} deg", magnitude.to_degrees()),
        _ => format!("displaced by {magnitude:.3} mm"),
    }
}

impl DiagnosedFilm<'_> {
    /// The name of a tile.
    pub(crate) fn name(&self, tile: usize) -> &str {
        &self.layout.tiles[tile].name
    }

    /// What could be wrong instead, in words.
    pub(crate) fn candidate(&self, candidate: Candidate) -> String {
        format!("{} of {}", kind(candidate.kind), self.name(candidate.tile))
    }

    /// Errors that the scan hardly narrows.
    pub(crate) fn unresolved(&self) -> Vec<NarrowedError> {
        self.diagnosis.narrowed.iter().copied().filter(NarrowedError::is_unresolved).collect()
    }

    /// Whether an error turns a tile about its J, which hardly changes the field.
    pub(crate) fn is_about_j(&self, tile: usize, error: TileError) -> bool {
        let along = self.layout.tiles[tile].tile.scene_polarization_t().normalize_or_zero();
        matches!(error, TileError::Rotation(axis) if along[axis.index()].abs() > ABOUT_J)
    }

    /// The largest standard deviation of the errors of a tile after the scan over that before it,
    /// but for turns about J.
    #[cfg(feature = "report")]
    pub(crate) fn unresolved_of(&self, tile: usize) -> f64 {
        let of_tile = self.diagnosis.narrowed.iter();
        let of_tile = of_tile.filter(|error| error.tile == tile && !self.is_about_j(tile, error.error));
        of_tile.map(NarrowedError::ratio).fold(0.0, f64::max)
    }

    /// Pairs of errors that look alike, without those of one tile between its turn and its J.
    pub(crate) fn similar(&self) -> &[SimilarErrors] {
        &self.diagnosis.similar
    }

    /// The film that was found as a layout. Requirements and the brief are those of the film as
    /// ordered, and are left out; so are the errors of its tiles, which are now known.
    pub(crate) fn found_layout(&self, original: &Layout, scan: &str) -> Layout {
        let mut layout = original.clone().with_made_tiles(&self.diagnosis.tiles);
        layout.tolerance =
            layout.tolerance.map(|tolerance| FilmTolerance { tiles: Vec::new(), groups: Vec::new(), ..tolerance });
        layout.tolerance = layout.tolerance.filter(|tolerance| *tolerance != FilmTolerance::default());
        let named: Vec<String> = self
            .diagnosis
            .named
            .iter()
            .map(|named| format!("{} {}", self.name(named.candidate.tile), in_words(named)))
            .collect();
        layout.history.push(format!(
            "magsplice {} diagnose: from \"{}\" (sha256 {}) by {}: {}",
            env!("CARGO_PKG_VERSION"),
            original.name,
            &original.sha256[..12],
            scan,
            if named.is_empty() { "no tile is wrong".to_owned() } else { named.join(", ") }
        ));
        layout
    }
}
