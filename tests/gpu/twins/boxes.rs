//! Boxes of the hierarchies.

use super::probe::Probe;
use super::{L, Words, float, list, rays, run, uniform, unit_vector, vector, words};
use crate::common::gpu::program::Programs;
use glam::DVec3;
use weekender::kernel::{NONE, Node};
use weekender::render_cpu::bvh::{misses_box, slabs_of};
use weekender::render_cpu::lanes::Single;
use weekender::stages::DielectricLaws;

/// A ray, a box that it hits in about half the cases, the length of the ray, and the largest coordinate.
fn ray_and_box(i: u32) -> Words {
    let [x, y, z, size] = uniform(i, 70);
    let low = [x, y, z].map(|x| 4.0 * x - 2.0);
    let [a, b, c, reach] = uniform(i, 71);
    let high = [low[0] + size + a, low[1] + size + b, low[2] + size + c];
    let origin = unit_vector(i, 72).map(|x| 8.0 * reach * x);
    let [u, v, w, limit] = uniform(i, 73);
    let target = [0, 1, 2].map(|k| low[k] + (1.8 * [u, v, w][k] - 0.4) * (high[k] - low[k]));
    let mut d = DVec3::from_array([0, 1, 2].map(|k| f64::from(target[k] - origin[k])));
    // Sometimes along an axis, where a component's inverse is not finite.
    match i % 8 {
        0 => d.x = 0.0,
        1 => (d.y, d.z) = (0.0, -0.0),
        _ => {}
    }
    let d = d.normalize();
    let direction = d.as_vec3().to_array();
    let mut words = words(&[&origin[..], &direction, &[0.0; 2], &low, &high, &[16.0 * limit, 4.0]].concat());
    (words[6], words[7]) = (NONE, NONE);
    words
}

/// Distances at which a ray enters and leaves a box, in `f64`.
fn slab(origin: [f32; 3], direction: [f32; 3], low: [f32; 3], high: [f32; 3], limit: f32) -> [f64; 2] {
    let mut within = [0.0, f64::from(limit)];
    for axis in 0..3 {
        let [o, d, low, high] = [origin[axis], direction[axis], low[axis], high[axis]].map(f64::from);
        let at = [(low - o) / d, (high - o) / d];
        if d == 0.0 {
            if o < low || o > high {
                return [1.0, -1.0];
            }
            continue;
        }
        within = [within[0].max(at[0].min(at[1])), within[1].min(at[0].max(at[1]))];
    }
    within
}

#[test]
fn boxes_are_met_alike() {
    let Some(gpu) = Programs::open() else { return };
    let (mut met, mut missed) = (0, 0);
    for (input, output) in run(&gpu, DielectricLaws::Schlick, Probe::Box, ray_and_box) {
        let (low, high) = (list(vector(&input, 8)), list(vector(&input, 11)));
        let (limit, extent) = (float(&input, 14), float(&input, 15));
        let node = Node { low, first: 0, high, count: 1 };
        let on_cpu = !misses_box(L, &slabs_of(L, &rays(&input), extent), &node, Single(limit));
        assert!(output[0] == 0 || output[0] == 15, "four times the same box: {:b}", output[0]);
        let on_gpu = output[0] != 0;
        let rays = rays(&input);
        let [enter, leave] = slab(list(rays.origin), list(rays.direction), low, high, limit);
        // Boxes are enlarged slightly, which matters most along an axis on which the ray hardly moves.
        let slowest = list(rays.direction).into_iter().filter(|d| *d != 0.0).fold(1.0, |a, b| b.abs().min(a));
        let margin = 2e-5 / f64::from(slowest);
        if leave - enter > 0.0 {
            assert!(on_cpu && on_gpu, "{input:?}");
            met += 1;
        } else if leave - enter < -4.0 * margin {
            assert!(!on_cpu && !on_gpu, "{input:?}");
            missed += 1;
        }
    }
    assert!(met > 500 && missed > 500, "{met} met, {missed} missed");
}
