//! A bounding volume hierarchy over many spheres.
//!
//! obvhs builds the trees of its regions. This module joins and lays them out for the kernels and widens their boxes, so
//! that rounding never hides a hit that testing every sphere would find.

use super::bounded::Bounded;
use super::effort::Leaves;
use super::regions::{Forest, Method};
use super::wide_bvh::WideBvh;
use crate::kernel::{Node, ORDER_SHIFT, Real, STACK_SIZE};
use crate::scene::Sphere;
use glam::DVec3;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::node::Bvh2Node;
use std::ops::RangeInclusive;
use std::sync::atomic::AtomicBool;

pub use super::effort::Effort;

/// Maximum number of levels of a tree, limited by the traversal's stack.
pub const DEPTH_LIMIT: usize = STACK_SIZE;

/// Numbers of spheres for which a thorough build beats a quick one and fits time and memory.
const IMPROVABLE: RangeInclusive<usize> = 20_001..=4_000_000;

/// The nodes, and the order of the spheres.
#[derive(Clone, Debug)]
pub struct Hierarchy<R> {
    /// The nodes for the CPU, root first. Empty in a hierarchy for the GPU.
    pub nodes: Vec<Node<R>>,
    /// The nodes for the GPU; `None` in a hierarchy for the CPU.
    pub wide: Option<WideBvh>,
    /// Largest absolute coordinate of any box, which bounds the rounding error.
    pub extent: R,
    /// Each sphere's place in the list, in leaf order. At equal distance, the first in the list is hit.
    pub ranks: Vec<u32>,
}

/// A region's tree, its spheres' places in the list in leaf order, and its number of levels.
struct Region {
    nodes: Vec<Bvh2Node>,
    ranks: Vec<u32>,
    depth: usize,
}

impl<R: Real> Hierarchy<R> {
    /// Builds the hierarchy over at least one sphere, with coordinates relative to `origin`.
    pub fn build<'a>(spheres: impl IntoIterator<Item = &'a Sphere>, origin: DVec3, effort: Effort) -> Self {
        #[expect(clippy::expect_used, reason = "nothing cancels it")]
        Hierarchy::build_unless(&AtomicBool::new(false), spheres, origin, effort)
            .expect("it is not cancelled")
    }

    /// As [`Hierarchy::build`]. Returns `None` soon after `cancel` is set.
    pub fn build_unless<'a>(
        cancel: &AtomicBool,
        spheres: impl IntoIterator<Item = &'a Sphere>,
        origin: DVec3,
        effort: Effort,
    ) -> Option<Self> {
        let spheres = Bounded::all(spheres, &origin);
        let region = |tree: Bvh2, _: &[Aabb], places: &[u32]| {
            let Bvh2 { nodes, primitive_indices, .. } = in_walking_order(tree);
            let ranks = primitive_indices.iter().map(|index| places[*index as usize]).collect();
            Region { depth: depth(&nodes), nodes, ranks }
        };
        for method in Method::ALL {
            let leaves = Leaves::of(spheres.len());
            let forest = Forest::build(&spheres, leaves, effort, method, cancel, region)?;
            let (joined, depth) = Hierarchy::joined(forest);
            // Halving gives about as many levels as the number of spheres has bits.
            assert!(depth <= DEPTH_LIMIT || method != Method::Halved, "the hierarchy has too many levels");
            if depth <= DEPTH_LIMIT {
                return Some(joined);
            }
        }
        None
    }

    /// The tree above the regions, with theirs in place of its leaves, and the number of levels.
    fn joined(Forest { trees, top }: Forest<Region>) -> (Self, usize) {
        let top = in_walking_order(top);
        let node_count: usize = trees.iter().map(|region| region.nodes.len() - 1).sum();
        let mut nodes = Vec::with_capacity(top.nodes.len() + node_count);
        let mut ranks = Vec::with_capacity(trees.iter().map(|region| region.ranks.len()).sum());
        let (mut rest, mut deepest) = (top.nodes.len() as u32, 0);
        let levels = levels(&top.nodes);
        // How far the nodes of each region, except its root, and its spheres move.
        let mut shifts = Vec::with_capacity(trees.len());
        for (node, level) in top.nodes.iter().zip(levels) {
            if !node.is_leaf() {
                nodes.push(converted(node, &top.nodes, [0, 0]));
                continue;
            }
            let region = &trees[top.primitive_indices[node.first_index as usize] as usize];
            let shift = [rest - 1, ranks.len() as u32];
            nodes.push(converted(&region.nodes[0], &region.nodes, shift));
            shifts.push((region, shift));
            ranks.extend_from_slice(&region.ranks);
            rest += region.nodes.len() as u32 - 1;
            deepest = deepest.max(level + region.depth - 1);
        }
        for (region, shift) in shifts {
            nodes.extend(region.nodes[1..].iter().map(|node| converted(node, &region.nodes, shift)));
        }
        (Hierarchy { nodes, wide: None, extent: extent(top.nodes[0].aabb()), ranks }, deepest)
    }

    /// A hierarchy for the GPU: see [`Hierarchy::build_unless`].
    pub fn build_wide<'a>(
        cancel: &AtomicBool,
        spheres: impl IntoIterator<Item = &'a Sphere>,
        origin: DVec3,
    ) -> Option<Self> {
        let (mut wide, whole) = WideBvh::build_unless(cancel, spheres, origin)?;
        let ranks = std::mem::take(&mut wide.order);
        Some(Hierarchy { nodes: Vec::new(), wide: Some(wide), extent: extent(&whole), ranks })
    }
}

/// The largest absolute coordinate of a box.
fn extent<R: Real>(whole: &Aabb) -> R {
    R::from_f64(f64::from(whole.min.abs().max(whole.max.abs()).max_element()))
}

/// A node among `siblings` for the kernel, with its children and spheres this much further back.
fn converted<R: Real>(node: &Bvh2Node, siblings: &[Bvh2Node], [nodes, spheres]: [u32; 2]) -> Node<R> {
    let corner = |v: glam::Vec3A| v.to_array().map(|x| R::from_f64(f64::from(x)));
    let (shift, axis) = match node.is_leaf() {
        true => (spheres, 0),
        false => (nodes, parting_axis(siblings, node.first_index as usize)),
    };
    Node {
        low: corner(node.aabb().min),
        first: node.first_index + shift,
        high: corner(node.aabb().max),
        count: node.prim_count | axis,
    }
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
    levels(nodes).into_iter().max().unwrap_or(0)
}

/// Nodes on the path from the root to each node, itself included. Children come after their parents.
fn levels(nodes: &[Bvh2Node]) -> Vec<usize> {
    let mut levels = vec![1; nodes.len()];
    for (index, node) in nodes.iter().enumerate().filter(|(_, node)| !node.is_leaf()) {
        for child in [0, 1] {
            levels[node.first_index as usize + child] = levels[index] + 1;
        }
    }
    levels
}

impl<R> Hierarchy<R> {
    /// Whether a thorough build is worth its time if this many spheres are traced for long.
    pub fn is_improvable(&self) -> bool {
        IMPROVABLE.contains(&self.ranks.len())
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
    use crate::prepared::parted;

    #[test]
    fn too_deep_tree_is_halved() {
        // Each sphere is twice as far away as the one before, so any split that pays leaves most of them together.
        let far = |place: i32| 2_f64.powi(place);
        let sphere = |place| Sphere { center: DVec3::X * far(place), radius: 0.1 * far(place), material: 0 };
        let spheres: Vec<Sphere> = (0..80).map(sphere).collect();
        let bounded = Bounded::all(&spheres, &DVec3::ZERO);
        let go_on = AtomicBool::new(false);
        let tree = in_walking_order(parted::build(&bounded, 1, false, &go_on));
        assert!(depth(&tree.nodes) > 8, "{}", depth(&tree.nodes));
        let tree = in_walking_order(parted::build(&bounded, 1, true, &go_on));
        assert_eq!(depth(&tree.nodes), 8);
    }
}
