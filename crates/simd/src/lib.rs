//! Vectors of f64 and the functions evaluated in them.
//!
//! * [`lanes`]: a vector of the processor, and two of them at a time.
//! * [`functions`]: artanh and arctangent of ratios.
//! * [`pairwise`]: a field evaluated at many points, two vectors at a time.
//! * [`column`](mod@column): numbers in memory aligned to cache lines.
//! * [`prefetch`]: memory requested before it is needed.
//! * [`compensated_sum`]: sums without loss of digits.
//! * [`power_of_two`]: exact scales.
//! * [`InstructionSet`]: the vector instructions of the processor.
//!
//! All operations are generic over the instruction set or `#[inline]`. Kernels of other crates
//! consist of these operations, and a call per operation would take a multiple of their time.

/// Numbers in memory aligned to cache lines.
pub mod column;
/// Sums of two doubles without loss.
pub mod compensated_sum;
/// Logarithms and arctangents of ratios.
pub mod functions;
/// The vector instructions of the processor.
mod instruction_set;
/// A vector of the processor, and two of them at a time.
pub mod lanes;
/// A field evaluated at many points, two vectors at a time.
pub mod pairwise;
/// Exact scales.
pub mod power_of_two;
/// Memory requested before it is needed.
pub mod prefetch;

pub use instruction_set::{InstructionSet, MissingInstructions};

#[cfg(test)]
mod tests;
