//! A bounding volume hierarchy over many spheres.
//!
//! obvhs builds the tree. This module lays it out for the kernels and widens its boxes, so that rounding never hides a
//! hit that testing every sphere would find.

use super::bounded::Bounded;
use super::parted;
use crate::kernel::{Node, ORDER_SHIFT, Real, STACK_SIZE};
use crate::scene::Sphere;
use glam::DVec3;
use obvhs::BvhBuildParams;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2;
use obvhs::bvh2::node::Bvh2Node;
use std::ops::RangeInclusive;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// Most levels of a tree, limited by the traversal's stack.
pub const DEPTH_LIMIT: usize = STACK_SIZE;

#[derive(Clone, Copy)]
pub(super) struct Leaves {
    /// Most spheres in a leaf.
    pub most: u32,
    /// Cost of a packet's visit to a node, in sphere tests. Higher costs make fuller leaves.
    visit_cost: f32,
}

impl Leaves {
    /// One sphere per leaf.
    pub const SINGLE: Leaves = Leaves { most: 1, visit_cost: 0.0 };
    /// For a tree that fits a core's cache. Between costs of 5 and 8, packets differ by less than 3 %, and one lane
    /// prefers 5.
    const SMALL: Leaves = Leaves { most: 12, visit_cost: 5.0 };
    /// For a tree whose nodes come from farther away.
    const FULL: Leaves = Leaves { most: 24, visit_cost: 8.0 };

    /// The leaves that gave the fastest traversal for this many spheres.
    fn of(spheres: usize) -> Leaves {
        if spheres <= 20_000 { Leaves::SMALL } else { Leaves::FULL }
    }
}

/// Numbers of spheres for which a thorough build beats a quick one and fits time and memory.
const IMPROVABLE: RangeInclusive<usize> = 20_001..=4_000_000;

/// How long a build may take.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effort {
    /// Up to some .1 s on one core, and 1 µs per sphere: for a picture that someone waits for.
    Quick,
    /// As long as the best tree takes: up to 20 times as long.
    Thorough,
}

/// The nodes, root first, and the order of the spheres.
#[derive(Clone, Debug)]
pub struct Hierarchy<R> {
    pub nodes: Vec<Node<R>>,
    /// Largest absolute coordinate of any box, which bounds the rounding error.
    pub extent: R,
    /// Each sphere's place in the list, in leaf order. At equal distance, the first in the list is hit.
    pub ranks: Vec<u32>,
}

impl<R: Real> Hierarchy<R> {
    /// Builds the hierarchy over at least one sphere, with coordinates relative to `origin`.
    pub fn build<'a>(spheres: impl IntoIterator<Item = &'a Sphere>, origin: DVec3, effort: Effort) -> Self {
        Hierarchy::build_unless(&AtomicBool::new(false), spheres, origin, effort)
    }

    /// Like [`Hierarchy::build`], but once `cancel` is set it hurries, and the hierarchy is poor.
    pub fn build_unless<'a>(
        cancel: &AtomicBool,
        spheres: impl IntoIterator<Item = &'a Sphere>,
        origin: DVec3,
        effort: Effort,
    ) -> Self {
        let fits = |tree: &Bvh2| depth(&tree.nodes) <= DEPTH_LIMIT;
        let spheres = Bounded::all(spheres, &origin);
        let tree = build_tree(&spheres, Leaves::of(spheres.len()), effort, in_walking_order, fits, cancel);
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

/// Builds a tree over at least one sphere: with obvhs, unless that would take long for these spheres or give more
/// levels than a traversal supports. Once `cancel` is set, any valid tree will do; obvhs itself cannot be interrupted.
pub(super) fn build_tree<T>(
    spheres: &[Bounded<'_>],
    leaves: Leaves,
    effort: Effort,
    lay_out: impl Fn(Bvh2) -> T,
    fits: impl Fn(&T) -> bool,
    cancel: &AtomicBool,
) -> T {
    if !parted::is_crowded(spheres) && !cancel.load(Ordering::Relaxed) {
        let params = params(spheres.len(), leaves, effort);
        let tree = lay_out(build_bvh2(spheres, params, &mut Duration::default()));
        if fits(&tree) {
            return tree;
        }
    }
    let top_down = |halved| lay_out(parted::build(spheres, leaves.most as usize, halved, cancel));
    let tree = top_down(false);
    if fits(&tree) {
        return tree;
    }
    let tree = top_down(true);
    // Halving gives about as many levels as the number of spheres has bits.
    assert!(fits(&tree) || cancel.load(Ordering::Relaxed), "the hierarchy has too many levels");
    tree
}

/// Reorders nodes and spheres depth-first, so that consecutive visits are close together in memory.
fn in_walking_order(mut tree: Bvh2) -> Bvh2 {
    tree.reorder_in_stack_traversal_order();
    let mut ordered = Vec::with_capacity(tree.primitive_indices.len());
    for node in tree.nodes.iter_mut().filter(|node| node.is_leaf()) {
        let first = node.first_index as usize;
        node.first_index = ordered.len() as u32;
        ordered.extend_from_slice(&tree.primitive_indices[first..first + node.prim_count as usize]);
    }
    tree.primitive_indices = ordered;
    tree
}

/// Nodes on the longest path from the root to a leaf.
fn depth(nodes: &[Bvh2Node]) -> usize {
    let mut deepest = 0;
    let mut open = vec![(0_usize, 1_usize)];
    while let Some((index, depth)) = open.pop() {
        deepest = deepest.max(depth);
        if !nodes[index].is_leaf() {
            let first = nodes[index].first_index as usize;
            open.extend([(first, depth + 1), (first + 1, depth + 1)]);
        }
    }
    deepest
}

impl<R> Hierarchy<R> {
    /// Whether a thorough build is worth its time if this many spheres are traced for long.
    pub fn is_improvable(&self) -> bool {
        IMPROVABLE.contains(&self.ranks.len())
    }
}

/// obvhs's build parameters for this many spheres.
fn params(spheres: usize, leaves: Leaves, effort: Effort) -> BvhBuildParams {
    let preset = match (spheres, effort) {
        (0..=1_000, _) => BvhBuildParams::medium_build(),
        (1_001..=20_000, _) | (_, Effort::Thorough) => BvhBuildParams::very_slow_build(),
        (20_001..=200_000, Effort::Quick) => BvhBuildParams::slow_build(),
        (_, Effort::Quick) => BvhBuildParams::fast_build(),
    };
    // A split box would list its sphere twice.
    BvhBuildParams {
        pre_split: false,
        max_prims_per_leaf: leaves.most,
        collapse_traversal_cost: leaves.visit_cost,
        ..preset
    }
}

/// The axis along which two sibling boxes are farthest apart, in bits 30 and 31. Bit 29 is set if the second box comes
/// before the first on that axis.
fn parting_axis(nodes: &[Bvh2Node], first: usize) -> u32 {
    let apart = nodes[first + 1].aabb().center() - nodes[first].aabb().center();
    let size = apart.abs();
    let axis = (0..3).max_by(|a, b| size[*a].total_cmp(&size[*b])).unwrap_or(0);
    (2 * axis as u32 + u32::from(apart[axis] < 0.0)) << ORDER_SHIFT
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn too_deep_tree_is_halved() {
        // Each sphere is twice as far away as the one before, so any split that pays leaves most of them together.
        let far = |place: i32| 2_f64.powi(place);
        let sphere = |place| Sphere { center: DVec3::X * far(place), radius: 0.1 * far(place), material: 0 };
        let spheres: Vec<Sphere> = (0..64).map(sphere).collect();
        let bounded = Bounded::all(&spheres, &DVec3::ZERO);
        const LEVELS: usize = 7;
        let go_on = AtomicBool::new(false);
        assert!(depth(&parted::build(&bounded, 1, false, &go_on).nodes) > LEVELS);
        let fits = |tree: &Bvh2| depth(&tree.nodes) <= LEVELS;
        let tree = build_tree(&bounded, Leaves::SINGLE, Effort::Quick, |tree| tree, fits, &go_on);
        assert_eq!(depth(&tree.nodes), LEVELS);
        let mut order = tree.primitive_indices;
        order.sort_unstable();
        assert!(order.into_iter().eq(0..64), "each sphere is in it once");
    }
}
