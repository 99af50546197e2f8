//! Instruction set levels and the lane counts that each supports.

#[cfg(any(target_arch = "x86_64", target_arch = "aarch64", target_arch = "wasm32"))]
use fearless_simd::Level;
use std::fmt;

/// An instruction set that kernels are compiled for. The binary contains all levels of its processor family and picks
/// one at startup.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Isa {
    /// Scalar code that runs on every processor of the target.
    Portable,
    /// x86-64 with SSE4.2: 4 lanes; multiply and add round separately.
    Sse42,
    /// x86-64 with AVX2 and FMA: 8 lanes.
    Avx2,
    /// x86-64 with AVX-512 (Ice Lake and later): 16 lanes.
    Avx512,
    /// 64-bit Arm: 4 lanes.
    Neon,
    /// WebAssembly: 4 lanes; multiply and add round separately.
    Simd128,
}

impl Isa {
    /// Every level of every processor family.
    pub const ALL: [Isa; 6] = [Isa::Portable, Isa::Sse42, Isa::Avx2, Isa::Avx512, Isa::Neon, Isa::Simd128];

    /// The level's name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Isa::Portable => "portable",
            Isa::Sse42 => "sse4.2",
            Isa::Avx2 => "avx2",
            Isa::Avx512 => "avx512",
            Isa::Neon => "neon",
            Isa::Simd128 => "simd128",
        }
    }

    /// The levels that this processor supports, from least to most capable.
    pub fn available() -> Vec<Isa> {
        let is_available = |isa: &Isa| match isa {
            Isa::Portable => true,
            #[cfg(target_arch = "x86_64")]
            Isa::Sse42 => Level::new().as_sse4_2().is_some(),
            #[cfg(target_arch = "x86_64")]
            Isa::Avx2 => Level::new().as_avx2().is_some(),
            #[cfg(target_arch = "x86_64")]
            Isa::Avx512 => Level::new().as_avx512().is_some(),
            #[cfg(target_arch = "aarch64")]
            Isa::Neon => Level::new().as_neon().is_some(),
            #[cfg(target_arch = "wasm32")]
            Isa::Simd128 => Level::new().as_wasm_simd128().is_some(),
            _ => false,
        };
        Isa::ALL.into_iter().filter(is_available).collect()
    }

    /// Lane counts that have kernels at this level: 1 and those of a register. Whether two registers are faster depends on
    /// the processor with NEON.
    pub fn lane_counts(self) -> &'static [usize] {
        match self {
            Isa::Portable => &[1],
            Isa::Sse42 | Isa::Simd128 => &[1, 4],
            Isa::Neon => &[1, 4, 8],
            Isa::Avx2 => &[1, 8],
            Isa::Avx512 => &[1, 16],
        }
    }

    /// The number of lanes in one register, which is the fastest count.
    pub fn native_lanes(self) -> usize {
        match self {
            Isa::Portable => 1,
            Isa::Sse42 | Isa::Neon | Isa::Simd128 => 4,
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
