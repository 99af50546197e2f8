//! Integers, and the functions of angles.

use super::*;

#[test]
fn integers_are_equal_to_the_bit() {
    let Some(gpu) = Programs::open() else { return };
    let laws = DielectricLaws::Schlick;
    let random = |i: u32| {
        let [a, b, c, d] = pcg4d([i, 1, 2, 3]);
        let mut words = [0; PROBE_STRIDE];
        words[..5].copy_from_slice(&[a, b & 1, c, d, i % 50]);
        words
    };
    for (input, output) in run(&gpu, laws, Probe::Pcg4d, random) {
        assert_eq!(output[..4], pcg4d([input[0], input[1], input[2], input[3]]));
    }
    for (input, output) in run(&gpu, laws, Probe::Sobol, random) {
        let [seed, half, pixel, counter, bounce] = [0, 1, 2, 3, 4].map(|i| input[i]);
        let key = pixel_key(seed, half, pixel);
        assert_eq!(output[..4], sobol_numbers(key, counter, bounce));
    }
    let rounded = |i: u32| {
        let x = match i {
            0 => 0.5,
            1 => 1.5,
            2 => 2.5,
            3 => FIXED_POINT_MAX as f32,
            4 => 3e9,
            _ => uniform(i, 5)[0] * (1_u32 << (i % 31)) as f32,
        };
        words(&[x])
    };
    for (input, output) in run(&gpu, laws, Probe::FixedPoint, rounded) {
        let rounded = f64::from(float(&input, 0)).round_ties_even().min(f64::from(FIXED_POINT_MAX));
        assert_eq!(f64::from(output[0]), rounded, "{input:?}");
    }
}

#[test]
fn sine_and_cosine() {
    let Some(gpu) = Programs::open() else { return };
    let mut ulps = Ulps::default();
    for (input, output) in run(&gpu, DielectricLaws::Schlick, Probe::SinCos, |i| {
        let mut words = [0; PROBE_STRIDE];
        words[0] = i << 20 | pcg4d([i, 0, 0, 0])[0] >> 12;
        words
    }) {
        assert_eq!(float(&output, 0), unit_float(input[0]));
        let (sine, cosine) = sin_cos_turns(unit_float(input[0]));
        ulps.compare(&[float(&output, 1), float(&output, 2)], &[sine, cosine], 0.75);
    }
    ulps.within("sin_cos_turns", 4.0);
}
