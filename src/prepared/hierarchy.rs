//! A hierarchy of boxes over many spheres.
//!
//! obvhs builds the tree; here it is laid out for the kernels, and its boxes are made wide enough that rounding
//! never hides a hit that testing every sphere would find.

use super::bounded::Bounded;
use super::parted;
use crate::kernel::{COUNT_MASK, Node, Real, STACK_SIZE};
use crate::scene::Sphere;
use glam::DVec3;
use obvhs::BvhBuildParams;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2;
use obvhs::bvh2::node::Bvh2Node;
use std::time::Duration;

/// Most levels of a tree: what a traversal has room for.
pub const DEPTH_LIMIT: usize = STACK_SIZE;

/// Most spheres of a leaf.
const LEAF_SPHERES: u32 = 8;

/// Nodes, the root first.
#[derive(Clone, Debug)]
pub struct Hierarchy<R> {
    /// All nodes.
    pub nodes: Vec<Node<R>>,
    /// Largest coordinate of any box in size: how coarse rounding can be.
    pub extent: R,
    /// The place in the list of each sphere in the order of the leaves. Of two spheres at one distance that which
    /// stands first in the list is met.
    pub ranks: Vec<u32>,
}

impl<R: Real> Hierarchy<R> {
    /// Builds it over at least one sphere, with coordinates measured from `origin`.
    pub fn build<'a>(spheres: impl IntoIterator<Item = &'a Sphere>, origin: DVec3) -> Self {
        let fits = |tree: &Bvh2| depth(&tree.nodes) <= DEPTH_LIMIT;
        let tree = build_tree(&Bounded::all(spheres, &origin), LEAF_SPHERES, |tree| tree, fits);
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
                    low: corner(aabb.min),
                    first: node.first_index,
                    high: corner(aabb.max),
                    count: node.prim_count | axis,
                }
            })
            .collect();
        Hierarchy { nodes, extent: R::from_f64(f64::from(extent)), ranks: tree.primitive_indices }
    }
}

/// A tree over at least one sphere with at most `leaf_spheres` to a leaf, laid out: by obvhs, unless the spheres are
/// such that it would take long, or what it makes does not fit (by having more levels than a traversal has room for).
pub(super) fn build_tree<T>(
    spheres: &[Bounded<'_, '_>],
    leaf_spheres: u32,
    lay_out: impl Fn(Bvh2) -> T,
    fits: impl Fn(&T) -> bool,
) -> T {
    if !parted::is_crowded(spheres) {
        let params = params(spheres.len(), leaf_spheres);
        let tree = lay_out(build_bvh2(spheres, params, &mut Duration::default()));
        if fits(&tree) {
            return tree;
        }
    }
    let tree = lay_out(parted::build(spheres, leaf_spheres as usize, false));
    if fits(&tree) { tree } else { lay_out(parted::build(spheres, leaf_spheres as usize, true)) }
}

/// Nodes on the longest way from the root to a leaf.
fn depth(nodes: &[Bvh2Node]) -> usize {
    levels(|index| {
        let node = &nodes[index as usize];
        (!node.is_leaf()).then_some(node.first_index)
    })
}

/// Levels of a tree, given the first of a node's two children, which stand side by side.
fn levels(first_child: impl Fn(u32) -> Option<u32>) -> usize {
    let mut deepest = 0;
    let mut open = vec![(0_u32, 1_usize)];
    while let Some((index, depth)) = open.pop() {
        deepest = deepest.max(depth);
        if let Some(first) = first_child(index) {
            open.extend([(first, depth + 1), (first + 1, depth + 1)]);
        }
    }
    deepest
}

impl<R> Hierarchy<R> {
    /// Nodes on the longest way from the root to a leaf.
    pub fn depth(&self) -> usize {
        levels(|index| {
            let node = &self.nodes[index as usize];
            (node.count & COUNT_MASK == 0).then_some(node.first)
        })
    }
}

/// How obvhs is to build the tree of so many spheres.
fn params(spheres: usize, max_prims_per_leaf: u32) -> BvhBuildParams {
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
