//! Measurements with errors, shim tiles, and samples of films with sorted tiles.

use glam::DVec3;
use magsplice_decouple::Figures;
use magsplice_layout::{Distribution, FilmTolerance, Layout, Part, TileErrors};
use magsplice_making::{
    AssignmentError, AssignmentProblem, AssignmentSettings, CutTile, MeasurementErrors, PlaceGroup, SortedSampler,
    Sorting,
};
use magsplice_tolerance::{EvaluationGrid, RealFilm, Sampler, Statistics, TileChanges};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

/// Errors of cutting: 3 % of strength, 1 degree of direction.
const BOXES: MeasurementErrors = MeasurementErrors { strength: 0.03, direction_rad: 0.0175, size_mm: None };

/// Errors of a teslameter and a jig: 0.5 % and 0.3 degrees.
const MEASUREMENT: MeasurementErrors = MeasurementErrors { strength: 0.005, direction_rad: 0.0052, size_mm: None };

const QUICK: AssignmentSettings = AssignmentSettings { starts: Some(2), kicks: 30, seed: 1, may_turn_over: true };

struct Film {
    layout: Layout,
    volume: EvaluationGrid,
    model: TileChanges,
}

impl Film {
    fn shipped(name: &str) -> Film {
        let layout = Layout::read(format!("../../layouts/{name}.toml")).unwrap_or_else(|e| panic!("{e}"));
        let volume = layout.volume.expect("a volume");
        let volume = EvaluationGrid { grid: volume.grid, reference: volume.reference_mm };
        let model = TileChanges::new(
            &RealFilm::new(&layout.bare_tiles(), &FilmTolerance::default()),
            &volume,
            &layout.ideal.unwrap(),
        )
        .unwrap();
        Film { layout, volume, model }
    }

    /// The parts, with the scattered tiles of a box.
    fn parts(&self, seed: u64) -> Vec<PlaceGroup> {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let group = |part: Part| {
            let polarization_t = part.strength_t * part.direction;
            let right = CutTile { name: part.example, polarization_t, size_mm: part.size_mm };
            let tiles = (0..part.count).map(|_| BOXES.measured(&right, part.size_mm, &mut random)).collect();
            PlaceGroup { size_mm: part.size_mm, polarization_t, places: part.tiles, tiles }
        };
        self.layout.parts().into_iter().map(group).collect()
    }
}

/// The errors of the true tiles have the scatter predicted from the errors of the measurements.
///
/// The errors of a film scatter by about a third, so mean and 95th percentile of 400 films have
/// relative standard errors of 1.5 and 3 %. The test allows four of them.
#[test]
fn predicted_errors_are_those_of_samples() {
    let film = Film::shipped("designed-displacement");
    let (tiles, groups) = (film.layout.bare_tiles(), film.parts(5));
    let problem = AssignmentProblem::new(&film.model, &tiles, &groups, &[], &QUICK).unwrap();
    let found = problem.solve(&QUICK, || ()).unwrap();
    let predicted = problem.rms_of_measured_mm(&found.placed, &[], &MEASUREMENT, 1).unwrap();
    let mut random = ChaCha8Rng::seed_from_u64(77);
    let of_truth = |_| {
        let mut made = tiles.clone();
        for placed in &found.placed {
            let measured = &groups[placed.group].tiles[placed.tile];
            let truth = MEASUREMENT.measured(measured, measured.size_mm, &mut random);
            made[placed.place] = truth.at(&tiles[placed.place], placed.orientation).unwrap();
        }
        film.model.rms_mm(&film.model.exact(&made).unwrap())
    };
    let sampled = Statistics::new((0..400).map(of_truth)).unwrap();
    let [mean, p95] = [sampled.mean.value / predicted.mean.value, sampled.p95.value / predicted.p95.value];
    assert!((mean - 1.0).abs() < 0.06 && (p95 - 1.0).abs() < 0.12, "{mean}, {p95} of {predicted:?}");
    assert!(predicted.mean.value > 1.5 * found.rms_mm, "{predicted:?} and {found:?}");
}

/// Measurements scatter about the tile with the stated deviations.
///
/// Mean and deviation of 4000 deviates have standard errors of 1.6 and 1.1 % of the deviation. The
/// test allows four of them. The turn shortens the component along J by 1e-4 of it, which is 0.5 %
/// of its deviation.
#[test]
fn measured_tiles_have_the_stated_deviations() {
    let tile =
        CutTile { name: "t".to_owned(), polarization_t: DVec3::new(0.2, 0.0, 0.0), size_mm: DVec3::new(3.0, 2.0, 1.0) };
    let errors = MeasurementErrors { strength: 0.02, direction_rad: 0.01, size_mm: Some(0.03) };
    let mut random = ChaCha8Rng::seed_from_u64(3);
    let measured: Vec<CutTile> = (0..4000).map(|_| errors.measured(&tile, DVec3::ONE, &mut random)).collect();
    let assert_scatter = |of: fn(&CutTile) -> DVec3, deviations: DVec3| {
        for axis in 0..3 {
            let deviates = measured.iter().map(|one| (of(one) - of(&tile))[axis] / deviations[axis]);
            let mean = deviates.clone().sum::<f64>() / 4000.0;
            let rms = (deviates.map(|deviate| deviate * deviate).sum::<f64>() / 4000.0).sqrt();
            assert!(mean.abs() < 0.07 && (rms - 1.0).abs() < 0.045, "axis {axis}: mean {mean}, rms {rms}");
        }
    };
    assert_scatter(|tile| tile.polarization_t, 0.2 * DVec3::new(0.02, 0.01, 0.01));
    assert_scatter(|tile| tile.size_mm, DVec3::splat(0.03));
    let unmeasured = MeasurementErrors { size_mm: None, ..errors }.measured(&tile, DVec3::ONE, &mut random);
    assert_eq!(unmeasured.size_mm, DVec3::ONE);
}

/// Without shims the film is the best found; with two, it is better, and at a minimum with respect
/// to their strengths.
#[test]
fn shims_have_the_best_strengths() {
    let film = Film::shipped("designed-displacement");
    let tiles = film.layout.bare_tiles();
    let mut groups = film.parts(9);
    let shims: Vec<usize> = groups[..2].iter().map(|group| group.places[0]).collect();
    for group in &mut groups {
        group.places.retain(|place| !shims.contains(place));
        group.tiles.truncate(group.places.len());
    }
    let [without, with] = [&[][..], &shims].map(|shims| {
        let problem = AssignmentProblem::new(&film.model, &tiles, &groups, shims, &QUICK).unwrap();
        let found = problem.solve(&QUICK, || ()).unwrap();
        assert_eq!(found.shim_factors.len(), shims.len());
        assert_eq!(problem.rms_mm(&found.placed, &found.shim_factors).unwrap(), found.rms_mm);
        for (shim, step) in (0..shims.len()).flat_map(|shim| [(shim, 1e-3), (shim, -1e-3)]) {
            let mut changed = found.shim_factors.clone();
            changed[shim] += step;
            assert!(problem.rms_mm(&found.placed, &changed).unwrap() > found.rms_mm);
        }
        found
    });
    assert!(with.rms_mm < without.rms_mm, "{with:?} and {without:?}");
    let refused = AssignmentProblem::new(&film.model, &tiles, &groups, &[shims[0], shims[0]], &QUICK);
    assert_eq!(refused.err(), Some(AssignmentError::Shim { tile: shims[0] }));
}

fn rms_mm(errors: &Figures) -> f64 {
    (errors.displacement_rmse_mm.to_array().iter().map(|error| error * error).sum::<f64>() / 3.0).sqrt()
}

fn percentile_95(errors: &[Figures]) -> f64 {
    Statistics::new(errors.iter().map(rms_mm)).unwrap().p95.value
}

/// The tiles of samples differ in strength and direction alone: sorting removes most of their
/// errors, measurement errors restore a part, and placement errors remain.
#[test]
fn samples_of_sorted_films() {
    let film = Film::shipped("designed-displacement");
    let tiles = film.layout.bare_tiles();
    let cut = TileErrors {
        strength: Distribution::normal(0.03),
        direction: [0.0175; 2].map(Distribution::normal),
        ..TileErrors::default()
    };
    let placed = TileErrors { position: [0.05; 3].map(Distribution::normal), ..cut.clone() };
    let ideal = film.layout.ideal.unwrap();
    let exact = MeasurementErrors::default();
    let p95 = |errors: &TileErrors, sorted: Option<(usize, MeasurementErrors)>| {
        let real = RealFilm::new(&tiles, &FilmTolerance::of_tiles(errors, tiles.len()));
        let sampler = Sampler::new(&real, &film.volume, &ideal, 4).unwrap();
        let Some((spares, measurement)) = sorted else {
            return percentile_95(&sampler.errors_of_range(0..20, || {}).unwrap());
        };
        let parts = film.parts(0).into_iter().map(|part| PlaceGroup { tiles: Vec::new(), ..part }).collect();
        let sorting = Sorting { spares, measurement, settings: QUICK };
        let sorted = SortedSampler::new(&sampler, parts, &film.volume, &ideal, sorting).unwrap();
        let whole = sorted.errors_of_range(0..20).unwrap();
        assert_eq!(sorted.errors_of_range(7..8).unwrap()[..], whole[7..8]);
        percentile_95(&whole)
    };
    let (unsorted, sorted) = (p95(&cut, None), p95(&cut, Some((0, exact))));
    assert!(unsorted > 8.0 * sorted, "{unsorted} to {sorted}");
    let with_spares = p95(&cut, Some((14, exact)));
    assert!(with_spares < sorted, "{with_spares} and {sorted}");
    let measured = p95(&cut, Some((0, MEASUREMENT)));
    assert!(measured > 1.5 * sorted && measured < 0.5 * unsorted, "{measured}");
    let [placed_unsorted, placed_sorted] = [None, Some((0, exact))].map(|sorted| p95(&placed, sorted));
    assert!(
        placed_sorted > 4.0 * sorted && placed_sorted < 0.9 * placed_unsorted,
        "{placed_sorted} of {placed_unsorted}"
    );
}

/// A box of exact tiles gives the ordered film.
#[test]
fn tiles_without_errors_are_placed_as_ordered() {
    let film = Film::shipped("published-film");
    let tiles = film.layout.bare_tiles();
    let ideal = film.layout.ideal.unwrap();
    let real = RealFilm::new(&tiles, &FilmTolerance::default());
    let sampler = Sampler::new(&real, &film.volume, &ideal, 1).unwrap();
    let parts = film.parts(0).into_iter().map(|part| PlaceGroup { tiles: Vec::new(), ..part }).collect();
    let sorting = Sorting { spares: 3, measurement: MeasurementErrors::default(), settings: QUICK };
    let sorted = SortedSampler::new(&sampler, parts, &film.volume, &ideal, sorting).unwrap();
    let [found, ordered] = [sorted.errors_of(0).unwrap(), sampler.errors_of(0).unwrap()].map(|e| rms_mm(&e));
    assert!((found / ordered - 1.0).abs() < 1e-9, "{found} and {ordered}");
}
