//! Traces a range of samples: splits it into dispatches, reads the film back, and traces missing samples again.

use super::dispatches::{BoundDispatch, CAUTION_LIMIT, CAUTION_SHIFT, Incomplete};
use super::layout::{GpuBlock, GpuDispatch, WORKGROUP_SIZE, tile_size};
use super::loaded::Loaded;
use super::scene::SHARED_BLOCK;
use super::schedule::Blocks;
use super::{GpuRenderer, failed};
use crate::film::Film;
use crate::job::render::{RenderError, Stats};
use std::ops::Range;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

impl GpuRenderer {
    /// Submits the dispatches of `range`; the last may still be in flight on return. A readback in progress is added to
    /// `film` as soon as the device has other work.
    pub(super) fn trace_range(
        &mut self,
        loaded: &mut Loaded,
        range: &Range<u64>,
        film: &mut Film,
        cancel: &AtomicBool,
    ) -> Result<Stats, Incomplete> {
        loaded.film.check_new(range, film)?;
        self.dispatches.check_whole()?;
        let (settings, suspends) = (*loaded.job.settings(), loaded.features.suspends);
        let block_limit =
            loaded.scene.prepared.block_limit.min(if suspends { SHARED_BLOCK } else { u32::MAX });
        let mut stats = Stats::default();
        for slab in 0..loaded.film.slabs.len() {
            let area = [settings.width, loaded.film.slabs[slab].row_count];
            let tiles = Tiles::new(slab, area, tile_size(settings.width, settings.height));
            let mut left = Blocks::of_range(range.clone(), &settings, block_limit);
            loop {
                let (blocks, samples) = left.take(self.affordable_samples(loaded, &tiles));
                if blocks.is_empty() {
                    break;
                }
                stats.add(&self.trace_blocks(loaded, &tiles, &blocks.into(), samples, film, cancel)?);
            }
        }
        stats.add(&loaded.film.finish_readback(&self.gpu, film)?);
        Ok(stats)
    }

    /// Samples per pixel for which the time of a dispatch of all `tiles` suffices.
    fn affordable_samples(&mut self, loaded: &Loaded, tiles: &Tiles) -> u64 {
        let threads = (u64::from(tiles.count) * TILE_PIXELS).min(self.gpu.adapter.busy_threads());
        let affordable = self.dispatches.budget(&loaded.features).paths() / threads;
        let samples = self.options.samples_per_dispatch.unwrap_or(affordable);
        let whole_samples = self.dispatches.whole_samples(&loaded.features, &loaded.scene.prepared);
        samples.min(whole_samples.unwrap_or(u64::MAX)) >> (CAUTION_SHIFT * self.dispatches.caution)
    }

    /// Submits the dispatches of `blocks`, which have `samples` samples, in all `tiles`.
    fn trace_blocks(
        &mut self,
        loaded: &mut Loaded,
        tiles: &Tiles,
        blocks: &Arc<[GpuBlock]>,
        samples: u64,
        film: &mut Film,
        cancel: &AtomicBool,
    ) -> Result<Stats, Incomplete> {
        let features = loaded.features;
        let mut stats = Stats::default();
        let mut first_tile = 0;
        while first_tile < tiles.count {
            if cancel.load(Ordering::Relaxed) {
                return Err(RenderError::Cancelled.into());
            }
            let slot = self.dispatches.free_slot(&self.gpu, cancel)?;
            let affordable = self.dispatches.budget(&features).paths() / (TILE_PIXELS * samples);
            let tile_count = evenly(tiles.count - first_tile, affordable.min(self.dispatches.tile_limit()));
            let slab = &loaded.film.slabs[tiles.slab];
            let dispatch = BoundDispatch {
                kernel: features,
                pipeline: loaded.kernel.pipeline.clone(),
                scene: loaded.scene.group.clone(),
                film: slab.group.clone(),
                parameters_buffer: loaded.film.parameters.clone(),
                blocks_buffer: loaded.film.blocks.clone(),
                counters: loaded.film.counters.clone(),
                blocks: Arc::clone(blocks),
                parameters: GpuDispatch {
                    first_tile,
                    tile_count,
                    block_count: blocks.len() as u32,
                    iteration_limit: self.dispatches.iteration_limit(&features),
                    first_row: slab.first_row,
                    row_count: slab.row_count,
                    ..GpuDispatch::default()
                },
                paths: u64::from(tile_count) * TILE_PIXELS * samples,
                samples: tiles.pixels_within(first_tile..first_tile + tile_count) * samples,
            };
            self.dispatches.submit(&self.gpu, slot, dispatch, 0).map_err(failed)?;
            first_tile += tile_count;
            if loaded.film.is_reading_back() {
                stats.add(&loaded.film.finish_readback(&self.gpu, film)?);
            }
        }
        Ok(stats)
    }

    /// Requests a readback of the film, after the dispatches in flight.
    pub(super) fn read_film_back(&mut self, loaded: &mut Loaded) -> Result<(), Incomplete> {
        if !loaded.film.is_reading_back() {
            self.readbacks += 1;
            self.dispatches.drain(&self.gpu, None)?;
            loaded.film.request_readback(&self.gpu);
        }
        Ok(self.gpu.faults.check().map_err(failed)?)
    }

    /// Adds everything traced so far to the film.
    pub(super) fn finish_all(&mut self, loaded: &mut Loaded, film: &mut Film) -> Result<Stats, Incomplete> {
        let mut stats = Stats::default();
        // A readback already in progress comes first.
        while loaded.film.holds_samples() {
            self.read_film_back(loaded)?;
            stats.add(&loaded.film.finish_readback(&self.gpu, film)?);
        }
        Ok(stats)
    }

    /// Returns the outcome of tracing `range`. If samples are missing, traces those on the device and `range` again, in
    /// smaller dispatches.
    ///
    /// # Errors
    /// If samples are still missing; the film is then unchanged.
    pub(super) fn completed(
        &mut self,
        loaded: &mut Loaded,
        mut outcome: Result<Stats, Incomplete>,
        range: Range<u64>,
        film: &mut Film,
        cancel: &AtomicBool,
    ) -> Result<Stats, RenderError> {
        let mut missing = loaded.film.held();
        // The range may have been recorded before.
        if missing.overlap(&range).is_none() {
            missing.insert(range)?;
        }
        loop {
            let shortfall = match outcome {
                Err(Incomplete::Short(shortfall)) => shortfall,
                Err(Incomplete::Failed(error)) => return Err(error),
                Ok(stats) => return Ok(stats),
            };
            if self.dispatches.caution == CAUTION_LIMIT {
                return Err(failed(format!("{shortfall}; update the graphics driver or render on the CPU")));
            }
            self.dispatches.caution += 1;
            self.messages
                .push(format!("{shortfall}; the missing samples are traced again in smaller pieces"));
            self.discard(loaded);
            let begin = Instant::now();
            let traced = missing.iter().try_fold(Stats::default(), |mut stats, range| {
                stats.add(&self.trace_range(loaded, &range, film, cancel)?);
                self.dispatches.drain(&self.gpu, Some(cancel))?;
                loaded.film.note(range, begin.elapsed())?;
                Ok(stats)
            });
            outcome = traced.and_then(|mut stats| {
                stats.add(&self.finish_all(loaded, film)?);
                Ok(stats)
            });
        }
    }
}

/// Pixels of a tile that lies within the picture.
const TILE_PIXELS: u64 = WORKGROUP_SIZE as u64;

/// The tiles of a slab, numbered row by row.
struct Tiles {
    slab: usize,
    /// Width and height of the slab and of a tile, pixels.
    area: [u32; 2],
    tile: [u32; 2],
    count: u32,
}

impl Tiles {
    fn new(slab: usize, area: [u32; 2], tile: [u32; 2]) -> Self {
        Tiles { slab, area, tile, count: area[0].div_ceil(tile[0]) * area[1].div_ceil(tile[1]) }
    }

    /// Number of pixels of the slab in these tiles.
    fn pixels_within(&self, tiles: Range<u32>) -> u64 {
        let Tiles { area: [width, height], tile, .. } = *self;
        let across = width.div_ceil(tile[0]);
        let pixels = |number: u32| {
            let corner = [number % across * tile[0], number / across * tile[1]];
            u64::from((width - corner[0]).min(tile[0])) * u64::from((height - corner[1]).min(tile[1]))
        };
        tiles.map(pixels).sum()
    }
}

/// Splits the remaining tiles into equal parts of at most `affordable` and at least one, so that no small dispatch remains.
fn evenly(left: u32, affordable: u64) -> u32 {
    let left = u64::from(left);
    left.div_ceil(left.div_ceil(affordable.max(1))) as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_have_all_pixels_once_and_fewer_at_the_edges() {
        for (area, tile) in
            [([50_u32, 43_u32], [8, 8]), ([1, 2000], [1, 64]), ([4, 4], [4, 16]), ([64, 64], [8, 8])]
        {
            let tiles = Tiles::new(0, area, tile);
            assert_eq!(tiles.pixels_within(0..tiles.count), u64::from(area[0]) * u64::from(area[1]));
        }
        // Seven tiles across: the last is 2 pixels wide, and those of the last row are 3 high.
        let pixels = |tiles: Range<u32>| Tiles::new(0, [50, 43], [8, 8]).pixels_within(tiles);
        assert_eq!([0..0, 0..1, 13..14, 35..36, 41..42].map(pixels), [0, 64, 2 * 8, 8 * 3, 2 * 3]);
        assert_eq!(pixels(5..8), 64 + 2 * 8 + 64);
    }

    #[test]
    fn remainder_is_split_into_equal_parts() {
        // Of ten with nine affordable, two parts of five rather than one of nine and one of one; at least one at a time.
        for (left, affordable, expected) in
            [(10, 100, 10), (10, 9, 5), (10, 4, 4), (9, 4, 3), (7, 0, 1), (u32::MAX, u64::MAX, u32::MAX)]
        {
            assert_eq!(evenly(left, affordable), expected, "{left}, {affordable} affordable");
        }
    }
}
