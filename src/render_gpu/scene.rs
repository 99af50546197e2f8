//! A scene's spheres, shading records and hierarchy, in the order in which the kernel reads them, for this host and for
//! others, such as a web page.

use super::layout::GpuJob;
use crate::job::render::RenderJob;
use crate::kernel::{AnchoredSphere, Features, RECORD_COLUMNS, words_of};
use crate::prepared::PreparedScene;
use crate::stages::SurfaceRule;
use glam::DVec3;
use std::borrow::Cow;

/// The contents of a scene's buffers that its prepared scene does not hold.
pub struct SceneData {
    /// Centre and squared radius of each sphere.
    pub spheres: Vec<[f32; 4]>,
    /// The shading record of each sphere, huge ones last.
    pub records: Vec<[f32; RECORD_COLUMNS]>,
    /// The hierarchy's nodes, followed by each sphere's place in the list; not empty, as the shader's type requires.
    pub nodes: Vec<[u32; 4]>,
    /// Number of nodes.
    pub node_count: u32,
}

impl SceneData {
    /// Collects the data of a scene, and takes the nodes of its hierarchy.
    pub fn new(prepared: &mut PreparedScene<f32>) -> Self {
        let mut data = SceneData {
            spheres: prepared.opaque.iter().chain(&prepared.two_root).copied().collect(),
            records: prepared.records.iter().map(|row| row.0).collect(),
            nodes: vec![[0; 4]],
            node_count: 0,
        };
        let Some(hierarchy) = &mut prepared.hierarchy else { return data };
        let nodes = hierarchy.wide.take().map_or_else(Vec::new, |wide| wide.nodes);
        data.node_count = nodes.len() as u32;
        data.nodes = bytemuck::allocation::cast_vec(nodes);
        data.nodes.extend(hierarchy.ranks.chunks(4).map(|four| {
            let mut places = [0; 4];
            places[..four.len()].copy_from_slice(four);
            places
        }));
        data
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
}

/// Iterations that a thread of a dispatch may take over all its loops, not counting its last ray. After that, the
/// thread suspends its path, and the next dispatch resumes it.
///
/// This is half of the smallest limit known. llvmpipe ends every loop once the loops of a thread have taken 65,535
/// iterations together; it runs 8 threads in step, and iterations that two of them take count twice.
pub const ITERATION_LIMIT: u32 = 1 << 15;

/// Maximum number of samples in a block where the threads of a workgroup share its blocks. A thread that finds none
/// left waits no longer than the others need for a block; each one costs the time of some rays.
pub const SHARED_BLOCK: u32 = 16;

/// Iterations over lists for one ray. Twin: `iterations_over_lists` in shaders/path.wgsl.
pub fn iterations_over_lists(features: &Features, prepared: &PreparedScene<f32>) -> u64 {
    let is_in_hierarchy = features.hierarchy && features.surface == SurfaceRule::Exact;
    let listed = if is_in_hierarchy { 0 } else { prepared.opaque.len() + prepared.two_root.len() };
    (prepared.anchored.len() + listed) as u64
}

/// The contents of a job's buffers, and what a host must know to run its kernel.
#[derive(Clone, Debug)]
pub struct Exported {
    /// The features that the kernel must support. The host decides `suspends`, which depends on its limit on iterations.
    pub features: Features,
    /// The bytes of the buffers of group 0, by binding: see shaders/bindings.wgsl.
    pub buffers: [Vec<u8>; 5],
    /// The index in the scene of each shading record's sphere.
    pub scene_index: Vec<u32>,
    /// Iterations over lists for one ray.
    pub iterations_over_lists: u64,
    /// Maximum number of samples in a block: a power of two.
    pub block_limit: u32,
    /// The origin of the buffers' coordinates, in scene coordinates.
    pub origin: DVec3,
}

impl Exported {
    /// Prepares a job.
    pub fn new(job: &RenderJob) -> Self {
        let mut prepared = PreparedScene::<f32>::wide(job);
        let data = SceneData::new(&mut prepared);
        let features = prepared.features;
        Exported {
            features,
            buffers: data.buffers(&prepared).map(|(_, bytes)| bytes.into_owned()),
            iterations_over_lists: iterations_over_lists(&features, &prepared),
            block_limit: prepared.block_limit,
            origin: prepared.origin,
            scene_index: prepared.scene_index,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::job::recipe::Recipe;
    use crate::job::render::RenderSettings;
    use crate::scene::{Camera, Material, Scene};
    use crate::stages::Rules;

    #[test]
    fn a_ray_tests_all_spheres_that_are_in_no_hierarchy() {
        let iterations = |name: &str, surface: SurfaceRule| {
            let mut recipe = Recipe::find(name).unwrap();
            recipe.rules = Rules { surface, ..recipe.rules };
            let prepared = PreparedScene::<f32>::new(&recipe.job().unwrap());
            let listed = prepared.opaque.len() + prepared.two_root.len();
            let iterations = iterations_over_lists(&prepared.features, &prepared) as usize;
            (iterations - prepared.anchored.len(), listed)
        };
        assert_eq!(iterations("field:60", SurfaceRule::Exact).0, 0);
        for (name, surface) in [("three-spheres", SurfaceRule::Exact), ("field:60", SurfaceRule::Book)] {
            let (tested, listed) = iterations(name, surface);
            assert!(tested == listed && listed > 3, "{name}: {tested} {listed}");
        }
    }

    #[test]
    fn the_buffers_are_relative_to_the_origin() {
        for away in [DVec3::ZERO, DVec3::new(4096.0, 0.0, -65_536.0)] {
            let mut scene = Scene::default();
            let matte = scene.add_material("matte", Material::Lambertian { albedo: DVec3::splat(0.5) });
            for x in [-1.5, 0.0, 1.5] {
                scene.add_sphere(away + DVec3::new(x, 0.0, -1.0), 0.5, matte);
            }
            let book = Camera::BOOK;
            let camera = Camera { look_from: away + book.look_from, look_at: away + book.look_at, ..book };
            let job = RenderJob::new(scene, camera, RenderSettings::default(), Rules::default()).unwrap();
            let exported = Exported::new(&job);
            assert_eq!(exported.origin == DVec3::ZERO, away == DVec3::ZERO, "{}", exported.origin);
            let rows: Vec<[f32; 4]> =
                exported.buffers[1].chunks_exact(16).map(bytemuck::pod_read_unaligned).collect();
            assert_eq!(rows.len(), 3);
            for ([x, y, z, _], index) in rows.into_iter().zip(&exported.scene_index) {
                let center = exported.origin + DVec3::from([x, y, z].map(f64::from));
                assert_eq!(center, job.scene().spheres[*index as usize].center);
            }
        }
    }
}
