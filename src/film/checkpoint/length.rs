//! Whether an EXR file is long enough for what it claims to hold.

use exr::meta::BlockDescription;
use exr::meta::header::Header;
use exr::prelude::Compression;

/// Minimum size of a chunk in bytes: its offset table entry, row number and length.
const CHUNK_BYTES: u64 = 16;

/// A chunk may always have this many bytes, whatever the file's length, because tiles may be larger than the picture.
const SMALL_CHUNK_BYTES: u64 = 16 << 20;

/// Refuses files that are too short for what they claim to hold, and files that no reader can handle.
pub(crate) fn check_length(header: &Header, length: u64) -> Result<(), String> {
    if header.deep {
        return Err("it holds deep data".to_owned());
    }
    if header.channels.list.iter().any(|channel| channel.sampling.area() != 1) {
        return Err("some of its channels have fewer samples than pixels".to_owned());
    }
    // Maximum number of bytes that one stored byte can decompress to.
    let ratio = match header.compression {
        Compression::Uncompressed => 1,
        Compression::RLE => 64,
        Compression::ZIP1 | Compression::ZIP16 => 1032,
        _ => 4096,
    };
    let (columns, rows) = (header.layer_size.x() as u64, header.layer_size.y() as u64);
    let bytes = columns.saturating_mul(rows).saturating_mul(header.channels.bytes_per_pixel as u64);
    let least = (header.chunk_count as u64).saturating_mul(CHUNK_BYTES).saturating_add(bytes / ratio);
    if length < least {
        return Err(format!(
            "it has {length} bytes, but {columns}x{rows} pixels of {} bytes need at least {least}",
            header.channels.bytes_per_pixel
        ));
    }
    let (across, down) = match header.blocks {
        BlockDescription::Tiles(tiles) => (tiles.tile_size.x(), tiles.tile_size.y()),
        BlockDescription::ScanLines => (header.layer_size.x(), header.compression.scan_lines_per_block()),
    };
    let pixels = (across as u64).saturating_mul(down as u64);
    let most = length.saturating_mul(ratio).saturating_add(SMALL_CHUNK_BYTES);
    if pixels.saturating_mul(header.channels.bytes_per_pixel as u64) > most {
        return Err(format!("it has {length} bytes, too few for chunks of {across}x{down} pixels"));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use exr::math::RoundingMode;
    use exr::meta::attribute::LevelMode;
    use exr::prelude::{ChannelDescription, LineOrder, SampleType, SmallVec, Text, TileDescription, Vec2};

    /// The header of a picture with one channel of floats.
    fn header(size: (usize, usize), compression: Compression, blocks: BlockDescription) -> Header {
        let text = |text: &[u8]| Text::from_slice_unchecked(text);
        let mut channels: SmallVec<[ChannelDescription; 5]> = SmallVec::new();
        channels.push(ChannelDescription::new(text(b"Y"), SampleType::F32, false));
        Header::new(text(b"x"), size, channels).with_encoding(compression, blocks, LineOrder::Increasing)
    }

    /// 400,000 bytes of pixels and 16 bytes for each chunk, of 1, 16 or 32 rows.
    #[test]
    fn file_must_be_long_enough_for_its_pixels() {
        for (compression, least) in [
            (Compression::Uncompressed, 100 * 16 + 400_000),
            (Compression::RLE, 100 * 16 + 6250),
            (Compression::ZIP1, 100 * 16 + 387),
            (Compression::ZIP16, 7 * 16 + 387),
            (Compression::PIZ, 4 * 16 + 97),
        ] {
            let header = header((1000, 100), compression, BlockDescription::ScanLines);
            assert_eq!(check_length(&header, least), Ok(()), "{compression:?}");
            let message =
                format!("it has {} bytes, but 1000x100 pixels of 4 bytes need at least {least}", least - 1);
            assert_eq!(check_length(&header, least - 1), Err(message));
        }
    }

    #[test]
    fn tile_size_beyond_the_picture_is_limited() {
        let tile_size = Vec2(8192, 8192);
        let (level_mode, rounding_mode) = (LevelMode::Singular, RoundingMode::Down);
        let tiles = BlockDescription::Tiles(TileDescription { tile_size, level_mode, rounding_mode });
        let header = header((10, 10), Compression::Uncompressed, tiles);
        let least = (8192 * 8192 * 4) - (16 << 20);
        assert_eq!(check_length(&header, least), Ok(()));
        let message = check_length(&header, least - 1).unwrap_err();
        assert!(message.contains("8192x8192"), "{message}");
    }
}
