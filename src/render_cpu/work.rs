//! The work of a tile: blocks of samples of its pixels, from which lanes are refilled.

use super::lanes::{Lanes, MAX_LANES, Mask, WideU};
use super::rng;
use crate::film::PixelSum;
use crate::job::render::RenderSettings;
use crate::kernel::sampling::{HalfKey, SampleBlock};

/// The film's rows within a tile: those of the first half, then those of the second.
pub type TileRows<'film> = Vec<&'film mut [PixelSum]>;

/// Statistics of a tile.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TileStats {
    /// Rays traced: the number of busy lanes, summed over all intersections.
    pub rays: u64,
    /// Available lanes, summed over all intersections.
    pub offered_lanes: u64,
    /// Samples rejected because they were not finite.
    pub rejected: u64,
}

impl TileStats {
    /// Adds another tile's statistics.
    pub fn plus(self, other: TileStats) -> TileStats {
        TileStats {
            rays: self.rays + other.rays,
            offered_lanes: self.offered_lanes + other.offered_lanes,
            rejected: self.rejected + other.rejected,
        }
    }
}

/// A block of samples as lanes count through it.
#[derive(Clone, Copy, Debug)]
pub struct RefillBlock {
    half: u32,
    /// The part of the sampler's keys that depends on the half.
    half_key: HalfKey,
    /// Number of samples.
    count: u32,
    counter: u32,
    step: u32,
    /// The counter after the last sample.
    end: u32,
}

impl RefillBlock {
    /// Splits the sample range `range` into blocks.
    pub fn of_range(range: std::ops::Range<u64>, settings: &RenderSettings, limit: u32) -> Vec<RefillBlock> {
        SampleBlock::split(range, limit)
            .into_iter()
            .map(|block| {
                let (counter, step) = block.counter(settings);
                RefillBlock {
                    half: block.half,
                    half_key: HalfKey::new(settings, block.half),
                    count: block.count,
                    counter,
                    step,
                    end: counter.wrapping_add(step.wrapping_mul(block.count)),
                }
            })
            .collect()
    }
}

/// The blocks of a packet's lanes, each of one pixel's samples.
#[derive(Clone, Copy)]
pub struct LaneBlocks<L: Lanes> {
    /// The sampler's counter, which selects the sample.
    pub counter: L::U,
    /// The increment of the counter.
    pub step: L::U,
    /// The counter after the block's last sample.
    pub end: L::U,
    /// The sampler's key, which separates pixels and halves.
    pub key: L::U,
    /// `x | y << 16`.
    pub pixel: L::U,
    /// Sums of the block so far, RGB.
    pub sums: [L::U; 3],
    /// Destination of the sums: `column | row << 16` of the tile's rows.
    slot: L::U,
}

impl<L: Lanes> LaneBlocks<L> {
    /// No lane has a block.
    #[inline(always)]
    pub fn none(l: L) -> Self {
        let zero = l.splat_u(0);
        LaneBlocks {
            counter: zero,
            step: zero,
            end: zero,
            key: zero,
            pixel: zero,
            sums: [zero; 3],
            slot: zero,
        }
    }
}

/// The pixels of a tile in the order in which lanes take them.
pub struct RefillOrder {
    width: u32,
    height: u32,
    /// `x | y << 16` within the tile, padded so that a row of lanes can be loaded at every pixel.
    places: Vec<u32>,
}

impl RefillOrder {
    /// Orders the pixels of a tile in squares of four by four, so that a packet's first rays are close together.
    pub fn new(width: u32, height: u32) -> Self {
        const SQUARE: u32 = 4;
        let starts = |size: u32| (0..size).step_by(SQUARE as usize);
        let within = |start: u32, size: u32| start..(start + SQUARE).min(size);
        let mut places = Vec::with_capacity((width * height) as usize + MAX_LANES);
        for top in starts(height) {
            for left in starts(width) {
                for y in within(top, height) {
                    places.extend(within(left, width).map(|x| x | y << 16));
                }
            }
        }
        places.resize(places.len() + MAX_LANES, 0);
        RefillOrder { width, height, places }
    }

    /// Width and height of the tile.
    pub fn size(&self) -> [u32; 2] {
        [self.width, self.height]
    }

    /// Number of pixels.
    fn len(&self) -> usize {
        self.places.len() - MAX_LANES
    }

    /// The next pixels from number `first` on, one for each possible lane. The last ones may be padding.
    #[inline(always)]
    fn row(&self, first: usize) -> &[u32; MAX_LANES] {
        const PADDING: &[u32; MAX_LANES] = &[0; MAX_LANES];
        self.places[first..].first_chunk().unwrap_or(PADDING)
    }
}

/// A tile's pixels, blocks and sums.
pub struct Work<'film> {
    blocks: &'film [RefillBlock],
    order: &'film RefillOrder,
    /// Position of the tile's upper left pixel in the picture.
    corner: [u32; 2],
    pub(super) rows: TileRows<'film>,
    next_block: usize,
    next_place: usize,
    finished: u64,
    /// If set, this many blocks are subtracted from the film, and none is added.
    withdrawn: Option<u64>,
}

impl<'film> Work<'film> {
    /// Creates the work for a tile whose pixels are taken in `order`.
    pub fn new(
        blocks: &'film [RefillBlock],
        order: &'film RefillOrder,
        corner: [u32; 2],
        rows: TileRows<'film>,
    ) -> Self {
        Work { blocks, order, corner, rows, next_block: 0, next_place: 0, finished: 0, withdrawn: None }
    }

    /// Subtracts the first `count` finished blocks from the film instead of adding all. A kernel finishes a tile's
    /// blocks in the same order every time, with the same sums.
    pub fn withdrawing(self, count: u64) -> Self {
        Work { withdrawn: Some(count), ..self }
    }

    /// Blocks whose sums are in the film, over all pixels.
    pub fn finished(&self) -> u64 {
        self.finished
    }

    /// Blocks in total, over all pixels.
    pub fn expected(&self) -> u64 {
        self.blocks.len() as u64 * self.order.len() as u64
    }

    /// Maximum number of steps that lanes wait for a refill. A refill takes nearly as long for one lane as for several, so
    /// waiting pays where refills are frequent; a lane with a single sample would wait as long as it works.
    pub fn pause(&self) -> u32 {
        let samples: u64 = self.blocks.iter().map(|block| u64::from(block.count)).sum();
        let per_block = samples.checked_div(self.blocks.len() as u64).unwrap_or(0);
        u32::from((2..=8).contains(&per_block))
    }

    /// Adds the sums of the lanes `done` to the film and gives each of them its next block. `busy` is the bit mask of the
    /// lanes that have a block. Returns the blocks, and the new mask.
    #[inline(always)]
    pub fn refill<L: Lanes>(
        &mut self,
        l: L,
        done: u32,
        busy: u32,
        mut lanes: LaneBlocks<L>,
    ) -> (LaneBlocks<L>, u32) {
        self.add_sums::<L>(done & busy, &lanes);
        let is_done = l.mask(done);
        let [red, green, blue] = lanes.sums;
        lanes.sums = [l.keep(!is_done, red), l.keep(!is_done, green), l.keep(!is_done, blue)];
        let mut idle = done;
        while idle != 0 {
            let Some(block) = self.blocks.get(self.next_block) else { break };
            let given = lowest(idle, self.order.len() - self.next_place);
            idle &= !given;
            let m = l.mask(given);
            let place = l.expand(m, self.order.row(self.next_place));
            let pixel = place + l.splat_u(self.corner[0] | self.corner[1] << 16);
            let row = place + l.splat_u((block.half * self.order.height) << 16);
            lanes.slot = m.select(row, lanes.slot);
            lanes.pixel = m.select(pixel, lanes.pixel);
            lanes.step = m.select(l.splat_u(block.step), lanes.step);
            lanes.end = m.select(l.splat_u(block.end), lanes.end);
            lanes.key = m.select(rng::sampler_key(l, block.half_key, pixel), lanes.key);
            lanes.counter = m.select(l.splat_u(block.counter), lanes.counter);
            self.next_place += given.count_ones() as usize;
            if self.next_place == self.order.len() {
                self.next_place = 0;
                self.next_block += 1;
            }
        }
        if idle != 0 {
            // A counter that stands still before its end never asks for another block.
            let m = l.mask(idle);
            lanes.step = l.keep(!m, lanes.step);
            lanes.end = m.select(lanes.counter + l.splat_u(1), lanes.end);
        }
        (lanes, (busy | done) & !idle)
    }

    /// Adds the sums of the lanes `done` to the film.
    #[inline(always)]
    fn add_sums<L: Lanes>(&mut self, done: u32, lanes: &LaneBlocks<L>) {
        let slots = stored::<L>(lanes.slot);
        let [red, green, blue] = lanes.sums;
        let (red, green, blue) = (stored::<L>(red), stored::<L>(green), stored::<L>(blue));
        let mut left = done;
        while left != 0 {
            let lane = left.trailing_zeros() as usize % MAX_LANES;
            left &= left - 1;
            let slot = slots[lane];
            let sums = [u64::from(red[lane]), u64::from(green[lane]), u64::from(blue[lane])];
            let pixel = &mut self.rows[(slot >> 16) as usize][(slot & 0xFFFF) as usize];
            match self.withdrawn {
                None => pixel.add(PixelSum(sums)),
                Some(count) if self.finished < count => subtract(pixel, sums),
                Some(_) => {}
            }
            self.finished += 1;
        }
    }
}

/// The numbers of a row.
#[inline(always)]
fn stored<L: Lanes>(row: L::U) -> [u32; MAX_LANES] {
    let mut wide = WideU::default();
    L::store_u(row, &mut wide);
    wide.0
}

/// The lowest `count` of the bits that are set.
#[inline(always)]
fn lowest(bits: u32, count: usize) -> u32 {
    if bits.count_ones() as usize <= count {
        return bits;
    }
    let above = (0..count).fold(bits, |above, _| above & above.wrapping_sub(1));
    bits & !above
}

fn subtract(pixel: &mut PixelSum, sums: [u64; 3]) {
    for (all, part) in pixel.0.iter_mut().zip(sums) {
        *all = all.wrapping_sub(part);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lanes_wait_where_blocks_are_short() {
        let settings = RenderSettings::default();
        let order = RefillOrder::new(1, 1);
        let pause = |range: std::ops::Range<u64>| {
            let blocks = RefillBlock::of_range(range, &settings, 1 << 10);
            Work::new(&blocks, &order, [0; 2], Vec::new()).pause()
        };
        // Half of the samples belong to each half of the film.
        assert_eq!([0..2, 0..4, 0..8, 8..16, 0..16, 0..32, 0..256].map(pause), [0, 1, 1, 1, 1, 0, 0]);
        assert_eq!(pause(0..0), 0);
        // More samples than 32 bits can count.
        let full = RefillBlock::of_range(0..1 << 20, &settings, 1 << 10)[0];
        let blocks = vec![RefillBlock { count: (1 << 23) + 4, ..full }; 1 << 9];
        assert_eq!(Work::new(&blocks, &order, [0; 2], Vec::new()).pause(), 0);
    }
}
