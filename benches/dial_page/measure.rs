//! Time and error of every model at one place.

use std::hint::black_box;
use std::path::Path;
use std::time::Instant;

use glam::DVec3;
use magsplice::field::{Accuracy, FittedField, Grid, Quantity, Scene, Tile, Tolerance};
use magsplice_benches::{Magba, Magpylib, evenly_thinned, median};
use magsplice_tests::oracle::Oracle;
use nalgebra::Vector3;

use crate::Effort;
use crate::scenes::Place;

/// What takes more seconds is timed once.
pub(crate) const SLOW_S: f64 = 3.0;

/// Points with 130 digits.
const MOST_ORACLE_POINTS: usize = 200;

/// What computes a field.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Model {
    Exact,
    Grid,
    List,
    LookUps,
    Magba,
    Magpylib,
}

impl Model {
    pub(crate) const ALL: [Model; 6] =
        [Model::Exact, Model::Grid, Model::List, Model::LookUps, Model::Magba, Model::Magpylib];

    pub(crate) fn name(self) -> &'static str {
        match self {
            Model::Exact => "exact",
            Model::Grid => "grid",
            Model::List => "list of points",
            Model::LookUps => "look-ups",
            Model::Magba => "magba",
            Model::Magpylib => "magpylib",
        }
    }

    pub(crate) fn is_ours(self) -> bool {
        !matches!(self, Model::Magba | Model::Magpylib)
    }
}

/// One model with one tolerance.
pub(crate) struct Measured {
    pub(crate) model: Model,
    pub(crate) tolerance: Option<f64>,
    /// For a point, once everything is prepared.
    pub(crate) ns: f64,
    /// Relative errors of |B|.
    pub(crate) median: f64,
    pub(crate) worst: f64,
    /// Share of the points that are named as ones at which the tolerance cannot be kept.
    pub(crate) refused: f64,
    /// What look-ups take before the first.
    pub(crate) prepared_ms: Option<f64>,
}

/// All models at one place.
pub(crate) struct Measurements {
    pub(crate) measured: Vec<Measured>,
    /// Tolerances for which no box was prepared.
    pub(crate) unprepared: Vec<f64>,
    /// Points on which the exact field was checked with 130 digits.
    pub(crate) checked_points: usize,
    /// Points on which peers were run.
    pub(crate) peer_points: usize,
}

impl Measurements {
    pub(crate) fn of(&self, model: Model) -> impl Iterator<Item = &Measured> {
        self.measured.iter().filter(move |m| m.model == model)
    }

    pub(crate) fn exact(&self) -> &Measured {
        self.of(Model::Exact).next().expect("always measured")
    }
}

/// A model ready to run.
enum Way {
    OnGrid(Scene, Grid),
    AtPoints(Scene),
    LookUps(Box<FittedField>),
    Magba(Magba),
    Magpylib(Magpylib),
}

/// Points, some of which have a known field.
struct Known<'a> {
    points: &'a [DVec3],
    at: Vec<usize>,
    exact: Vec<DVec3>,
}

impl<'a> Known<'a> {
    fn of(scene: &Scene, points: &'a [DVec3], most: usize) -> Result<Known<'a>, String> {
        let at = evenly_thinned(points, most);
        let some: Vec<DVec3> = at.iter().map(|&index| points[index]).collect();
        let mut exact = vec![DVec3::ZERO; some.len()];
        scene.field_into(Quantity::FluxDensity, &some, &mut exact).map_err(|e| e.to_string())?;
        Ok(Known { points, at, exact })
    }
}

pub(crate) fn measure(
    tiles: &[Tile],
    place: &Place,
    python: Option<&Path>,
    effort: Effort,
) -> Result<Measurements, String> {
    let scene = Scene::new(tiles);
    let in_list = Known::of(&scene, &place.points, effort.exact_pairs / tiles.len())?;
    let alone: Vec<DVec3> = in_list.at.iter().map(|&index| place.points[index]).collect();
    let exact = Known { points: &alone, at: (0..alone.len()).collect(), exact: in_list.exact.clone() };
    let of_peers = evenly_thinned(&alone, (effort.peer_pairs / tiles.len()).max(effort.peer_points));
    let peer_points: Vec<DVec3> = of_peers.iter().map(|&index| alone[index]).collect();
    let for_peers = Known {
        points: &peer_points,
        at: (0..peer_points.len()).collect(),
        exact: of_peers.iter().map(|&index| exact.exact[index]).collect(),
    };
    let on_grid: Vec<DVec3> = place.volume.iter().flat_map(|grid| grid.points().collect::<Vec<_>>()).collect();
    let in_grid = place.volume.map(|_| Known::of(&scene, &on_grid, usize::MAX)).transpose()?;

    let mut ways = vec![(Model::Exact, None, None, Way::AtPoints(scene.clone()), &exact)];
    let mut unprepared = Vec::new();
    for fraction in crate::NOTCHES {
        let tolerance = Tolerance::relative(fraction).expect("above zero");
        let within = || scene.clone().with_accuracy(Accuracy::Within(tolerance));
        if let (Some(grid), Some(known)) = (place.volume, &in_grid) {
            ways.push((Model::Grid, Some(fraction), None, Way::OnGrid(within(), grid), known));
            let start = Instant::now();
            let fitted = FittedField::new(&scene, grid.lower, grid.upper, tolerance);
            let ms = 1e3 * start.elapsed().as_secs_f64();
            match fitted {
                Ok(fitted) => {
                    let way = Way::LookUps(Box::new(fitted));
                    ways.push((Model::LookUps, Some(fraction), Some(ms), way, &in_list));
                }
                Err(_) => unprepared.push(fraction),
            }
        }
        ways.push((Model::List, Some(fraction), None, Way::AtPoints(within()), &in_list));
    }
    ways.push((Model::Magba, None, None, Way::Magba(Magba::new(tiles, &peer_points)), &for_peers));
    if let Some(python) = python {
        let way = Way::Magpylib(Magpylib::start(python, tiles, &peer_points)?);
        ways.push((Model::Magpylib, None, None, way, &for_peers));
    }

    let mut seconds = vec![Vec::new(); ways.len()];
    let mut errors = Vec::new();
    for round in 0..=effort.rounds {
        for ((model, .., way, known), seconds) in ways.iter_mut().zip(&mut seconds) {
            let slow = seconds.first().is_some_and(|s| *s > SLOW_S);
            if slow || !model.is_ours() && round > effort.peer_rounds {
                continue;
            }
            let mut field = vec![DVec3::ZERO; known.points.len()];
            let took = run(way, known.points, &mut field)?;
            if round == 0 {
                // This run makes what later ones find made, and its field is kept.
                errors.push(if *model == Model::Exact {
                    own_errors(tiles, known, effort)
                } else {
                    let found = known.at.iter().map(|&index| field[index]);
                    found.zip(&known.exact).map(|(found, exact)| error(found, *exact)).collect()
                });
            } else {
                seconds.push(took);
            }
        }
    }
    let checked_points = errors[0].len();
    // Where another model falls back on the exact field, it shares its errors.
    let own = Quantiles::of(errors[0].clone());
    let measured = ways.iter().zip(seconds).zip(errors).map(|(((model, tolerance, prepared_ms, _, known), s), e)| {
        let all = e.len() as f64;
        let found = Quantiles::of(e);
        Measured {
            model: *model,
            tolerance: *tolerance,
            ns: 1e9 * median(s) / known.points.len() as f64,
            median: if found.kept == 0 { f64::NAN } else { found.median.max(own.median) },
            worst: if found.kept == 0 { f64::NAN } else { found.worst.max(own.worst) },
            refused: 1.0 - found.kept as f64 / all,
            prepared_ms: *prepared_ms,
        }
    });
    Ok(Measurements { measured: measured.collect(), unprepared, checked_points, peer_points: peer_points.len() })
}

/// Of the errors that are numbers.
struct Quantiles {
    kept: usize,
    median: f64,
    worst: f64,
}

impl Quantiles {
    fn of(mut errors: Vec<f64>) -> Quantiles {
        errors.retain(|e| !e.is_nan());
        errors.sort_by(f64::total_cmp);
        let at = |index: usize| errors.get(index).copied().unwrap_or(f64::NAN);
        Quantiles { kept: errors.len(), median: at(errors.len() / 2), worst: at(errors.len().wrapping_sub(1)) }
    }
}

/// Seconds. Points at which a tolerance cannot be kept are NaN in the field.
fn run(way: &mut Way, points: &[DVec3], field: &mut [DVec3]) -> Result<f64, String> {
    let start = Instant::now();
    match way {
        Way::OnGrid(scene, grid) => drop(scene.field_on_grid(Quantity::FluxDensity, black_box(grid), field)),
        Way::AtPoints(scene) => drop(scene.field_into(Quantity::FluxDensity, black_box(points), field)),
        Way::LookUps(fitted) => drop(fitted.flux_density_into(black_box(points), field)),
        Way::Magba(magba) => {
            let mut found = vec![Vector3::zeros(); points.len()];
            magba.field(&mut found);
            let seconds = start.elapsed().as_secs_f64();
            field.iter_mut().zip(&found).for_each(|(b, found)| *b = DVec3::new(found.x, found.y, found.z));
            return Ok(seconds);
        }
        Way::Magpylib(magpylib) => {
            let seconds = magpylib.run()?;
            field.copy_from_slice(&magpylib.field()?);
            return Ok(seconds);
        }
    }
    Ok(start.elapsed().as_secs_f64())
}

/// Of the exact field against sums of 130 digits, at some of the points.
fn own_errors(tiles: &[Tile], known: &Known, effort: Effort) -> Vec<f64> {
    let mut oracle = Oracle::new();
    let chosen = evenly_thinned(known.points, (effort.oracle_pairs / tiles.len()).min(MOST_ORACLE_POINTS));
    let chosen = chosen.into_iter().map(|index| {
        // What the rounding of a sum loses is added at its end.
        let (mut sum, mut lost) = (DVec3::ZERO, DVec3::ZERO);
        for tile in tiles {
            let b = oracle.field(tile, known.points[index]).flux_density_t;
            let next = sum + b;
            let rest = next - sum;
            lost += (sum - (next - rest)) + (b - rest);
            sum = next;
        }
        error(known.exact[index], sum + lost)
    });
    chosen.collect()
}

fn error(found: DVec3, exact: DVec3) -> f64 {
    (found - exact).length() / exact.length()
}
