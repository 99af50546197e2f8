//! The GPU's hierarchy, with eight children per node. obvhs builds the tree and orders the children of a node by octant.
//! (Ylitie, Karras and Laine 2017, "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs".) Its boxes
//! are compressed to 8 bits per bound; this module computes boxes that are not, because the GPU decodes for longer than
//! it reads.

use super::bounded::Bounded;
use super::hierarchy::{Effort, Leaves, build_tree};
use crate::kernel::WIDE_STACK_SIZE;
use crate::scene::Sphere;
use glam::DVec3;
use obvhs::Boundable;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::cwbvh::bvh2_to_cwbvh::bvh2_to_cwbvh;
use obvhs::cwbvh::node::CwBvhNode;
use std::sync::atomic::AtomicBool;

/// Most spheres in a leaf: a node's marks have room for 3.
const LEAF_SPHERES: u32 = 3;

/// Most levels of a tree, limited by the traversal's stack.
pub const DEPTH_LIMIT: usize = WIDE_STACK_SIZE;

/// Rows of four words in a node. Twin: `NODE_ROWS` in shaders/bvh.wgsl.
pub const NODE_ROWS: usize = 16;

/// A wide hierarchy, root first.
#[derive(Clone, Debug)]
pub struct WideBvh {
    /// Children come after their parents. The compressed boxes are not used.
    nodes: Vec<CwBvhNode>,
    /// The boxes of each node's children.
    boxes: Vec<[Aabb; 8]>,
    /// The sphere index at each place in leaf order.
    pub order: Vec<u32>,
}

impl WideBvh {
    /// Builds the hierarchy over at least one sphere, with coordinates relative to `origin`.
    pub fn build<'a>(spheres: impl IntoIterator<Item = &'a Sphere>, origin: DVec3) -> Self {
        let bounded = Bounded::all(spheres, &origin);
        let wide = |tree: Bvh2| {
            let wide = bvh2_to_cwbvh(&tree, LEAF_SPHERES, true, false);
            WideBvh { nodes: wide.nodes, boxes: Vec::new(), order: wide.primitive_indices }
        };
        let fits = |built: &WideBvh| built.depth() <= DEPTH_LIMIT;
        let mut built =
            build_tree(&bounded, Leaves::SINGLE, Effort::Quick, wide, fits, &AtomicBool::new(false));
        let boxes: Vec<Aabb> = built.order.iter().map(|index| bounded[*index as usize].aabb()).collect();
        built.set_boxes(&boxes);
        #[cfg(test)]
        assert_eq!(built.validate(&bounded), Ok(()));
        built
    }

    /// Number of nodes.
    pub fn node_count(&self) -> usize {
        self.nodes.len()
    }

    /// The nodes as rows of four words. Rows 0 to 11 hold the bounds of children 0 to 3 and 4 to 7,
    /// lower then upper, along x, y and z. Rows 12 and 13 hold the bits that each child adds to a mask of hits. Row 14
    /// holds the first child, the first sphere, and which children are nodes; row 15 is padding.
    pub fn rows(&self) -> Vec<[u32; 4]> {
        let mut rows = Vec::with_capacity(NODE_ROWS * self.nodes.len());
        for (node, boxes) in self.nodes.iter().zip(&self.boxes) {
            let mut own = [[0; 4]; NODE_ROWS];
            for child in (0..8).filter(|child| !node.is_child_empty(*child)) {
                let (four, column) = (child / 4, child % 4);
                for axis in 0..3 {
                    own[4 * axis + four][column] = boxes[child].min[axis].to_bits();
                    own[4 * axis + 2 + four][column] = boxes[child].max[axis].to_bits();
                }
                let mark = u32::from(node.child_meta[child]);
                own[12 + four][column] = (mark >> 5) << (mark & 31);
            }
            own[14] = [node.child_base_idx, node.primitive_base_idx, u32::from(node.imask), 0];
            rows.extend(own);
        }
        rows
    }

    /// Computes all boxes from those of the spheres, given in leaf order.
    fn set_boxes(&mut self, spheres: &[Aabb]) {
        let mut boxes = vec![Aabb::empty(); self.nodes.len()];
        self.boxes = vec![[Aabb::empty(); 8]; self.nodes.len()];
        for index in (0..self.nodes.len()).rev() {
            let node = &self.nodes[index];
            let children: [Aabb; 8] = std::array::from_fn(|child| {
                if node.is_child_empty(child) {
                    Aabb::empty()
                } else if node.is_leaf(child) {
                    let (first, count) = node.child_primitives(child);
                    united(&spheres[first as usize..(first + count) as usize])
                } else {
                    boxes[node.child_node_index(child) as usize]
                }
            });
            boxes[index] = united(&children);
            self.boxes[index] = children;
        }
    }

    /// Nodes on the longest path from the root to a leaf.
    pub fn depth(&self) -> usize {
        let mut depths = vec![1; self.nodes.len()];
        for (index, node) in self.nodes.iter().enumerate() {
            for child in (0..8).filter(|child| !node.is_leaf(*child)) {
                depths[node.child_node_index(child) as usize] = depths[index] + 1;
            }
        }
        depths.into_iter().max().unwrap_or(0)
    }
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
        /// leaf and inside all boxes around that leaf.
        pub(super) fn validate(&self, spheres: &[Bounded<'_>]) -> Result<(), String> {
            let (mut is_reached, mut is_held) = (vec![false; self.nodes.len()], vec![false; spheres.len()]);
            // Every node, with the boxes that enclose it.
            let mut open = vec![(0_u32, Vec::new())];
            while let Some((index, around)) = open.pop() {
                let Some(node) = self.nodes.get(index as usize) else {
                    return Err(format!("node {index} is named, but there are {}", self.nodes.len()));
                };
                if std::mem::replace(&mut is_reached[index as usize], true) {
                    return Err(format!("node {index} has two parents"));
                }
                for child in (0..8).filter(|child| !node.is_child_empty(*child)) {
                    let mut around: Vec<Aabb> = around.clone();
                    around.push(self.boxes[index as usize][child]);
                    if !node.is_leaf(child) {
                        let child = node.child_node_index(child);
                        if child <= index {
                            return Err(format!(
                                "node {index} has the child {child}, which is not behind it"
                            ));
                        }
                        open.push((child, around));
                        continue;
                    }
                    let (first, count) = node.child_primitives(child);
                    for place in first..first + count {
                        let number = self.order.get(place as usize).copied().unwrap_or(u32::MAX);
                        let Some(sphere) = spheres.get(number as usize) else {
                            return Err(format!("node {index} names sphere {number} of {}", spheres.len()));
                        };
                        if std::mem::replace(&mut is_held[number as usize], true) {
                            return Err(format!("sphere {number} is in two leaves"));
                        }
                        let (center, radius) = (sphere.center(), sphere.radius());
                        let is_within = |around: &Aabb| {
                            around.min.as_dvec3().cmplt(center - radius).all()
                                && around.max.as_dvec3().cmpgt(center + radius).all()
                        };
                        if !around.iter().all(is_within) {
                            return Err(format!("sphere {number} reaches out of a box around node {index}"));
                        }
                    }
                }
            }
            match (is_reached.iter().position(|is| !is), is_held.iter().position(|is| !is)) {
                (Some(node), _) => Err(format!("node {node} has no parent")),
                (_, Some(sphere)) => Err(format!("sphere {sphere} is in no leaf")),
                (None, None) => Ok(()),
            }
        }
    }

    fn check(spheres: &[Sphere]) {
        let built = WideBvh::build(spheres, DVec3::ZERO);
        assert_eq!(built.validate(&Bounded::all(spheres, &DVec3::ZERO)), Ok(()));
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

    #[test]
    fn rows_hold_boxes_marks_and_links() {
        let built = WideBvh::build(&field(3000).0.spheres, DVec3::ZERO);
        let rows = built.rows();
        assert_eq!(rows.len(), NODE_ROWS * built.nodes.len());
        for ((node, boxes), rows) in built.nodes.iter().zip(&built.boxes).zip(rows.chunks_exact(NODE_ROWS)) {
            assert_eq!(rows[14][..3], [node.child_base_idx, node.primitive_base_idx, u32::from(node.imask)]);
            for child in (0..8).filter(|child| !node.is_child_empty(*child)) {
                let (four, column) = (child / 4, child % 4);
                let mark = u32::from(node.child_meta[child]);
                assert_eq!(rows[12 + four][column], (mark >> 5) << (mark & 31));
                let bound =
                    |row: usize| [0, 4, 8].map(|axis| f32::from_bits(rows[row + axis + four][column]));
                let aabb = &boxes[child];
                assert_eq!([bound(0), bound(2)], [aabb.min.to_array(), aabb.max.to_array()]);
            }
        }
    }
}
