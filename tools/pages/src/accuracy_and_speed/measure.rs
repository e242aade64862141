//! Time and error of every contender at one place.

use std::hint::black_box;
use std::path::Path;
use std::time::Instant;

use glam::DVec3;
use magsplice::field::{Accuracy, FittedField, Grid, Quantity, Scene, Tile, Tolerance};
use magsplice_benches::{Magba, PlacedScene, ScenePlace, evenly_thinned, median};
use magsplice_tests::oracle::Oracle;
use nalgebra::Vector3;

use super::effort::{DialEffort, TOLERANCES};
use crate::magpylib::Magpylib;

/// Seconds above which a contender is timed once.
pub(crate) const SLOW_S: f64 = 3.0;

/// Largest number of points at which the exact field is checked with 130 digits.
const MOST_ORACLE_POINTS: usize = 200;

/// A way to compute a field: one of magsplice, or a peer.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Contender {
    Exact,
    Grid,
    List,
    LookUps,
    Magba,
    Magpylib,
}

impl Contender {
    pub(crate) const ALL: [Contender; 6] =
        [Contender::Exact, Contender::Grid, Contender::List, Contender::LookUps, Contender::Magba, Contender::Magpylib];

    /// Name in tables and in the legend.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Contender::Exact => "exact",
            Contender::Grid => "grid",
            Contender::List => "list of points",
            Contender::LookUps => "look-ups",
            Contender::Magba => "magba",
            Contender::Magpylib => "magpylib",
        }
    }

    pub(crate) fn is_magsplice(self) -> bool {
        !matches!(self, Contender::Magba | Contender::Magpylib)
    }
}

/// One contender with one tolerance.
pub(crate) struct Measured {
    pub(crate) contender: Contender,
    /// Requested relative tolerance; `None` for exact fields and peers.
    pub(crate) tolerance: Option<f64>,
    /// Nanoseconds for a point, without preparation.
    pub(crate) ns: f64,
    /// Median relative error of |B|.
    pub(crate) median: f64,
    /// Largest relative error of |B|.
    pub(crate) worst: f64,
    /// Share of the points refused because they cannot keep the tolerance.
    pub(crate) refused: f64,
    /// Time to prepare look-ups.
    pub(crate) prepared_ms: Option<f64>,
}

/// All contenders at one place.
pub(crate) struct Measurements {
    pub(crate) measured: Vec<Measured>,
    /// Tolerances for which look-ups could not be prepared.
    pub(crate) unprepared: Vec<f64>,
    /// Number of points at which the exact field was checked with 130 digits.
    pub(crate) checked_points: usize,
    /// Number of points of the peers.
    pub(crate) peer_points: usize,
}

impl Measurements {
    pub(crate) fn measured_by(&self, contender: Contender) -> impl Iterator<Item = &Measured> {
        self.measured.iter().filter(move |m| m.contender == contender)
    }

    pub(crate) fn exact(&self) -> &Measured {
        self.measured_by(Contender::Exact).next().expect("always measured")
    }
}

/// A scene with its measurements, one for each place.
pub(crate) struct MeasuredScene {
    pub(crate) scene: PlacedScene,
    pub(crate) measurements: Vec<Measurements>,
}

/// A contender ready to run.
enum Runner {
    OnGrid(Scene, Grid),
    AtPoints(Scene),
    LookUps(Box<FittedField>),
    Magba(Magba),
    Magpylib(Magpylib),
}

/// Points, some of which have a known field.
struct KnownField<'a> {
    points: &'a [DVec3],
    /// Indices of the points with a known field.
    at: Vec<usize>,
    /// The exact field at these, in tesla.
    exact: Vec<DVec3>,
}

impl<'a> KnownField<'a> {
    /// The exact field at up to `most` of the points.
    fn new(scene: &Scene, points: &'a [DVec3], most: usize) -> Result<KnownField<'a>, String> {
        let at = evenly_thinned(points, most);
        let some: Vec<DVec3> = at.iter().map(|&index| points[index]).collect();
        let mut exact = vec![DVec3::ZERO; some.len()];
        scene.field_into(Quantity::FluxDensity, &some, &mut exact).map_err(|e| e.to_string())?;
        Ok(KnownField { points, at, exact })
    }
}

/// Times and errors of all contenders at one place; without `python` magpylib is omitted.
pub(crate) fn measure(
    tiles: &[Tile],
    place: &ScenePlace,
    python: Option<&Path>,
    effort: DialEffort,
) -> Result<Measurements, String> {
    let scene = Scene::new(tiles);
    let in_list = KnownField::new(&scene, &place.points, effort.exact_pairs / tiles.len())?;
    let alone: Vec<DVec3> = in_list.at.iter().map(|&index| place.points[index]).collect();
    let exact = KnownField { points: &alone, at: (0..alone.len()).collect(), exact: in_list.exact.clone() };
    let of_peers = evenly_thinned(&alone, (effort.peer_pairs / tiles.len()).max(effort.peer_points));
    let peer_points: Vec<DVec3> = of_peers.iter().map(|&index| alone[index]).collect();
    let for_peers = KnownField {
        points: &peer_points,
        at: (0..peer_points.len()).collect(),
        exact: of_peers.iter().map(|&index| exact.exact[index]).collect(),
    };
    let on_grid: Vec<DVec3> = place.volume.iter().flat_map(|grid| grid.points().collect::<Vec<_>>()).collect();
    let in_grid = place.volume.map(|_| KnownField::new(&scene, &on_grid, usize::MAX)).transpose()?;

    let mut runners = vec![(Contender::Exact, None, None, Runner::AtPoints(scene.clone()), &exact)];
    let mut unprepared = Vec::new();
    for fraction in TOLERANCES {
        let tolerance = Tolerance::relative(fraction).expect("above zero");
        let within = || scene.clone().with_accuracy(Accuracy::Within(tolerance));
        if let (Some(grid), Some(known)) = (place.volume, &in_grid) {
            runners.push((Contender::Grid, Some(fraction), None, Runner::OnGrid(within(), grid), known));
            let start = Instant::now();
            let fitted = scene.fitted_field(grid.lower(), grid.upper(), tolerance);
            let ms = 1e3 * start.elapsed().as_secs_f64();
            match fitted {
                Ok(fitted) => {
                    let runner = Runner::LookUps(Box::new(fitted));
                    runners.push((Contender::LookUps, Some(fraction), Some(ms), runner, &in_list));
                }
                Err(_) => unprepared.push(fraction),
            }
        }
        runners.push((Contender::List, Some(fraction), None, Runner::AtPoints(within()), &in_list));
    }
    runners.push((Contender::Magba, None, None, Runner::Magba(Magba::new(tiles, &peer_points)), &for_peers));
    if let Some(python) = python {
        let runner = Runner::Magpylib(Magpylib::start(python, tiles, &peer_points)?);
        runners.push((Contender::Magpylib, None, None, runner, &for_peers));
    }

    let mut seconds = vec![Vec::new(); runners.len()];
    let mut errors = Vec::new();
    for round in 0..=effort.rounds {
        for ((contender, .., runner, known), seconds) in runners.iter_mut().zip(&mut seconds) {
            let slow = seconds.first().is_some_and(|s| *s > SLOW_S);
            if slow || !contender.is_magsplice() && round > effort.peer_rounds {
                continue;
            }
            // Memory is written before the run, so the run does not wait for the system.
            let mut field = vec![DVec3::NAN; known.points.len()];
            let took = run(runner, known.points, &mut field)?;
            if round == 0 {
                // The first run builds reused data. It is not timed; its field gives the errors.
                errors.push(if *contender == Contender::Exact {
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
    // A contender that falls back to direct summation has the errors of the exact field.
    let own = Quantiles::new(errors[0].clone());
    let measured =
        runners.iter().zip(seconds).zip(errors).map(|(((contender, tolerance, prepared_ms, _, known), s), e)| {
            let all = e.len() as f64;
            let found = Quantiles::new(e);
            Measured {
                contender: *contender,
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

/// Number, median and largest of the errors that are not NaN.
struct Quantiles {
    kept: usize,
    median: f64,
    worst: f64,
}

impl Quantiles {
    fn new(mut errors: Vec<f64>) -> Quantiles {
        errors.retain(|e| !e.is_nan());
        errors.sort_by(f64::total_cmp);
        let at = |index: usize| errors.get(index).copied().unwrap_or(f64::NAN);
        Quantiles { kept: errors.len(), median: at(errors.len() / 2), worst: at(errors.len().wrapping_sub(1)) }
    }
}

/// Evaluates the field once. Returns the time in seconds. The field is NaN at points that cannot
/// keep the tolerance.
fn run(runner: &mut Runner, points: &[DVec3], field: &mut [DVec3]) -> Result<f64, String> {
    let start = Instant::now();
    match runner {
        Runner::OnGrid(scene, grid) => drop(scene.field_on_grid_into(Quantity::FluxDensity, black_box(grid), field)),
        Runner::AtPoints(scene) => drop(scene.field_into(Quantity::FluxDensity, black_box(points), field)),
        Runner::LookUps(fitted) => drop(fitted.flux_density_into(black_box(points), field)),
        Runner::Magba(magba) => {
            let mut found = vec![Vector3::zeros(); points.len()];
            magba.field(&mut found);
            let seconds = start.elapsed().as_secs_f64();
            field.iter_mut().zip(&found).for_each(|(b, found)| *b = DVec3::new(found.x, found.y, found.z));
            return Ok(seconds);
        }
        Runner::Magpylib(magpylib) => {
            let seconds = magpylib.run()?;
            field.copy_from_slice(&magpylib.field()?);
            return Ok(seconds);
        }
    }
    Ok(start.elapsed().as_secs_f64())
}

/// Errors of the exact field against sums of 130 digits, at some of the points.
fn own_errors(tiles: &[Tile], known: &KnownField, effort: DialEffort) -> Vec<f64> {
    let mut oracle = Oracle::new();
    let chosen = evenly_thinned(known.points, (effort.oracle_pairs / tiles.len()).min(MOST_ORACLE_POINTS));
    let chosen = chosen.into_iter().map(|index| {
        // Two-sum: the rounding errors of the sum are collected and added at the end.
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
