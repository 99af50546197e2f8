//! Numbers that host and shaders share.

use crate::film::{FIXED_POINT_MAX, FIXED_POINT_SCALE, RADIANCE_LIMIT};
use crate::sampling::{GOLDEN_RATIO, LENS_BLOCK, sine_coefficients};
use crate::stages::BOOK_T_MIN;
use std::fmt::Write;

/// A number that can be written as a constant of WGSL.
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

/// Declares constants in Rust and lists them for WGSL, together with others that are declared elsewhere.
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
    /// Threads of a workgroup.
    pub const WORKGROUP_SIZE: u32 = 64;

    /// Spheres that fit the uniform buffer: as long as there are no more, all threads read them from there.
    pub const UNIFORM_SPHERES: usize = 32;

    /// The same for anchored spheres.
    pub const UNIFORM_ANCHORED: usize = 4;

    /// Nodes of the hierarchy that a traversal can have set aside, one a level: most levels of a tree.
    pub const STACK_SIZE: usize = 64;

    /// The same for a compressed hierarchy.
    pub const CWBVH_STACK_SIZE: usize = 24;

    /// Words in which a thread of the GPU puts its path aside: see shaders/aside.wgsl.
    pub const ASIDE_STRIDE: u32 = 17;

    /// Words of a probe's input and output.
    pub const PROBE_STRIDE: usize = 18;

    /// Words before the rays of a recorded path.
    pub const RECORD_HEADER: usize = 4;

    /// Words of a recorded ray.
    pub const RECORD_STRIDE: usize = 12;

    /// In place of a sphere's number: no sphere.
    pub const NONE: u32 = u32::MAX;

    /// Where a ray starts in place of a sphere that it leaves: at an eye on the surface of one.
    pub const EYE: u32 = u32::MAX - 1;

    /// The bits of an anchored sphere's flags that tell which roots count.
    pub const ROOTS_MASK: u32 = 3;

    /// The bit of an anchored sphere's flags that says that the eye is on the surface.
    pub const UNDER_EYE: u32 = 4;

    /// The bits of a node's count that hold the number of spheres.
    pub const COUNT_MASK: u32 = (1 << 29) - 1;

    /// A distance's bits where nothing is met.
    pub const INFINITE_KEY: u32 = 0x7F80_0000;

    /// More than the bits of any distance: a box that is not met.
    pub const MISS_KEY: u32 = u32::MAX;

    /// The bits of -0.
    pub const NEGATIVE_ZERO_BITS: u32 = 1 << 31;

    /// The bits of the least sum over the channels of a radiance that the film does not take.
    pub const RADIANCE_TOTAL_LIMIT_BITS: u32 = (RADIANCE_TOTAL_LIMIT as f32).to_bits();

    /// That sum, in units of the film.
    pub const RADIANCE_TOTAL_LIMIT: f64 = 3.0 * RADIANCE_LIMIT * FIXED_POINT_SCALE;

    /// What a number's upper 24 bits count for.
    pub const UNIT_FLOAT_SCALE: f64 = 1.0 / 16_777_216.0;

    /// Below this squared length, the normal plus a unit vector is a rounding error, and the normal stands in.
    pub const NEAR_ZERO: f64 = 1e-14;

    /// A direction's component counts as no smaller than this, so that its inverse is finite.
    pub const LEAST_COMPONENT: f64 = 1e-18;

    /// Rounding in the test of a sphere and of a box, relative to the largest coordinate that takes part, is below this.
    pub const BOX_MARGIN: f64 = 8.0 * HALF_EPSILON;

    /// The same for boxes that are measured from the corner of a node: the distance to that corner is rounded by 2 units
    /// more, and a box reaches farther than what it holds by at most 1 / 127 of its node.
    pub const CWBVH_MARGIN: f64 = 12.0 * HALF_EPSILON;

    /// By what a box's far side is moved away, for the rounding of the distances themselves.
    pub const BOX_WIDENING: f64 = 1.0 + 8.0 * HALF_EPSILON;

    also
    GOLDEN_RATIO: u32,
    LENS_BLOCK: u32,
    BOOK_T_MIN: f64,
    FIXED_POINT_SCALE: f64,
    FIXED_POINT_MAX: f64,
}

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
