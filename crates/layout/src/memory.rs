//! The memory that work on a layout takes, asked for before it is taken.

use std::fs;
use std::hint::black_box;

use glam::DVec3;
use thiserror::Error;

use crate::limits::{BYTES_PER_POINT, MAX_POINTS};
use crate::volume::{WorkingVolume, least_step};

/// Largest memory of a step of work in bytes: what `compare` holds at [`MAX_POINTS`].
const MOST_BYTES: f64 = MAX_POINTS * BYTES_PER_POINT;

/// Work takes more memory than there is.
#[derive(Clone, Debug, Error, PartialEq)]
#[error(
    "{cause}, for which this takes {:.2} GB of memory, and {:.2} GB can be had: {remedy}",
    1e-9 * bytes, 1e-9 * most_bytes
)]
pub struct MemoryError {
    /// The number that makes the work so large, with its table.
    pub cause: String,
    /// Memory that the work takes, an estimate.
    pub bytes: f64,
    /// Memory that it may take.
    pub most_bytes: f64,
    /// What to do.
    pub remedy: String,
}

/// Checks that there is so much memory. `cause` is the number that makes the work so large, and
/// `remedy` says what to do with the memory in bytes that can be had.
///
/// # Errors
/// If it is more than 10 GB, more than the system has available, or more than it lets this process
/// allocate.
pub fn check_memory(
    bytes: f64,
    cause: impl FnOnce() -> String,
    remedy: impl FnOnce(f64) -> String,
) -> Result<(), MemoryError> {
    let most_bytes = allocatable(bytes).min(available_bytes()).min(MOST_BYTES);
    if bytes <= most_bytes {
        return Ok(());
    }
    Err(MemoryError { cause: cause(), bytes, most_bytes, remedy: remedy(most_bytes) })
}

impl WorkingVolume {
    /// Checks that there is memory for work that takes so many bytes for each point of the grid.
    ///
    /// # Errors
    /// As [`check_memory`].
    pub fn check_memory(&self, bytes_per_point: f64) -> Result<(), MemoryError> {
        let (points, extents) = (self.grid.len(), self.upper_mm - self.lower_mm);
        let coarser = |most_bytes: f64| {
            let most_points = most_bytes / bytes_per_point;
            // No step makes fewer points than two along each axis.
            if most_points < 8.0 || extents == DVec3::ZERO {
                return "take fewer tiles".to_owned();
            }
            format!("use a step_mm of at least {} mm along each axis", least_step(extents, most_points))
        };
        check_memory(points as f64 * bytes_per_point, || format!("[volume] has {points} points"), coarser)
    }
}

/// The largest part of `bytes`, halved until it can be, that the system lets this process allocate.
/// Limits of a process, as `ulimit -v` sets them, end a program that asks for more later.
fn allocatable(bytes: f64) -> f64 {
    let mut allocatable = bytes;
    while allocatable >= 1.0 {
        let mut asked = Vec::<u8>::new();
        // Nothing is written, so no memory is taken. The optimizer must not remove the allocation.
        if asked.try_reserve_exact(allocatable as usize).is_ok() && black_box(&asked).capacity() > 0 {
            break;
        }
        allocatable *= 0.5;
    }
    allocatable
}

/// The memory that Linux estimates to be available without swapping; no limit on other systems.
fn available_bytes() -> f64 {
    let text = fs::read_to_string("/proc/meminfo").unwrap_or_default();
    let line = text.lines().find_map(|line| line.strip_prefix("MemAvailable:"));
    let kib: Option<f64> = line.and_then(|line| line.trim().strip_suffix("kB")?.trim().parse().ok());
    kib.map_or(f64::INFINITY, |kib| 1024.0 * kib)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A cube of 101 x 101 x 101 points.
    fn volume() -> WorkingVolume {
        WorkingVolume::new(DVec3::ZERO, DVec3::ONE, DVec3::splat(0.01), DVec3::ZERO).unwrap()
    }

    #[test]
    fn work_beyond_the_memory_is_refused_with_a_step_that_fits() {
        assert_eq!(volume().check_memory(100.0), Ok(()));
        let error = volume().check_memory(1e6).unwrap_err();
        assert!(error.bytes == 1_030_301e6 && error.most_bytes <= MOST_BYTES);
        let start = "[volume] has 1030301 points, for which this takes 1030.30 GB of memory, and ";
        assert!(error.to_string().starts_with(start), "{error}");
        let step = error.remedy.strip_prefix("use a step_mm of at least ").unwrap();
        let step: f64 = step.strip_suffix(" mm along each axis").unwrap().parse().unwrap();
        let coarser = WorkingVolume::new(DVec3::ZERO, DVec3::ONE, DVec3::splat(step), DVec3::ZERO).unwrap();
        assert!(coarser.grid.len() as f64 * 1e6 <= error.most_bytes, "{error}");
        assert_eq!(volume().check_memory(1e12).unwrap_err().remedy, "take fewer tiles");
    }

    #[test]
    fn more_than_an_address_space_is_not_allocatable() {
        assert!(allocatable(1e30) < 2e19);
        assert_eq!(allocatable(1e3), 1e3);
    }
}
