//! Scans by hand with wild values, for tests and for the example `damaged_scans`.

use glam::DVec3;
use magsplice_scan::ScanParameters;
use rand::Rng;
use rand::seq::index::sample;
use rand_chacha::ChaCha8Rng;

/// Random parameters of a scan by hand.
pub(crate) fn truth(random: &mut ChaCha8Rng) -> ScanParameters {
    let mut vector = |size: f64| size * DVec3::from([(); 3].map(|()| random.random_range(-1.0..1.0)));
    ScanParameters {
        offset_t: vector(5e-5),
        rotation_rad: vector(0.05),
        start: vector(0.5),
        strength: 1.0 + vector(0.1).x,
    }
}

/// Wild values of a bus, a loose wire or a passing tool: any size from 100 uT to 1 T in one
/// component. Their indices.
pub(crate) fn make_wild(readings_t: &mut [DVec3], count: usize, random: &mut ChaCha8Rng) -> Vec<usize> {
    let mut indices = sample(random, readings_t.len(), count).into_vec();
    indices.sort_unstable();
    for index in &indices {
        let size_t = 10.0_f64.powf(random.random_range(-4.0..0.0));
        readings_t[*index][random.random_range(0..3)] += if random.random() { size_t } else { -size_t };
    }
    indices
}
