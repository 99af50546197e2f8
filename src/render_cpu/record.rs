//! Records one path ray by ray, using the rendering code itself. The pixel inspector shows these records, and a
//! comparison of two backends uses them to find where they differ.

use super::Isa;
use super::broadcast::BroadcastScene;
use super::lanes::{Lanes, Scalar, V3, Wide};
use super::path::SinglePath;
use super::sphere::NONE;
use super::work::{RefillBlock, RefillOrder, Work};
use crate::film::PixelSum;
use crate::job::render::RenderJob;
use crate::kernel::Real;
use crate::kernel::path_record::{PathRecord, RecordedHit, RecordedRay};
use crate::prepared::PreparedScene;
use fearless_simd::{Level, Simd};
use std::sync::atomic::AtomicBool;

/// Records sample `index` of pixel (`x`, `y`), which must be inside the picture, as `isa` traces it, or in `f64` if
/// `isa` is `None`.
pub fn record_path(job: &RenderJob, pixel: [u32; 2], index: u64, isa: Option<Isa>) -> PathRecord {
    match isa {
        Some(isa) => recorder(isa)(&BroadcastScene::new(PreparedScene::new(job)), pixel, index),
        None => record(super::lanes::Reference, &BroadcastScene::new(PreparedScene::new(job)), pixel, index),
    }
}

/// Records many paths of one job, in turn or from several threads.
pub struct PathRecorder {
    job: RenderJob,
    prepared: BroadcastScene<f32>,
    recorder: Recorder,
}

impl PathRecorder {
    /// Creates a recorder for paths as `isa` traces them. It reuses what it can of the `earlier` job's recorder.
    pub fn new(job: &RenderJob, isa: Isa, earlier: Option<PathRecorder>) -> Self {
        let old = earlier.map(|earlier| (earlier.prepared.prepared, earlier.job));
        // Never cancelled.
        let renewed = PreparedScene::renewed(&AtomicBool::new(false), old, job);
        let prepared = BroadcastScene::new(renewed.unwrap_or_else(|| PreparedScene::new(job)));
        PathRecorder { prepared, recorder: recorder(isa), job: job.clone() }
    }

    /// The job whose paths are recorded.
    pub fn job(&self) -> &RenderJob {
        &self.job
    }

    /// Records sample `index` of a pixel, which must be inside the picture.
    pub fn record(&self, pixel: [u32; 2], index: u64) -> PathRecord {
        (self.recorder)(&self.prepared, pixel, index)
    }
}

/// A function that records one path.
type Recorder = Box<dyn Fn(&BroadcastScene<f32>, [u32; 2], u64) -> PathRecord + Send + Sync>;

/// Returns a recorder that computes the same bits as the kernels of `isa`.
fn recorder(isa: Isa) -> Recorder {
    let level = Level::new();
    #[cfg(target_arch = "x86_64")]
    let fused = level.as_avx2();
    #[cfg(target_arch = "aarch64")]
    let fused = level.as_neon();
    match fused {
        Some(simd) if isa.is_fused() => Box::new(move |prepared, pixel, index| {
            simd.vectorize(
                #[inline(always)]
                || record(Scalar::<true>, prepared, pixel, index),
            )
        }),
        _ => Box::new(|prepared, pixel, index| record(Scalar::<false>, prepared, pixel, index)),
    }
}

/// Records a path using one lane.
#[inline(always)]
pub(super) fn record<L: Lanes>(
    l: L,
    broadcast: &BroadcastScene<L::Real>,
    pixel: [u32; 2],
    index: u64,
) -> PathRecord {
    let prepared = &broadcast.prepared;
    let blocks = RefillBlock::of_range(index..index + 1, &prepared.settings, 1);
    let mut sums = vec![PixelSum::default(); prepared.settings.half_count()];
    let rows = sums.iter_mut().map(std::slice::from_mut).collect();
    let order = RefillOrder::new(1, 1);
    let mut work = Work::new(&blocks, &order, pixel, rows);
    let mut path = SinglePath::start(l, broadcast, &mut work);
    let in_scene = |position: V3<L::F>| {
        let [x, y, z] = first_lane::<L>(position);
        (glam::DVec3::new(x, y, z) + prepared.origin).to_array()
    };
    let mut rays: Vec<RecordedRay> = Vec::new();
    while path.is_alive() {
        let mut ray = RecordedRay {
            origin: in_scene(path.origin()),
            direction: first_lane::<L>(path.direction()),
            throughput: first_lane::<L>(path.throughput()),
            hit: None,
        };
        let (sphere, distance) = path.advance(l, broadcast, &mut work);
        let goes_on = path.is_alive() && !path.is_absorbed();
        if sphere != NONE {
            let position = goes_on.then(|| in_scene(path.origin()));
            let sphere = prepared.scene_index[sphere as usize] as usize;
            ray.hit = Some(RecordedHit { sphere, distance, position });
        }
        rays.push(ray);
        // The last step of an absorbed path would add nothing.
        if !goes_on {
            break;
        }
    }
    let mut total = PixelSum::default();
    sums.iter().for_each(|sum| total.add(*sum));
    PathRecord { rays, radiance: total.radiance() }
}

#[inline(always)]
fn first_lane<L: Lanes>(v: V3<L::F>) -> [f64; 3] {
    [v.x, v.y, v.z].map(|component| {
        let mut buffer = Wide::default();
        L::store(component, &mut buffer);
        buffer.0[0].to_f64()
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::job::recipe::Recipe;
    use crate::job::render::Renderer;
    use crate::render_cpu::{CpuOptions, CpuRenderer};
    use std::sync::atomic::AtomicBool;

    fn small_job(scene: &str) -> RenderJob {
        let mut recipe = Recipe::find(scene).expect("a built-in scene");
        (recipe.settings.width, recipe.settings.height) = (12, 7);
        recipe.job().expect("valid")
    }

    #[test]
    fn a_record_is_the_path_that_the_renderer_traced() {
        for scene in ["three-spheres", "book"] {
            let job = small_job(scene);
            for isa in Isa::available().into_iter().map(Some).chain([None]) {
                let mut renderer = match isa {
                    Some(isa) => CpuRenderer::new(CpuOptions { isa: Some(isa), ..CpuOptions::default() }),
                    None => CpuRenderer::reference(Some(1)),
                }
                .expect("available");
                let mut film = job.new_film();
                renderer.accumulate(&job, 5..6, &mut film, &AtomicBool::new(false)).expect("traced");
                for y in 0..7 {
                    for x in 0..12 {
                        let record = record_path(&job, [x, y], 5, isa);
                        let pixel = film.pixel_sum((y * 12 + x) as usize).radiance();
                        assert_eq!(record.radiance, pixel, "{scene} {isa:?} pixel {x},{y}");
                    }
                }
            }
        }
    }

    #[test]
    fn a_record_is_connected_and_ends_where_the_path_does() {
        let job = small_job("three-spheres");
        for y in 0..7 {
            for x in 0..12 {
                let record = record_path(&job, [x, y], 0, None);
                for pair in record.rays.windows(2) {
                    let hit = pair[0].hit.expect("a ray that goes on has hit");
                    assert_eq!(hit.position, Some(pair[1].origin));
                    let sphere = job.scene().spheres[hit.sphere];
                    let off =
                        (glam::DVec3::from(pair[1].origin).distance(sphere.center) - sphere.radius).abs();
                    assert!(off < 1e-12 * sphere.radius, "{off} off the sphere");
                }
                let last = record.rays.last().expect("a camera ray");
                assert!(last.hit.is_none_or(|hit| hit.position.is_none()));
            }
        }
    }
}
