//! Enumerations that shaders represent as numbers.

use super::ROOTS_MASK;
use crate::job::render::SamplerKind;
use crate::stages::{DielectricLaws, Shading, SurfaceRule, Transfer};
use std::fmt::Write;

pub trait Tag: Copy + Eq + 'static {
    /// All values.
    const ALL: &'static [Self];
    /// Name of the value's WGSL constant.
    fn constant(self) -> &'static str;
    /// Number of the value in WGSL.
    fn tag(self) -> u32;
}

/// Which roots of an anchored sphere count.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum Roots {
    /// The nearer: no ray is inside the sphere. A ray that rounding puts inside hits it where it starts.
    Nearer = 0,
    Both = 1,
    /// The farther: the sphere is opaque and encloses the eye, so every ray is inside and hits it despite rounding.
    Farther = 2,
}

impl Roots {
    /// Reads the tag from the flags of an [`super::AnchoredSphere`].
    #[inline(always)]
    pub fn of_flags(flags: u32) -> Self {
        match flags & ROOTS_MASK {
            0 => Roots::Nearer,
            1 => Roots::Both,
            _ => Roots::Farther,
        }
    }
}

/// Implements [`Tag`] and gives each value its WGSL name.
macro_rules! tags {
    ($type:ident { $($value:ident = $constant:literal),* $(,)? }) => {
        impl $crate::kernel::Tag for $type {
            const ALL: &'static [Self] = &[$($type::$value),*];
            fn constant(self) -> &'static str {
                match self {
                    $($type::$value => $constant,)*
                }
            }
            fn tag(self) -> u32 {
                self as u32
            }
        }
    };
}

tags!(Roots { Nearer = "ROOTS_NEARER", Both = "ROOTS_BOTH", Farther = "ROOTS_FARTHER" });

tags!(Shading {
    ImageGradient = "SHADING_IMAGE_GRADIENT",
    FirstHitRed = "SHADING_FIRST_HIT_RED",
    Normals = "SHADING_NORMALS",
    Path = "SHADING_PATH",
});

tags!(DielectricLaws {
    RefractOnly = "LAWS_REFRACT_ONLY",
    TotalReflection = "LAWS_TOTAL_REFLECTION",
    Schlick = "LAWS_SCHLICK",
});

tags!(SurfaceRule { Exact = "SURFACE_EXACT", Acne = "SURFACE_ACNE", Book = "SURFACE_BOOK" });

tags!(Transfer {
    Linear = "TRANSFER_LINEAR",
    Gamma2 = "TRANSFER_GAMMA2",
    LinearAboveGamma2 = "TRANSFER_LINEAR_ABOVE_GAMMA2",
});

tags!(SamplerKind { Independent = "SAMPLER_INDEPENDENT", Sobol = "SAMPLER_SOBOL" });

/// The values of one enumeration in WGSL.
fn values<T: Tag>() -> String {
    T::ALL.iter().fold(String::new(), |mut text, value| {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "const {} = {}u;", value.constant(), value.tag());
        text
    })
}

pub(super) fn wgsl() -> String {
    [
        values::<Roots>(),
        values::<Shading>(),
        values::<DielectricLaws>(),
        values::<SurfaceRule>(),
        values::<Transfer>(),
        values::<SamplerKind>(),
    ]
    .concat()
}
