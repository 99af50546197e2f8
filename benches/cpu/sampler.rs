//! The numbers of a ray.

use crate::widths::{Body, COUNT, run, widths};
use divan::Bencher;
use divan::counter::ItemsCount;
use weekender::render_cpu::lanes::{Lanes, Mask, Unsigned};
use weekender::render_cpu::rng::{laine_karras, mix32, pcg4d, sobol_pair};

/// A pair of Sobol coordinates for each of [`COUNT`] rays.
struct Sobol;

impl Body for Sobol {
    #[inline(always)]
    fn run<L: Lanes<Real = f32>>(&self, l: L) -> u32 {
        let mut sum = l.splat_u(0);
        for first in (0..COUNT).step_by(L::WIDTH) {
            let counter = l.splat_u(divan::black_box(first as u32).reverse_bits());
            let index = laine_karras(l, counter, mix32(l, sum));
            let [u, v] = sobol_pair(l, index, l.splat_u(2));
            sum = sum + (u ^ v);
        }
        sum.eq(l.splat_u(0)).bits()
    }
}

/// Four independent numbers for each of [`COUNT`] rays.
struct Independent;

impl Body for Independent {
    #[inline(always)]
    fn run<L: Lanes<Real = f32>>(&self, l: L) -> u32 {
        let mut sum = l.splat_u(0);
        for first in (0..COUNT).step_by(L::WIDTH) {
            let counter = l.splat_u(divan::black_box(first as u32));
            let [a, b, c, d] = pcg4d(l, [counter, sum, l.splat_u(3), l.splat_u(7)]);
            sum = sum + (a ^ b ^ c ^ d);
        }
        sum.eq(l.splat_u(0)).bits()
    }
}

#[divan::bench(args = widths())]
fn sobol(bencher: Bencher, width: usize) {
    bencher.counter(ItemsCount::new(COUNT)).bench(|| run(width, &Sobol));
}

#[divan::bench(args = widths())]
fn independent(bencher: Bencher, width: usize) {
    bencher.counter(ItemsCount::new(COUNT)).bench(|| run(width, &Independent));
}
