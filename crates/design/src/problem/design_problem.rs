//! Design problems: a layout and its brief, prepared for the search.

use std::borrow::Cow;

use magsplice_ideal::IdealFilm;
use magsplice_layout::{Brief, Goal, Layout, MemoryError, Symmetry, Under, Variable, WorkingVolume, check_memory};
use magsplice_magnet::{BoundingBox, Grid, IronPlane, Tile};

use crate::error::{DesignError, NeededTable};
use crate::problem::error_model::ErrorModel;
use crate::problem::least_squares::LeastSquares;
use crate::problem::near_iron::TILTED;
use crate::problem::objective::{Objective, ideal_field_t};
use crate::problem::pattern::Pattern;
use crate::problem::reading::Reading;
use crate::problem::rules::{DesignBounds, LinearRule};
use crate::problem::sampling::Sampling;
use crate::problem::symmetry::orbits;
use crate::rule::Rule;
use crate::tolerances::{AMPLITUDE_MARGIN, POINTS_ALONG, SAME_TILE};

/// A layout with a brief that can be carried out. Lengths in millimetres, polarization in tesla.
///
/// See the [crate's example](crate#example).
#[derive(Clone, Debug)]
pub struct DesignProblem<'a> {
    pub(crate) layout: Cow<'a, Layout>,
    pub(crate) brief: Brief,
    pub(crate) ideal: IdealFilm,
    pub(crate) volume: WorkingVolume,
    pub(crate) tiles: Vec<Tile>,
    /// The film with every number free that the brief lets vary.
    pub(crate) pattern: Pattern,
    pub(crate) least_squares: LeastSquares,
}

/// Ends of a film along x and y; `None` along an axis where it is centred on 0.
fn off_centre_mm(tiles: &[Tile]) -> [Option<[f64; 2]>; 2] {
    let film = BoundingBox::from_tiles(tiles);
    [0, 1].map(|axis| {
        let (low, high) = (film.lower[axis], film.upper[axis]);
        ((low + high).abs() > SAME_TILE * (high - low)).then(|| [low, high].map(shown_mm))
    })
}

/// A length without the round-off of sums of decimal numbers.
fn shown_mm(value_mm: f64) -> f64 {
    // Adding 0 turns -0 into 0.
    format!("{value_mm:.6}").parse().unwrap_or(value_mm) + 0.0
}

impl<'a> DesignProblem<'a> {
    /// The problem of the layout's `[design]` table.
    ///
    /// # Errors
    /// If the layout lacks a table, its tiles lack the symmetry of the brief, no number is free, or
    /// the working volume is not below the film.
    pub fn new(layout: &'a Layout) -> Result<DesignProblem<'a>, DesignError> {
        let brief = layout.brief.clone().ok_or(DesignError::Missing(NeededTable::Design))?;
        DesignProblem::from_brief(layout, brief)
    }

    /// The problem of another brief for this layout.
    ///
    /// # Errors
    /// As [`DesignProblem::new`].
    pub fn from_brief(layout: &'a Layout, brief: Brief) -> Result<DesignProblem<'a>, DesignError> {
        DesignProblem::of(Cow::Borrowed(layout), brief)
    }

    pub(crate) fn of(layout: Cow<'a, Layout>, brief: Brief) -> Result<DesignProblem<'a>, DesignError> {
        let ideal = layout.ideal.ok_or(DesignError::Missing(NeededTable::Ideal))?;
        let volume = layout.volume.ok_or(DesignError::Missing(NeededTable::Volume))?;
        let is_level = |plane: &IronPlane| plane.normal().x.abs().max(plane.normal().y.abs()) <= TILTED;
        if brief.symmetry != Symmetry::None && !layout.iron.planes().iter().all(is_level) {
            return Err(DesignError::TiltedIron);
        }
        let tiles = layout.bare_tiles();
        let named = |indices: Vec<usize>| indices.into_iter().map(|i| layout.tiles[i].name.clone()).collect();
        let moves = [Variable::Size, Variable::Position, Variable::Cut].into_iter().any(|moved| brief.varies(moved));
        let moves = moves || brief.symmetry != Symmetry::None;
        let rotated: Vec<usize> = (0..tiles.len()).filter(|&i| !tiles[i].rotation().is_near_identity()).collect();
        if moves && !rotated.is_empty() {
            return Err(DesignError::Rotated(named(rotated)));
        }
        let orbits = orbits(&tiles, brief.symmetry).map_err(|without| {
            let most = 2 * without.len() >= tiles.len();
            let off_centre_mm = if most { off_centre_mm(&tiles) } else { [None; 2] };
            DesignError::NotSymmetric { tiles: named(without), off_centre_mm }
        })?;
        if brief.varies(Variable::Head) && layout.head_spacing_mm().is_none() {
            return Err(DesignError::NoSpacing);
        }
        let pattern = Pattern::new(&tiles, &orbits, &brief);
        if pattern.kinds.is_empty() && !brief.varies(Variable::Head) {
            return Err(DesignError::NothingFree);
        }
        let reading = Reading::new(layout.head());
        check_free_memory(&pattern, &design_grid(&volume, brief.step_mm), &reading).map_err(DesignError::Memory)?;
        volume.check_memory(BYTES_PER_POINT).map_err(DesignError::Memory)?;
        let grid = design_grid(&volume, brief.step_mm);
        let sampling =
            Sampling::new(grid, volume.reference_mm, brief.symmetry, reading, &layout.iron.reflections(&tiles));
        let ideal_field_t = ideal_field_t(&ideal, layout.head(), sampling.computed())?;
        let objective = Objective {
            goal: brief.goal,
            weights: brief.weights,
            ideal,
            ideal_field_t,
            amplitude: brief.least_amplitude,
            amplitude_weights: [volume.grid, finer(&sampling.grid)].map(|grid| sampling.weights_for(&grid)).to_vec(),
        };
        let bounds = DesignBounds::new(&brief, &tiles);
        let errors = match (brief.under, &layout.tolerance) {
            (Under::Nominal, _) => None,
            (Under::Tolerance, None) => return Err(DesignError::Missing(NeededTable::Tolerance)),
            (Under::Tolerance, Some(_)) if brief.goal != Goal::Displacement => {
                return Err(DesignError::NotDisplacement);
            }
            (Under::Tolerance, Some(tolerance)) => {
                let has_iron = tolerance.common.iron.is_some();
                if has_iron && (layout.has_recoil() || brief.varies(Variable::Head)) {
                    return Err(DesignError::NearIron);
                }
                Some(ErrorModel::new(tolerance, &tiles, &sampling, brief.weights)?)
            }
        };
        let least_squares = LeastSquares {
            sampling,
            objective,
            bounds,
            least_amplitude: brief.least_amplitude.map(|least| least * (1.0 + AMPLITUDE_MARGIN)),
            errors,
        };
        Ok(DesignProblem { layout, brief, ideal, volume, tiles, pattern, least_squares })
    }

    /// Number of free parameters, the variables of the search.
    pub fn variable_count(&self) -> usize {
        self.pattern.kinds.len() + usize::from(self.brief.varies(Variable::Head))
    }

    /// The goal of the search.
    pub fn brief(&self) -> &Brief {
        &self.brief
    }

    /// Number of tiles that determine all others by symmetry.
    pub fn orbit_count(&self) -> usize {
        self.pattern.tiles.len()
    }

    /// The design grid: the points at which the search evaluates films.
    pub fn grid(&self) -> &Grid {
        &self.least_squares.sampling.grid
    }

    /// The design grid refined five times, which shows errors between the points of the design
    /// grid.
    pub fn finer_grid(&self) -> Grid {
        finer(self.grid())
    }

    /// The ideal film of the layout.
    pub fn ideal(&self) -> &IdealFilm {
        &self.ideal
    }

    /// The error of rules that no film keeps together.
    pub(crate) fn contradiction(&self, rules: Vec<LinearRule>) -> DesignError {
        DesignError::Contradiction(self.named(rules))
    }

    /// Rules with the names of their tiles.
    pub(crate) fn named(&self, rules: Vec<LinearRule>) -> Vec<Rule> {
        let name = |tile: usize| self.layout.tiles[tile].name.clone();
        let named = |LinearRule { demand, tiles: (tile, other), .. }| Rule {
            tiles: [Some(tile), other].into_iter().flatten().map(name).collect(),
            demand,
        };
        rules.into_iter().map(named).collect()
    }
}

/// Bytes of the metrics of a film for each point of the volume. Measured: 163.
const BYTES_PER_POINT: f64 = 164.0;

/// Checks the memory of the derivatives at the points of the design grid and at the places of a
/// head, for each start that runs at once, and of the curvature.
fn check_free_memory(pattern: &Pattern, grid: &Grid, reading: &Reading) -> Result<(), MemoryError> {
    let (free, points) = (pattern.kinds.len(), grid.len());
    let vectors = (3 * size_of::<f64>()) as f64;
    let of_start = vectors * free as f64 * ((1 + reading.sensors().len()) * points + free) as f64;
    check_memory(
        of_start * rayon::current_num_threads() as f64,
        || format!("[design] has {free} free parameters at {points} points of its grid"),
        |_| "let fewer properties of fewer tiles vary, or use a larger step_mm in [design]".to_owned(),
    )
}

/// Refinement of the grid on which a design is confirmed.
const FINER: usize = 5;

fn finer(grid: &Grid) -> Grid {
    Grid::new(grid.lower(), grid.upper(), grid.counts().map(|n| FINER * (n - 1) + 1)).expect("a grid of points")
}

/// The grid over the region of the volume, with the step of the brief or as few points as are
/// enough.
fn design_grid(volume: &WorkingVolume, step_mm: Option<f64>) -> Grid {
    let grid = volume.grid;
    let extent = grid.upper() - grid.lower();
    let counts = [0, 1, 2].map(|axis| match step_mm {
        _ if extent[axis] == 0.0 => 1,
        Some(step) => (extent[axis] / step).round().max(1.0) as usize + 1,
        None => grid.counts()[axis].min(POINTS_ALONG[axis]),
    });
    Grid::new(grid.lower(), grid.upper(), counts).expect("a grid of points")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rounding to the resolution moves the amplitude by less than 1e-4 of it, and by more than
    /// 1e-6.
    #[test]
    fn search_aims_above_the_least_amplitude() {
        let text = "format = 1\nname = \"film\"\n[ideal]\nwavelength_mm = 10.0\nthickness_mm = 1.0\namplitude_t = 0.12\n\
                    [volume]\nx_mm = [-2.0, 2.0]\ny_mm = [-2.0, 2.0]\nz_mm = [-5.0, -3.0]\nstep_mm = 1.0\n\
                    [design]\nvary = [\"direction\"]\namplitude = { min = 0.5 }\n\
                    [[tile]]\nposition_mm = [0, 0, 0.5]\nsize_mm = [1, 1, 1]\npolarization_t = [0.1, 0.1, 0]\n";
        let layout = Layout::parse(text, "film").unwrap();
        let problem = DesignProblem::new(&layout).unwrap();
        let aim = problem.least_squares.least_amplitude.unwrap();
        assert!((0.5 * (1.0 + 1e-6)..0.5 * (1.0 + 1e-4)).contains(&aim), "{aim}");
        assert_eq!(problem.brief().least_amplitude, Some(0.5));
    }

    /// A film of four tiles, and of others beside them.
    fn refused(design: &str, positions: &[[f64; 2]]) -> DesignError {
        let mut text = format!(
            "format = 1\nname = \"film\"\n[ideal]\nwavelength_mm = 10.0\nthickness_mm = 1.0\namplitude_t = 0.12\n\
             [volume]\nx_mm = [-2.0, 2.0]\ny_mm = [-2.0, 2.0]\nz_mm = [-5.0, -3.0]\nstep_mm = 1.0\n[design]\n{design}\n"
        );
        for [x, y] in positions {
            text += &format!(
                "[[tile]]\nposition_mm = [{x}, {y}, 0.5]\nsize_mm = [1, 1, 1]\npolarization_t = [{}, 0, 0]\n",
                0.1 * x.signum()
            );
        }
        let layout = Layout::parse(&text, "film").unwrap_or_else(|e| panic!("{e}"));
        DesignProblem::new(&layout).map(|_| ()).expect_err("refused")
    }

    /// Where most tiles lack an image, the film is beside the axis. A single tile without one is
    /// the cause itself.
    #[test]
    fn films_beside_their_axis_are_told_with_their_ends() {
        let mirror = "vary = [\"size\"]\nsymmetry = \"mirror\"";
        let of = |positions: &[[f64; 2]]| match refused(mirror, positions) {
            DesignError::NotSymmetric { tiles, off_centre_mm } => (tiles.len(), off_centre_mm),
            other => panic!("{other}"),
        };
        let beside = [[2.5, 2.0], [-1.5, 2.0], [2.5, -2.0], [-1.5, -2.0]];
        assert_eq!(of(&beside), (4, [Some([-2.0, 3.0]), None]));
        assert_eq!(of(&beside.map(|[x, y]| [x - 0.5, y + 0.25])), (2, [None, Some([-2.25, 2.75])]));
        // Half of the tiles, and fewer.
        let pair = [[2.0, 0.0], [-2.0, 0.0]];
        assert_eq!(of(&[pair[0], pair[1], [4.0, 0.0], [6.0, 0.0]]), (2, [Some([-2.5, 6.5]), None]));
        assert_eq!(of(&[pair[0], pair[1], [4.0, 0.0]]), (1, [None; 2]));
    }

    /// Each start holds three components of the derivatives at all points twice, and of the
    /// curvature. The sizes of 1200 tiles at 57 x 57 x 29 points need more than the 10.4 GB that
    /// any work may take.
    #[test]
    fn memory_of_the_design_grid_is_limited() {
        let many: Vec<[f64; 2]> = (0..1200).map(|n| [2.0 * f64::from(n % 40), 2.0 * f64::from(n / 40)]).collect();
        let DesignError::Memory(error) = refused("vary = [\"size\"]\nstep_mm = 0.071", &many) else { panic!("memory") };
        let (free, points) = (2400.0, 57.0 * 57.0 * 29.0);
        let bytes = 24.0 * free * (2.0 * points + free) * rayon::current_num_threads() as f64;
        assert!((error.bytes / bytes - 1.0).abs() < 1e-12, "{error:?}, not {bytes}");
        assert_eq!(error.cause, format!("[design] has {free} free parameters at {points} points of its grid"));
    }

    /// The step of the brief divides the extents to the nearest count. Without one, the grid of the
    /// volume counts up to a limit. The finer grid has five steps for each.
    #[test]
    fn grids_have_the_steps_of_the_brief() {
        let volume = |step_mm: f64| {
            let (lower, upper) = (glam::DVec3::new(-2.0, -2.0, -5.0), glam::DVec3::new(2.0, 1.0, -5.0));
            WorkingVolume::new(lower, upper, glam::DVec3::splat(step_mm), glam::DVec3::new(0.0, 0.0, -4.0)).unwrap()
        };
        let counts = |step_mm: f64, of_brief: Option<f64>| design_grid(&volume(step_mm), of_brief).counts();
        assert_eq!(counts(1.0, Some(0.8)), [6, 5, 1]);
        assert_eq!(counts(1.0, Some(9.0)), [2, 2, 1]);
        assert_eq!(counts(1.0, None), [5, 4, 1]);
        assert_eq!(counts(0.1, None), [9, 9, 1]);
        let grid = design_grid(&volume(1.0), None);
        assert_eq!(finer(&grid).counts(), [21, 16, 1]);
        assert_eq!((finer(&grid).lower(), finer(&grid).upper()), (grid.lower(), grid.upper()));
    }

    #[test]
    fn shown_lengths_have_no_round_off() {
        assert_eq!([shown_mm(0.1 + 0.2), shown_mm(-2.5)], [0.3, -2.5]);
        assert_eq!(shown_mm(-1e-9).to_bits(), 0.0_f64.to_bits());
    }
}
