//! A scene's spheres, shading records and hierarchy, in the order in which the kernel reads them.

use super::HierarchyKind;
use super::layout::{GpuCwbvhNode, GpuJob};
use crate::job::render::RenderJob;
use crate::kernel::{AnchoredSphere, CWBVH_STACK_SIZE, RECORD_COLUMNS, words_of};
use crate::prepared::PreparedScene;
use crate::prepared::wide_bvh::WideBvh;
use std::borrow::Cow;

/// The contents of a scene's buffers.
pub struct SceneData {
    /// Centre and squared radius of each sphere.
    pub spheres: Vec<[f32; 4]>,
    /// The shading record of each sphere, huge ones last.
    pub records: Vec<[f32; RECORD_COLUMNS]>,
    /// The index in the scene of each sphere.
    pub scene_index: Vec<u32>,
    /// The hierarchy's nodes, followed by each sphere's place in the list; not empty, as the shader's type requires.
    pub nodes: Vec<[u32; 4]>,
    /// Number of nodes.
    pub node_count: u32,
}

impl SceneData {
    /// Collects the data of a scene, with a hierarchy of the given kind if the prepared scene has one.
    ///
    /// # Errors
    /// If the hierarchy has more levels than a traversal supports.
    pub fn new(job: &RenderJob, prepared: &PreparedScene<f32>, kind: HierarchyKind) -> Result<Self, String> {
        let mut data = SceneData {
            spheres: prepared.opaque.iter().chain(&prepared.two_root).copied().collect(),
            records: prepared.records.iter().map(|row| row.0).collect(),
            scene_index: prepared.scene_index.clone(),
            nodes: vec![[0; 4]],
            node_count: 0,
        };
        let Some(hierarchy) = &prepared.hierarchy else { return Ok(data) };
        let depth = data.take_hierarchy(job, prepared, &hierarchy.ranks, kind);
        if depth > CWBVH_STACK_SIZE {
            return Err(format!(
                "the hierarchy has {depth} levels, but the kernel has room for {CWBVH_STACK_SIZE}; render this scene on the CPU"
            ));
        }
        Ok(data)
    }

    /// The bytes of the buffers of group 0, by binding, with the names of their contents.
    pub fn buffers(&self, prepared: &PreparedScene<f32>) -> [(&'static str, Cow<'_, [u8]>); 5] {
        let bytes = |words: Vec<u32>| Cow::Owned(bytemuck::cast_slice(&words).to_vec());
        let anchored = match prepared.anchored.as_slice() {
            // The shader's type requires an element.
            [] => words_of(&[AnchoredSphere::<f32>::default()]),
            anchored => words_of(anchored),
        };
        [
            ("job", bytes(words_of(&[GpuJob::new(prepared, self.node_count)]))),
            ("spheres", Cow::Borrowed(bytemuck::cast_slice(&self.spheres))),
            ("anchored spheres", bytes(anchored)),
            ("records", Cow::Borrowed(bytemuck::cast_slice(&self.records))),
            ("nodes", Cow::Borrowed(bytemuck::cast_slice(&self.nodes))),
        ]
    }

    /// Builds the hierarchy, puts spheres and records in the order of its leaves, and returns its depth.
    fn take_hierarchy(
        &mut self,
        job: &RenderJob,
        prepared: &PreparedScene<f32>,
        ranks: &[u32],
        kind: HierarchyKind,
    ) -> usize {
        let built = WideBvh::build(prepared.spheres_of_hierarchy(job), prepared.origin);
        self.spheres = built.order.iter().map(|i| self.spheres[*i as usize]).collect();
        let records: Vec<_> = built.order.iter().map(|i| self.records[*i as usize]).collect();
        self.records[..records.len()].copy_from_slice(&records);
        let scene_index: Vec<u32> = built.order.iter().map(|i| self.scene_index[*i as usize]).collect();
        self.scene_index[..scene_index.len()].copy_from_slice(&scene_index);
        self.node_count = built.nodes.len() as u32;
        self.nodes = match kind {
            HierarchyKind::Whole => built.whole_nodes(),
            HierarchyKind::Compressed => {
                let nodes: Vec<GpuCwbvhNode> = built.nodes.iter().map(Into::into).collect();
                bytemuck::cast_slice(&nodes).to_vec()
            }
        };
        let ranks: Vec<u32> = built.order.iter().map(|place| ranks[*place as usize]).collect();
        self.nodes.extend(ranks.chunks(4).map(|four| {
            let mut places = [0; 4];
            places[..four.len()].copy_from_slice(four);
            places
        }));
        built.depth()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::job::recipe::Recipe;

    #[test]
    fn each_sphere_has_its_record_and_its_rank() {
        let job = Recipe::find("field:500").unwrap().job().unwrap();
        let prepared = PreparedScene::<f32>::new(&job);
        let ranks_in_the_scene = |kind, rows_of_a_node: usize| {
            let data = SceneData::new(&job, &prepared, kind).unwrap();
            for (sphere, record) in data.spheres.iter().zip(&data.records) {
                assert_eq!(sphere[..3], record[..3], "the centre");
            }
            let count = data.node_count as usize;
            let ranks: Vec<u32> = data.nodes[rows_of_a_node * count..].concat();
            // They fill whole rows of four.
            assert_eq!(ranks.len(), data.spheres.len().next_multiple_of(4));
            let mut ranks: Vec<(u32, u32)> = data.scene_index.iter().copied().zip(ranks).collect();
            ranks.truncate(data.spheres.len());
            ranks.sort_unstable();
            ranks
        };
        let whole = ranks_in_the_scene(HierarchyKind::Whole, 16);
        assert_eq!(ranks_in_the_scene(HierarchyKind::Compressed, 5), whole);
        let mut order: Vec<u32> = whole.iter().map(|(_, rank)| *rank).collect();
        order.sort_unstable();
        assert!(order.into_iter().eq(0..whole.len() as u32), "each rank once");
    }

    #[test]
    fn buffers_are_in_the_order_of_their_bindings() {
        for name in ["three-spheres", "field:500"] {
            let job = Recipe::find(name).unwrap().job().unwrap();
            let prepared = PreparedScene::<f32>::new(&job);
            let data = SceneData::new(&job, &prepared, HierarchyKind::Compressed).unwrap();
            let buffers = data.buffers(&prepared);
            let bytes = buffers.each_ref().map(|(label, bytes)| (*label, bytes.len()));
            let spheres = prepared.opaque.len() + prepared.two_root.len();
            assert_eq!(
                bytes,
                [
                    ("job", size_of::<GpuJob>()),
                    ("spheres", 16 * spheres),
                    // At least one, because the shader's type requires it.
                    ("anchored spheres", size_of::<AnchoredSphere<f32>>() * prepared.anchored.len().max(1)),
                    ("records", 4 * RECORD_COLUMNS * prepared.records.len()),
                    ("nodes", 16 * data.nodes.len()),
                ],
                "{name}"
            );
            let has_nodes = prepared.hierarchy.is_some();
            assert_eq!((data.node_count > 0, data.nodes.len() > 1), (has_nodes, has_nodes), "{name}");
        }
    }
}
