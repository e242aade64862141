//! The vector instructions of the processor.

use std::fmt;

use fearless_simd::Level;

/// Vector instructions for fields at many points. The best set of the processor is found at run
/// time.
///
/// The error bounds hold for all sets. The digits below the bounds differ between sets with and
/// without a fused multiply-add.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum InstructionSet {
    /// x86-64, eight doubles.
    Avx512,
    /// x86-64, four doubles, fused multiply-add.
    Avx2,
    /// x86-64, two doubles; every such processor has it.
    Sse2,
    /// Arm, two doubles; every 64-bit processor has it.
    Neon,
    /// The instructions the program was compiled for, on other processors.
    Baseline,
}

impl InstructionSet {
    /// All sets of this processor, the best first.
    pub fn available() -> Vec<InstructionSet> {
        use InstructionSet::{Avx2, Avx512, Baseline, Neon, Sse2};
        let level = Level::new();
        let mut sets: Vec<InstructionSet> =
            [Avx512, Avx2, Sse2, Neon].into_iter().filter(|set| set.level(level).is_some()).collect();
        if sets.is_empty() {
            sets.push(Baseline);
        }
        sets
    }

    /// The level with these instructions and no better ones.
    #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
    fn level(self, best: Level) -> Option<Level> {
        match self {
            InstructionSet::Avx512 => best.as_avx512().map(Level::Avx512),
            InstructionSet::Avx2 => best.as_avx2().map(Level::Avx2),
            InstructionSet::Sse2 => best.as_sse2().map(Level::Sse2),
            InstructionSet::Neon => None,
            InstructionSet::Baseline => Some(Level::baseline()),
        }
    }

    /// The level with these instructions and no better ones.
    #[cfg(not(any(target_arch = "x86", target_arch = "x86_64")))]
    fn level(self, best: Level) -> Option<Level> {
        match self {
            #[cfg(target_arch = "aarch64")]
            InstructionSet::Neon => best.as_neon().map(Level::Neon),
            InstructionSet::Baseline => Some(Level::baseline()),
            _ => {
                let _ = best;
                None
            }
        }
    }

    /// The level, if the processor has it.
    pub fn detected(self) -> Option<Level> {
        self.level(Level::new())
    }
}

/// An instruction set that the processor lacks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MissingInstructions(pub InstructionSet);

impl fmt::Display for MissingInstructions {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "the processor has no {:?} instructions; it has {:?}", self.0, InstructionSet::available())
    }
}

impl std::error::Error for MissingInstructions {}
