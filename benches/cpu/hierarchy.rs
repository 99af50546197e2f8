//! Building the hierarchy and going through it, for several numbers of spheres.

use crate::widths::{Body, COUNT, Vectors, rays, run, widths};
use divan::Bencher;
use divan::counter::ItemsCount;
use glam::DVec3;
use weekender::prepared::hierarchy::{Effort, Hierarchy};
use weekender::render_cpu::bvh::{EMPTY_STACK, traverse};
use weekender::render_cpu::lanes::{Lanes, Mask, Unsigned};
use weekender::render_cpu::sphere::Nearest;
use weekender::scene::Sphere;
use weekender::scene::builtin::field;

const COUNTS: [u64; 4] = [100, 1000, 10_000, 100_000];

/// The small spheres of a field.
fn spheres(count: u64) -> Vec<Sphere> {
    field(count).0.spheres.split_off(1)
}

#[divan::bench(args = COUNTS, sample_count = 10)]
fn build(bencher: Bencher, count: u64) {
    let spheres = spheres(count);
    bencher
        .counter(ItemsCount::new(count))
        .bench(|| Hierarchy::<f32>::build(divan::black_box(&spheres), DVec3::ZERO, Effort::Quick));
}

/// Rays in all directions from a little above the middle of a field.
struct Traverse {
    hierarchy: Hierarchy<f32>,
    spheres: Vec<[f32; 4]>,
    origins: Vectors,
    directions: Vectors,
}

impl Traverse {
    fn new(count: u64) -> Self {
        let spheres = spheres(count);
        let hierarchy = Hierarchy::build(&spheres, DVec3::ZERO, Effort::Quick);
        let packed = |index: &u32| {
            let Sphere { center, radius, .. } = spheres[*index as usize];
            [center.x, center.y, center.z, radius * radius].map(|x| x as f32)
        };
        Traverse {
            spheres: hierarchy.ranks.iter().map(packed).collect(),
            hierarchy,
            origins: Vectors::within(0.5, 1.0),
            directions: Vectors::within(-1.0, 1.0).normalised(),
        }
    }
}

impl Body for Traverse {
    #[inline(always)]
    fn run<L: Lanes<Real = f32>>(&self, l: L) -> u32 {
        let mut stack = EMPTY_STACK;
        let mut found = l.splat_u(0);
        let all = l.mask(u32::MAX >> (32 - L::WIDTH));
        for first in (0..COUNT).step_by(L::WIDTH) {
            let rays = rays(l, self.origins.load(l, first).0, self.directions.load(l, first).0);
            let mut nearest = Nearest::nothing(l);
            traverse(l, &self.hierarchy, &self.spheres, &rays, all, &mut stack, &mut nearest);
            found = found ^ nearest.sphere;
        }
        found.eq(l.splat_u(0)).bits()
    }
}

fn go_through(bencher: Bencher, width: usize, count: u64) {
    let body = Traverse::new(count);
    bencher.counter(ItemsCount::new(COUNT)).bench(|| run(width, divan::black_box(&body)));
}

#[divan::bench(args = widths(), sample_count = 20)]
fn traverse_1000(bencher: Bencher, width: usize) {
    go_through(bencher, width, 1000);
}

#[divan::bench(args = widths(), sample_count = 20)]
fn traverse_100000(bencher: Bencher, width: usize) {
    go_through(bencher, width, 100_000);
}
