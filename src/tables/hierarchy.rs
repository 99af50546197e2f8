//! A hierarchy of boxes over many spheres.
//!
//! obvhs builds the tree; here it is laid out for the kernels, and its boxes are made wide enough that rounding
//! never hides a hit that testing every sphere would find.

use super::Real;
use crate::scene::Sphere;
use glam::DVec3;
use obvhs::aabb::Aabb;
use obvhs::bvh2::builder::build_bvh2;
use obvhs::{Boundable, BvhBuildParams};
use std::time::Duration;

/// The bits of [`Node::count`] that hold the number of spheres.
pub const COUNT_MASK: u32 = (1 << 29) - 1;

/// Rounding in the test of a sphere and of a box, relative to the largest coordinate that takes part, is below
/// this many units of `2^-24`.
pub const ROUNDING_UNITS: f64 = 8.0;

/// A direction's component counts as no smaller than this, so that its inverse is finite.
pub const LEAST_COMPONENT: f64 = 1e-18;

/// A box and what it holds.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct Node<R> {
    /// Lowest corner.
    pub min: [R; 3],
    /// First sphere of a leaf, or the first of two children that stand side by side.
    pub first: u32,
    /// Highest corner.
    pub max: [R; 3],
    /// Spheres of a leaf; else 0, or'ed with the axis that parts the children in bits 30 and 31.
    pub count: u32,
}

/// Nodes, the root first.
#[derive(Clone, Debug)]
pub struct Hierarchy<R> {
    /// All nodes.
    pub nodes: Vec<Node<R>>,
    /// Largest coordinate of any box in size: how coarse rounding can be.
    pub extent: R,
}

/// A sphere whose box is widened by the rounding in the test of a sphere. The box is worked out when it is asked
/// for: in a scene of millions it would be most of what a build takes.
pub(super) struct Bounded<'a>(pub(super) &'a Sphere);

impl Boundable for Bounded<'_> {
    fn aabb(&self) -> Aabb {
        let Sphere { center, radius, .. } = *self.0;
        let unit = f64::from(f32::EPSILON) / 2.0;
        let reach = radius + ROUNDING_UNITS * unit * (radius + center.abs().max_element());
        let below = |x: f64| (x as f32).next_down();
        let above = |x: f64| (x as f32).next_up();
        let vector = |v: DVec3, f: fn(f64) -> f32| glam::Vec3A::new(f(v.x), f(v.y), f(v.z));
        Aabb::new(vector(center - reach, below), vector(center + reach, above))
    }
}

impl<R: Real> Hierarchy<R> {
    /// Builds it over at least one sphere. Returns also the order in which the leaves name the spheres.
    pub fn build<'a>(spheres: impl IntoIterator<Item = &'a Sphere>) -> (Self, Vec<u32>) {
        let bounded: Vec<Bounded<'_>> = spheres.into_iter().map(Bounded).collect();
        let tree = build_bvh2(&bounded, params(bounded.len(), 8), &mut Duration::default());
        drop(bounded);
        let corner = |v: glam::Vec3A| v.to_array().map(|x| R::from_f64(f64::from(x)));
        let mut extent = 0.0_f32;
        let nodes = tree
            .nodes
            .iter()
            .map(|node| {
                let aabb = node.aabb();
                extent = extent.max(aabb.min.abs().max_element()).max(aabb.max.abs().max_element());
                let axis =
                    if node.is_leaf() { 0 } else { parting_axis(&tree.nodes, node.first_index as usize) };
                Node {
                    min: corner(aabb.min),
                    first: node.first_index,
                    max: corner(aabb.max),
                    count: node.prim_count | axis,
                }
            })
            .collect();
        (Hierarchy { nodes, extent: R::from_f64(f64::from(extent)) }, tree.primitive_indices)
    }
}

impl<R> Hierarchy<R> {
    /// Nodes on the longest way from the root to a leaf.
    pub fn depth(&self) -> usize {
        let mut deepest = 0;
        let mut open = vec![(0_u32, 1_usize)];
        while let Some((index, depth)) = open.pop() {
            deepest = deepest.max(depth);
            let node = &self.nodes[index as usize];
            if node.count & COUNT_MASK == 0 {
                open.extend([(node.first, depth + 1), (node.first + 1, depth + 1)]);
            }
        }
        deepest
    }
}

/// How obvhs is to build the tree of so many spheres.
pub(super) fn params(spheres: usize, max_prims_per_leaf: u32) -> BvhBuildParams {
    let preset =
        if spheres <= 100_000 { BvhBuildParams::medium_build() } else { BvhBuildParams::fast_build() };
    BvhBuildParams { max_prims_per_leaf, ..preset }
}

/// The axis along which two sibling boxes lie farthest apart, in bits 30 and 31; bit 29 is set where the second
/// lies before the first.
fn parting_axis(nodes: &[obvhs::bvh2::node::Bvh2Node], first: usize) -> u32 {
    let apart = nodes[first + 1].aabb().center() - nodes[first].aabb().center();
    let size = apart.abs();
    let axis = (0..3).max_by(|a, b| size[*a].total_cmp(&size[*b])).unwrap_or(0);
    (axis as u32) << 30 | u32::from(apart[axis] < 0.0) << 29
}
