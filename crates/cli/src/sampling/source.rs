//! What samples are samples of.

use std::fmt::{self, Write};
use std::ops::Range;

use magsplice::layout::Layout;
use magsplice::making::Sorting;
use sha2::{Digest, Sha256};

/// A run: a film with its errors, the seed, and the numbers of the samples.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct SampleSource {
    /// SHA-256 of the tiles, their permeabilities and errors, the working volume, the ideal film
    /// and how tiles are sorted, which with the seed determine every sample.
    pub(crate) fingerprint: String,
    pub(crate) seed: u64,
    /// Number of the first sample.
    pub(crate) first: u64,
    /// Number of samples.
    pub(crate) count: u64,
}

impl SampleSource {
    pub(crate) fn new(layout: &Layout, sorting: Option<&Sorting>, seed: u64, first: u64, count: u64) -> SampleSource {
        let mut hash = HashWriter(Sha256::new());
        // Debug writes every digit of every number.
        let Layout { tiles, tolerance, volume, ideal, .. } = layout;
        let errors = tolerance.as_ref().map(|t| (&t.tiles, &t.groups, &t.common));
        write!(hash, "{:?}", (tiles.iter().map(|t| t.tile).collect::<Vec<_>>(), errors, volume, ideal))
            .expect("a hash accepts every text");
        if layout.has_recoil() {
            write!(hash, "{:?}", (layout.permeabilities(), layout.material.recoil_error))
                .expect("a hash accepts every text");
        }
        if let Some(sorting) = sorting {
            write!(hash, "{sorting:?}").expect("a hash accepts every text");
        }
        let mut fingerprint = String::new();
        for byte in hash.0.finalize() {
            let _ = write!(fingerprint, "{byte:02x}");
        }
        SampleSource { fingerprint, seed, first, count }
    }

    /// The numbers of the samples.
    pub(crate) fn range(&self) -> Range<u64> {
        self.first..self.first + self.count
    }

    /// The line before the samples in a file.
    pub(crate) fn line(&self) -> String {
        let SampleSource { fingerprint, seed, first, count } = self;
        format!("# magsplice tolerance: film {fingerprint}, seed {seed}, first {first}, count {count}")
    }

    /// The run that a line tells. `None` if it tells none.
    pub(crate) fn parse(line: &str) -> Option<SampleSource> {
        let rest = line.strip_prefix("# magsplice tolerance: film ")?;
        let (fingerprint, rest) = rest.split_once(", seed ")?;
        let (seed, rest) = rest.split_once(", first ")?;
        let (first, count) = rest.split_once(", count ")?;
        let [seed, first, count] = [seed, first, count].map(|number| number.parse().ok());
        Some(SampleSource { fingerprint: fingerprint.to_owned(), seed: seed?, first: first?, count: count? })
    }
}

struct HashWriter(Sha256);

impl Write for HashWriter {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        self.0.update(text.as_bytes());
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_read_as_it_was_written() {
        let source = SampleSource { fingerprint: "0123abcd".to_owned(), seed: 7, first: 100, count: 25 };
        assert_eq!(SampleSource::parse(&source.line()), Some(source));
        assert_eq!(SampleSource::parse("# x,y,z"), None);
    }
}
