//! Limits of jobs, what they need and share, and their statistics.

use super::*;
use crate::scene::Material;
use glam::DVec3;

type Pass = dyn FnMut(&RenderJob, Range<u64>, &mut Film, &mut Vec<String>) -> Result<(), RenderError> + Send;

/// A renderer whose passes are a closure, which may leave messages.
pub(crate) struct Scripted(Box<Pass>, Vec<String>);

impl Scripted {
    pub(crate) fn boxed<P>(pass: P) -> Box<dyn Renderer>
    where
        P: FnMut(&RenderJob, Range<u64>, &mut Film, &mut Vec<String>) -> Result<(), RenderError>
            + Send
            + 'static,
    {
        Box::new(Scripted(Box::new(pass), Vec::new()))
    }
}

impl Renderer for Scripted {
    fn info(&self) -> BackendInfo {
        BackendInfo { name: "scripted", device: String::new(), lanes: 1, threads: 1 }
    }

    fn take_messages(&mut self) -> Vec<String> {
        std::mem::take(&mut self.1)
    }

    fn prepare(&mut self, _: &RenderJob, _: &AtomicBool) -> Result<(), RenderError> {
        Ok(())
    }

    fn advance(
        &mut self,
        job: &RenderJob,
        samples: Range<u64>,
        film: &mut Film,
        _: &Control,
    ) -> Result<Outcome, RenderError> {
        (self.0)(job, samples, film, &mut self.1)?;
        Ok(Outcome::Added(Stats::default()))
    }
}

/// The job of a built-in scene in this size.
pub(crate) fn sized(scene: &str, [width, height]: [u32; 2]) -> RenderJob {
    let recipe = crate::job::recipe::Recipe::find(scene).unwrap();
    let settings = RenderSettings { width, height, ..recipe.settings };
    RenderJob::new(recipe.scene, recipe.camera, settings, recipe.rules).unwrap()
}

/// A job without spheres.
fn job(width: u32, height: u32, max_depth: u32) -> Result<RenderJob, JobError> {
    let settings = RenderSettings { width, height, max_depth, ..RenderSettings::default() };
    RenderJob::new(Scene::default(), Camera::BOOK, settings, Rules::FINISHED)
}

#[test]
fn pictures_may_reach_the_limits() {
    for (width, height, depth) in [(1, 1, 1), (SIZE_LIMIT, 1, 1), (1, SIZE_LIMIT, DEPTH_LIMIT)] {
        assert!(job(width, height, depth).is_ok(), "{width}x{height}, {depth}");
    }
    for (width, height, what, pixels) in [
        (0, 1, "width", 0),
        (1, 0, "height", 0),
        (SIZE_LIMIT + 1, 2, "width", SIZE_LIMIT + 1),
        (2, SIZE_LIMIT + 1, "height", SIZE_LIMIT + 1),
    ] {
        let message = job(width, height, 1).unwrap_err().to_string();
        assert!(message.contains(what) && message.contains(&format!("is {pixels},")), "{message}");
    }
    for depth in [0, DEPTH_LIMIT + 1] {
        let message = job(2, 1, depth).unwrap_err().to_string();
        assert!(message.contains(&format!("max_depth is {depth}")), "{message}");
    }
    let good = job(2, 1, 1).unwrap();
    let blind = Camera { vfov_degrees: 0.0, ..Camera::BOOK };
    assert!(matches!(good.seen_by(blind, *good.settings()), Err(JobError::Scene(_))));
}

#[test]
fn memory_check_counts_films_file_and_spheres() {
    if memory::room().is_none() {
        return;
    }
    // More than any machine has, in 48 bytes for each pixel.
    const FILMS: u64 = 1 << 20;
    let (width, height) = (SIZE_LIMIT, SIZE_LIMIT - 1);
    let pixels = u64::from(width) * u64::from(height);
    let mut scene = Scene::default();
    let glass = scene.add_material("glass", Material::Dielectric { refraction_index: 1.5 });
    for x in [-3.0, 0.0, 3.0] {
        scene.add_sphere(DVec3::new(x, 0.0, -5.0), 1.0, glass);
    }
    let settings = RenderSettings { width, height, ..RenderSettings::default() };
    let job = RenderJob::new(scene, Camera::BOOK, settings, Rules::FINISHED).unwrap();
    let error = job.check_memory(FILMS, 0).unwrap_err();
    assert_eq!(error.needed_bytes, pixels * (48 * FILMS + 4) + 3 * 400 + (64 << 20));
    assert_eq!(error.what, "a picture of 16384x16383 of 3 spheres");
}

#[test]
fn statistics_add_up() {
    let trace = Duration::from_secs(7);
    let stats = Stats { paths: 1, rays: 2, rejected: 3, busy_lanes: 4, offered_lanes: 5, trace };
    let mut sum = stats;
    sum.add(&stats);
    let trace = 2 * trace;
    assert_eq!(sum, Stats { paths: 2, rays: 4, rejected: 6, busy_lanes: 8, offered_lanes: 10, trace });
}
