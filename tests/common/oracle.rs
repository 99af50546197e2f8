//! The numbers of a sample in plain scalar code: the oracle for all lane widths and the GPU.

use weekender::kernel::sampling::{
    GOLDEN_RATIO, PIXEL_REARRANGEMENT, REARRANGEMENT, REARRANGEMENT_SQUARE, mix32, sine_coefficients,
};

/// The key that separates the Sobol scramblings of pixels, halves and seeds.
pub fn pixel_key(seed: u32, half: u32, pixel: u32) -> u32 {
    mix32(mix32(seed.wrapping_add(half.wrapping_mul(GOLDEN_RATIO))) ^ pixel)
}

/// Converts the upper 24 bits to a float in `[0, 1)`, so that the result is exact and never 1.
pub fn unit_float(u: u32) -> f32 {
    (u >> 8) as f32 * (1.0 / 16_777_216.0)
}

/// Owen's nested uniform scrambling, on reversed bits: each bit is flipped or kept depending on a hash of the bits
/// below it.
///
/// Source: Laine and Karras, "Stratified Sampling for Stochastic Transparency", EGSR 2011; constants from
/// Vegdahl, "Building a Better LK Hash", 2021.
pub fn laine_karras(x: u32, seed: u32) -> u32 {
    let x = x ^ x.wrapping_mul(0x3D20_ADEA);
    let x = x.wrapping_add(seed);
    let x = x.wrapping_mul((seed >> 16) | 1);
    let x = x ^ x.wrapping_mul(0x0552_6C56);
    x ^ x.wrapping_mul(0x53A2_2864)
}

/// The second Sobol coordinate of the point whose first coordinate is `u`, both in units of `2^-32`. It is the product
/// with Pascal's triangle modulo 2, which is a Kronecker power and therefore takes five steps.
pub fn pascal(u: u32) -> u32 {
    let u = u ^ (u << 16);
    let u = u ^ ((u & 0x00FF_00FF) << 8);
    let u = u ^ ((u & 0x0F0F_0F0F) << 4);
    let u = u ^ ((u & 0x3333_3333) << 2);
    u ^ ((u & 0x5555_5555) << 1)
}

/// The Sobol numbers of ray `bounce` of the sample with the reversed index `counter`. The first three rays share a
/// shuffle of the index and differ by a rearrangement, as do the lens and the point in the pixel. Those of the second pair
/// matter only for the camera ray.
pub fn sobol_numbers(key: u32, counter: u32, bounce: u32) -> [u32; 4] {
    let stream = if bounce <= 2 { key } else { key.wrapping_add(bounce - 2) };
    let index = laine_karras(counter, mix32(stream));
    let factor = bounce.wrapping_mul(REARRANGEMENT_SQUARE).wrapping_add(REARRANGEMENT);
    let [first, second] =
        [bounce.wrapping_mul(factor), PIXEL_REARRANGEMENT].map(|factor| index ^ index.wrapping_mul(factor));
    [first, pascal(first), second, pascal(second)]
}

fn sine_of_quarter(x: f32) -> f32 {
    let [c0, c1, c2, c3, c4] = sine_coefficients().map(|c| c as f32);
    let y = x * x;
    (c0 + y * (c1 + y * (c2 + y * (c3 + y * c4)))) * x
}

/// Sine and cosine of an angle in turns, `0 <= u < 1`. Graphics APIs only guarantee their own sine to 2^-11, so CPU and
/// GPU share this polynomial.
pub fn sin_cos_turns(u: f32) -> (f32, f32) {
    let x = u - 0.5;
    let q = x.abs() - 0.25;
    (-sine_of_quarter(0.25 - q.abs()).copysign(x), sine_of_quarter(q))
}

/// A uniform point on the unit sphere. Its pole is vertical, like that of the sky and of the ground, which scatters
/// most of the light. Evenly spaced numbers then give evenly spaced heights, which matters most for Sobol points.
pub fn unit_sphere(u0: f32, u1: f32) -> [f32; 3] {
    let (sine, cosine) = sin_cos_turns(u1);
    let rho = 2.0 * (u0 * (1.0 - u0)).sqrt();
    [rho * cosine, 1.0 - 2.0 * u0, rho * sine]
}
