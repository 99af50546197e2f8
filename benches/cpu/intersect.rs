//! Rays against spheres, for each form of the roots.

use crate::widths::{Body, COUNT, Vectors, rays, run, widths};
use divan::Bencher;
use divan::counter::ItemsCount;
use weekender::kernel::{AnchoredSphere, Roots};
use weekender::render_cpu::lanes::{Lanes, Mask, Unsigned};
use weekender::render_cpu::sphere::{
    BroadcastSphere, Nearest, Spheres, anchored_root, book_root, near_root, nearest_root,
};

/// Spheres that each ray is tested against: enough that loading the rays does not matter.
const SPHERES: usize = 32;

#[derive(Clone, Copy, Debug)]
enum Root {
    Near,
    Nearest,
    Book,
    Anchored,
}

struct Intersect {
    root: Root,
    origins: Vectors,
    directions: Vectors,
    spheres: Vec<BroadcastSphere<f32>>,
    grounds: Vec<AnchoredSphere<f32>>,
}

impl Intersect {
    fn new(root: Root) -> Self {
        let directions = Vectors::within(-1.0, 1.0).normalised();
        // In a ring around the origins.
        let sphere = |index: usize| {
            let (sine, cosine) = (index as f32 / SPHERES as f32 * std::f32::consts::TAU).sin_cos();
            BroadcastSphere::new([2.0 * cosine, 0.0, 2.0 * sine, 0.25], index as u32)
        };
        let spheres = (0..SPHERES).map(sphere).collect();
        let ground = |index: usize| AnchoredSphere {
            anchor: [0.0, -0.5 - index as f32, -1.0],
            inward: [0.0, -1.0, 0.0],
            curvature: 0.001,
            flags: Roots::Nearer as u32,
        };
        let grounds = (0..SPHERES).map(ground).collect();
        Intersect { root, origins: Vectors::within(-0.1, 0.1), directions, spheres, grounds }
    }
}

impl Body for Intersect {
    #[inline(always)]
    fn run<L: Lanes<Real = f32>>(&self, l: L) -> u32 {
        let mut found = l.splat_u(0);
        for first in (0..COUNT).step_by(L::WIDTH) {
            let rays = rays(l, self.origins.load(l, first).0, self.directions.load(l, first).0);
            let mut nearest = Nearest::nothing(l);
            for (index, (sphere, ground)) in self.spheres.iter().zip(&self.grounds).enumerate() {
                let (sphere, number) = (Spheres::load(l, sphere), l.splat_u(index as u32));
                let candidate = match self.root {
                    Root::Near => near_root(l, &rays, &sphere),
                    Root::Nearest => nearest_root(l, &rays, &sphere),
                    Root::Book => book_root(l, &rays, &sphere, l.constant(0.001)),
                    Root::Anchored => anchored_root(l, &rays, ground, number),
                };
                nearest.take(l, candidate, number);
            }
            found = found ^ nearest.sphere;
        }
        found.eq(l.splat_u(0)).bits()
    }
}

fn measure(bencher: Bencher, width: usize, root: Root) {
    let body = Intersect::new(root);
    bencher.counter(ItemsCount::new(COUNT * SPHERES)).bench(|| run(width, divan::black_box(&body)));
}

#[divan::bench(args = widths())]
fn near(bencher: Bencher, width: usize) {
    measure(bencher, width, Root::Near);
}

#[divan::bench(args = widths())]
fn nearest(bencher: Bencher, width: usize) {
    measure(bencher, width, Root::Nearest);
}

#[divan::bench(args = widths())]
fn book(bencher: Bencher, width: usize) {
    measure(bencher, width, Root::Book);
}

#[divan::bench(args = widths())]
fn anchored(bencher: Bencher, width: usize) {
    measure(bencher, width, Root::Anchored);
}
