// The random numbers of a sample.
//
// Twin: src/render_cpu/rng.rs

// Hashes 32 bits to 32 bits; a bijection.
fn mix32(v: u32) -> u32 {
    var x = (v ^ (v >> 16u)) * 0x7FEB352Du;
    x = (x ^ (x >> 15u)) * 0x846CA68Bu;
    return x ^ (x >> 16u);
}

// Hashes four numbers to four numbers.
fn pcg4d(numbers: vec4u) -> vec4u {
    let v = stir(numbers * 1664525u + 1013904223u);
    return stir(v ^ (v >> vec4u(16u)));
}

fn stir(numbers: vec4u) -> vec4u {
    var v = numbers;
    v.x += v.y * v.w;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v.w += v.y * v.z;
    return v;
}

// Owen scrambling on reversed bits.
fn laine_karras(reversed: u32, seed: u32) -> u32 {
    var x = reversed ^ (reversed * 0x3D20ADEAu);
    x = x + seed;
    x = x * ((seed >> 16u) | 1u);
    x = x ^ (x * 0x05526C56u);
    return x ^ (x * 0x53A22864u);
}

// Computes the second Sobol coordinate from the first.
fn pascal(first: u32) -> u32 {
    var u = first ^ (first << 16u);
    u = u ^ ((u & 0x00FF00FFu) << 8u);
    u = u ^ ((u & 0x0F0F0F0Fu) << 4u);
    u = u ^ ((u & 0x33333333u) << 2u);
    return u ^ ((u & 0x55555555u) << 1u);
}

// A pair of Sobol coordinates from a shuffled index.
fn sobol_pair(index: u32, rearrangement: u32) -> vec2u {
    let u = index ^ (index * rearrangement);
    return vec2u(u, pascal(u));
}

// The key that separates the Sobol scramblings of pixels, halves and seeds.
fn pixel_key(seed: u32, half: u32, pixel: u32) -> u32 {
    return mix32(mix32(seed + half * GOLDEN_RATIO) ^ pixel);
}

// The key that separates a pixel's scramblings; 0 for samplers that hash the pixel itself.
fn sampler_key(seed: u32, half: u32, pixel: u32) -> u32 {
    if SAMPLER == SAMPLER_SOBOL {
        return pixel_key(seed, half, pixel);
    }
    return 0u;
}

// Two pairs of numbers for a path's next ray; the second pair matters only `with_lens`, for camera rays.
fn numbers(seed: u32, pixel: u32, counter: u32, key: u32, bounce: u32, with_lens: bool) -> vec4u {
    if SAMPLER == SAMPLER_SOBOL {
        let index = laine_karras(counter, mix32(key + bounce - min(bounce, LAST_TOGETHER)));
        let first = sobol_pair(index, bounce * (bounce * REARRANGEMENT_SQUARE + REARRANGEMENT));
        if with_lens {
            return vec4u(first, sobol_pair(index, PIXEL_REARRANGEMENT));
        }
        return first.xyxy;
    }
    let drawn = pcg4d(vec4u(pixel, counter, bounce, seed));
    return select(drawn.xyxy, drawn, with_lens);
}
