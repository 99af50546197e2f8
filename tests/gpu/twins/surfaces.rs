//! Angles of incidence, and the stages' rules that replace the book's final ones.

use super::probe::Probe;
use super::{L, Ulps, float, job, list, run, uniform, unit_vector, vector, words};
use crate::common::gpu::program::Programs;
use weekender::render_cpu::lanes::Single;
use weekender::render_cpu::material::{hemisphere, incidence_of, incidence_of_sine2};
use weekender::stages::DielectricLaws;

/// Cosines of rays from either side; rounding puts some of them beyond 1.
#[test]
fn incidence_and_stage_rules() {
    let Some(gpu) = Programs::open() else { return };
    let width = job(DielectricLaws::Schlick).settings().width;
    let (mut ulps, mut directions) = (Ulps::default(), Ulps::default());
    for (input, output) in run(&gpu, DielectricLaws::Schlick, Probe::Incidence, |i| {
        let [cosine, sine2, ..] = uniform(i, 60);
        let (normal, unit) = (unit_vector(i, 61), unit_vector(i, 62));
        let [cosine, sine2] = [2.2 * cosine - 1.1, 1.1 * sine2];
        let mut words = words(&[cosine, sine2, normal[0], normal[1], normal[2], unit[0], unit[1], unit[2]]);
        words[8] = (i % width) | ((i / width) << 16);
        words
    }) {
        let (cosine, sine2) = (float(&input, 0), float(&input, 1));
        let expected = incidence_of(L, Single(cosine));
        assert!((0.0..=1.0).contains(&expected.cosine.0), "{cosine}");
        ulps.compare(&[float(&output, 0), float(&output, 1)], &[expected.cosine.0, expected.sine2.0], 1.0);
        let expected = incidence_of_sine2(L, Single(sine2));
        assert!((0.0..=1.0).contains(&expected.sine2.0), "{sine2}");
        ulps.compare(&[float(&output, 2), float(&output, 3)], &[expected.cosine.0, expected.sine2.0], 1.0);
        let (normal, unit) = (vector(&input, 2), vector(&input, 5));
        let expected = list(hemisphere(L, normal, unit));
        directions.compare(&list(vector(&output, 4)), &expected, 1.0);
        // Five strips from left to right.
        let strip = (5 * (input[8] & 0xFFFF) / width) as f32;
        ulps.compare(&[float(&output, 7)], &[0.1 + 0.2 * strip], 1.0);
    }
    ulps.within("incidence and strips", 4.0);
    directions.within("hemisphere", 0.0);
}
