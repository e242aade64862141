//! The option `--preset`.

use std::path::Path;

use clap::{Args, ValueEnum};
use magsplice::layout::{self, CommonErrors, FilmTolerance, Layout};

use crate::failure::Failure;

/// Errors of tiles to assume instead of those of the layout.
#[derive(Args)]
pub(crate) struct PresetArgs {
    /// Typical errors of every tile, instead of [tolerance]
    #[arg(long, value_enum)]
    preset: Option<Preset>,
}

/// Usual errors of tiles, by the way in which a film is made.
#[derive(Clone, Copy, ValueEnum)]
pub(crate) enum Preset {
    /// Magnets from a shop, placed along a drawn line: 0.15 mm, 1.5 degrees, 3 % of strength, sizes
    /// to 0.05 mm, direction of J to 2 degrees
    ByHand,
    /// Sorted magnets, placed with care against stops: 0.05 mm, 0.5 degrees, 1 % of strength
    Workshop,
    /// Ground magnets of one batch in a milled frame: 0.02 mm, 0.2 degrees, 1 % of strength, sizes
    /// to 0.02 mm, direction of J to 1 degree
    Jig,
}

impl From<Preset> for layout::Preset {
    fn from(preset: Preset) -> layout::Preset {
        match preset {
            Preset::ByHand => layout::Preset::ByHand,
            Preset::Workshop => layout::Preset::Workshop,
            Preset::Jig => layout::Preset::Jig,
        }
    }
}

impl PresetArgs {
    /// Gives the tiles of a layout the errors of the preset, and no others. Samples and seed stay.
    /// Returns a remark on tables that then do not count.
    ///
    /// # Errors
    /// For discs and a preset with errors of sizes. `file` is the file of the layout.
    pub(crate) fn apply(&self, layout: &mut Layout, file: &Path) -> Result<Option<String>, Failure> {
        let Some(preset) = self.preset.map(layout::Preset::from) else { return Ok(None) };
        let FilmTolerance { samples, seed, common, groups, .. } = layout.tolerance.take().unwrap_or_default();
        let errors = FilmTolerance::of_film(&preset.errors(), &layout.tiles);
        let errors = errors.map_err(|fault| Failure::at(file, fault))?;
        layout.tolerance = Some(FilmTolerance { samples, seed, ..errors });
        let replaced = common != CommonErrors::default() || !groups.is_empty();
        Ok(replaced.then(|| {
            format!(
                "{}: --preset replaces [tolerance] with its tables of groups, surroundings and sensor: to keep them, write \
                 preset = \"{}\" in [tolerance]",
                file.display(),
                preset.name()
            )
        }))
    }
}
