//! The job that every backend renders, and its interface: [`RenderJob`] and the [`Renderer`] trait.
//!
//! **A sample is a pure function** of (job, pixel, sample index). It does not depend on the backend, the packet width,
//! the thread, neighbouring pixels or earlier samples. Everything else relies on this.

mod settings;

pub use settings::{RenderSettings, SamplerKind};

pub use crate::film::{SAMPLE_LIMIT, SIZE_LIMIT};

use crate::film::Film;
use crate::scene::{Camera, Scene, SceneError};
use crate::stages::Rules;
use crate::system::memory::{self, MemoryError};
use serde::Serialize;
use std::any::Any;
use std::ops::Range;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Duration;
use thiserror::Error;

/// Largest number of rays per path.
pub const DEPTH_LIMIT: u32 = 10_000;

/// Memory per pixel besides its sums while the picture is written.
const OUTPUT_BYTES_PER_PIXEL: u64 = 4;

/// Memory per sphere besides its place in the scene: prepared scene, hierarchy, and the peak while building them.
pub const TRACING_BYTES_PER_SPHERE: u64 = 400;

/// A job: a picture to render, validated once. Two equal jobs have the same samples.
#[derive(Clone, Debug)]
pub struct RenderJob {
    scene: Arc<Scene>,
    camera: Camera,
    settings: RenderSettings,
    rules: Rules,
    viewport: Viewport,
}

/// Where pictures of other programs have their viewport: across at `0.5 + scale * (p - 0.5) + shift` instead of `p`, in
/// shares of its width and height from the upper left.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Viewport {
    pub scale: [f64; 2],
    pub shift: [f64; 2],
}

impl Viewport {
    pub const WHOLE: Viewport = Viewport { scale: [1.0; 2], shift: [0.0; 2] };
}

impl PartialEq for RenderJob {
    /// Scenes that share memory are not compared sphere by sphere.
    fn eq(&self, other: &Self) -> bool {
        (self.camera, self.settings, self.rules, self.viewport)
            == (other.camera, other.settings, other.rules, other.viewport)
            && (Arc::ptr_eq(&self.scene, &other.scene) || self.scene == other.scene)
    }
}

impl RenderJob {
    /// Creates a job and validates everything that backends rely on.
    ///
    /// # Errors
    /// The first invalid value, with its limit and a remedy.
    pub fn new(
        scene: impl Into<Arc<Scene>>,
        camera: Camera,
        settings: RenderSettings,
        rules: Rules,
    ) -> Result<Self, JobError> {
        let scene = scene.into();
        scene.validate()?;
        RenderJob { scene, camera, settings, rules, viewport: Viewport::WHOLE }.seen_by(camera, settings)
    }

    /// The same scene and rules with another camera or other settings. The scene is shared and not validated again.
    ///
    /// # Errors
    /// The first invalid value of the camera or the settings.
    pub fn seen_by(&self, camera: Camera, settings: RenderSettings) -> Result<Self, JobError> {
        camera.validate()?;
        for (what, value, limit, remedy) in [
            ("width", settings.width, SIZE_LIMIT, "choose a smaller picture or stitch several"),
            ("height", settings.height, SIZE_LIMIT, "choose a smaller picture or stitch several"),
            ("max_depth", settings.max_depth, DEPTH_LIMIT, "the book uses 50 rays per path"),
        ] {
            if !(1..=limit).contains(&value) {
                let reason = format!("{what} is {value}, but must be between 1 and {limit}; {remedy}");
                return Err(JobError::Settings(reason));
            }
        }
        Ok(RenderJob { scene: Arc::clone(&self.scene), camera, settings, ..*self })
    }

    /// The same job with another viewport.
    pub fn through(self, viewport: Viewport) -> Self {
        RenderJob { viewport, ..self }
    }

    pub fn viewport(&self) -> &Viewport {
        &self.viewport
    }

    /// Whether both jobs share one scene in memory, under the same rules.
    pub fn shares_scene_with(&self, other: &RenderJob) -> bool {
        Arc::ptr_eq(&self.scene, &other.scene) && self.rules == other.rules
    }

    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    pub fn camera(&self) -> &Camera {
        &self.camera
    }

    pub fn settings(&self) -> &RenderSettings {
        &self.settings
    }

    pub fn rules(&self) -> &Rules {
        &self.rules
    }

    pub fn new_film(&self) -> Film {
        Film::new(self.settings.width, self.settings.height)
    }

    /// Returns an error if preparing, tracing and writing the job with `films` films of its size, and `more` bytes per
    /// pixel for its picture, needs more memory than is available.
    ///
    /// # Errors
    /// [`MemoryError`], with a remedy.
    pub fn check_memory(&self, films: u64, more: u64) -> Result<(), MemoryError> {
        let RenderSettings { width, height, .. } = self.settings;
        let film = Film::bytes(width, height).saturating_mul(films);
        let output = u64::from(width) * u64::from(height) * (OUTPUT_BYTES_PER_PIXEL + more);
        let spheres = self.scene.spheres.len();
        memory::check(
            || format!("a picture of {width}x{height} of {spheres} spheres"),
            film.saturating_add(output).saturating_add(TRACING_BYTES_PER_SPHERE * spheres as u64),
            "choose a smaller --size or a scene of fewer spheres",
        )
    }
}

/// A job that cannot be rendered.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum JobError {
    /// The scene or the camera is invalid.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// A setting is out of range: what it is, and the remedy.
    #[error("{0}")]
    Settings(String),
}

/// Statistics of a call to [`Renderer::advance`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Stats {
    /// Completed paths: pixels times samples.
    pub paths: u64,
    /// Rays traced.
    pub rays: u64,
    /// Rejected samples: NaN, infinite or negative.
    pub rejected: u64,
    /// Lanes that traced a ray, summed over all intersections of packets.
    pub busy_lanes: u64,
    /// Available lanes, summed over all intersections of packets.
    pub offered_lanes: u64,
    /// Wall time spent tracing.
    pub trace: Duration,
}

impl Stats {
    /// Adds the statistics of another call.
    pub fn add(&mut self, other: &Stats) {
        self.paths += other.paths;
        self.rays += other.rays;
        self.rejected += other.rejected;
        self.busy_lanes += other.busy_lanes;
        self.offered_lanes += other.offered_lanes;
        self.trace += other.trace;
    }
}

/// A renderer's kernel for its job; empty without a job.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct KernelInfo {
    /// The kernel, and how long it took to compile.
    pub about: String,
    /// The parts that it leaves out.
    pub left_out: Vec<&'static str>,
    /// Wall time of building the hierarchy; zero if there is none.
    pub hierarchy_time: Duration,
}

/// Why samples could not be added to a film.
#[derive(Debug, Error)]
pub enum RenderError {
    /// The caller cancelled the call. The film's sums are then unusable.
    #[error("cancelled")]
    Cancelled,
    /// The backend failed; another can continue from the last good film.
    #[error("{backend} failed: {reason}")]
    Backend { backend: &'static str, reason: String },
    /// The backend failed while adding samples, and its partial additions could not be removed: the film is unusable.
    #[error("{backend} failed: {reason}; the samples that it was adding spoiled the film")]
    FilmLost { backend: &'static str, reason: String },
    /// The same samples were requested twice.
    #[error(transparent)]
    Film(#[from] crate::film::FilmError),
}

impl RenderError {
    /// Converts a backend's panic to an error.
    pub fn of_panic(backend: &'static str, payload: &(dyn Any + Send)) -> Self {
        RenderError::Backend { backend, reason: format!("it panicked: {}", panic_text(payload)) }
    }
}

pub fn panic_text(payload: &(dyn Any + Send)) -> &str {
    let text = payload.downcast_ref::<String>().map(String::as_str);
    text.or_else(|| payload.downcast_ref::<&str>().copied()).unwrap_or("for no stated reason")
}

/// Describes a backend, for reports.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct BackendInfo {
    /// "cpu", "reference" or "gpu".
    pub name: &'static str,
    /// The instruction level, or the adapter.
    pub device: String,
    /// Number of paths that advance in step.
    pub lanes: usize,
    pub threads: usize,
}

/// Figures of a renderer about its prepared job.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Diagnostics {
    pub kernel: KernelInfo,
    /// Total time of all dispatches so far by the device's own clock; `None` without one.
    pub device_time: Option<Duration>,
    /// Whether the renderer acts on [`Control::stop`], so that stopping takes at most half the time of a pass.
    pub stops_early: bool,
}

/// How a call of [`Renderer::advance`] may end.
#[derive(Clone, Copy, Debug)]
pub struct Control<'a> {
    /// Ends the call at the next small unit of work and leaves the film's sums incomplete.
    pub cancel: &'a AtomicBool,
    /// The renderer either finishes or withdraws what it has added, whichever is quicker. It may also ignore this flag.
    pub stop: &'a AtomicBool,
    /// Whether samples may stay with the renderer until a later call adds them to the same film.
    pub may_defer: bool,
}

impl<'a> Control<'a> {
    /// A call that ends only when all samples are in the film, or `cancel` is set.
    pub fn new(cancel: &'a AtomicBool) -> Self {
        static NEVER: AtomicBool = AtomicBool::new(false);
        Control { cancel, stop: &NEVER, may_defer: false }
    }

    /// Like [`Control::new`], but samples may stay with the renderer.
    pub fn deferring(cancel: &'a AtomicBool) -> Self {
        Control { may_defer: true, ..Control::new(cancel) }
    }
}

/// The result of [`Renderer::advance`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Outcome {
    /// Statistics of the samples that this call added to the film.
    Added(Stats),
    /// The call was stopped and the film is unchanged.
    Withdrawn,
}

impl Outcome {
    /// Statistics of the samples that were added.
    pub fn stats(self) -> Stats {
        match self {
            Outcome::Added(stats) => stats,
            Outcome::Withdrawn => Stats::default(),
        }
    }
}

/// A backend, which adds samples to a film.
pub trait Renderer: Send {
    fn info(&self) -> BackendInfo;

    fn diagnostics(&self) -> Diagnostics {
        Diagnostics::default()
    }

    /// Takes messages that the user has not seen yet, such as a software adapter in use or a part that failed.
    fn take_messages(&mut self) -> Vec<String> {
        Vec::new()
    }

    /// Begins a film of `job`: builds whatever tracing needs and is missing (prepared scene, hierarchy, kernels), and
    /// discards traced samples that are not in a film.
    ///
    /// Checks `cancel` while the scene is prepared and while kernels compile.
    ///
    /// # Errors
    /// [`RenderError::Backend`] if the backend cannot render this job; [`RenderError::Cancelled`] if it was cancelled.
    fn prepare(&mut self, job: &RenderJob, cancel: &AtomicBool) -> Result<(), RenderError>;

    /// Estimates how long a sample of every pixel of the prepared job takes, by tracing about one pixel in `one_in` and
    /// discarding the result. In long passes a sample takes less time. `None` if the renderer cannot tell.
    fn estimate_sample_time(&mut self, _one_in: usize, _cancel: &AtomicBool) -> Option<Duration> {
        None
    }

    /// Adds samples `range` of every pixel to `film`, which records the samples that it contains. Prepares the job if
    /// necessary.
    ///
    /// # Errors
    /// After [`RenderError::Cancelled`] and [`RenderError::FilmLost`] the film's sums are incomplete: discard it. After
    /// any other error the film is unchanged, and deferred samples are lost. The film is also unchanged after a panic: a
    /// renderer that adds to it piece by piece catches panics and removes the pieces.
    fn advance(
        &mut self,
        job: &RenderJob,
        range: Range<u64>,
        film: &mut Film,
        control: &Control,
    ) -> Result<Outcome, RenderError>;

    /// Calls [`Renderer::advance`] with [`Control::new`].
    ///
    /// # Errors
    /// As for [`Renderer::advance`].
    fn accumulate(
        &mut self,
        job: &RenderJob,
        range: Range<u64>,
        film: &mut Film,
        cancel: &AtomicBool,
    ) -> Result<Stats, RenderError> {
        Ok(self.advance(job, range, film, &Control::new(cancel))?.stats())
    }

    /// Requests the samples deferred so far: the next [`Renderer::advance`] adds them to the film while tracing.
    ///
    /// # Errors
    /// [`RenderError::Backend`].
    fn request_readback(&mut self) -> Result<(), RenderError> {
        Ok(())
    }

    /// Waits for all deferred samples and adds them to the film.
    ///
    /// # Errors
    /// [`RenderError::Backend`]; samples that are not in the film are then lost.
    fn finish(&mut self, _film: &mut Film) -> Result<Stats, RenderError> {
        Ok(Stats::default())
    }
}

#[cfg(test)]
pub(crate) mod tests;
