//! Fewer distinct parts: tiles that are nearly alike become alike, by what it costs.
//!
//! A part is a size with a direction of polarization. A tile is a part laid in one of the eight ways a rectangle can lie, turned over included. Beginning with a
//! part for every tile, that pair of parts becomes one which costs least, tried by designing the film anew; parts that are at hand take tiles in the same way.

use std::ops::ControlFlow;

use glam::DVec3;
use magsplice_field::Tile;
use magsplice_layout::Layout;
use rayon::prelude::*;

use crate::descent::Found;
use crate::division::Division;
use crate::pattern::Pattern;
use crate::search::{Progress, Stage, Watch};
use crate::setting::Setting;
use crate::tolerances::{MOST_STEPS, PARTS_TRIED, TRIAL_STEPS, TRIALS_FINISHED};

/// A film of few parts.
#[derive(Clone, Debug)]
pub(crate) struct Parted {
    division: Division,
    pub(crate) pattern: Pattern,
    pub(crate) found: Found,
}

impl Parted {
    /// How many parts its tiles are made of.
    pub(crate) fn count(&self) -> usize {
        self.division.used().len()
    }
}

/// How many distinct parts tiles are made of, as the bill of materials counts them.
pub(crate) fn distinct(layout: &Layout, tiles: &[Tile]) -> usize {
    let mut layout = layout.clone();
    layout.tiles.iter_mut().zip(tiles).for_each(|(named, tile)| named.tile = *tile);
    layout.tiles.retain(|named| named.tile.polarization_t() != DVec3::ZERO);
    layout.parts().len()
}

/// The best film found with as few parts as the brief wants.
pub(crate) fn fewer(setting: &Setting, pattern: &Pattern, found: &Found, watch: Watch) -> Option<Parted> {
    levels(setting, pattern, found, setting.free_parts(), watch).pop()
}

/// The best films found with fewer and fewer parts, down to so many that are not at hand.
pub(crate) fn levels(
    setting: &Setting,
    pattern: &Pattern,
    found: &Found,
    free_parts: usize,
    watch: Watch,
) -> Vec<Parted> {
    let Some(mut parted) = Division::of(setting, pattern, found).designed(setting, pattern, MOST_STEPS) else {
        return Vec::new();
    };
    let from = parted.division.free();
    let mut levels = Vec::new();
    loop {
        let left = parted.division.free();
        let progress = Progress {
            stage: Stage::Parts(parted.count()),
            done: from - left,
            of: from.saturating_sub(free_parts),
            best: Some(setting.root_mean_square(&parted.found)),
        };
        if left <= free_parts {
            if let Some(better) = regrouped(setting, &parted, watch) {
                parted = better;
            }
            levels.push(parted);
            return levels;
        }
        levels.push(parted.clone());
        if watch(progress).is_break() {
            return levels;
        }
        let mut merged = parted.division.merged(setting.brief.vary.direction);
        if left > PARTS_TRIED {
            merged.sort_by(|a, b| a.distance.total_cmp(&b.distance));
            merged.truncate(TRIALS_FINISHED);
        }
        match best_of(setting, &parted.pattern, merged.into_iter().map(|m| m.division).collect()) {
            Some(next) => parted = next,
            None => return levels,
        }
    }
}

/// Gives single tiles other parts as long as that helps.
fn regrouped(setting: &Setting, parted: &Parted, watch: Watch) -> Option<Parted> {
    let mut best: Option<Parted> = None;
    loop {
        let now = best.as_ref().unwrap_or(parted);
        let progress = Progress {
            stage: Stage::Parts(now.count()),
            done: 0,
            of: 0,
            best: Some(setting.root_mean_square(&now.found)),
        };
        if now.division.placed.len() > PARTS_TRIED || watch(progress).is_break() {
            return best;
        }
        let next = best_of(setting, &now.pattern, now.division.with_one_exchanged(setting.brief.vary.direction))?;
        if next.found.merit() >= 0.999 * now.found.merit() {
            return best;
        }
        best = Some(next);
    }
}

/// Tries all a little, the best to the end.
fn best_of(setting: &Setting, pattern: &Pattern, divisions: Vec<Division>) -> Option<Parted> {
    let mut tried: Vec<Parted> =
        divisions.into_par_iter().filter_map(|division| division.designed(setting, pattern, TRIAL_STEPS)).collect();
    tried.sort_by(|a, b| a.found.merit().total_cmp(&b.found.merit()));
    tried.truncate(TRIALS_FINISHED);
    let finished: Vec<Parted> = tried
        .into_par_iter()
        .filter_map(|parted| {
            let go_on = &mut |_: &Found| ControlFlow::Continue(());
            let found = setting.problem.descend(&parted.pattern, parted.found.at, MOST_STEPS, go_on)?;
            Some(Parted { division: parted.division.at(&parted.pattern, &found), pattern: parted.pattern, found })
        })
        .collect();
    finished.into_iter().min_by(|a, b| a.found.merit().total_cmp(&b.found.merit()))
}

impl Setting<'_> {
    /// How many parts may be made that are not at hand.
    pub(crate) fn free_parts(&self) -> usize {
        self.brief.parts.map_or(0, |parts| parts.saturating_sub(self.brief.stock.len()))
    }
}

impl Division {
    /// The film with the sizes of parts and the places of tiles free, designed for so many steps.
    fn designed(self, setting: &Setting, like: &Pattern, steps: usize) -> Option<Parted> {
        let pattern = self.pattern(setting, like);
        let at = setting.problem.nearest(&pattern, &pattern.start).ok()?;
        let found = setting.problem.descend(&pattern, at, steps, &mut |_| ControlFlow::Continue(()))?;
        Some(Parted { division: self.at(&pattern, &found), pattern, found })
    }
}
