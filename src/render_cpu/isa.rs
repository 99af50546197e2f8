//! Instruction levels, and the lane counts that each offers.

use fearless_simd::Level;
use std::fmt;

/// A set of instructions that kernels are compiled for. The binary holds all of its processor family; which
/// one runs is decided when it starts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Isa {
    /// What every processor of the target has; scalar code.
    Baseline,
    /// x86-64 with SSE4.2: 4 lanes, multiply and add rounded apart.
    Sse42,
    /// x86-64 with AVX2 and FMA: 8 lanes.
    Avx2,
    /// x86-64 with AVX-512 (as of Ice Lake): 16 lanes.
    Avx512,
    /// 64-bit Arm: 4 lanes.
    Neon,
}

impl Isa {
    /// All of them, of every processor family.
    pub const ALL: [Isa; 5] = [Isa::Baseline, Isa::Sse42, Isa::Avx2, Isa::Avx512, Isa::Neon];

    /// The name used on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Isa::Baseline => "baseline",
            Isa::Sse42 => "sse4.2",
            Isa::Avx2 => "avx2",
            Isa::Avx512 => "avx512",
            Isa::Neon => "neon",
        }
    }

    /// Those that this processor has, from the least to the most capable.
    pub fn available() -> Vec<Isa> {
        let mut levels = vec![Isa::Baseline];
        let level = Level::new();
        #[cfg(target_arch = "x86_64")]
        {
            let found = [
                (level.as_sse4_2().is_some(), Isa::Sse42),
                (level.as_avx2().is_some(), Isa::Avx2),
                (level.as_avx512().is_some(), Isa::Avx512),
            ];
            levels.extend(found.iter().filter(|(has, _)| *has).map(|(_, isa)| *isa));
        }
        #[cfg(target_arch = "aarch64")]
        if level.as_neon().is_some() {
            levels.push(Isa::Neon);
        }
        let _ = level;
        levels
    }

    /// Lane counts that this level has kernels for: 1, those that fit its registers, and twice those.
    pub fn lane_counts(self) -> &'static [usize] {
        match self {
            Isa::Baseline => &[1],
            Isa::Sse42 | Isa::Neon => &[1, 4, 8],
            Isa::Avx2 | Isa::Avx512 => &[1, 4, 8, 16],
        }
    }

    /// The lane count that one register holds: the fastest.
    pub fn native_lanes(self) -> usize {
        match self {
            Isa::Baseline => 1,
            Isa::Sse42 | Isa::Neon => 4,
            Isa::Avx2 => 8,
            Isa::Avx512 => 16,
        }
    }

    /// Whether `a b + c` is rounded once. Levels that agree in this render the same bits.
    pub fn is_fused(self) -> bool {
        matches!(self, Isa::Avx2 | Isa::Avx512 | Isa::Neon)
    }
}

impl fmt::Display for Isa {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
