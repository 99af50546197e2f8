//! A pass over a film: its tiles are traced by all threads, and a pass that breaks off is withdrawn. An
//! estimate traces a few tiles to learn how long a pass will take.

use super::broadcast::BroadcastScene;
use super::kernels::Kernel;
use super::tiles::{Tile, tiles};
use super::work::{RefillBlock, RefillOrder, TileStats, Work};
use crate::film::{Film, PixelSum};
use crate::job::render::panic_text;
use crate::kernel::Real;
use crate::prepared::PreparedScene;
use crate::system::threads::Pool;
use rayon::prelude::*;
use std::ops::Range;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::{Duration, Instant};

/// A job's prepared scene and kernel in one of the two precisions.
pub(super) enum Prepared {
    Single(Box<BroadcastScene<f32>>, Kernel<f32>),
    Double(Box<BroadcastScene<f64>>, Kernel<f64>),
}

/// A pass.
#[derive(Clone, Copy)]
pub(super) struct Pass<'a> {
    pub side: u32,
    pub range: &'a Range<u64>,
    pub cancel: &'a AtomicBool,
    /// Leaves out the other tiles once a stop is requested, if little has been traced.
    pub stop: &'a StopRequest<'a>,
    pub purpose: Purpose<'a>,
}

/// Decides, when a stop is requested, whether a pass is finished or withdrawn.
pub(super) struct StopRequest<'a> {
    requested: &'a AtomicBool,
    tiles_begun: AtomicUsize,
    is_given_up: OnceLock<bool>,
}

impl<'a> StopRequest<'a> {
    /// A stop that is requested by setting `requested`.
    pub fn when(requested: &'a AtomicBool) -> Self {
        StopRequest { requested, tiles_begun: AtomicUsize::new(0), is_given_up: OnceLock::new() }
    }

    /// Whether the pass was given up.
    pub fn is_given_up(&self) -> bool {
        self.is_given_up.get().copied().unwrap_or(false)
    }

    /// Whether the next of `tile_count` tiles is left out. To withdraw a tile, it is traced again, so a pass is given up if
    /// fewer than half of its tiles have begun.
    fn skips_next(&self, tile_count: usize) -> bool {
        let begun = self.tiles_begun.fetch_add(1, Ordering::Relaxed);
        self.requested.load(Ordering::Relaxed) && *self.is_given_up.get_or_init(|| 2 * begun < tile_count)
    }
}

/// The use of the sums of a pass.
#[derive(Clone, Copy)]
pub(super) enum Purpose<'a> {
    /// Adds them to the film.
    Add,
    /// Subtracts the first blocks of each tile from the film: how many, by tile.
    Withdraw(&'a [u64]),
    /// Drops them, and traces only one tile in `one_in`.
    Estimate { one_in: usize },
}

/// Whether an estimate from one tile in `one_in` traces tile `number`. These tiles are spread over the picture; there is at
/// least one.
fn is_probed(number: usize, tile_count: usize, one_in: usize) -> bool {
    number % one_in == tile_count.min(one_in) / 2
}

/// The outcome of tracing a tile.
#[derive(Default)]
pub(super) struct TracedTile {
    pub stats: TileStats,
    /// Blocks whose sums are in the film.
    pub finished: u64,
    /// Blocks that the tile has.
    pub expected: u64,
    /// The message of the tracer's panic, if it panicked.
    pub panic: Option<String>,
    /// Wall time of the tile.
    pub took: Duration,
}

impl TracedTile {
    fn is_whole(&self) -> bool {
        self.panic.is_none() && self.finished == self.expected
    }
}

/// Traces passes.
#[derive(Clone, Copy)]
pub(super) struct PassTracer<'a> {
    pub threads: &'a Pool,
    pub prepared: &'a Prepared,
}

impl PassTracer<'_> {
    /// Adds a pass to the film's sums. Returns the outcome of each tile, row by row.
    pub fn trace(&self, pass: Pass, film: &mut Film) -> Vec<TracedTile> {
        match self.prepared {
            Prepared::Single(broadcast, kernel) => self.trace_with(broadcast, kernel, pass, film),
            Prepared::Double(broadcast, kernel) => self.trace_with(broadcast, kernel, pass, film),
        }
    }

    /// Subtracts from the film what an incomplete pass has added; `false` if that fails. A sample is a pure function, so
    /// tracing it again gives the values to subtract. A pass that succeeds pays nothing for this.
    pub fn withdraw(&self, pass: Pass, traced: &[TracedTile], film: &mut Film) -> bool {
        let added: Vec<u64> = traced.iter().map(|tile| tile.finished).collect();
        let never = AtomicBool::new(false);
        let (purpose, stop) = (Purpose::Withdraw(&added), &StopRequest::when(&never));
        let again = self.trace(Pass { purpose, cancel: &never, stop, ..pass }, film);
        again.iter().zip(&added).all(|(tile, added)| tile.finished >= *added)
    }

    /// Estimates the time of a pass from some of its tiles; `None` if one of them failed. The film is unchanged.
    pub fn estimate_time(&self, pass: Pass, film: &mut Film) -> Option<Duration> {
        let tile_count = film.width().div_ceil(pass.side) * film.height().div_ceil(pass.side);
        let traced = self.trace(pass, film);
        let share = traced.len() as f64 / f64::from(tile_count);
        let took: Duration = traced.iter().map(|tile| tile.took).sum();
        let is_whole = !traced.is_empty() && traced.iter().all(TracedTile::is_whole);
        is_whole.then(|| took.div_f64(share * self.threads.count() as f64))
    }

    fn trace_with<R: Real>(
        &self,
        broadcast: &BroadcastScene<R>,
        kernel: &Kernel<R>,
        pass: Pass,
        film: &mut Film,
    ) -> Vec<TracedTile> {
        let PreparedScene { settings, block_limit, .. } = &broadcast.prepared;
        let blocks = RefillBlock::of_range(pass.range.clone(), settings, *block_limit);
        let is_first = film.sample_count() == 0 && matches!(pass.purpose, Purpose::Add);
        let mut tiles = tiles(film.halves_mut(), settings.width, pass.side);
        if let Purpose::Estimate { one_in } = pass.purpose {
            let count = tiles.len();
            let probed =
                tiles.into_iter().enumerate().filter(|(number, _)| is_probed(*number, count, one_in));
            tiles = probed.map(|(_, tile)| tile).collect();
        }
        let mut orders: Vec<RefillOrder> = Vec::new();
        for tile in &tiles {
            if !orders.iter().any(|order| order.size() == tile.size()) {
                let [width, height] = tile.size();
                orders.push(RefillOrder::new(width, height));
            }
        }
        let tile_count = tiles.len();
        let trace_tile = |(index, mut tile): (usize, Tile)| {
            if is_first && !pass.cancel.load(Ordering::Relaxed) {
                // The system provides a page of zeros faster if it is written to before it is read.
                tile.rows.iter_mut().for_each(|row| row.fill(PixelSum::default()));
            }
            let order = orders.iter().find(|order| order.size() == tile.size()).unwrap_or(&orders[0]);
            let work = Work::new(&blocks, order, tile.corner, tile.rows);
            let mut traced = TracedTile { expected: work.expected(), ..TracedTile::default() };
            let mut work = match pass.purpose {
                Purpose::Add => work,
                Purpose::Withdraw(added) if added[index] == 0 => return traced,
                Purpose::Withdraw(added) => work.withdrawing(added[index]),
                Purpose::Estimate { .. } => work.withdrawing(0),
            };
            if pass.cancel.load(Ordering::Relaxed) || pass.stop.skips_next(tile_count) {
                return traced;
            }
            let begin = Instant::now();
            // After a panic `work` is still consistent: the sums that it counts are in the film.
            match catch_unwind(AssertUnwindSafe(|| kernel(broadcast, &mut work))) {
                Ok(stats) => traced.stats = stats,
                Err(payload) => traced.panic = Some(panic_text(payload.as_ref()).to_owned()),
            }
            traced.finished = work.finished();
            traced.took = begin.elapsed();
            traced
        };
        self.threads.install(|| tiles.into_par_iter().enumerate().map(trace_tile).collect())
    }
}

/// Describes the first tile that lacks samples, and why; `None` if the pass is complete.
pub(super) fn describe_missing(traced: &[TracedTile], side: u32, width: u32) -> Option<String> {
    let index = traced.iter().position(|tile| !tile.is_whole())?;
    let TracedTile { finished, expected, panic, .. } = &traced[index];
    let columns = width.div_ceil(side) as usize;
    let (x, y) = (index % columns * side as usize, index / columns * side as usize);
    let why = panic.as_ref().map_or(String::new(), |text| format!("it panicked: {text}; "));
    Some(format!(
        "{why}only {finished} of {expected} blocks of samples in the tile at pixel ({x}, {y}) were finished"
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pass_is_given_up_before_half_of_its_tiles_have_begun() {
        for (begun, is_given_up) in [(0, true), (1, true), (2, true), (3, false), (4, false)] {
            let requested = AtomicBool::new(false);
            let stop = StopRequest::when(&requested);
            (0..begun).for_each(|_| assert!(!stop.skips_next(5)));
            assert!(!stop.is_given_up(), "no stop was requested");
            requested.store(true, Ordering::Relaxed);
            // The decision does not change when more tiles have been left out or begun.
            (begun..5).for_each(|_| assert_eq!(stop.skips_next(5), is_given_up, "after {begun} of 5"));
            assert_eq!(stop.is_given_up(), is_given_up, "after {begun} of 5");
        }
    }

    #[test]
    fn incomplete_tile_is_named_by_its_corner() {
        let (stats, took) = (TileStats::default(), Duration::ZERO);
        let tile = |finished| TracedTile { stats, finished, expected: 9, panic: None, took };
        // Tiles of 8 pixels in a picture of 20: three columns.
        let mut traced: Vec<TracedTile> = [9, 9, 9, 9, 4, 9].map(tile).into();
        let reason = describe_missing(&traced, 8, 20).expect("samples are missing");
        assert!(reason.contains("only 4 of 9 blocks") && reason.contains("pixel (8, 8)"), "{reason}");
        assert_eq!(describe_missing(&traced[..4], 8, 20), None);
        traced[2].panic = Some("a slip".to_owned());
        let reason = describe_missing(&traced, 8, 20).expect("a panic");
        assert!(
            reason.starts_with("it panicked: a slip; only 9") && reason.contains("pixel (16, 0)"),
            "{reason}"
        );
    }
}
