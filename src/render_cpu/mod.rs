//! The CPU backends: SIMD packets, scalar code and the `f64` reference, all from one width-generic source.

pub mod broadcast;
pub mod bvh;
pub mod camera;
mod isa;
mod kernels;
pub mod lanes;
pub mod material;
mod options;
pub mod path;
mod record;
pub mod rng;
pub mod sphere;
mod tiles;
pub mod work;

pub use crate::record::{PathRecord, RecordedHit, RecordedRay};
pub use isa::Isa;
pub use options::{CpuError, CpuOptions};
pub use record::{PathRecorder, record_path};

use crate::film::{Film, FilmError};
use crate::kernel::{Real, parts};
use crate::prepared::PreparedScene;
use crate::render::{
    BackendInfo, KernelContents, RenderError, RenderJob, Renderer, Stats, TileOccupancy, panic_text,
};
use broadcast::BroadcastScene;
use kernels::Kernel;
use rayon::prelude::*;
use std::ops::Range;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};
use tiles::{Tile, tile_side, tiles};
use work::{RefillBlock, RefillOrder, TileStats, Work};

/// The nice value added to low-priority threads. Under contention each step costs about a tenth of the time.
#[cfg(target_os = "linux")]
const NICENESS: i32 = 10;

/// A job's prepared scene and kernel in one of the two precisions.
enum Prepared {
    Single(Box<BroadcastScene<f32>>, Kernel<f32>),
    Double(Box<BroadcastScene<f64>>, Kernel<f64>),
}

/// The renderer on the CPU.
pub struct CpuRenderer {
    /// Level and lane count; `None` for the reference.
    packets: Option<(Isa, usize)>,
    /// Whether every job gets the general kernel.
    general: bool,
    threads: rayon::ThreadPool,
    job: Option<RenderJob>,
    prepared: Option<Prepared>,
    occupancy: TileOccupancy,
    messages: Vec<String>,
    /// Tiles left before one in which the tracer panics (fault injection).
    tiles_to_panic: Option<AtomicU64>,
}

/// What a pass traces, and how.
#[derive(Clone, Copy)]
struct Pass<'a> {
    side: u32,
    range: &'a Range<u64>,
    cancel: &'a AtomicBool,
    /// If set, the pass subtracts blocks from the film instead of adding all: the number of blocks by tile.
    taken_away: Option<&'a [u64]>,
}

/// The outcome of tracing a tile.
struct TracedTile {
    stats: TileStats,
    /// Blocks whose sums are in the film.
    finished: u64,
    /// Blocks that the tile has.
    expected: u64,
    /// The message of the tracer's panic, if it panicked.
    panic: Option<String>,
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
                threads,
                job: None,
                prepared: None,
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

/// Lowers the priority of this thread. If the system refuses, the priority stays unchanged.
fn give_way() {
    // On Linux this changes the thread's priority, not the process's.
    #[cfg(target_os = "linux")]
    let _ = rustix::process::nice(NICENESS);
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

    fn prepare(&mut self, job: &RenderJob, _: &AtomicBool) -> Result<(), RenderError> {
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
                let prepared = self.threads.install(|| PreparedScene::renewed(old.zip(before), job));
                self.messages = prepared.warnings().to_vec();
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
                let prepared = self.threads.install(|| PreparedScene::renewed(old.zip(before), job));
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

    fn accumulate(
        &mut self,
        job: &RenderJob,
        range: Range<u64>,
        film: &mut Film,
        cancel: &AtomicBool,
    ) -> Result<Stats, RenderError> {
        self.prepare(job, cancel)?;
        if let Some(range) = film.samples().overlap(&range) {
            return Err(FilmError::Overlap { range }.into());
        }
        let start = Instant::now();
        let side = tile_side(film.width(), film.height(), self.threads.current_num_threads());
        let pass = Pass { side, range: &range, cancel, taken_away: None };
        let traced = self.trace_prepared(pass, film);
        if cancel.load(Ordering::Relaxed) {
            return Err(RenderError::Cancelled);
        }
        if let Some(reason) = what_is_missing(&traced, side, film.width()) {
            return Err(self.undone(pass, &traced, film, reason));
        }
        let pixels = u64::from(film.width()) * u64::from(film.height());
        let paths = pixels * range.end.saturating_sub(range.start);
        let tiles = traced.iter().map(|tile| tile.stats).fold(TileStats::default(), TileStats::plus);
        film.record(range, tiles.rejected)?;
        self.note_occupancy(side, film.width().div_ceil(side), &traced);
        Ok(Stats {
            paths,
            rays: tiles.rays,
            rejected: tiles.rejected,
            busy_lanes: tiles.rays,
            offered_lanes: tiles.offered_lanes,
            trace: start.elapsed(),
        })
    }
}

impl CpuRenderer {
    fn wanted_parts<R: Real>(&self, prepared: &PreparedScene<R>) -> u32 {
        if self.general { parts::ALL } else { prepared.features.parts() }
    }

    /// Like [`CpuRenderer::trace`], with the prepared scene at hand.
    fn trace_prepared(&self, pass: Pass, film: &mut Film) -> Vec<TracedTile> {
        match &self.prepared {
            Some(Prepared::Single(prepared, kernel)) => self.trace(prepared, kernel, pass, film),
            Some(Prepared::Double(prepared, kernel)) => self.trace(prepared, kernel, pass, film),
            None => Vec::new(),
        }
    }

    /// Adds a pass to the film's sums. Returns the outcome of each tile, row by row.
    fn trace<R: Real>(
        &self,
        prepared: &BroadcastScene<R>,
        kernel: &Kernel<R>,
        pass: Pass,
        film: &mut Film,
    ) -> Vec<TracedTile> {
        let settings = &prepared.prepared.settings;
        let blocks = RefillBlock::of_range(pass.range.clone(), settings, prepared.prepared.block_limit);
        let tiles = tiles(film.halves_mut(), settings.width, pass.side);
        let mut orders: Vec<RefillOrder> = Vec::new();
        for tile in &tiles {
            if !orders.iter().any(|order| order.size() == tile.size()) {
                let [width, height] = tile.size();
                orders.push(RefillOrder::new(width, height));
            }
        }
        let trace_tile = |(index, tile): (usize, Tile)| {
            let order = orders.iter().find(|order| order.size() == tile.size()).unwrap_or(&orders[0]);
            let mut work = Work::new(&blocks, order, tile.corner, tile.rows);
            let expected = work.expected();
            if let Some(taken_away) = pass.taken_away {
                work = work.taking_away(taken_away[index]);
            } else if self.is_to_panic() {
                work = work.sabotaged();
            }
            let mut traced = TracedTile { stats: TileStats::default(), finished: 0, expected, panic: None };
            if pass.cancel.load(Ordering::Relaxed) {
                return traced;
            }
            // After a panic `work` is still consistent: the sums that it counts are in the film.
            match catch_unwind(AssertUnwindSafe(|| kernel(prepared, &mut work))) {
                Ok(stats) => traced.stats = stats,
                Err(payload) => traced.panic = Some(panic_text(payload.as_ref()).to_owned()),
            }
            traced.finished = work.finished();
            traced
        };
        self.threads.install(|| tiles.into_par_iter().enumerate().map(trace_tile).collect())
    }

    fn is_to_panic(&self) -> bool {
        self.tiles_to_panic.as_ref().is_some_and(|left| left.fetch_sub(1, Ordering::Relaxed) == 0)
    }

    /// Removes from the film what an incomplete pass has added. A sample is a pure function, so tracing it again
    /// gives the values to subtract. A pass that succeeds pays nothing for this.
    fn undone(&self, pass: Pass, traced: &[TracedTile], film: &mut Film, reason: String) -> RenderError {
        let backend = self.info().name;
        let added: Vec<u64> = traced.iter().map(|tile| tile.finished).collect();
        let never = AtomicBool::new(false);
        let again = self.trace_prepared(Pass { taken_away: Some(&added), cancel: &never, ..pass }, film);
        let is_undone = again.iter().zip(&added).all(|(tile, added)| tile.finished >= *added);
        if is_undone {
            RenderError::Backend { backend, reason }
        } else {
            RenderError::FilmLost { backend, reason }
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

/// Describes the first tile that lacks samples, and why; `None` if the pass is complete.
fn what_is_missing(traced: &[TracedTile], side: u32, width: u32) -> Option<String> {
    let index = traced.iter().position(|tile| tile.panic.is_some() || tile.finished != tile.expected)?;
    let TracedTile { finished, expected, panic, .. } = &traced[index];
    let columns = width.div_ceil(side) as usize;
    let (x, y) = (index % columns * side as usize, index / columns * side as usize);
    let why = panic.as_ref().map_or(String::new(), |text| format!("it panicked: {text}; "));
    Some(format!(
        "{why}of {expected} blocks of samples in the tile at pixel ({x}, {y}) {finished} were finished"
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recipe::Recipe;
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
    fn a_tile_without_all_its_samples_is_named_by_its_corner() {
        let tile = |finished| TracedTile { stats: TileStats::default(), finished, expected: 9, panic: None };
        // Tiles of 8 pixels in a picture of 20: three columns.
        let mut traced: Vec<TracedTile> = [9, 9, 9, 9, 4, 9].map(tile).into();
        let told = what_is_missing(&traced, 8, 20).expect("samples are missing");
        assert_eq!(told, "of 9 blocks of samples in the tile at pixel (8, 8) 4 were finished");
        assert_eq!(what_is_missing(&traced[..4], 8, 20), None);
        traced[2].panic = Some("a slip".to_owned());
        let told = what_is_missing(&traced, 8, 20).expect("a panic");
        assert!(
            told.starts_with("it panicked: a slip; of 9 blocks of samples in the tile at pixel (16, 0)"),
            "{told}"
        );
    }
}
