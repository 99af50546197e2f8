//! A job as another host of the same shaders needs it, such as a web page.

use super::HierarchyKind;
use super::scene::SceneData;
use super::turns::turns_over_lists;
use crate::job::render::RenderJob;
use crate::kernel::Features;
use crate::prepared::PreparedScene;
use glam::DVec3;

/// The contents of a job's buffers, and what a host must know to run its kernel.
#[derive(Clone, Debug)]
pub struct Exported {
    /// What the kernel must support. The host decides `aside`, which depends on its limit on loop turns.
    pub features: Features,
    /// The bytes of the buffers of group 0, by binding: see shaders/bindings.wgsl.
    pub buffers: [Vec<u8>; 5],
    /// The index in the scene of each shading record's sphere.
    pub scene_index: Vec<u32>,
    /// Loop turns over lists for one ray.
    pub turns_over_lists: u64,
    /// Most samples in a block: a power of two.
    pub block_limit: u32,
    /// The origin of the buffers' coordinates, in scene coordinates.
    pub origin: DVec3,
}

impl Exported {
    /// Prepares a job with the compressed hierarchy if it needs one.
    ///
    /// # Errors
    /// If the hierarchy has more levels than a traversal supports.
    pub fn new(job: &RenderJob) -> Result<Self, String> {
        let prepared = PreparedScene::<f32>::new(job);
        let kind = HierarchyKind::Compressed;
        let data = SceneData::new(job, &prepared, kind)?;
        let features = kind.in_features(prepared.features);
        Ok(Exported {
            features,
            buffers: data.buffers(&prepared).map(|(_, bytes)| bytes.into_owned()),
            turns_over_lists: turns_over_lists(&features, &prepared),
            block_limit: prepared.block_limit,
            origin: prepared.origin,
            scene_index: data.scene_index,
        })
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
            let exported = Exported::new(&job).unwrap();
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

    #[test]
    fn a_host_is_told_what_its_kernel_needs() {
        let job = Recipe::find("field:60").unwrap().job().unwrap();
        let prepared = PreparedScene::<f32>::new(&job);
        let exported = Exported::new(&job).unwrap();
        assert!(exported.features.hierarchy && exported.features.cwbvh, "{:?}", exported.features);
        assert_eq!(exported.turns_over_lists, prepared.anchored.len() as u64);
        assert_eq!(exported.block_limit, prepared.block_limit);
        let mut indices = exported.scene_index;
        indices.sort_unstable();
        assert!(indices.into_iter().eq(0..job.scene().spheres.len() as u32));
    }
}
