//! Scrambled Sobol points in two dimensions.
//!
//! Both functions work on reversed bits, where Owen scrambling is an integer hash and the first Sobol dimension is the
//! index itself. Scrambling the reversed index shuffles the sequence within each aligned power-of-two block and moves
//! the block as a whole. The pair `(u, pascal(u))` is then a point of a moved Sobol net. Every aligned block of samples
//! is such a net, and blocks of different bounces and pixels are independent.

/// Offset from a bounce's block number to the block of its second pair of dimensions, far from any bounce.
pub const LENS_BLOCK: u32 = 0x4000_0000;

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
