//! Numeric constants that host and shaders share.

use crate::film::{FIXED_POINT_MAX, FIXED_POINT_SCALE, RADIANCE_LIMIT};
use crate::kernel::sampling::{
    GOLDEN_RATIO, LAST_TOGETHER, PIXEL_REARRANGEMENT, REARRANGEMENT, REARRANGEMENT_SQUARE, sine_coefficients,
};
use crate::stages::BOOK_T_MIN;
use std::fmt::Write;

/// A number that can be written as a WGSL constant.
trait Constant: Copy {
    fn wgsl(self) -> String;
}

impl Constant for u32 {
    fn wgsl(self) -> String {
        format!("{self:#x}u")
    }
}

impl Constant for usize {
    fn wgsl(self) -> String {
        format!("{self}u")
    }
}

impl Constant for f64 {
    fn wgsl(self) -> String {
        format!("{:?}f", self as f32)
    }
}

/// Declares constants in Rust and lists them for WGSL, together with some that are declared elsewhere.
macro_rules! constants {
    (
        $($(#[$meta:meta])* pub const $name:ident: $type:ty = $value:expr;)*
        also $($other:ident: $other_type:ty),* $(,)?
    ) => {
        $($(#[$meta])* pub const $name: $type = $value;)*

        fn listed() -> Vec<(String, String)> {
            vec![
                $((stringify!($name).to_owned(), Constant::wgsl($name)),)*
                $((stringify!($other).to_owned(), Constant::wgsl(<$other_type>::from($other))),)*
            ]
        }
    };
}

constants! {
    /// Threads per workgroup.
    pub const WORKGROUP_SIZE: u32 = 64;

    /// Capacity of the uniform buffer in spheres. If a scene has no more, all threads read them from there.
    pub const UNIFORM_SPHERES: usize = 32;

    /// Capacity of the uniform buffer in anchored spheres.
    pub const UNIFORM_ANCHORED: usize = 4;

    /// Stack entries of a traversal on the GPU, one per level, and therefore the maximum number of levels of a tree.
    pub const WIDE_STACK_SIZE: usize = 24;

    /// Stands for "no sphere" where a sphere's number is expected.
    pub const NONE: u32 = u32::MAX;

    /// Stands for the sphere that a ray leaves if the ray starts at an eye on a surface.
    pub const EYE: u32 = u32::MAX - 1;

    /// Bits of an anchored sphere's flags that hold the tag of its [`super::Roots`].
    pub const ROOTS_MASK: u32 = 3;

    /// Bit of an anchored sphere's flags that is set if the eye is on its surface.
    pub const UNDER_EYE: u32 = 4;

    /// Bits of the distance where nothing is hit.
    pub const INFINITE_KEY: u32 = 0x7F80_0000;

    /// Key of a box that is not hit: larger than the bits of any distance.
    pub const MISS_KEY: u32 = u32::MAX;

    /// The bits of -0.
    pub const NEGATIVE_ZERO_BITS: u32 = 1 << 31;

    /// Bits of the smallest sum over the channels of a radiance that the film rejects.
    pub const RADIANCE_TOTAL_LIMIT_BITS: u32 = (RADIANCE_TOTAL_LIMIT as f32).to_bits();

    /// That sum in units of the film.
    pub const RADIANCE_TOTAL_LIMIT: f64 = 3.0 * RADIANCE_LIMIT * FIXED_POINT_SCALE;

    /// Scale that turns a number's upper 24 bits into a float in `[0, 1)`.
    pub const UNIT_FLOAT_SCALE: f64 = 1.0 / 16_777_216.0;

    /// If the squared length of the normal plus a unit vector is below this, it is a rounding error, and the normal is
    /// used.
    pub const NEAR_ZERO: f64 = 1e-14;

    /// Smallest size of a direction's component in box tests, so that its inverse is finite.
    pub const LEAST_COMPONENT: f64 = 1e-18;

    /// Upper bound of the rounding error in sphere and box tests, relative to the largest coordinate involved.
    pub const BOX_MARGIN: f64 = 8.0 * HALF_EPSILON;

    /// Factor for the distance to a box's far side, which covers the rounding of the distances themselves.
    pub const BOX_WIDENING: f64 = 1.0 + 8.0 * HALF_EPSILON;

    also
    GOLDEN_RATIO: u32,
    REARRANGEMENT: u32,
    REARRANGEMENT_SQUARE: u32,
    PIXEL_REARRANGEMENT: u32,
    LAST_TOGETHER: u32,
    BOOK_T_MIN: f64,
    FIXED_POINT_SCALE: f64,
    FIXED_POINT_MAX: f64,
}

/// Stack entries of a traversal on the CPU, one per level, and therefore the maximum number of levels of a tree.
pub const STACK_SIZE: usize = 64;

/// From this bit on, [`super::Node::count`] holds the order of an inner node's children: twice the axis that separates
/// them, plus 1 if the second child comes before the first.
pub const ORDER_SHIFT: u32 = 29;

/// Bits of a node's count that hold the number of spheres.
pub const COUNT_MASK: u32 = (1 << ORDER_SHIFT) - 1;

/// Half a unit in the last place of 1, in `f32`.
pub const HALF_EPSILON: f64 = f32::EPSILON as f64 / 2.0;

/// All constants in WGSL.
pub(super) fn wgsl() -> String {
    let sines = sine_coefficients().into_iter().enumerate();
    let sines = sines.map(|(index, coefficient)| (format!("SINE_{index}"), coefficient.wgsl()));
    let mut text = String::new();
    for (name, value) in listed().into_iter().chain(sines) {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "const {name} = {value};");
    }
    text
}
