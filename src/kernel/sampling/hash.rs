//! Integer hashes.

/// `2^32` over the golden ratio, rounded to an odd number: its multiples are far apart.
pub const GOLDEN_RATIO: u32 = 0x9E37_79B9;

/// Hashes four numbers: a bijection in which each output bit depends on every input bit.
///
/// Source: Jarzynski and Olano, "Hash Functions for GPU Rendering", JCGT 9(3), 2020.
pub fn pcg4d(v: [u32; 4]) -> [u32; 4] {
    let v = stir(v.map(|a| a.wrapping_mul(1_664_525).wrapping_add(1_013_904_223)));
    stir(v.map(|a| a ^ (a >> 16)))
}

fn stir([x, y, z, w]: [u32; 4]) -> [u32; 4] {
    let x = x.wrapping_add(y.wrapping_mul(w));
    let y = y.wrapping_add(z.wrapping_mul(x));
    let z = z.wrapping_add(x.wrapping_mul(y));
    let w = w.wrapping_add(y.wrapping_mul(z));
    [x, y, z, w]
}

/// Hashes a number: a bijection.
///
/// Source: Wellons, "Prospecting for Hash Functions", 2018 (`lowbias32`).
pub fn mix32(mut x: u32) -> u32 {
    x = (x ^ (x >> 16)).wrapping_mul(0x7FEB_352D);
    x = (x ^ (x >> 15)).wrapping_mul(0x846C_A68B);
    x ^ (x >> 16)
}
