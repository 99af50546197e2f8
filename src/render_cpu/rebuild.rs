//! A better hierarchy for a scene of many spheres, built in the background while paths are traced with the first one.
//!
//! The first picture should not wait, so the first hierarchy is built quickly. A render that takes long gains from a
//! better one. It is taken between two passes and finds the same hits, so the film stays the same to the bit.

use super::priority::give_way;
use crate::job::render::{RenderJob, TRACING_BYTES_PER_SPHERE};
use crate::prepared::{HierarchySource, PreparedScene};
use crate::system::memory;
use std::thread::JoinHandle;
use std::time::Duration;

/// A better hierarchy is begun after tracing for this many times as long as the first one took to build, divided by the
/// number of threads. It takes 4 to 15 times as long to build as the first one, on a thread of its own, and saves 7 to 22 %
/// of the time (docs/benchmarks.md). By then, its cost is about the time that it would have saved.
const PATIENCE: u32 = 80;

/// State of the better hierarchy: pending, being built, or in use.
pub(super) struct Rebuild {
    /// Time of building the first hierarchy, and the multiple of it that is traced before a better one is begun.
    first: Duration,
    patience: u32,
    /// How long paths have been traced with the first hierarchy.
    traced: Duration,
    /// Whether the better hierarchy is in use, or cannot be built.
    is_settled: bool,
    /// The job of the better hierarchy that is being built, and the thread that builds it.
    building: Option<(RenderJob, JoinHandle<PreparedScene<f32>>)>,
}

impl Rebuild {
    pub fn new() -> Self {
        Rebuild {
            first: Duration::ZERO,
            patience: PATIENCE,
            traced: Duration::ZERO,
            is_settled: true,
            building: None,
        }
    }

    /// Notes that a scene has been prepared, perhaps with the hierarchy of the one before.
    pub fn note_prepared(&mut self, prepared: &PreparedScene<f32>) {
        let is_kept = prepared.hierarchy_source == HierarchySource::Kept;
        let is_improvable = prepared.hierarchy.as_ref().is_some_and(|hierarchy| hierarchy.is_improvable());
        if !is_kept || !is_improvable {
            (self.first, self.traced) = (prepared.hierarchy_source.time(), Duration::ZERO);
            self.is_settled = !is_improvable;
        }
    }

    /// Notes how long a pass of `job` took on this many threads, and begins a better hierarchy if it is time. With a
    /// single thread, nothing is begun: the user wants to give no more.
    pub fn note_pass(
        &mut self,
        took: Duration,
        threads: usize,
        prepared: &PreparedScene<f32>,
        job: &RenderJob,
        low_priority: bool,
    ) {
        self.traced += took;
        let is_early = self.traced * (threads as u32) < self.first * self.patience;
        if self.is_settled || self.building.is_some() || threads < 2 || is_early {
            return;
        }
        let bytes = TRACING_BYTES_PER_SPHERE * prepared.records.len() as u64;
        let job_then = job.clone();
        let build = move || {
            if low_priority {
                give_way();
            }
            PreparedScene::thorough(&job_then)
        };
        let fits = memory::check(|| "a better hierarchy".to_owned(), bytes, "").is_ok();
        // Without memory or a thread for it, the first hierarchy suffices.
        let thread = fits.then(|| std::thread::Builder::new().name("rebuild".to_owned()).spawn(build).ok());
        self.building = thread.flatten().map(|thread| (job.clone(), thread));
        self.is_settled = self.building.is_none();
    }

    /// Returns the scene with the better hierarchy once, when it is built, prepared for `job`. One that was built for
    /// another scene is dropped.
    pub fn take_built(&mut self, job: &RenderJob) -> Option<PreparedScene<f32>> {
        let (job_then, thread) = self.building.take_if(|(_, thread)| thread.is_finished())?;
        let Ok(mut prepared) = thread.join() else {
            // The panic has been reported. Another try would fail, too, and the first hierarchy suffices.
            self.is_settled |= job_then.scene() == job.scene();
            return None;
        };
        if self.is_settled || !prepared.try_reuse(&job_then, job) {
            return None;
        }
        self.is_settled = true;
        Some(prepared)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::Film;
    use crate::job::render::Renderer;
    use crate::job::render::tests::sized;
    use crate::render_cpu::pass::Prepared;
    use crate::render_cpu::{CpuOptions, CpuRenderer};
    use glam::DVec3;
    use std::sync::atomic::AtomicBool;

    const PASSES: std::ops::Range<u64> = 0..6;

    fn field(spheres: u32) -> RenderJob {
        sized(&format!("field:{spheres}"), [20, 12])
    }

    fn renderer(patience: u32) -> CpuRenderer {
        let mut renderer =
            CpuRenderer::new(CpuOptions { threads: Some(2), ..CpuOptions::default() }).unwrap();
        renderer.rebuild.patience = patience;
        renderer
    }

    /// Renders some passes, each after the hierarchy being built is finished.
    fn render(renderer: &mut CpuRenderer, job: &RenderJob) -> Film {
        let mut film = job.new_film();
        for index in PASSES {
            wait(&renderer.rebuild);
            renderer.accumulate(job, index..index + 1, &mut film, &AtomicBool::new(false)).unwrap();
        }
        film
    }

    fn wait(rebuild: &Rebuild) {
        while rebuild.building.as_ref().is_some_and(|(_, thread)| !thread.is_finished()) {
            std::thread::yield_now();
        }
    }

    /// The film of a renderer that keeps its first hierarchy, and the hierarchy's nodes.
    fn expected(job: &RenderJob) -> (Film, usize) {
        let mut renderer = renderer(PATIENCE);
        let film = render(&mut renderer, job);
        assert!(!renderer.rebuild.is_settled && renderer.rebuild.building.is_none(), "too early");
        let nodes = nodes(&renderer);
        (film, nodes)
    }

    fn nodes(renderer: &CpuRenderer) -> usize {
        let Some(Prepared::Single(scene, _)) = &renderer.prepared else { panic!("no scene is prepared") };
        scene.prepared.hierarchy.as_ref().map_or(0, |hierarchy| hierarchy.nodes.len())
    }

    #[test]
    fn long_render_gets_better_hierarchy_and_same_film() {
        let job = field(21_000);
        let (film, first) = expected(&job);
        let mut renderer = renderer(0);
        assert!(render(&mut renderer, &job) == film);
        let better = nodes(&renderer);
        assert!(better != first && renderer.rebuild.is_settled && renderer.rebuild.building.is_none());
        // It outlives the move of a camera.
        let mut moved = *job.camera();
        moved.look_from += DVec3::new(0.5, 0.25, -1.0);
        let moved = job.seen_by(moved, *job.settings()).unwrap();
        assert!(render(&mut renderer, &moved) == expected(&moved).0);
        assert_eq!(nodes(&renderer), better);
    }

    #[test]
    fn hierarchy_of_another_scene_is_dropped() {
        let (job, other) = (field(21_000), field(22_000));
        let mut renderer = renderer(0);
        let never = AtomicBool::new(false);
        renderer.accumulate(&job, 0..1, &mut job.new_film(), &never).unwrap();
        assert!(renderer.rebuild.building.is_some(), "it has begun");
        assert!(render(&mut renderer, &other) == expected(&other).0);
    }

    #[test]
    fn panicking_builder_is_not_restarted() {
        let job = field(21_000);
        let mut renderer = renderer(0);
        renderer.prepare(&job, &AtomicBool::new(false)).unwrap();
        let panics = std::thread::spawn(|| -> PreparedScene<f32> { panic!("injected fault") });
        renderer.rebuild.building = Some((job.clone(), panics));
        let (film, first) = expected(&job);
        assert!(render(&mut renderer, &job) == film && nodes(&renderer) == first);
        assert!(renderer.rebuild.is_settled && renderer.rebuild.building.is_none());
    }

    #[test]
    fn better_hierarchy_is_begun_after_80_build_times() {
        let job = field(60);
        let prepared = PreparedScene::<f32>::new(&job);
        let second = Duration::from_secs(1);
        for (seconds, threads, is_settled, is_begun) in
            [(1000, 1, false, false), (39, 2, false, false), (40, 2, false, true), (1000, 2, true, false)]
        {
            let mut rebuild = Rebuild { first: second, is_settled, ..Rebuild::new() };
            rebuild.note_pass(seconds * second, threads, &prepared, &job, false);
            assert_eq!(rebuild.building.is_some(), is_begun, "{seconds} s on {threads} threads");
        }
        // The time of another scene does not count, and a small one needs no better hierarchy.
        let mut rebuild = Rebuild { traced: 9 * second, is_settled: false, ..Rebuild::new() };
        rebuild.note_prepared(&prepared);
        assert_eq!((rebuild.traced, rebuild.is_settled), (Duration::ZERO, true));
    }
}
