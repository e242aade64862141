//! How many damaged scans of a right film are fitted as the undamaged scan is, and how many have a
//! tile reported as faulty:
//!
//!     cargo run --release -p magsplice-scan --example damaged_scans -- layouts/published-film.toml 100
//!
//! The arguments are a layout with a working volume, a number of scans of each kind, and optionally
//! one kind, such as `Wild`. A scan is of a film of another strength, under a turned sensor with an
//! offset, from another start, with 5 uT of noise. It covers the film in steps of 1 mm, 3 mm below
//! it.

use std::f64::consts::PI;

use glam::{DQuat, DVec3};
use magsplice_field::Scene;
use magsplice_layout::Layout;
use magsplice_magnet::{BoundingBox, HallSensor, Quantity};
use magsplice_scan::{
    DiagnosisSettings, FieldScan, FreeParameters, ScanDiagnosis, ScanFit, ScanParameter, ScanParameters, SignedAxes,
    fit_scan,
};
use magsplice_sensor::SensedField;
use rand::seq::IndexedRandom;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

const NOISE_T: f64 = 5e-6;
const BELOW_MM: f64 = 3.0;

/// Range of the sensor over the largest reading of the scan.
const RANGE: f64 = 0.8;

/// Largest distance of a parameter from the truth, in standard deviations: of a million normal
/// errors, one is larger.
const MOST_DEVIATIONS: f64 = 5.0;

#[path = "../tests/scan/damage.rs"]
mod damage;
#[path = "../tests/scan/noisy.rs"]
mod noisy;

use damage::{make_wild, truth};
use noisy::{normal, readings};

/// What happens to a scan.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Damage {
    None,
    Wild,
    Missing,
    Saturated,
    SensorAxes,
    StageAxes,
    Stage,
    All,
}

/// A film, and where it is scanned.
struct Film {
    scene: Scene,
    sensor: HallSensor,
    sensed: SensedField<'static>,
    points: Vec<DVec3>,
    centre: DVec3,
}

/// A scan with the names of its axes.
struct Scan {
    points: Vec<DVec3>,
    readings_t: Vec<DVec3>,
}

impl Film {
    /// An undamaged scan.
    fn scan(&self, truth: &ScanParameters, random: &mut ChaCha8Rng) -> Scan {
        let places: Vec<DVec3> = self.points.iter().map(|point| *point + truth.start).collect();
        let field_t = self.scene.field_at(Quantity::FluxDensity, &places).expect("points below the film");
        let mut noise_t = || NOISE_T * DVec3::from([(); 3].map(|()| normal(random)));
        let readings_t = field_t.iter().map(|b| truth.reading_t(*b) + noise_t()).collect();
        Scan { points: self.points.clone(), readings_t }
    }

    fn damaged(&self, scan: Scan, damage: Damage, random: &mut ChaCha8Rng) -> Scan {
        let is = |kinds: &[Damage]| kinds.contains(&damage) || damage == Damage::All;
        let Scan { mut points, mut readings_t } = scan;
        if is(&[Damage::SensorAxes]) {
            let axes = *SignedAxes::all().choose(random).expect("48");
            readings_t.iter_mut().for_each(|reading| *reading = axes.apply(*reading));
        }
        if is(&[Damage::StageAxes]) {
            let axes = *SignedAxes::all().choose(random).expect("48");
            points.iter_mut().for_each(|point| *point = axes.apply(*point));
        }
        if is(&[Damage::Stage]) {
            let home = DVec3::from([(); 3].map(|()| random.random_range(-200.0..200.0)));
            points.iter_mut().for_each(|point| *point += home);
            let half_turn = DQuat::from_rotation_z(PI);
            readings_t.iter_mut().for_each(|reading| *reading = half_turn * *reading);
        }
        if is(&[Damage::Wild]) {
            let count = random.random_range(1..=10);
            make_wild(&mut readings_t, count, random);
        }
        if is(&[Damage::Missing]) {
            for _ in 0..random.random_range(1..=10) {
                let index = random.random_range(0..readings_t.len());
                readings_t[index][random.random_range(0..3)] = f64::NAN;
            }
        }
        if is(&[Damage::Saturated]) {
            readings_t.iter_mut().filter(|reading| reading.is_finite()).for_each(|reading| {
                *reading = reading.clamp(-self.sensor.range_t, self.sensor.range_t);
            });
        }
        Scan { points, readings_t }
    }

    fn fit(&self, scan: &Scan) -> Result<ScanFit, String> {
        let fit = fit_scan(self.sensed.clone(), &scan.points, &scan.readings_t, FreeParameters::ALL, Some(self.centre));
        fit.map_err(|error| error.to_string())
    }
}

/// Whether a fit leaves the noise and, as far as names of axes do not change them, has the
/// parameters of the scan.
fn is_right(fit: &ScanFit, truth: &ScanParameters, damage: Damage) -> bool {
    let is_near = |parameter: ScanParameter| {
        (fit.parameters.get(parameter) - truth.get(parameter)).abs() < MOST_DEVIATIONS * fit.deviations.get(parameter)
    };
    let is_named = !matches!(damage, Damage::None | Damage::Wild | Damage::Missing | Damage::Saturated);
    let parameters = if is_named { &[ScanParameter::Strength][..] } else { &ScanParameter::ALL };
    (fit.noise_t / NOISE_T - 1.0).abs() < 0.15 && parameters.iter().all(|parameter| is_near(*parameter))
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [path, scans, rest @ ..] = &arguments[..] else { panic!("arguments: LAYOUT SCANS [KIND]") };
    let layout = Layout::read(path).unwrap_or_else(|error| panic!("{error}"));
    let scans: u64 = scans.parse().expect("a number of scans");
    let tiles = layout.bare_tiles();
    let volume = layout.volume.as_ref().expect("a working volume");
    let around = BoundingBox::from_tiles(&tiles);
    let counts = ((around.upper - around.lower).truncate().round() + 1.0).as_usizevec2();
    let first = around.lower.with_z(around.lower.z - BELOW_MM);
    let at = |i: usize| first + DVec3::new((i % counts.x) as f64, (i / counts.x) as f64, 0.0);
    let points: Vec<DVec3> = (0..counts.x * counts.y).map(at).collect();
    let scene: &'static Scene = Box::leak(Box::new(Scene::new(&tiles)));
    let field_t = scene.field_at(Quantity::FluxDensity, &points).expect("points below the film");
    let largest_t = field_t.iter().map(|b| b.abs().max_element()).fold(0.0, f64::max);
    let sensor = HallSensor {
        range_t: DVec3::splat(RANGE * largest_t),
        noise_t: DVec3::splat(NOISE_T),
        ..HallSensor::default()
    };
    let sensed = SensedField::new(scene, sensor, &volume.grid).expect("a sensor");
    let centre = 0.5 * (volume.lower_mm + volume.upper_mm);
    let film = Film { scene: scene.clone(), sensor, sensed, points: points.clone(), centre };
    let field_scan = FieldScan { points_mm: points.clone(), noise_t: DVec3::splat(NOISE_T) };
    let diagnosis = ScanDiagnosis::new(&tiles, field_scan, DiagnosisSettings::default(), ScanParameters::PERFECT)
        .expect("a scan outside tiles");
    println!("{path}: of {scans} scans: fitted / refused / wrong; with a tile reported as faulty");
    for damage in [
        Damage::None,
        Damage::Wild,
        Damage::Missing,
        Damage::Saturated,
        Damage::SensorAxes,
        Damage::StageAxes,
        Damage::Stage,
        Damage::All,
    ] {
        if rest.first().is_some_and(|kind| *kind != format!("{damage:?}")) {
            continue;
        }
        let [mut fitted, mut refused, mut wrong, mut reported] = [0; 4];
        for seed in 0..scans {
            let mut random = ChaCha8Rng::seed_from_u64(seed);
            let truth = truth(&mut random);
            let scan = film.scan(&truth, &mut random);
            let scan = film.damaged(scan, damage, &mut random);
            match film.fit(&scan) {
                Ok(fit) if is_right(&fit, &truth, damage) => fitted += 1,
                Ok(_) => wrong += 1,
                Err(_) => refused += 1,
            }
            // A diagnosis has the stated axes and places; other ones are refused before it.
            if matches!(damage, Damage::None | Damage::Wild | Damage::Missing | Damage::Saturated) {
                let readings_t = readings(&tiles, &points, NOISE_T, &mut random);
                let scan = Scan { points: points.clone(), readings_t };
                let mut readings_t = film.damaged(scan, damage, &mut random).readings_t;
                readings_t.iter_mut().filter(|of| sensor.is_saturated(**of)).for_each(|of| *of = DVec3::NAN);
                let found = diagnosis.diagnose(&readings_t, |_| {}).expect("a diagnosis");
                reported += u64::from(!found.is_residual_too_large() && !found.detected.is_empty());
            }
        }
        println!("{damage:?}: {fitted} / {refused} / {wrong}; {reported}");
    }
}
