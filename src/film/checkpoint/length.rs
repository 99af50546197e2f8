//! Whether an EXR file is long enough for what it claims to hold.

use exr::meta::BlockDescription;
use exr::meta::header::Header;
use exr::prelude::Compression;

/// Fewest bytes of a chunk: its entry in the offset table, its row number and its length.
const CHUNK_BYTES: u64 = 16;

/// A chunk may always have this many bytes, whatever the file's length, because tiles may be larger than the picture.
const SMALL_CHUNK_BYTES: u64 = 16 << 20;

/// Refuses a file that is too short for what it claims to hold, and files that no reader can handle.
pub(crate) fn check_length(header: &Header, length: u64) -> Result<(), String> {
    if header.deep {
        return Err("it holds deep data".to_owned());
    }
    if header.channels.list.iter().any(|channel| channel.sampling.area() != 1) {
        return Err("some of its channels have fewer samples than pixels".to_owned());
    }
    // The largest number of bytes that one stored byte can decompress to.
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
