//! The GPU's hierarchy, with eight children per node. obvhs builds the tree and orders the children of a node by octant.
//! (Ylitie, Karras and Laine 2017, "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs".) Its boxes
//! are compressed to 8 bits per bound; this module computes boxes in full precision, because decoding takes the GPU
//! longer than reading.

use super::bounded::Bounded;
use super::effort::{Effort, Leaves};
use super::regions::{Forest, Method};
use crate::kernel::WIDE_STACK_SIZE;
use crate::scene::Sphere;
use glam::DVec3;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::cwbvh::CwBvh;
use obvhs::cwbvh::bvh2_to_cwbvh::bvh2_to_cwbvh;
use obvhs::cwbvh::node::CwBvhNode;
use std::sync::atomic::AtomicBool;

/// Maximum number of spheres in a leaf: a node's marks have room for 3.
const LEAF_SPHERES: u32 = 3;

/// Maximum number of levels of a tree, limited by the traversal's stack.
pub const DEPTH_LIMIT: usize = WIDE_STACK_SIZE;

/// Rows of four words in a node. Twin: `NODE_ROWS` in shaders/bvh.wgsl.
///
/// Rows 0 to 11 hold the bounds of children 0 to 3 and 4 to 7, lower then upper, along x, y and z. Rows 12 and 13 hold
/// the bits that each child adds to a mask of hits. Row 14 holds the first child, the first sphere, and which children
/// are nodes; row 15 is padding.
pub const NODE_ROWS: usize = 16;

type NodeRows = [[u32; 4]; NODE_ROWS];

/// The row of a node that holds its links.
const LINKS: usize = 14;

/// A wide hierarchy.
#[derive(Clone, Debug)]
pub struct WideBvh {
    /// The nodes, root first. Children come after their parents.
    pub nodes: Vec<NodeRows>,
    /// The sphere index at each place in leaf order.
    pub order: Vec<u32>,
    /// Nodes on the longest path from the root to a leaf.
    pub depth: usize,
}

impl WideBvh {
    /// Builds the hierarchy over at least one sphere, with coordinates relative to `origin`. Also returns the box around
    /// all. Returns `None` soon after `cancel` is set.
    pub fn build_unless<'a>(
        cancel: &AtomicBool,
        spheres: impl IntoIterator<Item = &'a Sphere>,
        origin: DVec3,
    ) -> Option<(Self, Aabb)> {
        let bounded = Bounded::all(spheres, &origin);
        for method in Method::ALL {
            let forest =
                Forest::build(&bounded, Leaves::SINGLE, Effort::Quick, method, cancel, WideBvh::region)?;
            let whole = *forest.top.nodes[0].aabb();
            let built = WideBvh::joined(forest);
            // Halving gives about as many levels as the number of spheres has bits.
            assert!(
                built.depth <= DEPTH_LIMIT || method != Method::Halved,
                "the hierarchy has too many levels"
            );
            if built.depth <= DEPTH_LIMIT {
                #[cfg(test)]
                built.validate(&bounded);
                return Some((built, whole));
            }
        }
        None
    }

    /// The hierarchy of a region, whose spheres have these boxes and these places in the list.
    fn region(tree: Bvh2, spheres: &[Aabb], places: &[u32]) -> WideBvh {
        let CwBvh { nodes, primitive_indices, .. } = bvh2_to_cwbvh(&tree, LEAF_SPHERES, true, false);
        let spheres: Vec<Aabb> = primitive_indices.iter().map(|index| spheres[*index as usize]).collect();
        let (mut around, mut depths) = (vec![Aabb::empty(); nodes.len()], vec![1; nodes.len()]);
        let mut rows = vec![[[0; 4]; NODE_ROWS]; nodes.len()];
        for (index, node) in nodes.iter().enumerate().rev() {
            let children: [Aabb; 8] = std::array::from_fn(|child| {
                if node.is_child_empty(child) {
                    Aabb::empty()
                } else if node.is_leaf(child) {
                    let (first, count) = node.child_primitives(child);
                    united(&spheres[first as usize..(first + count) as usize])
                } else {
                    let child = node.child_node_index(child) as usize;
                    depths[index] = depths[index].max(1 + depths[child]);
                    around[child]
                }
            });
            around[index] = united(&children);
            rows[index] = rows_of(node, &children);
        }
        let order = primitive_indices.iter().map(|index| places[*index as usize]).collect();
        WideBvh { nodes: rows, order, depth: depths[0] }
    }

    /// The nodes above the regions, with theirs in place of its leaves.
    fn joined(Forest { trees, top }: Forest<WideBvh>) -> Self {
        if let [_] = trees.as_slice() {
            return trees.into_iter().next().unwrap_or_else(|| unreachable!("there is one"));
        }
        let count = |count: fn(&WideBvh) -> usize| trees.iter().map(count).sum::<usize>();
        let (node_count, sphere_count) = (count(|tree| tree.nodes.len()), count(|tree| tree.order.len()));
        let mut trees: Vec<Option<WideBvh>> = trees.into_iter().map(Some).collect();
        let above = bvh2_to_cwbvh(&top, 1, true, false);
        let mut nodes: Vec<NodeRows> = Vec::with_capacity(node_count + above.nodes.len());
        nodes.push([[0; 4]; NODE_ROWS]);
        let mut order = Vec::with_capacity(sphere_count);
        let mut depth = 0;
        // Nodes above the regions, each with its place and level.
        let mut open = vec![(0, 0_usize, 1)];
        let mut placed = Vec::new();
        while let Some((index, place, level)) = open.pop() {
            let mut node: CwBvhNode = above.nodes[index as usize];
            let first = nodes.len();
            let children: Vec<usize> = (0..8).filter(|child| !node.is_child_empty(*child)).collect();
            nodes.resize(first + children.len(), [[0; 4]; NODE_ROWS]);
            let mut places = [None; 8];
            for (child, place) in children.into_iter().zip(first..) {
                places[child] = Some(place);
                if !node.is_leaf(child) {
                    open.push((node.child_node_index(child), place, level + 1));
                    continue;
                }
                let (leaf, _) = node.child_primitives(child);
                let region = above.primitive_indices[leaf as usize] as usize;
                let Some(tree) = trees[region].take() else { continue };
                let shift = [nodes.len() as u32 - 1, order.len() as u32];
                let mut shifted = tree.nodes.into_iter().map(|mut rows| {
                    rows[LINKS][0] += shift[0];
                    rows[LINKS][1] += shift[1];
                    rows
                });
                nodes[place] = shifted.next().unwrap_or_default();
                nodes.extend(shifted);
                order.extend(tree.order);
                depth = depth.max(level + tree.depth);
            }
            // All its children are nodes now.
            for child in (0..8).filter(|child| places[*child].is_some()) {
                node.imask |= 1 << child;
                node.child_meta[child] = 0b0010_0000 | (24 + child as u8);
            }
            (node.child_base_idx, node.primitive_base_idx) = (first as u32, 0);
            placed.push((place, node, places));
        }
        // Parents have been placed before their children.
        for (place, node, children) in placed.into_iter().rev() {
            let around = children
                .map(|child| child.map_or_else(Aabb::empty, |place: usize| united(&boxes_of(&nodes[place]))));
            nodes[place] = rows_of(&node, &around);
        }
        WideBvh { nodes, order, depth }
    }
}

/// A node as the GPU reads it, with the boxes of its children.
fn rows_of(node: &CwBvhNode, boxes: &[Aabb; 8]) -> NodeRows {
    let mut rows = [[0; 4]; NODE_ROWS];
    for child in (0..8).filter(|child| !node.is_child_empty(*child)) {
        let (four, column) = (child / 4, child % 4);
        for axis in 0..3 {
            rows[4 * axis + four][column] = boxes[child].min[axis].to_bits();
            rows[4 * axis + 2 + four][column] = boxes[child].max[axis].to_bits();
        }
        let mark = u32::from(node.child_meta[child]);
        rows[12 + four][column] = (mark >> 5) << (mark & 31);
    }
    rows[LINKS] = [node.child_base_idx, node.primitive_base_idx, u32::from(node.imask), 0];
    rows
}

/// The boxes of a node's children; those of children that it lacks are empty.
fn boxes_of(rows: &NodeRows) -> [Aabb; 8] {
    std::array::from_fn(|child| {
        let (four, column) = (child / 4, child % 4);
        let corner = |row: usize| {
            glam::Vec3A::from([0, 4, 8].map(|axis| f32::from_bits(rows[row + axis + four][column])))
        };
        if rows[12 + four][column] == 0 { Aabb::empty() } else { Aabb::new(corner(0), corner(2)) }
    })
}

fn united(boxes: &[Aabb]) -> Aabb {
    boxes.iter().fold(Aabb::empty(), |all, one| all.union(one))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::builtin::field;

    impl WideBvh {
        /// Checks what traversals rely on: each node has one parent, which comes before it; each of the `spheres` is in one
        /// leaf and inside all boxes around that leaf; no path is longer than stated.
        pub(super) fn validate(&self, spheres: &[Bounded<'_>]) {
            let (mut is_reached, mut is_held) = (vec![false; self.nodes.len()], vec![false; spheres.len()]);
            // Every node, with the boxes that enclose it.
            let mut open = vec![(0_u32, Vec::new())];
            while let Some((index, around)) = open.pop() {
                let rows = &self.nodes[index as usize];
                let is_again = std::mem::replace(&mut is_reached[index as usize], true);
                assert!(!is_again && around.len() < self.depth, "node {index}: two parents, or too deep");
                let [first_child, first_sphere, which_are_nodes, _] = rows[LINKS];
                for (child, own) in boxes_of(rows).into_iter().enumerate() {
                    let mark = rows[12 + child / 4][child % 4];
                    if mark == 0 {
                        continue;
                    }
                    let mut around: Vec<Aabb> = around.clone();
                    around.push(own);
                    let is_node = which_are_nodes >> child & 1 == 1;
                    assert_eq!(
                        is_node,
                        mark == 1 << (24 + child),
                        "child {child} of node {index}: {mark:#x}"
                    );
                    if is_node {
                        let before = (which_are_nodes & ((1 << child) - 1)).count_ones();
                        assert!(first_child + before > index, "child {child} is not behind node {index}");
                        open.push((first_child + before, around));
                        continue;
                    }
                    let first = first_sphere + mark.trailing_zeros();
                    for place in first..first + mark.count_ones() {
                        let number = self.order[place as usize] as usize;
                        let is_again = std::mem::replace(&mut is_held[number], true);
                        assert!(!is_again, "sphere {number} is in two leaves");
                        let (center, radius) = (spheres[number].center(), spheres[number].radius());
                        let is_within = |around: &Aabb| {
                            around.min.as_dvec3().cmplt(center - radius).all()
                                && around.max.as_dvec3().cmpgt(center + radius).all()
                        };
                        assert!(around.iter().all(is_within), "sphere {number} is out of a box of {index}");
                    }
                }
            }
            assert!(is_reached.into_iter().chain(is_held).all(|is| is), "a node or a sphere is not reached");
        }
    }

    fn check(spheres: &[Sphere]) {
        let (built, whole) = WideBvh::build_unless(&AtomicBool::new(false), spheres, DVec3::ZERO)
            .expect("it is not cancelled");
        built.validate(&Bounded::all(spheres, &DVec3::ZERO));
        let root = united(&boxes_of(&built.nodes[0]));
        assert_eq!([root.min, root.max], [whole.min, whole.max]);
    }

    #[test]
    fn boxes_hold_their_spheres() {
        check(&field(3000).0.spheres);
        check(&field(3000).0.spheres[5..6]);
        for scale in [1e-9, 1e6, 1e12] {
            let mut spheres = field(500).0.spheres;
            for sphere in &mut spheres {
                sphere.center = sphere.center * scale + DVec3::X * 3e3 * scale;
                sphere.radius *= scale;
            }
            check(&spheres);
        }
        // All spheres at the same place.
        check(&[field(1).0.spheres[0]; 40]);
    }
}
