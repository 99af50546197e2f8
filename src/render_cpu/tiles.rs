//! Splits a film into tiles for the threads.

use super::work::TileRows;
use crate::film::PixelSum;

/// Side of a tile in pixels in a large picture.
const SIDE: u32 = 64;

/// Smallest side in pixels: in smaller tiles, lanes wait for the end of the tile longer than they work.
const SIDE_MIN: u32 = 8;

/// Number of tiles to aim for per thread, so that no thread waits for long.
const TILES_A_THREAD: u32 = 4;

/// A tile of the film: its position, and its rows in each half.
pub struct Tile<'film> {
    /// Column and row of the upper left pixel.
    pub corner: [u32; 2],
    /// Number of rows in one half.
    pub height: u32,
    /// The rows of both halves, one half after the other.
    pub rows: TileRows<'film>,
}

impl Tile<'_> {
    /// Width and height in pixels.
    pub fn size(&self) -> [u32; 2] {
        [self.rows.first().map_or(0, |row| row.len() as u32), self.height]
    }
}

/// The side of the tiles for a picture and a number of threads, a power of two.
pub fn tile_side(width: u32, height: u32, threads: usize) -> u32 {
    let count = |side: u32| width.div_ceil(side) * height.div_ceil(side);
    let wanted = TILES_A_THREAD.saturating_mul(threads as u32);
    let mut side = SIDE;
    while side > SIDE_MIN && count(side) < wanted {
        side /= 2;
    }
    side
}

/// Splits the halves of a film `width` pixels wide into tiles, row by row.
pub fn tiles(halves: &mut [Vec<PixelSum>], width: u32, side: u32) -> Vec<Tile<'_>> {
    let mut tiles: Vec<Tile> = Vec::new();
    let across = width.div_ceil(side) as usize;
    for (half_index, half) in halves.iter_mut().enumerate() {
        for (y, row) in half.chunks_mut(width as usize).enumerate() {
            let y = y as u32;
            for (column, part) in row.chunks_mut(side as usize).enumerate() {
                let index = (y / side) as usize * across + column;
                if index == tiles.len() {
                    let rows = Vec::with_capacity(2 * side as usize);
                    tiles.push(Tile { corner: [column as u32 * side, y], height: 0, rows });
                }
                let tile = &mut tiles[index];
                tile.height += u32::from(half_index == 0);
                tile.rows.push(part);
            }
        }
    }
    tiles
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tile_side_follows_the_number_of_threads() {
        for (size, threads, expected) in [
            ([1920, 1080], 1, 64),
            ([128, 128], 1, 64),
            ([129, 64], 1, 32),
            ([256, 256], 5, 32),
            ([256, 256], 17, 16),
            ([16, 9], 8, 8),
            ([1, 1], 1000, 8),
        ] {
            assert_eq!(tile_side(size[0], size[1], threads), expected, "{size:?}, {threads} threads");
        }
    }
}
