//! Fixed-point sums of radiance.

/// One unit of the film's fixed point is `2^-24` of radiance.
pub const FIXED_POINT_SCALE: f64 = 16_777_216.0;

/// The most that rounding its samples can cost a mean, linear radiance: half a fixed-point unit. It costs that much
/// where all samples of a pixel are equal, because they all round the same way, however many there are.
pub const ROUNDING_LIMIT: f64 = 0.5 / FIXED_POINT_SCALE;

/// A sample's radiance is clamped to stay below this limit. It is the largest limit whose fixed-point values fit a
/// signed 32-bit integer, to which every processor converts in one instruction.
pub const RADIANCE_LIMIT: f64 = 128.0;

/// The largest fixed-point value of a sample: that of the largest `f32` below [`RADIANCE_LIMIT`].
pub const FIXED_POINT_MAX: u32 = 2_147_483_520;

/// Sums of one pixel in units of `2^-24`, RGB.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, bytemuck::Zeroable)]
#[repr(transparent)]
pub struct PixelSum(pub [u64; 3]);

impl PixelSum {
    /// Adds the sum of other samples of the same pixel. It cannot overflow: see [`super::SAMPLE_LIMIT`].
    pub fn add(&mut self, other: PixelSum) {
        for (mine, theirs) in self.0.iter_mut().zip(other.0) {
            *mine += theirs;
        }
    }

    /// Sum in units of radiance. Exact up to 2^53 units, which is 5 x 10^8 samples of radiance 1.
    pub fn radiance(self) -> [f64; 3] {
        self.0.map(|k| k as f64 / FIXED_POINT_SCALE)
    }
}

/// Converts one sample's radiance to fixed point. Returns `None` if a component is NaN, infinite or negative; such a
/// sample is counted but not added.
pub fn fixed_point(radiance: [f64; 3]) -> Option<PixelSum> {
    if radiance.iter().all(|x| x.is_finite() && *x >= 0.0) {
        let k = |x: f64| ((x * FIXED_POINT_SCALE).round_ties_even() as u64).min(u64::from(FIXED_POINT_MAX));
        Some(PixelSum(radiance.map(k)))
    } else {
        None
    }
}
