//! Remarks on standard error: what is allowed in a layout or a result but usually a mistake.

use std::path::Path;

use magsplice::layout::{FindingSubject, Layout};

use crate::failure;
use crate::text::number::counted;

/// Largest number of findings that a verb other than `check` prints.
const PRINTED_FINDINGS: usize = 5;

/// Subjects of verbs that use the tiles alone.
pub(crate) const OF_TILES: &[FindingSubject] = &[FindingSubject::Tiles];

/// Subjects of verbs that evaluate the field on the working volume.
pub(crate) const OF_FIELDS: &[FindingSubject] = &[FindingSubject::Tiles, FindingSubject::Volume];

/// Subjects of verbs that compare the field with the ideal film.
pub(crate) const OF_COMPARISONS: &[FindingSubject] =
    &[FindingSubject::Tiles, FindingSubject::Volume, FindingSubject::IdealFilm];

/// Subjects of `design`.
pub(crate) const OF_DESIGNS: &[FindingSubject] =
    &[FindingSubject::Tiles, FindingSubject::Volume, FindingSubject::IdealFilm, FindingSubject::Design];

/// Says after a long result how many warnings were printed before it, unless `quiet`.
pub(crate) fn recall(layout: &Layout, subjects: &[FindingSubject], quiet: bool) {
    let told = layout.findings.iter().filter(|finding| subjects.contains(&finding.subject)).count();
    if told > 0 && !quiet {
        failure::tell(&format_args!("{} above", counted(told, "warning", "warnings")));
    }
}

/// Prints the findings of a layout about `subjects`.
pub(crate) fn tell(path: &Path, layout: &Layout, subjects: &[FindingSubject]) {
    let path = path.display();
    let mut findings = layout.findings.iter().filter(|finding| subjects.contains(&finding.subject));
    for finding in findings.by_ref().take(PRINTED_FINDINGS) {
        failure::tell(&format_args!("warning: {path}: {finding}"));
    }
    let more = findings.count();
    if more > 0 {
        failure::tell(&format_args!("warning: {path}: and {more} more, listed by `magsplice check {path}`"));
    }
}
