//! Layers of a picture besides its light: the normal and the albedo at the first hit of each pixel, and the number of
//! rays per path. The paths are those of the picture, as recorded by [`PathRecorder`].

use crate::job::render::{JobError, RenderJob, RenderSettings};
use crate::kernel::path_record::PathRecord;
use crate::render_cpu::PathRecorder;
use crate::scene::Scene;
use glam::DVec3;
use rayon::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Layer {
    /// `(n + 1) / 2` of the normal where the camera's ray meets a surface; the sky where it meets none.
    Normals,
    /// The reflectance of the surface that the camera's ray meets, linear RGB; the sky where it meets none.
    Albedo,
    /// Rays per path, including the camera ray, in all three components.
    RaysPerPath,
}

impl Layer {
    /// The job whose paths this layer records: the picture's job with only as many rays per path as the layer needs.
    ///
    /// # Errors
    /// If the settings of `job` are invalid, which they never are.
    pub fn job(self, job: &RenderJob) -> Result<RenderJob, JobError> {
        let settings = *job.settings();
        // The albedo of a surface shows in the throughput of the next ray.
        let depth = match self {
            Layer::Normals => 1,
            Layer::Albedo => 2,
            Layer::RaysPerPath => settings.max_depth,
        };
        job.seen_by(*job.camera(), RenderSettings { max_depth: depth.min(settings.max_depth), ..settings })
    }

    fn value(self, scene: &Scene, record: &PathRecord) -> DVec3 {
        let Some(first) = record.rays.first() else { return DVec3::ZERO };
        if self == Layer::RaysPerPath {
            return DVec3::splat(record.rays.len() as f64);
        }
        let direction = DVec3::from(first.direction);
        let Some((hit, sphere)) = first.hit.and_then(|hit| Some((hit, scene.spheres.get(hit.sphere)?)))
        else {
            let height = (direction.y + 1.0) / 2.0;
            return (1.0 - height) * scene.sky.bottom + height * scene.sky.top;
        };
        match (self, record.rays.get(1)) {
            (Layer::Normals, _) => {
                let point = DVec3::from(first.origin) + hit.distance * direction;
                ((point - sphere.center) / sphere.radius + 1.0) / 2.0
            }
            // The camera ray has throughput 1, so the next ray's throughput is the albedo.
            (_, Some(next)) => DVec3::from(next.throughput),
            (_, None) => scene.material_of(sphere).albedo().unwrap_or(DVec3::ONE),
        }
    }
}

/// A layer, averaged over samples.
#[derive(Clone, Debug, PartialEq)]
pub struct LayerImage {
    layer: Layer,
    pub width: u32,
    pub height: u32,
    pub samples: u64,
    sums: Vec<[f32; 3]>,
}

impl LayerImage {
    /// An empty layer of the size of `job`.
    pub fn new(layer: Layer, job: &RenderJob) -> Self {
        let RenderSettings { width, height, .. } = *job.settings();
        let sums = vec![[0.0; 3]; width as usize * height as usize];
        LayerImage { layer, width, height, samples: 0, sums }
    }

    /// Adds the next sample of each pixel. `paths` records [`Layer::job`] in this size. Returns false if it was
    /// cancelled; the sums are then invalid.
    pub fn add_sample(&mut self, paths: &PathRecorder, cancel: &AtomicBool) -> bool {
        let (layer, index, scene) = (self.layer, self.samples, paths.job().scene());
        self.sums.par_chunks_mut(self.width.max(1) as usize).enumerate().for_each(|(y, row)| {
            if cancel.load(Ordering::Relaxed) {
                return;
            }
            for (x, sum) in row.iter_mut().enumerate() {
                let value = layer.value(scene, &paths.record([x as u32, y as u32], index));
                [0, 1, 2].into_iter().for_each(|i| sum[i] += value[i] as f32);
            }
        });
        self.samples += 1;
        !cancel.load(Ordering::Relaxed)
    }

    /// The mean of a pixel, which must be inside the picture.
    pub fn mean(&self, [x, y]: [u32; 2]) -> [f64; 3] {
        let count = self.samples.max(1) as f64;
        self.sums[y as usize * self.width as usize + x as usize].map(|sum| f64::from(sum) / count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::job::recipe::Recipe;
    use crate::render_cpu::Isa;
    use crate::scene::{Camera, Sky};
    use crate::stages::Stage;
    use std::sync::Arc;

    fn image(layer: Layer, recipe: &Recipe, samples: u64) -> LayerImage {
        let mut recipe = recipe.clone();
        (recipe.settings.width, recipe.settings.height) = (32, 18);
        let job = layer.job(&recipe.job().unwrap()).unwrap();
        let paths = PathRecorder::new(&job, Isa::available().into_iter().max().unwrap(), None);
        let mut image = LayerImage::new(layer, &job);
        (0..samples).for_each(|_| assert!(image.add_sample(&paths, &AtomicBool::new(false))));
        image
    }

    fn of_stage(layer: Layer, id: &str) -> LayerImage {
        image(layer, &Stage::find(id).unwrap().recipe(), 4)
    }

    #[test]
    fn normals_and_albedo_are_those_of_the_scene() {
        // The middle sphere faces the camera; the ground below it is the book's yellow-green.
        let normal = of_stage(Layer::Normals, "metal").mean([16, 9]);
        assert!((normal[2] - 1.0).abs() < 0.02, "{normal:?}");
        let ground = of_stage(Layer::Albedo, "metal").mean([16, 17]);
        assert!(ground.iter().zip([0.8, 0.8, 0.0]).all(|(a, b)| (a - b).abs() < 1e-6), "{ground:?}");
    }

    #[test]
    fn ray_counts_match_the_renderer() {
        use crate::job::render::Renderer;
        use crate::render_cpu::{CpuOptions, CpuRenderer};
        let image = image(Layer::RaysPerPath, &Recipe::builtin("three-spheres").unwrap(), 2);
        let job = crate::job::render::tests::sized("three-spheres", [32, 18]);
        let mut renderer = CpuRenderer::new(CpuOptions::default()).unwrap();
        let mut film = job.new_film();
        let stats = renderer.accumulate(&job, 0..2, &mut film, &AtomicBool::new(false)).unwrap();
        let sum: f64 = (0..18).flat_map(|y| (0..32).map(move |x| [x, y])).map(|at| image.mean(at)[0]).sum();
        assert!((sum * 2.0 - stats.rays as f64).abs() < 0.01 * stats.rays as f64, "{sum} {}", stats.rays);
    }

    #[test]
    fn layers_can_be_cancelled_and_glass_is_white() {
        let mut recipe = Stage::find("glass-schlick").unwrap().recipe();
        recipe.settings.max_depth = 1;
        assert_eq!(image(Layer::Albedo, &recipe, 1).mean([8, 9]), [1.0; 3]);
        let job = Layer::Normals.job(&recipe.job().unwrap()).unwrap();
        let paths = PathRecorder::new(&job, Isa::Portable, None);
        assert!(!LayerImage::new(Layer::Normals, &job).add_sample(&paths, &AtomicBool::new(true)));
    }

    #[test]
    fn layers_show_the_sky_on_a_miss() {
        let mut recipe = Recipe::builtin("three-spheres").unwrap();
        let sky = Sky { bottom: DVec3::X, top: DVec3::Y };
        recipe.scene = Arc::new(Scene { sky, ..Scene::default() });
        for (look_at, expected) in [(DVec3::NEG_Y, sky.bottom), (DVec3::Y, sky.top)] {
            recipe.camera = Camera { look_at, vup: DVec3::Z, vfov_degrees: 1.0, ..Camera::BOOK };
            for layer in [Layer::Normals, Layer::Albedo] {
                let mean = DVec3::from(image(layer, &recipe, 1).mean([16, 9]));
                assert!((mean - expected).length() < 1e-3, "{layer:?} towards {look_at}: {mean}");
            }
        }
    }
}
