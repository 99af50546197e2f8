//! Traversal of a hierarchy by whole packets.
//!
//! Twin: shaders/bvh.wgsl

use super::lanes::{Float, Lanes, Mask, V3, splat3};
use super::sphere::{Nearest, Rays, signed_root};
use crate::kernel::{BOX_MARGIN, BOX_WIDENING, LEAST_COMPONENT, Node, STACK_SIZE};
use crate::prepared::hierarchy::Hierarchy;

/// Nodes still to be visited, at most one per level. The stack outlives each traversal, because clearing it every time
/// would show in the run time.
pub type Stack = [u32; STACK_SIZE];

/// A stack for the first traversal.
pub const EMPTY_STACK: Stack = [0; STACK_SIZE];

/// Rays prepared for box tests: `1/d` per axis, and the origin moved outwards by the largest possible rounding error.
pub struct Slabs<L: Lanes> {
    inverse: V3<L::F>,
    low: V3<L::F>,
    high: V3<L::F>,
}

/// Prepares rays for boxes whose coordinates are at most `extent` in absolute value.
#[inline(always)]
pub fn slabs_of<L: Lanes>(l: L, rays: &Rays<L>, extent: L::Real) -> Slabs<L> {
    let o = rays.origin;
    let size = o.x.abs().max(o.y.abs()).max(o.z.abs().max(l.splat(extent)));
    let margin = V3::splat(size * l.constant(BOX_MARGIN));
    let inverse = V3 {
        x: inverse_of(l, rays.direction.x),
        y: inverse_of(l, rays.direction.y),
        z: inverse_of(l, rays.direction.z),
    };
    Slabs { inverse, low: (o + margin).times(inverse), high: (o - margin).times(inverse) }
}

/// `1/d`, finite even where `d` is 0.
#[inline(always)]
fn inverse_of<L: Lanes>(l: L, d: L::F) -> L::F {
    let least = l.constant(LEAST_COMPONENT);
    let size = d.abs().max(least);
    (l.constant(1.0) / size).copysign(d)
}

/// Returns the lanes whose ray does not meet the box before distance `limit`.
#[inline(always)]
pub fn misses_box<L: Lanes>(l: L, slabs: &Slabs<L>, node: &Node<L::Real>, limit: L::F) -> L::M {
    let (low, high) = (splat3(l, node.low), splat3(l, node.high));
    let at = |corner: L::F, inverse: L::F, origin: L::F| corner.mul_add(inverse, -origin);
    let (x0, x1) = (at(low.x, slabs.inverse.x, slabs.low.x), at(high.x, slabs.inverse.x, slabs.high.x));
    let (y0, y1) = (at(low.y, slabs.inverse.y, slabs.low.y), at(high.y, slabs.inverse.y, slabs.high.y));
    let (z0, z1) = (at(low.z, slabs.inverse.z, slabs.low.z), at(high.z, slabs.inverse.z, slabs.high.z));
    let enter = x0.min(x1).max(y0.min(y1)).max(z0.min(z1).max(l.constant(0.0)));
    let leave = x0.max(x1).min(y0.max(y1)).min(z0.max(z1).min(limit));
    // The factor covers the rounding of the distances themselves.
    (leave * l.constant(BOX_WIDENING)).lt(enter)
}

/// For each order of children that a node can have ([`Node::nearer_child`]), a bit: the child, 0 or 1, that most of the
/// `active` rays reach first. Kept in a register, since the next node's address depends on it.
#[inline(always)]
fn near_children<L: Lanes>(l: L, rays: &Rays<L>, active: L::M) -> u32 {
    let d = rays.direction;
    let count = active.bits().count_ones();
    let mut near_children = 0;
    for (axis, d) in [d.x, d.y, d.z].into_iter().enumerate() {
        let forward = (l.constant(0.0).lt(d) & active).bits().count_ones();
        let both_orders = if 2 * forward >= count { 0b10 } else { 0b01 };
        near_children |= both_orders << (2 * axis);
    }
    near_children
}

/// Updates `nearest` with the nearest hits among the spheres of a hierarchy. Results matter only for `active` lanes.
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
    let slabs = slabs_of(l, rays, hierarchy.extent);
    let near_children = near_children(l, rays, active);
    let active_bits = active.bits();
    // The distance of a hit limits the search one box later than it could, so that the next box need not wait for the
    // square roots before it.
    let (mut limit, mut next_limit) = (l.constant(f64::INFINITY), nearest.distance());
    let (mut index, mut depth) = (0, 0);
    loop {
        let node = &hierarchy.nodes[index as usize];
        let missed = misses_box(l, &slabs, node, limit);
        limit = next_limit;
        if missed.bits() & active_bits != active_bits {
            let count = node.sphere_count();
            if count == 0 {
                let nearer = node.nearer_child(near_children);
                stack[depth] = node.first + 1 - nearer;
                index = node.first + nearer;
                depth += 1;
                continue;
            }
            let first = node.first as usize;
            for (offset, sphere) in spheres[first..first + count as usize].iter().enumerate() {
                let number = (first + offset) as u32;
                let candidate = signed_root(l, rays, sphere, l.splat_u(number));
                nearest.take_in_any_order(l, candidate, number, &hierarchy.ranks, active);
            }
            next_limit = nearest.distance();
        }
        if depth == 0 {
            return;
        }
        depth -= 1;
        index = stack[depth];
    }
}
