//! Errors of discs, whose strips move and change together.

use std::collections::HashMap;

use thiserror::Error;

use crate::layout::{NamedTile, WholeDisc};
use crate::tolerance::{ErrorGroup, FilmTolerance, TileErrors};

impl FilmTolerance {
    /// The same errors for each tile of a layout, and no others. A disc is one tile: its strips
    /// have them together.
    ///
    /// # Errors
    /// As [`FilmTolerance::of_whole_discs`].
    pub fn of_film(errors: &TileErrors, tiles: &[NamedTile]) -> Result<FilmTolerance, DiscErrorsFault> {
        FilmTolerance::of_tiles(errors, tiles.len()).of_whole_discs(tiles)
    }

    /// The errors with those of each disc as errors of a group of its strips.
    ///
    /// # Errors
    /// Errors of the size of a disc, or strips of one disc with different errors.
    pub fn of_whole_discs(mut self, tiles: &[NamedTile]) -> Result<FilmTolerance, DiscErrorsFault> {
        let is_strip = |index: usize| tiles[index].disc.is_some();
        if !self.tiles.is_empty() && (0..tiles.len()).any(is_strip) {
            for (disc, strips) in discs(tiles) {
                let own: Vec<TileErrors> = strips.iter().map(|strip| std::mem::take(&mut self.tiles[*strip])).collect();
                if own.iter().any(|errors| *errors != own[0]) {
                    return Err(DiscErrorsFault::Strips(disc.name.clone()));
                }
                if own[0] != TileErrors::default() {
                    let is_free = self.groups.iter().all(|group| group.name != disc.name);
                    let name = if is_free { disc.name.clone() } else { format!("disc {}", disc.name) };
                    self.groups.push(ErrorGroup { name, tiles: strips, errors: own[0].clone() });
                }
            }
            if self.tiles.iter().all(|errors| *errors == TileErrors::default()) {
                self.tiles = Vec::new();
            }
        }
        let of_strips = |group: &&ErrorGroup| group.tiles.iter().any(|tile| is_strip(*tile));
        let has_size = |group: &ErrorGroup| group.errors.size.iter().any(|error| !error.is_none());
        match self.groups.iter().filter(of_strips).find(|group| has_size(group)) {
            Some(group) => Err(DiscErrorsFault::Size(group.name.clone())),
            None => Ok(self),
        }
    }
}

/// The discs of tiles, each with the indices of its strips, in the order of their first strips.
pub(crate) fn discs(tiles: &[NamedTile]) -> Vec<(&WholeDisc, Vec<usize>)> {
    let mut found: Vec<(&WholeDisc, Vec<usize>)> = Vec::new();
    let mut known: HashMap<&str, usize> = HashMap::new();
    for (index, disc) in tiles.iter().enumerate().filter_map(|(index, named)| Some((index, named.disc.as_ref()?))) {
        let number = *known.entry(&disc.name).or_insert_with(|| {
            found.push((disc, Vec::new()));
            found.len() - 1
        });
        found[number].1.push(index);
    }
    found
}

/// Errors of discs that the strips cannot have.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum DiscErrorsFault {
    /// The group or disc of this name has errors of size.
    #[error(
        "\"{0}\" has errors of size_mm, which would change every strip of a disc: set size_mm = 0, in [tolerance] also beside \
         a preset, and count them in strength"
    )]
    Size(String),
    /// The strips of the disc of this name have different errors.
    #[error("the strips of the disc \"{0}\" have different errors, must have the same")]
    Strips(String),
}
