//! The check of the model by its definition.

use magsplice_layout::{CommonErrors, Distribution, FilmTolerance, SensorErrors, StrayField};

use super::{everything, ideal, tiles, volume};
use crate::first_order::displacement::displacement_errors_mm;
use crate::first_order::{AxisCheck, FirstOrder};
use crate::real_film::RealFilm;
use crate::sampler::Sampler;
use crate::statistics::Estimate;

/// An offset far above the field, for which the first order means nothing: exact errors are at most
/// half a wavelength, and linear ones have no bound. Half of the means of their squares are larger
/// than the expected one, so differences alone would give negative ratios.
#[test]
fn ratio_of_mean_squares_is_never_negative() {
    let sensor = SensorErrors { offset_t: [(); 3].map(|()| Distribution::normal(0.05)), ..SensorErrors::default() };
    let tolerance =
        FilmTolerance { common: CommonErrors { sensor, ..CommonErrors::default() }, ..FilmTolerance::default() };
    let film = RealFilm::new(&tiles(), &tolerance);
    let (volume, ideal) = (volume(), ideal());
    let model = FirstOrder::new(&film, &volume, &ideal).expect("a model");
    let mut checked = 0;
    for seed in 0..10 {
        let sampler = Sampler::new(&film, &volume, &ideal, seed).expect("a sampler");
        let Ok(check) = model.check(&sampler, 0..20, || ()) else { continue };
        checked += 1;
        for AxisCheck { sampled_mm2, mean_square_ratio, .. } in check.axes {
            let ratio = mean_square_ratio.expect("errors");
            assert!(ratio.value > 0.0 && ratio.interval[0] >= 0.0, "seed {seed}: {ratio:?}, of {sampled_mm2} mm2");
        }
    }
    assert!(checked > 5, "{checked} of 10 runs have samples");
}

/// The mean square of displacement errors along an axis.
fn mean_square(along: &[f64]) -> f64 {
    along.iter().map(|value| value * value).sum::<f64>() / along.len() as f64
}

/// Mean and standard deviation of values.
fn mean_and_deviation(values: &[f64]) -> [f64; 2] {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    [mean, (values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / (count - 1.0)).sqrt()]
}

/// The check by its definition: mean squares, and variances with and
/// without a bias, of usual errors, of large ones, and of errors far beyond the model. More samples
/// than are evaluated at once. Sums of squares, which cancel here to a hundredth, are exact to
/// 1e-12.
#[test]
fn check_is_that_of_its_definition() {
    let common = |common| FilmTolerance { common, ..FilmTolerance::default() };
    let field =
        |field_t: [f64; 3]| Some(StrayField { field_t: field_t.map(Distribution::normal), ..StrayField::default() });
    let gain = SensorErrors { gain: [0.0, 0.0, 0.3].map(Distribution::normal), ..SensorErrors::default() };
    let offset_t = SensorErrors { offset_t: [(); 3].map(|()| Distribution::normal(0.05)), ..SensorErrors::default() };
    let cases = [
        (everything(false), 0),
        (common(CommonErrors { sensor: gain, ..CommonErrors::default() }), 0),
        (common(CommonErrors { stray_field: field([3e-4, 2e-4, 4e-4]), ..CommonErrors::default() }), 0),
        (common(CommonErrors { sensor: offset_t, ..CommonErrors::default() }), 4),
    ];
    let (volume, ideal) = (volume(), ideal());
    let (mut biased, mut unbiased, mut far) = (0, 0, 0);
    for (tolerance, seed) in cases {
        let film = RealFilm::new(&tiles(), &tolerance);
        let model = FirstOrder::new(&film, &volume, &ideal).expect("a model");
        let sampler = Sampler::new(&film, &volume, &ideal, seed).expect("a sampler");
        let samples = 5..(if seed == 0 { 75 } else { 25 });
        let Ok(check) = model.check(&sampler, samples.clone(), || ()) else { continue };
        let n = (samples.end - samples.start) as f64;
        assert_eq!(check.samples as f64, n);
        let exact: Vec<Vec<f64>> = samples
            .clone()
            .map(|sample| {
                let read_t = sampler.readings_of_t(sample).expect("readings");
                displacement_errors_mm(sampler.points(), &read_t, &ideal).expect("parameters")
            })
            .collect();
        let linear: Vec<Vec<f64>> = samples.map(|sample| model.linear_sample_mm(seed, sample)).collect();
        for axis in 0..3 {
            let all = |from: &[Vec<f64>]| -> Vec<Vec<f64>> {
                from.iter().map(|errors| model.along(errors, axis).to_vec()).collect()
            };
            let (exact, linear, mean) = (all(&exact), all(&linear), model.along(&model.mean_mm, axis));
            let about = |errors: &[f64]| -> Vec<f64> { errors.iter().zip(mean).map(|(a, b)| a - b).collect() };
            let squares: Vec<f64> = exact.iter().map(|errors| mean_square(errors)).collect();
            let pairs = || exact.iter().zip(&linear);
            let changes: Vec<f64> = pairs().map(|(x, l)| mean_square(x) - mean_square(l)).collect();
            let abouts: Vec<f64> = pairs().map(|(x, l)| mean_square(&about(x)) - mean_square(&about(l))).collect();
            let differences: Vec<Vec<f64>> =
                pairs().map(|(x, l)| x.iter().zip(l).map(|(x, l)| x - l).collect()).collect();
            let mean_difference: Vec<f64> =
                (0..mean.len()).map(|at| differences.iter().map(|of| of[at]).sum::<f64>() / n).collect();
            let errors = model.axis_errors(axis);
            let found = check.axes[axis];
            let [square, square_deviation] = mean_and_deviation(&squares);
            assert!((found.sampled_mm2 / square - 1.0).abs() < 1e-12, "{found:?}: {square}");

            let [change, change_deviation] = mean_and_deviation(&changes);
            let (ratio, deviation) = match change_deviation <= square_deviation {
                true => (1.0 + change / errors.expected_mm2, change_deviation),
                false => (square / errors.expected_mm2, square_deviation),
            };
            far += usize::from(change_deviation > square_deviation);
            let agrees = |found: Option<Estimate>, value: f64, half: f64| {
                let found = found.expect("errors");
                let wanted = [value, value - half, value + half].map(|value| value.max(0.0));
                let is_equal = |(found, wanted): (f64, f64)| (found - wanted).abs() < 1e-9 * (1.0 + half);
                let all = [found.value, found.interval[0], found.interval[1]];
                assert!(all.into_iter().zip(wanted).all(is_equal), "{axis}: {found:?}, not {wanted:?}");
            };
            let per_root = 1.959_963_984_540_054 / n.sqrt();
            agrees(found.mean_square_ratio, ratio, per_root * deviation / errors.expected_mm2);

            let [about, about_deviation] = mean_and_deviation(&abouts);
            let found_bias = mean_square(&mean_difference);
            let of_differences = differences.iter().map(|of| mean_square(of)).sum::<f64>() / n;
            let scatter = (of_differences - found_bias) / (n - 1.0);
            let bias = (found_bias - scatter).max(0.0);
            if bias > 0.0 {
                biased += 1;
            } else {
                unbiased += 1;
            }
            let deviation = about_deviation + 2.0 * (bias * scatter * n).sqrt();
            let of = errors.variance_mm2;
            agrees(found.variance_ratio, 1.0 + (about - bias) / of, per_root * deviation / of);
        }
    }
    assert!(biased > 2 && unbiased > 0 && far > 0, "{biased} {unbiased} {far}");
}

/// A film without errors has no ratios, and its check is valid: nothing disagrees.
#[test]
fn film_without_errors_has_no_ratios() {
    let (film, volume, ideal) = (RealFilm::new(&tiles(), &FilmTolerance::default()), volume(), ideal());
    let model = FirstOrder::new(&film, &volume, &ideal).expect("a model");
    let sampler = Sampler::new(&film, &volume, &ideal, 1).expect("a sampler");
    let check = model.check(&sampler, 0..2, || ()).expect("samples");
    assert!(check.is_valid() && check.axes.iter().all(|axis| axis.variance_ratio.is_none()), "{check:?}");
    assert!(check.axes.iter().all(|axis| axis.mean_square_ratio.is_some_and(|ratio| ratio.value == 1.0)), "{check:?}");
}
