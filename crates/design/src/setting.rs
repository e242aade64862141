//! A layout and its brief, made ready to be designed.

use magsplice_field::{Grid, IdealFilm, Tile};
use magsplice_layout::{Brief, Layout, Symmetry, WorkingVolume};

use crate::descent::Problem;
use crate::error::DesignError;
use crate::objective::Objective;
use crate::pattern::Pattern;
use crate::rules::{Bounds, Meaning, Rule};
use crate::sampling::Sampling;
use crate::symmetry::orbits;
use crate::tolerances::{AMPLITUDE_MARGIN, POINTS_ALONG};

/// A layout whose `[design]` can be carried out.
#[derive(Clone, Debug)]
pub struct Setting<'a> {
    pub(crate) layout: &'a Layout,
    pub(crate) brief: Brief,
    pub(crate) ideal: IdealFilm,
    pub(crate) volume: WorkingVolume,
    pub(crate) tiles: Vec<Tile>,
    /// The film with everything free that the brief frees.
    pub(crate) pattern: Pattern,
    pub(crate) problem: Problem,
}

impl<'a> Setting<'a> {
    /// # Errors
    /// If the layout lacks a table, its tiles lack the symmetry that is to be kept, or nothing is free.
    pub fn of(layout: &'a Layout) -> Result<Setting<'a>, DesignError> {
        let brief = layout.brief.clone().ok_or(DesignError::Missing("design"))?;
        Setting::with_brief(layout, brief)
    }

    /// The same for another brief than the layout's.
    ///
    /// # Errors
    /// As [`Setting::of`].
    pub fn with_brief(layout: &'a Layout, brief: Brief) -> Result<Setting<'a>, DesignError> {
        let ideal = layout.ideal.ok_or(DesignError::Missing("ideal"))?;
        let volume = layout.volume.ok_or(DesignError::Missing("volume"))?;
        let tiles = layout.bare_tiles();
        let named = |indices: Vec<usize>| indices.into_iter().map(|i| layout.tiles[i].name.clone()).collect();
        let moves = brief.vary.size || brief.vary.position || brief.vary.cut || brief.symmetry != Symmetry::None;
        let rotated: Vec<usize> = (0..tiles.len()).filter(|&i| !tiles[i].rotation().is_near_identity()).collect();
        if moves && !rotated.is_empty() {
            return Err(DesignError::Rotated(named(rotated)));
        }
        let orbits = orbits(&tiles, brief.symmetry).map_err(|without| DesignError::NotSymmetric(named(without)))?;
        let pattern = Pattern::of(&tiles, &orbits, &brief);
        if pattern.kinds.is_empty() {
            return Err(DesignError::NothingFree);
        }
        let sampling = Sampling::new(design_grid(&volume, brief.step_mm), volume.reference_mm, brief.symmetry);
        let below = |p: &glam::DVec3| ideal.flux_density_t(*p).ok_or(DesignError::NotBelow(*p));
        let ideal_field_t = sampling.computed().iter().map(below).collect::<Result<_, _>>()?;
        let objective = Objective {
            goal: brief.goal,
            weights: brief.weights,
            ideal,
            ideal_field_t,
            amplitude: brief.least_amplitude,
            amplitude_weights: [volume.grid, finer(&sampling.grid)].map(|grid| sampling.weights_of(&grid)).to_vec(),
        };
        let mut bounds = Bounds::of(&brief, &tiles);
        if brief.vary.position && !brief.vary.size {
            // Rounded, each of two centres may come nearer by half of it.
            bounds.gap_mm += brief.resolution_mm;
        }
        let problem = Problem {
            sampling,
            objective,
            bounds,
            least_amplitude: brief.least_amplitude.map(|least| least * (1.0 + AMPLITUDE_MARGIN)),
        };
        Ok(Setting { layout, brief, ideal, volume, tiles, pattern, problem })
    }

    /// How many numbers are free.
    pub fn free(&self) -> usize {
        self.pattern.kinds.len()
    }

    /// How many tiles determine all others.
    pub fn orbits(&self) -> usize {
        self.pattern.shapes.len()
    }

    /// The points the film is designed on.
    pub fn grid(&self) -> &Grid {
        &self.problem.sampling.grid
    }

    /// The same region five times finer, to see that nothing hides between these points.
    pub fn finer_grid(&self) -> Grid {
        finer(self.grid())
    }

    /// The least amplitude asked for.
    pub fn least_amplitude(&self) -> Option<f64> {
        self.brief.least_amplitude
    }

    pub(crate) fn told(&self, rules: &[Rule]) -> Vec<String> {
        rules.iter().map(|rule| self.words(rule)).collect()
    }

    fn words(&self, rule: &Rule) -> String {
        let name = |index: usize| &self.layout.tiles[index].name;
        let bounds = &self.problem.bounds;
        match rule.meaning {
            Meaning::ShortestSide(tile) => {
                format!("tile \"{}\": a side must be at least {} mm", name(tile), bounds.smallest_cut_mm)
            }
            Meaning::Outline(tile) => format!(
                "tile \"{}\": must stay within outline_mm, x = {:?}, y = {:?}",
                name(tile),
                bounds.outline_mm[0],
                bounds.outline_mm[1]
            ),
            Meaning::Thickness(tile) => {
                format!("tile \"{}\": its thickness must be within {:?} mm", name(tile), self.brief.thickness_mm)
            }
            Meaning::Strength(tile) => {
                format!("tile \"{}\": its strength must be within {:?} T", name(tile), self.brief.strength_t)
            }
            Meaning::Apart(a, b) => {
                format!("tiles \"{}\" and \"{}\": must be at least {} mm apart", name(a), name(b), bounds.gap_mm)
            }
        }
    }
}

/// How much finer the grid is on which a design is confirmed.
const FINER: usize = 5;

fn finer(grid: &Grid) -> Grid {
    Grid::new(grid.lower(), grid.upper(), grid.counts().map(|n| FINER * (n - 1) + 1)).expect("a grid of points")
}

/// The region of the volume, with the step asked for or with as few points as are enough.
fn design_grid(volume: &WorkingVolume, step_mm: Option<f64>) -> Grid {
    let grid = volume.grid;
    let counts = [0, 1, 2].map(|axis| match step_mm {
        Some(step) => ((grid.upper()[axis] - grid.lower()[axis]) / step).round().max(1.0) as usize + 1,
        None => grid.counts()[axis].min(POINTS_ALONG[axis]),
    });
    Grid::new(grid.lower(), grid.upper(), counts).expect("a grid of points")
}
