//! A better hierarchy for a scene of many spheres, built in the background while paths are traced with the first one.
//!
//! The first picture should not wait, so the first hierarchy is built quickly. A render that takes long gains from a
//! better one. It is taken between two passes and finds the same hits, so the film stays the same to the bit.

use super::priority::give_way;
use crate::job::render::RenderJob;
use crate::prepared::PreparedScene;
use crate::system::memory;
use std::thread::JoinHandle;
use std::time::Duration;

/// A better hierarchy is begun after tracing for this many times as long as the first one took to build, divided by the
/// number of threads. It takes 4 to 15 times as long to build as the first one, on a thread of its own, and saves 7 to 22 %
/// of the time (docs/benchmarks.md). By then, what it costs is about what it would have saved.
const PATIENCE: u32 = 80;

/// Memory for building, as a multiple of what the prepared scene takes.
const MEMORY_RATIO: u64 = 3;

/// Whether a better hierarchy is wanted, in work or in use.
pub(super) struct Rebuild {
    /// How long the first hierarchy took, and how many times as long tracing goes on before a better one is begun.
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

    /// Notes that another scene has been prepared, if it was.
    pub fn note_prepared(&mut self, prepared: &PreparedScene<f32>) {
        let is_kept = prepared.hierarchy_time.is_zero();
        let is_improvable = prepared.hierarchy.as_ref().is_some_and(|hierarchy| hierarchy.is_improvable());
        if !is_kept || !is_improvable {
            (self.first, self.traced) = (prepared.hierarchy_time, Duration::ZERO);
            self.is_settled = !is_improvable;
        }
    }

    /// Notes how long a pass of `job` took on this many threads, and begins a better hierarchy if it is time. A single
    /// thread is left alone: it is all that the user wants to give.
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
        let bytes = MEMORY_RATIO * prepared.bytes() as u64;
        let job_then = job.clone();
        let build = move || {
            if low_priority {
                give_way();
            }
            PreparedScene::thorough(&job_then)
        };
        let fits = memory::check(|| "a better hierarchy".to_owned(), bytes, "").is_ok();
        // Without memory or a thread for it, the first hierarchy does.
        let thread = fits.then(|| std::thread::Builder::new().name("rebuild".to_owned()).spawn(build).ok());
        match thread.flatten() {
            Some(thread) => self.building = Some((job.clone(), thread)),
            None => self.is_settled = true,
        }
    }

    /// Returns the scene with the better hierarchy once, when it is built, prepared for `job`. One that was built for
    /// another scene is dropped.
    pub fn take_built(&mut self, job: &RenderJob) -> Option<PreparedScene<f32>> {
        let (job_then, thread) = self.building.take_if(|(_, thread)| thread.is_finished())?;
        let Ok(mut prepared) = thread.join() else {
            // The panic has been reported. Another try would end alike, and the first hierarchy does.
            self.is_settled |= job_then.scene() == job.scene();
            return None;
        };
        if self.is_settled || !prepared.follow(&job_then, job) {
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
    use crate::job::recipe::Recipe;
    use crate::job::render::Renderer;
    use crate::render_cpu::pass::Prepared;
    use crate::render_cpu::{CpuOptions, CpuRenderer};
    use glam::DVec3;
    use std::sync::atomic::AtomicBool;

    const PASSES: std::ops::Range<u64> = 0..6;

    fn field(spheres: u32) -> RenderJob {
        let mut recipe = Recipe::find(&format!("field:{spheres}")).expect("a field");
        (recipe.settings.width, recipe.settings.height) = (20, 12);
        recipe.job().expect("valid")
    }

    fn renderer(threads: usize) -> CpuRenderer {
        let options = CpuOptions { threads: Some(threads), ..CpuOptions::default() };
        CpuRenderer::new(options).expect("available")
    }

    fn pass(renderer: &mut CpuRenderer, job: &RenderJob, film: &mut Film, index: u64) {
        renderer.accumulate(job, index..index + 1, film, &AtomicBool::new(false)).expect("traced");
    }

    /// The film of a renderer that keeps its first hierarchy.
    fn expected(job: &RenderJob) -> Film {
        let (mut renderer, mut film) = (renderer(2), job.new_film());
        PASSES.for_each(|index| pass(&mut renderer, job, &mut film, index));
        assert!(!renderer.rebuild.is_settled && renderer.rebuild.building.is_none(), "too early");
        film
    }

    /// Waits until the hierarchy in work is built.
    fn wait(rebuild: &Rebuild) {
        while rebuild.building.as_ref().is_some_and(|(_, thread)| !thread.is_finished()) {
            std::thread::yield_now();
        }
    }

    fn scene(renderer: &CpuRenderer) -> &PreparedScene<f32> {
        match &renderer.prepared {
            Some(Prepared::Single(broadcast, _)) => &broadcast.prepared,
            _ => panic!("no scene is prepared"),
        }
    }

    fn nodes(renderer: &CpuRenderer) -> usize {
        scene(renderer).hierarchy.as_ref().map_or(0, |hierarchy| hierarchy.nodes.len())
    }

    #[test]
    fn a_long_render_gets_a_better_hierarchy_and_the_same_film() {
        let job = field(21_000);
        let mut moved = *job.camera();
        moved.look_from += DVec3::new(0.5, 0.25, -1.0);
        let moved = job.seen_by(moved, *job.settings()).expect("valid");
        let mut renderer = renderer(2);
        renderer.rebuild.patience = 0;
        let mut film = job.new_film();
        pass(&mut renderer, &job, &mut film, 0);
        assert!(renderer.rebuild.building.is_some(), "it has begun");
        let first = nodes(&renderer);
        wait(&renderer.rebuild);
        assert_eq!(nodes(&renderer), first, "it is taken between passes");
        PASSES.skip(1).for_each(|index| pass(&mut renderer, &job, &mut film, index));
        assert_ne!(nodes(&renderer), first);
        assert!(renderer.rebuild.is_settled && renderer.rebuild.building.is_none(), "once is enough");
        assert!(film == expected(&job));
        // It outlives the move of a camera.
        let (better, mut film) = (nodes(&renderer), moved.new_film());
        PASSES.for_each(|index| pass(&mut renderer, &moved, &mut film, index));
        assert_eq!(nodes(&renderer), better);
        assert!(film == expected(&moved));
    }

    #[test]
    fn a_hierarchy_of_another_scene_is_dropped() {
        let (job, other) = (field(21_000), field(22_000));
        let mut renderer = renderer(2);
        renderer.rebuild.patience = 0;
        pass(&mut renderer, &job, &mut job.new_film(), 0);
        wait(&renderer.rebuild);
        let mut film = other.new_film();
        pass(&mut renderer, &other, &mut film, 0);
        assert_eq!(scene(&renderer).scene_index.len(), other.scene().spheres.len());
        assert!(renderer.rebuild.building.is_some(), "that of the other scene has begun");
        wait(&renderer.rebuild);
        PASSES.skip(1).for_each(|index| pass(&mut renderer, &other, &mut film, index));
        assert!(film == expected(&other));
    }

    #[test]
    fn a_builder_that_panics_is_not_started_again() {
        let job = field(21_000);
        let mut renderer = renderer(2);
        renderer.rebuild.patience = 0;
        let mut film = job.new_film();
        pass(&mut renderer, &job, &mut film, 0);
        let first = nodes(&renderer);
        wait(&renderer.rebuild);
        let panics = std::thread::spawn(|| -> PreparedScene<f32> { panic!("injected fault") });
        renderer.rebuild.building = Some((job.clone(), panics));
        wait(&renderer.rebuild);
        PASSES.skip(1).for_each(|index| pass(&mut renderer, &job, &mut film, index));
        assert!(renderer.rebuild.is_settled && renderer.rebuild.building.is_none());
        assert_eq!(nodes(&renderer), first);
        assert!(film == expected(&job));
    }

    #[test]
    fn nothing_is_rebuilt_that_cannot_get_better() {
        for (job, threads) in [(field(5_000), 2), (field(21_000), 1)] {
            let mut renderer = renderer(threads);
            renderer.rebuild.patience = 0;
            let mut film = job.new_film();
            PASSES.for_each(|index| pass(&mut renderer, &job, &mut film, index));
            assert!(renderer.rebuild.building.is_none());
        }
    }

    #[test]
    fn a_better_hierarchy_is_begun_once_the_threads_have_traced_80_times_as_long() {
        let job = field(60);
        let prepared = PreparedScene::<f32>::new(&job);
        let second = Duration::from_secs(1);
        let wanted = || Rebuild { first: second, is_settled: false, ..Rebuild::new() };
        let mut rebuild = wanted();
        rebuild.note_pass(1000 * second, 1, &prepared, &job, false);
        assert!(rebuild.building.is_none(), "a single thread is left alone");
        // Two threads: 39 seconds, then one more.
        let mut rebuild = wanted();
        rebuild.note_pass(39 * second, 2, &prepared, &job, false);
        assert!(rebuild.building.is_none(), "too early");
        rebuild.note_pass(second, 2, &prepared, &job, false);
        assert!(rebuild.building.is_some());
        wait(&rebuild);
        assert!(rebuild.take_built(&job).is_some() && rebuild.is_settled);
        assert!(rebuild.take_built(&job).is_none(), "once");
        rebuild.note_pass(1000 * second, 2, &prepared, &job, false);
        assert!(rebuild.building.is_none(), "nothing is better than the best");
    }

    #[test]
    fn the_time_of_another_scene_does_not_count() {
        let mut large = PreparedScene::<f32>::new(&field(21_000));
        let mut rebuild = Rebuild::new();
        rebuild.traced = Duration::from_secs(9);
        rebuild.note_prepared(&large);
        assert_eq!((rebuild.first, rebuild.traced), (large.hierarchy_time, Duration::ZERO));
        assert!(!rebuild.is_settled);
        // A hierarchy that was kept goes on being what it is.
        rebuild.traced = Duration::from_secs(9);
        large.hierarchy_time = Duration::ZERO;
        rebuild.note_prepared(&large);
        assert_eq!(rebuild.traced, Duration::from_secs(9));
        assert!(!rebuild.is_settled && !rebuild.first.is_zero());
        rebuild.note_prepared(&PreparedScene::new(&field(60)));
        assert!(rebuild.is_settled, "a small scene needs no better one");
    }
}
