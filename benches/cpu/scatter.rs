//! Scattering, with and without the code of glass.

use crate::widths::{Body, COUNT, Vectors, run, widths};
use divan::Bencher;
use divan::counter::ItemsCount;
use weekender::render_cpu::lanes::{Float, Lanes, Mask, V3};
use weekender::render_cpu::material::{Material, incidence_of, scatter};
use weekender::stages::DielectricLaws;

/// Bounces of each ray: enough that loading it does not matter.
const BOUNCES: usize = 8;

/// Mixed materials: each lane has one of its own.
struct Scatter<const GLASS: bool> {
    directions: Vectors,
    normals: Vectors,
    units: Vectors,
}

impl<const GLASS: bool> Scatter<GLASS> {
    fn new() -> Self {
        Scatter {
            directions: Vectors::within(-1.0, 1.0).normalised(),
            normals: Vectors::within(-0.9, 1.1).normalised(),
            units: Vectors::within(-1.1, 0.9).normalised(),
        }
    }
}

impl<const GLASS: bool> Body for Scatter<GLASS> {
    #[inline(always)]
    fn run<L: Lanes<Real = f32>>(&self, l: L) -> u32 {
        let zero = l.constant(0.0);
        let mut sum = V3 { x: zero, y: zero, z: zero };
        for first in (0..COUNT).step_by(L::WIDTH) {
            let (mut direction, coin) = self.directions.load(l, first);
            let (normal, kind) = self.normals.load(l, first);
            let is_glass = kind.lt(l.constant(if GLASS { 0.3 } else { 0.0 }));
            let index = is_glass.select(l.constant(1.5), zero);
            let material = Material {
                weight: kind - l.constant(0.6),
                refraction_index: index,
                inverse_index: l.constant(1.0) / index,
                f0: l.constant(0.04),
            };
            let (unit, _) = self.units.load(l, first);
            for _ in 0..BOUNCES {
                let cosine = direction.dot(normal);
                let front = cosine.lt(zero);
                let cosine = cosine.abs().min(l.constant(1.0));
                let laws = DielectricLaws::Schlick;
                let found = scatter::<L, GLASS>(
                    l,
                    &material,
                    laws,
                    direction,
                    normal,
                    &incidence_of(l, cosine),
                    front,
                    unit,
                    coin,
                );
                direction = found.direction.scale(l.constant(0.5));
            }
            sum = sum + direction;
        }
        (sum.x + sum.y).lt(sum.z).bits()
    }
}

#[divan::bench(args = widths())]
fn opaque(bencher: Bencher, width: usize) {
    let body = Scatter::<false>::new();
    bencher.counter(ItemsCount::new(COUNT * BOUNCES)).bench(|| run(width, divan::black_box(&body)));
}

#[divan::bench(args = widths())]
fn with_glass(bencher: Bencher, width: usize) {
    let body = Scatter::<true>::new();
    bencher.counter(ItemsCount::new(COUNT * BOUNCES)).bench(|| run(width, divan::black_box(&body)));
}
