//! What a tile has to do, dealt to lanes: blocks of samples of its pixels.

use super::lanes::MAX_LANES;
use crate::film::PixelSum;
use crate::render::{RenderSettings, SamplerKind};
use crate::sampling::{SampleBlock, pixel_key};

/// Rows of one half of the film within a tile.
pub type TileRows<'film> = Vec<&'film mut [PixelSum]>;

/// Figures of a tile.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TileStats {
    /// Rays that were traced: lanes that did so, over all intersections.
    pub rays: u64,
    /// Lanes there were, over all intersections.
    pub offered_lanes: u64,
    /// Samples that were not finite.
    pub rejected: u64,
}

impl TileStats {
    /// Adds another tile's figures.
    pub fn plus(self, other: TileStats) -> TileStats {
        TileStats {
            rays: self.rays + other.rays,
            offered_lanes: self.offered_lanes + other.offered_lanes,
            rejected: self.rejected + other.rejected,
        }
    }
}

/// A block of samples as the lanes count through it.
#[derive(Clone, Copy, Debug)]
pub struct DealtBlock {
    half: u32,
    seed: u32,
    counter: u32,
    step: u32,
    count: u32,
}

impl DealtBlock {
    /// The blocks that samples `range` consist of.
    pub fn of_range(range: std::ops::Range<u64>, settings: &RenderSettings, limit: u32) -> Vec<DealtBlock> {
        SampleBlock::split(range, settings.half_count() as u32, limit)
            .into_iter()
            .map(|block| {
                let (counter, step) = block.counter(settings);
                DealtBlock { half: block.half, seed: settings.seed, counter, step, count: block.count }
            })
            .collect()
    }
}

/// What the lanes of a packet are at, as numbers in memory.
#[derive(Default)]
pub struct LaneState {
    /// The sampler's counter.
    pub counter: [u32; MAX_LANES],
    /// What the counter grows by.
    pub step: [u32; MAX_LANES],
    /// Samples left of the block, the current one included.
    pub remaining: [u32; MAX_LANES],
    /// The Sobol sampler's key.
    pub key: [u32; MAX_LANES],
    /// `x | y << 16`.
    pub pixel: [u32; MAX_LANES],
    /// What the block has added up to, RGB.
    pub sums: [[u32; MAX_LANES]; 3],
}

/// Bits of a column or row within a tile, in a lane's slot: `half << 16 | row << 8 | column`.
const SLOT_BITS: u32 = 8;

/// A tile's pixels, blocks and sums.
pub struct Work<'film> {
    sampler: SamplerKind,
    blocks: &'film [DealtBlock],
    /// Position in the picture of the tile's upper left pixel.
    corner: [u32; 2],
    /// Width and height of the tile, at most 256.
    size: [u32; 2],
    halves: Vec<TileRows<'film>>,
    next_block: usize,
    next_pixel: PixelWalk,
}

impl<'film> Work<'film> {
    /// Work for a tile whose rows of each half are `halves`.
    pub fn new(
        sampler: SamplerKind,
        blocks: &'film [DealtBlock],
        corner: [u32; 2],
        halves: Vec<TileRows<'film>>,
    ) -> Self {
        let height = halves[0].len() as u32;
        let width = halves[0].first().map_or(0, |row| row.len() as u32);
        Work {
            sampler,
            blocks,
            corner,
            size: [width, height],
            halves,
            next_block: 0,
            next_pixel: PixelWalk::default(),
        }
    }

    /// Takes the sums of the lanes `done` and gives each its next block. Returns the lanes for which there is
    /// none.
    #[inline(never)]
    pub fn deal(&mut self, done: u32, state: &mut LaneState, slots: &mut [u32; MAX_LANES]) -> u32 {
        let mut retired = 0;
        let mut left = done;
        while left != 0 {
            let lane = left.trailing_zeros() as usize;
            left &= left - 1;
            let slot = slots[lane];
            let row =
                &mut self.halves[(slot >> (2 * SLOT_BITS)) as usize][(slot >> SLOT_BITS & 0xFF) as usize];
            let sums = [0, 1, 2].map(|channel| u64::from(state.sums[channel][lane]));
            row[(slot & 0xFF) as usize].add(PixelSum(sums));
            for channel in &mut state.sums {
                channel[lane] = 0;
            }
            let Some(block) = self.blocks.get(self.next_block) else {
                retired |= 1 << lane;
                continue;
            };
            let [x, y] = self.next_pixel.position();
            if !self.next_pixel.advance(self.size) {
                self.next_block += 1;
            }
            let pixel = (self.corner[0] + x) | (self.corner[1] + y) << 16;
            slots[lane] = block.half << (2 * SLOT_BITS) | y << SLOT_BITS | x;
            state.counter[lane] = block.counter;
            state.step[lane] = block.step;
            state.remaining[lane] = block.count;
            state.pixel[lane] = pixel;
            if self.sampler == SamplerKind::Sobol {
                state.key[lane] = pixel_key(block.seed, block.half, pixel);
            }
        }
        retired
    }
}

/// A walk through a tile in squares of four by four pixels, so that a packet's first rays lie close together.
#[derive(Default)]
struct PixelWalk {
    square: [u32; 2],
    within: [u32; 2],
}

impl PixelWalk {
    const SIDE: u32 = 4;

    fn position(&self) -> [u32; 2] {
        [self.square[0] + self.within[0], self.square[1] + self.within[1]]
    }

    /// Goes on to the next pixel; at the end back to the first, and says `false`.
    fn advance(&mut self, size: [u32; 2]) -> bool {
        let end = |axis: usize| Self::SIDE.min(size[axis] - self.square[axis]);
        self.within[0] += 1;
        if self.within[0] < end(0) {
            return true;
        }
        self.within[0] = 0;
        self.within[1] += 1;
        if self.within[1] < end(1) {
            return true;
        }
        self.within[1] = 0;
        self.square[0] += Self::SIDE;
        if self.square[0] < size[0] {
            return true;
        }
        self.square[0] = 0;
        self.square[1] += Self::SIDE;
        if self.square[1] < size[1] {
            return true;
        }
        self.square[1] = 0;
        false
    }
}
