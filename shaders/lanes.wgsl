// Arithmetic on numbers and vectors. A WGSL compiler may assume that NaN and infinity never occur, so no shader relies
// on them: comparisons come before the operation.
//
// Twin: src/render_cpu/lanes

// The magnitude of `size` with the sign of `signed`.
fn copysign(size: f32, signed: f32) -> f32 {
    return bitcast<f32>((bitcast<u32>(size) & 0x7FFFFFFFu) | (bitcast<u32>(signed) & 0x80000000u));
}

fn dot3(a: vec3f, b: vec3f) -> f32 {
    return fma(a.x, b.x, fma(a.y, b.y, a.z * b.z));
}

// a s + b
fn mul_add3(a: vec3f, s: f32, b: vec3f) -> vec3f {
    return fma(a, vec3f(s), b);
}

// b - a s
fn neg_mul_add3(a: vec3f, s: f32, b: vec3f) -> vec3f {
    return fma(-a, vec3f(s), b);
}

fn normalized(v: vec3f) -> vec3f {
    return v * inverseSqrt(dot3(v, v));
}

// Rounds a radiance in units of the film to the nearest integer, ties to even.
fn fixed_point(x: f32) -> u32 {
    return u32(round(min(x, FIXED_POINT_MAX)));
}

// Sine and cosine of an angle in turns, 0 <= u < 1.
fn sin_cos_turns(u: f32) -> vec2f {
    let x = u - 0.5;
    let q = abs(x) - 0.25;
    return vec2f(-copysign(sine_of_quarter(0.25 - abs(q)), x), sine_of_quarter(q));
}

// Converts the upper 24 bits to a float in [0, 1).
fn unit_float(u: u32) -> f32 {
    return f32(u >> 8u) * UNIT_FLOAT_SCALE;
}

fn sine_of_quarter(x: f32) -> f32 {
    let y = x * x;
    return fma(y, fma(y, fma(y, fma(y, SINE_4, SINE_3), SINE_2), SINE_1), SINE_0) * x;
}
