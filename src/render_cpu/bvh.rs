//! Traversal of a hierarchy by whole packets.
//!
//! Twin: shaders/bvh.wgsl

use super::lanes::{Lanes, V3, splat3};
use super::sphere::{Nearest, Rays, Spheres, near_root, nearest_root};
use crate::tables::Real;
use crate::tables::hierarchy::{COUNT_MASK, DEPTH_LIMIT, Hierarchy, LEAST_COMPONENT, Node, ROUNDING_UNITS};

/// Nodes to be visited, one a level at most. It outlives the traversals: clearing it each time would show in the run
/// time.
pub type Stack = [u32; DEPTH_LIMIT];

/// A stack to start with.
pub const EMPTY_STACK: Stack = [0; DEPTH_LIMIT];

/// Takes the nearest hits among the spheres of a hierarchy into `nearest`. `active` lanes are those whose result
/// matters.
#[inline(always)]
pub fn traverse<L: Lanes>(
    l: L,
    hierarchy: &Hierarchy<L::Real>,
    spheres: &[[L::Real; 4]],
    rays: &Rays<L>,
    active: L::M,
    stack: &mut Stack,
    nearest: &mut Nearest<L>,
) {
    let slabs = Slabs::new(l, rays, hierarchy.extent);
    let forward = [rays.direction.x, rays.direction.y, rays.direction.z].map(|d| {
        2 * L::bits(L::lt(l.constant(0.0), d) & active).count_ones() >= L::bits(active).count_ones()
    });
    let mut limit = nearest.distance();
    let (mut index, mut depth) = (0, 0);
    loop {
        let node = &hierarchy.nodes[index as usize];
        if L::bits(slabs.meet(l, node, limit) & active) != 0 {
            let count = node.count & COUNT_MASK;
            if count == 0 {
                let ascending = node.count & (1 << 29) == 0;
                let nearer = u32::from(forward[(node.count >> 30) as usize] != ascending);
                stack[depth] = node.first + 1 - nearer;
                index = node.first + nearer;
                depth += 1;
                continue;
            }
            let first = node.first as usize;
            for (offset, &[x, y, z, radius2]) in spheres[first..first + count as usize].iter().enumerate() {
                let number = (first + offset) as u32;
                let sphere = |radius2| Spheres::splat(l, [x, y, z, radius2], l.splat_u(number));
                // Rays that leave one of two spheres of the same place must not meet the far side of the other.
                let key = if radius2 < L::Real::default() {
                    near_root(l, rays, &sphere(radius2.negated()))
                } else {
                    nearest_root(l, rays, &sphere(radius2))
                };
                nearest.take_in_any_order(l, key, number, &hierarchy.ranks, active);
            }
            limit = nearest.distance();
        }
        if depth == 0 {
            return;
        }
        depth -= 1;
        index = stack[depth];
    }
}

/// Rays prepared for boxes: per axis `1/d`, and the origin moved outwards by the rounding there can be.
struct Slabs<L: Lanes> {
    inverse: V3<L::F>,
    low: V3<L::F>,
    high: V3<L::F>,
}

impl<L: Lanes> Slabs<L> {
    #[inline(always)]
    fn new(l: L, rays: &Rays<L>, extent: L::Real) -> Self {
        let o = rays.origin;
        let size = L::max(L::max(L::abs(o.x), L::abs(o.y)), L::max(L::abs(o.z), l.splat(extent)));
        let margin = size * l.constant(ROUNDING_UNITS * f64::from(f32::EPSILON) / 2.0);
        let inverse = V3 {
            x: inverse(l, rays.direction.x),
            y: inverse(l, rays.direction.y),
            z: inverse(l, rays.direction.z),
        };
        let margin = V3 { x: margin, y: margin, z: margin };
        Slabs { inverse, low: (o + margin).times(inverse), high: (o - margin).times(inverse) }
    }

    /// Which rays meet the box before distance `limit`.
    #[inline(always)]
    fn meet(&self, l: L, node: &Node<L::Real>, limit: L::F) -> L::M {
        let (min, max) = (splat3(l, node.min), splat3(l, node.max));
        let at = |corner: L::F, inverse: L::F, origin: L::F| L::mul_add(corner, inverse, -origin);
        let (x0, x1) = (at(min.x, self.inverse.x, self.low.x), at(max.x, self.inverse.x, self.high.x));
        let (y0, y1) = (at(min.y, self.inverse.y, self.low.y), at(max.y, self.inverse.y, self.high.y));
        let (z0, z1) = (at(min.z, self.inverse.z, self.low.z), at(max.z, self.inverse.z, self.high.z));
        let enter = L::max(L::max(L::min(x0, x1), L::min(y0, y1)), L::max(L::min(z0, z1), l.constant(0.0)));
        let leave = L::min(L::min(L::max(x0, x1), L::max(y0, y1)), L::min(L::max(z0, z1), limit));
        // Rounding of the distances themselves.
        let wide = l.constant(1.0 + 4.0 * f64::from(f32::EPSILON));
        !L::lt(leave * wide, enter)
    }
}

/// `1/d`, finite also where `d` is 0.
#[inline(always)]
fn inverse<L: Lanes>(l: L, d: L::F) -> L::F {
    let least = l.constant(LEAST_COMPONENT);
    let size = L::max(L::abs(d), least);
    L::copysign(l.constant(1.0) / size, d)
}
