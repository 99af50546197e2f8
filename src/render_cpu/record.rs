//! Records one path ray by ray, using the rendering code itself.

use super::Isa;
use super::broadcast::BroadcastScene;
use super::lanes::Scalar;
use super::path::record;
use crate::job::render::RenderJob;
use crate::kernel::path_record::PathRecord;
use crate::prepared::PreparedScene;
use fearless_simd::{Level, Simd};
use std::sync::atomic::AtomicBool;

/// Records many paths of one job, in turn or from several threads.
pub struct PathRecorder {
    job: RenderJob,
    broadcast: BroadcastScene<f32>,
    recorder: Recorder,
}

impl PathRecorder {
    /// Creates a recorder for paths as `isa` traces them. It reuses what it can of the `earlier` job's recorder.
    pub fn new(job: &RenderJob, isa: Isa, earlier: Option<PathRecorder>) -> Self {
        let old = earlier.map(|earlier| (earlier.broadcast.prepared, earlier.job));
        // Never cancelled.
        let renewed = PreparedScene::renewed(&AtomicBool::new(false), old, job);
        let broadcast = BroadcastScene::new(renewed.unwrap_or_else(|| PreparedScene::new(job)));
        PathRecorder { broadcast, recorder: recorder(isa), job: job.clone() }
    }

    /// The job whose paths are recorded.
    pub fn job(&self) -> &RenderJob {
        &self.job
    }

    /// Records sample `index` of a pixel, which must be inside the picture.
    pub fn record(&self, pixel: [u32; 2], index: u64) -> PathRecord {
        (self.recorder)(&self.broadcast, pixel, index)
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
    // WebAssembly has no fused level; this only provides the type.
    #[cfg(target_arch = "wasm32")]
    let fused = level.as_wasm_simd128();
    match fused {
        Some(simd) if isa.is_fused() => Box::new(move |broadcast, pixel, index| {
            simd.vectorize(
                #[inline(always)]
                || record(Scalar::<true>, broadcast, pixel, index),
            )
        }),
        _ => Box::new(|broadcast, pixel, index| record(Scalar::<false>, broadcast, pixel, index)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::job::render::Renderer;
    use crate::job::render::tests::sized;
    use crate::render_cpu::{CpuOptions, CpuRenderer};
    use std::sync::atomic::AtomicBool;

    #[test]
    fn records_match_the_rendered_paths() {
        for scene in ["three-spheres", "book"] {
            let job = sized(scene, [12, 7]);
            for isa in Isa::available() {
                let options = CpuOptions { isa: Some(isa), ..CpuOptions::default() };
                let mut renderer = CpuRenderer::new(options).expect("available");
                let recorder = PathRecorder::new(&job, isa, None);
                let mut film = job.new_film();
                renderer.accumulate(&job, 5..6, &mut film, &AtomicBool::new(false)).expect("traced");
                for y in 0..7 {
                    for x in 0..12 {
                        let record = recorder.record([x, y], 5);
                        let pixel = film.pixel_sum((y * 12 + x) as usize).radiance();
                        assert_eq!(record.radiance, pixel, "{scene} {isa:?} pixel {x},{y}");
                    }
                }
            }
        }
    }
}
