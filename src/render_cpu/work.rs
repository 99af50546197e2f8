//! The work of a tile: blocks of samples of its pixels, from which lanes are refilled.

use super::lanes::WideU;
use crate::film::PixelSum;
use crate::render::RenderSettings;
use crate::sampling::{HalfKey, SampleBlock};

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
    counter: u32,
    step: u32,
    /// The counter after the last sample.
    end: u32,
}

impl RefillBlock {
    /// Splits the sample range `range` into blocks.
    pub fn of_range(range: std::ops::Range<u64>, settings: &RenderSettings, limit: u32) -> Vec<RefillBlock> {
        SampleBlock::split(range, settings.half_count() as u32, limit)
            .into_iter()
            .map(|block| {
                let (counter, step) = block.counter(settings);
                RefillBlock {
                    half: block.half,
                    half_key: HalfKey::new(settings, block.half),
                    counter,
                    step,
                    end: counter.wrapping_add(step.wrapping_mul(block.count)),
                }
            })
            .collect()
    }
}

/// Refill state of a packet's lanes: stored per lane, loaded as a vector.
#[derive(Clone)]
pub struct LaneBlocks {
    /// The sampler's counter at the block's first sample.
    pub start: WideU,
    /// The increment of the counter.
    pub step: WideU,
    /// The counter after the block's last sample.
    pub end: WideU,
    /// The sampler's stream for the camera ray.
    pub key: WideU,
    /// `x | y << 16`.
    pub pixel: WideU,
    /// Sums of the block so far, RGB.
    pub sums: [WideU; 3],
    /// Destination of the sums: `row << 8 | column` of the tile's rows, or [`NOWHERE`].
    slot: WideU,
}

/// The slot of a lane that has had no block yet.
const NOWHERE: u32 = u32::MAX;

impl Default for LaneBlocks {
    fn default() -> Self {
        let zero = WideU::default();
        let mut slot = WideU::default();
        slot.0.fill(NOWHERE);
        LaneBlocks { start: zero, step: zero, end: zero, key: zero, pixel: zero, sums: [zero; 3], slot }
    }
}

/// The pixels of a square tile with `side` pixels (at most 256) in refill order, as `y << 8 | x`. They are ordered in
/// squares of four by four, so that a packet's first rays are close together.
pub fn refill_order(side: u32) -> Vec<u16> {
    const SQUARE: u32 = 4;
    let starts = || (0..side).step_by(SQUARE as usize);
    let within = |start: u32| start..(start + SQUARE).min(side);
    let mut order = Vec::with_capacity((side * side) as usize);
    for top in starts() {
        for left in starts() {
            for y in within(top) {
                order.extend(within(left).map(|x| (y << 8 | x) as u16));
            }
        }
    }
    order
}

/// A tile's pixels, blocks and sums.
pub struct Work<'film> {
    blocks: &'film [RefillBlock],
    /// Pixels in [`refill_order`]; those outside the tile are skipped.
    order: &'film [u16],
    /// Position of the tile's upper left pixel in the picture.
    corner: [u32; 2],
    width: u32,
    height: u32,
    rows: TileRows<'film>,
    next_block: usize,
    next_place: usize,
    finished: u64,
    /// If set, this many blocks are subtracted from the film, and none is added.
    taken_away: Option<u64>,
}

impl<'film> Work<'film> {
    /// Creates the work for a tile with `height` rows in each half.
    pub fn new(
        blocks: &'film [RefillBlock],
        order: &'film [u16],
        corner: [u32; 2],
        height: u32,
        rows: TileRows<'film>,
    ) -> Self {
        let width = rows.first().map_or(0, |row| row.len() as u32);
        Work {
            blocks,
            order,
            corner,
            width,
            height,
            rows,
            next_block: 0,
            next_place: 0,
            finished: 0,
            taken_away: None,
        }
    }

    /// Subtracts the first `count` finished blocks from the film instead of adding all. A kernel finishes a tile's
    /// blocks in the same order every time, with the same sums.
    pub fn taking_away(self, count: u64) -> Self {
        Work { taken_away: Some(count), ..self }
    }

    /// Blocks whose sums are in the film, over all pixels.
    pub fn finished(&self) -> u64 {
        self.finished
    }

    /// Blocks in total, over all pixels.
    pub fn expected(&self) -> u64 {
        self.blocks.len() as u64 * u64::from(self.width) * u64::from(self.height)
    }

    /// Drops the last row, so that a kernel panics in the middle of the tile (fault injection).
    pub fn sabotaged(mut self) -> Self {
        self.rows.pop();
        self
    }

    /// The next block, and its pixel's position in the tile.
    #[inline(always)]
    fn next(&mut self) -> Option<(&'film RefillBlock, [u32; 2])> {
        loop {
            let block = self.blocks.get(self.next_block)?;
            let Some(&place) = self.order.get(self.next_place) else {
                self.next_place = 0;
                self.next_block += 1;
                continue;
            };
            self.next_place += 1;
            let [x, y] = [u32::from(place & 0xFF), u32::from(place >> 8)];
            if x < self.width && y < self.height {
                return Some((block, [x, y]));
            }
        }
    }

    /// Collects the sums of the lanes `done` and gives each lane its next block. Returns the lanes for which no block
    /// is left.
    #[inline(always)]
    pub fn refill(&mut self, done: u32, lanes: &mut LaneBlocks) -> u32 {
        let mut retired = 0;
        let mut left = done;
        while left != 0 {
            let lane = left.trailing_zeros() as usize;
            left &= left - 1;
            let slot = lanes.slot.0[lane];
            if slot != NOWHERE {
                let sums = [0, 1, 2].map(|channel| u64::from(lanes.sums[channel].0[lane]));
                let pixel = &mut self.rows[(slot >> 8) as usize][(slot & 0xFF) as usize];
                match self.taken_away {
                    None => pixel.add(PixelSum(sums)),
                    Some(count) if self.finished < count => take_away(pixel, sums),
                    Some(_) => {}
                }
                self.finished += 1;
            }
            for channel in &mut lanes.sums {
                channel.0[lane] = 0;
            }
            let Some((block, [x, y])) = self.next() else {
                retired |= 1 << lane;
                continue;
            };
            let pixel = (self.corner[0] + x) | (self.corner[1] + y) << 16;
            lanes.slot.0[lane] = (block.half * self.height + y) << 8 | x;
            lanes.start.0[lane] = block.counter;
            lanes.step.0[lane] = block.step;
            lanes.end.0[lane] = block.end;
            lanes.pixel.0[lane] = pixel;
            lanes.key.0[lane] = block.half_key.of_pixel(pixel);
        }
        retired
    }
}

fn take_away(pixel: &mut PixelSum, sums: [u64; 3]) {
    for (all, part) in pixel.0.iter_mut().zip(sums) {
        *all = all.wrapping_sub(part);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_pixel_is_dealt_once() {
        for side in [1, 3, 8, 64, 256] {
            let mut order = refill_order(side);
            order.sort_unstable();
            let expected: Vec<u16> =
                (0..side).flat_map(|y| (0..side).map(move |x| (y << 8 | x) as u16)).collect();
            assert_eq!(order, expected, "side {side}");
        }
    }
}
