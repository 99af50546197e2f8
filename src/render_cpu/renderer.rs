//! The renderer on the CPU: what it prepares for a job, and its passes.

use super::broadcast::BroadcastScene;
use super::isa::Isa;
use super::kernels;
use super::options::{CpuError, CpuOptions};
use super::pass::{Pass, PassTracer, Prepared, Purpose, Stop, TracedTile, what_is_missing};
use super::priority::give_way;
use super::rebuild::Rebuild;
use super::tiles::tile_side;
use super::work::TileStats;
use crate::film::{Film, FilmError};
use crate::kernel::{Real, parts};
use crate::prepared::PreparedScene;
use crate::render::{BackendInfo, KernelContents, RenderError, RenderJob, Renderer, Stats, TileOccupancy};
use std::ops::Range;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// The renderer on the CPU.
pub struct CpuRenderer {
    /// Level and lane count; `None` for the reference.
    packets: Option<(Isa, usize)>,
    /// Whether every job gets the general kernel.
    general: bool,
    low_priority: bool,
    threads: rayon::ThreadPool,
    job: Option<RenderJob>,
    pub(super) prepared: Option<Prepared>,
    pub(super) rebuild: Rebuild,
    occupancy: TileOccupancy,
    messages: Vec<String>,
    /// Tiles left before one in which the tracer panics (fault injection).
    tiles_to_panic: Option<AtomicU64>,
}

impl CpuRenderer {
    /// Creates a renderer in `f32` with these options.
    ///
    /// # Errors
    /// [`CpuError`], with what is available instead.
    pub fn new(options: CpuOptions) -> Result<Self, CpuError> {
        let available = Isa::available();
        let best = available.iter().copied().max().unwrap_or(Isa::Portable);
        let isa = options.isa.unwrap_or(best);
        if !available.contains(&isa) {
            return Err(CpuError::Isa { isa, available });
        }
        let lanes = options.lanes.unwrap_or_else(|| isa.native_lanes());
        if !isa.lane_counts().contains(&lanes) {
            return Err(CpuError::Lanes { lanes, isa, available: isa.lane_counts().to_vec() });
        }
        let renderer = CpuRenderer::with_packets(Some((isa, lanes)), options.threads, options.low_priority)?;
        let tiles_to_panic = options.panics_after.map(AtomicU64::new);
        Ok(CpuRenderer { general: options.general, tiles_to_panic, ..renderer })
    }

    /// Creates the reference renderer: scalar, `f64`, with `threads` threads (`None`: one per core).
    ///
    /// # Errors
    /// [`CpuError::Threads`] if the threads cannot be started.
    pub fn reference(threads: Option<usize>) -> Result<Self, CpuError> {
        CpuRenderer::with_packets(None, threads, false)
    }

    fn with_packets(
        packets: Option<(Isa, usize)>,
        threads: Option<usize>,
        low_priority: bool,
    ) -> Result<Self, CpuError> {
        let threads = threads.unwrap_or(0);
        rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .thread_name(|index| format!("trace-{index}"))
            .start_handler(move |_| {
                if low_priority {
                    give_way();
                }
            })
            .build()
            .map(|threads| CpuRenderer {
                packets,
                general: false,
                low_priority,
                threads,
                job: None,
                prepared: None,
                rebuild: Rebuild::new(),
                occupancy: TileOccupancy::default(),
                tiles_to_panic: None,
                messages: Vec::new(),
            })
            .map_err(|error| {
                let cores = std::thread::available_parallelism().map_or(1, usize::from);
                let threads = if threads == 0 { cores } else { threads };
                CpuError::Threads { threads, reason: error.to_string() }
            })
    }
}

impl Renderer for CpuRenderer {
    fn info(&self) -> BackendInfo {
        let threads = self.threads.current_num_threads();
        match self.packets {
            Some((isa, lanes)) => BackendInfo { name: "cpu", device: isa.to_string(), lanes, threads },
            None => BackendInfo { name: "reference", device: "f64".into(), lanes: 1, threads },
        }
    }

    fn kernel(&self) -> String {
        let needed = match &self.prepared {
            Some(Prepared::Single(prepared, _)) => prepared.prepared.features.parts(),
            Some(Prepared::Double(prepared, _)) => prepared.prepared.features.parts(),
            None => return String::new(),
        };
        let (present, needed) = (self.kernel_contents().present, parts::describe(needed));
        if needed == present { present } else { format!("{present} (needed: {needed})") }
    }

    fn kernel_contents(&self) -> KernelContents {
        let present = match (self.packets, &self.prepared) {
            (Some((isa, lanes)), Some(Prepared::Single(prepared, _))) => {
                kernels::offered(isa, lanes, self.wanted_parts(&prepared.prepared))
            }
            (_, Some(_)) => parts::ALL,
            (_, None) => return KernelContents::default(),
        };
        KernelContents { present: parts::describe(present), left_out: parts::left_out(present) }
    }

    fn hierarchy_time(&self) -> Duration {
        match &self.prepared {
            Some(Prepared::Single(prepared, _)) => prepared.prepared.hierarchy_time,
            Some(Prepared::Double(prepared, _)) => prepared.prepared.hierarchy_time,
            None => Duration::ZERO,
        }
    }

    fn prepare(&mut self, job: &RenderJob, cancel: &AtomicBool) -> Result<(), RenderError> {
        if self.prepared.is_some() && self.job.as_ref() == Some(job) {
            return Ok(());
        }
        self.occupancy = TileOccupancy::default();
        let before = self.job.take();
        self.prepared = Some(match (self.packets, self.prepared.take()) {
            (Some((isa, lanes)), old) => {
                let old = if let Some(Prepared::Single(broadcast, _)) = old {
                    Some(broadcast.prepared)
                } else {
                    None
                };
                let made = || PreparedScene::renewed_unless(cancel, old.zip(before), job);
                let prepared = self.threads.install(made).ok_or(RenderError::Cancelled)?;
                self.messages = prepared.warnings().to_vec();
                self.rebuild.note_prepared(&prepared);
                let wanted = self.wanted_parts(&prepared);
                let kernel = kernels::kernel(isa, lanes, wanted).ok_or_else(|| RenderError::Backend {
                    backend: "cpu",
                    reason: format!("there is no kernel for {lanes} lanes of {isa}"),
                })?;
                Prepared::Single(Box::new(BroadcastScene::new(prepared)), kernel)
            }
            (None, old) => {
                let old = if let Some(Prepared::Double(broadcast, _)) = old {
                    Some(broadcast.prepared)
                } else {
                    None
                };
                let made = || PreparedScene::renewed_unless(cancel, old.zip(before), job);
                let prepared = self.threads.install(made).ok_or(RenderError::Cancelled)?;
                Prepared::Double(Box::new(BroadcastScene::new(prepared)), kernels::reference_kernel())
            }
        });
        self.job = Some(job.clone());
        Ok(())
    }

    fn take_messages(&mut self) -> Vec<String> {
        std::mem::take(&mut self.messages)
    }

    fn tile_occupancy(&self) -> Option<TileOccupancy> {
        self.packets.map(|_| self.occupancy.clone())
    }

    fn try_out(&mut self, film: &mut Film, one_in: usize, cancel: &AtomicBool) -> Option<Duration> {
        let side = tile_side(film.width(), film.height(), self.threads.current_num_threads());
        let count = film.halves().len() as u64;
        let stop = Stop::when(cancel);
        let pass = Pass { side, range: &(0..count), cancel, stop: &stop, purpose: Purpose::Try(one_in) };
        Some(self.pass_tracer()?.try_out(pass, one_in, film)? / count as u32)
    }

    fn accumulate(
        &mut self,
        job: &RenderJob,
        range: Range<u64>,
        film: &mut Film,
        cancel: &AtomicBool,
    ) -> Result<Stats, RenderError> {
        let never = AtomicBool::new(false);
        Ok(self.advance_unless(job, range, film, cancel, &never)?.unwrap_or_default())
    }

    fn heeds_stop(&self) -> bool {
        true
    }

    fn advance_unless(
        &mut self,
        job: &RenderJob,
        range: Range<u64>,
        film: &mut Film,
        cancel: &AtomicBool,
        stop: &AtomicBool,
    ) -> Result<Option<Stats>, RenderError> {
        self.prepare(job, cancel)?;
        self.take_better_hierarchy(job);
        if let Some(range) = film.samples().overlap(&range) {
            return Err(FilmError::Overlap { range }.into());
        }
        let start = Instant::now();
        let side = tile_side(film.width(), film.height(), self.threads.current_num_threads());
        let stop = Stop::when(stop);
        let pass = Pass { side, range: &range, cancel, stop: &stop, purpose: Purpose::Add };
        let tracer = self.pass_tracer().ok_or_else(|| RenderError::Backend {
            backend: self.info().name,
            reason: "no scene is prepared".to_owned(),
        })?;
        let traced = tracer.trace(pass, film);
        if cancel.load(Ordering::Relaxed) {
            return Err(RenderError::Cancelled);
        }
        if let Some(reason) = what_is_missing(&traced, side, film.width()) {
            let backend = self.info().name;
            let is_taken_away = tracer.take_away(pass, &traced, film);
            return match (is_taken_away, stop.is_given_up()) {
                (false, _) => Err(RenderError::FilmLost { backend, reason }),
                (true, true) => Ok(None),
                (true, false) => Err(RenderError::Backend { backend, reason }),
            };
        }
        let pixels = u64::from(film.width()) * u64::from(film.height());
        let paths = pixels * range.end.saturating_sub(range.start);
        let tiles = traced.iter().map(|tile| tile.stats).fold(TileStats::default(), TileStats::plus);
        film.record(range, tiles.rejected)?;
        self.note_occupancy(side, film.width().div_ceil(side), &traced);
        let trace = start.elapsed();
        self.begin_better_hierarchy(job, trace);
        Ok(Some(Stats {
            paths,
            rays: tiles.rays,
            rejected: tiles.rejected,
            busy_lanes: tiles.rays,
            offered_lanes: tiles.offered_lanes,
            trace,
        }))
    }
}

impl CpuRenderer {
    fn pass_tracer(&self) -> Option<PassTracer<'_>> {
        let prepared = self.prepared.as_ref()?;
        Some(PassTracer { threads: &self.threads, prepared, tiles_to_panic: self.tiles_to_panic.as_ref() })
    }

    fn wanted_parts<R: Real>(&self, prepared: &PreparedScene<R>) -> u32 {
        if self.general { parts::ALL } else { prepared.features.parts() }
    }

    /// Goes on with the better hierarchy if it has been built.
    fn take_better_hierarchy(&mut self, job: &RenderJob) {
        if let Some(Prepared::Single(broadcast, _)) = &mut self.prepared
            && let Some(better) = self.rebuild.take_built(job)
        {
            **broadcast = BroadcastScene::new(better);
        }
    }

    /// Begins to build a better hierarchy if tracing has gone on for long.
    fn begin_better_hierarchy(&mut self, job: &RenderJob, traced: Duration) {
        if let Some(Prepared::Single(broadcast, _)) = &self.prepared {
            let threads = self.threads.current_num_threads();
            self.rebuild.note_pass(traced, threads, &broadcast.prepared, job, self.low_priority);
        }
    }

    fn note_occupancy(&mut self, side: u32, columns: u32, traced: &[TracedTile]) {
        let tiles = &mut self.occupancy.tiles;
        tiles.resize(traced.len(), [0; 2]);
        for (tile, TracedTile { stats, .. }) in tiles.iter_mut().zip(traced) {
            tile[0] += stats.rays;
            tile[1] += stats.offered_lanes;
        }
        (self.occupancy.side, self.occupancy.columns) = (side, columns);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recipe::Recipe;
    #[cfg(target_os = "linux")]
    use crate::render_cpu::priority::NICENESS;
    use crate::scene::{Material, Sphere};
    use glam::DVec3;

    fn small(scene: &str) -> RenderJob {
        let mut recipe = Recipe::find(scene).expect("a built-in scene");
        (recipe.settings.width, recipe.settings.height) = (20, 12);
        recipe.job().expect("valid")
    }

    fn film(renderer: &mut CpuRenderer, job: &RenderJob) -> Film {
        let mut film = job.new_film();
        renderer.accumulate(job, 0..4, &mut film, &AtomicBool::new(false)).expect("traced");
        film
    }

    #[test]
    fn a_hierarchy_outlives_the_move_of_a_camera_and_gives_the_same_film() {
        let first = small("field:200");
        let mut moved = *first.camera();
        moved.look_from += DVec3::new(0.5, 0.25, -1.0);
        moved.defocus_angle_degrees = 1.0;
        let scene = first.scene();
        let is_small_and_opaque =
            |s: &&Sphere| s.radius < 10.0 && !matches!(scene.material_of(s), Material::Dielectric { .. });
        let mut inside = *first.camera();
        inside.look_from = scene.spheres.iter().find(is_small_and_opaque).expect("one").center;
        let mut renderer = CpuRenderer::new(CpuOptions::default()).expect("available");
        film(&mut renderer, &first);
        assert_ne!(renderer.hierarchy_time(), Duration::ZERO);
        // Inside an opaque ball nothing else is visible, so there is nothing to build.
        for (camera, is_kept) in [(moved, true), (inside, true), (moved, false), (*first.camera(), true)] {
            let job = first.seen_by(camera, *first.settings()).expect("valid");
            let again = film(&mut renderer, &job);
            assert_eq!(renderer.hierarchy_time() == Duration::ZERO, is_kept, "{camera:?}");
            let mut fresh = CpuRenderer::new(CpuOptions::default()).expect("available");
            assert!(again == film(&mut fresh, &job), "{camera:?}");
        }
    }

    #[test]
    fn the_tiles_add_up_to_the_picture() {
        let job = small("three-spheres");
        let mut renderer = CpuRenderer::new(CpuOptions::default()).expect("available");
        let mut film = job.new_film();
        let mut stats = Stats::default();
        for range in [0..2, 2..4] {
            stats.add(&renderer.accumulate(&job, range, &mut film, &AtomicBool::new(false)).expect("traced"));
        }
        let occupancy = renderer.tile_occupancy().expect("packets");
        let sum = |which: usize| occupancy.tiles.iter().map(|tile| tile[which]).sum::<u64>();
        assert_eq!([sum(0), sum(1)], [stats.busy_lanes, stats.offered_lanes]);
        assert!(occupancy.share_at([19, 11]).is_some_and(|share| share > 0.0 && share <= 1.0));
        assert_eq!(occupancy.share_at([0, 4000]), None);
        renderer.prepare(&small("metals"), &AtomicBool::new(false)).expect("prepared");
        assert!(renderer.tile_occupancy().expect("packets").tiles.is_empty());
        assert_eq!(CpuRenderer::reference(Some(1)).expect("available").tile_occupancy(), None);
    }

    #[test]
    fn a_trial_tells_a_time_and_adds_nothing() {
        let (job, never) = (small("three-spheres"), AtomicBool::new(false));
        let mut renderer = CpuRenderer::new(CpuOptions::default()).expect("available");
        let mut film = job.new_film();
        assert_eq!(renderer.try_out(&mut film, 16, &never), None, "nothing is prepared");
        renderer.prepare(&job, &never).expect("prepared");
        assert!(renderer.try_out(&mut film, 16, &never).is_some_and(|time| time > Duration::ZERO));
        assert_eq!(renderer.try_out(&mut film, 16, &AtomicBool::new(true)), None, "it was cancelled");
        assert!(film == job.new_film());
        renderer.accumulate(&job, 0..4, &mut film, &never).expect("traced");
        let before = film.clone();
        assert!(renderer.try_out(&mut film, 16, &never).is_some());
        assert!(film == before);
    }

    #[test]
    fn a_stop_leaves_the_film_with_a_whole_pass_or_without_it() {
        let mut recipe = Recipe::find("three-spheres").expect("a built-in scene");
        (recipe.settings.width, recipe.settings.height) = (256, 144);
        let (job, never) = (recipe.job().expect("valid"), AtomicBool::new(false));
        let mut renderer =
            CpuRenderer::new(CpuOptions { threads: Some(2), ..CpuOptions::default() }).expect("available");
        let mut held = job.new_film();
        renderer.accumulate(&job, 0..4, &mut held, &never).expect("traced");
        let mut whole = held.clone();
        let begin = Instant::now();
        renderer.accumulate(&job, 4..68, &mut whole, &never).expect("traced");
        let pass = begin.elapsed();
        for eighths in [0, 1, 2, 3, 4, 6, 80] {
            let (mut film, stop) = (held.clone(), AtomicBool::new(eighths == 0));
            let outcome = std::thread::scope(|scope| {
                scope.spawn(|| {
                    std::thread::sleep(eighths * pass / 8);
                    stop.store(true, Ordering::Relaxed);
                });
                renderer.advance_unless(&job, 4..68, &mut film, &never, &stop).expect("no failure")
            });
            assert!(
                film == if outcome.is_some() { whole.clone() } else { held.clone() },
                "{eighths} eighths"
            );
            match eighths {
                0 => assert!(outcome.is_none(), "it was to be given up"),
                80 => assert!(outcome.is_some(), "it was to be finished"),
                _ => {}
            }
        }
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn threads_of_low_priority_give_way() {
        let niceness = |low_priority| {
            let options = CpuOptions { threads: Some(1), low_priority, ..CpuOptions::default() };
            CpuRenderer::new(options).unwrap().threads.install(|| {
                let stat = std::fs::read_to_string("/proc/thread-self/stat").unwrap();
                // The 19th field; the second is a name in brackets, which may hold blanks.
                let (_, from_third) = stat.rsplit_once(") ").unwrap();
                from_third.split(' ').nth(16).unwrap().parse::<i32>().unwrap()
            })
        };
        assert_eq!(niceness(true), (niceness(false) + NICENESS).min(19));
    }
}
