//! Writing a film file.

use super::head::{Head, Texts};
use super::planes::{self, Plane};
use super::{Description, FILM_ATTRIBUTE, Film, RECIPE_ATTRIBUTE, SOFTWARE, threads};
use crate::system::files::{WriteError, replace_file};
use crate::system::threads::shared;
use exr::block::chunk::Chunk;
use exr::block::writer::ChunksWriter;
use exr::block::{BlockIndex, UncompressedBlock};
use exr::meta::BlockDescription;
use exr::meta::header::Header;
use exr::prelude::{AttributeValue, ChannelDescription, Compression, LineOrder, MetaData, SmallVec, Text};
use std::io::{self, Seek, Write};
use std::path::Path;

/// Rows that a thread compresses before they are written.
const ROWS_AT_ONCE: usize = 32;

/// Writes a film file in place of `path`. Besides the film, this needs memory for a few rows.
///
/// # Errors
/// [`WriteError`]; the previous file is then unchanged.
pub fn save(path: &Path, film: &Film, description: &Description) -> Result<(), WriteError> {
    save_with(path, film, None, description)
}

/// As [`save`], with a denoised picture of the film as a layer for other programs.
///
/// # Errors
/// As [`save`].
pub fn save_with(
    path: &Path,
    film: &Film,
    denoised: Option<&Film>,
    description: &Description,
) -> Result<(), WriteError> {
    replace_file(path, |writer| write(film, denoised, description, writer))
}

/// Writes a film file.
///
/// # Errors
/// Those of `writer`.
pub(crate) fn write(
    film: &Film,
    denoised: Option<&Film>,
    description: &Description,
    writer: &mut (impl Write + Seek),
) -> io::Result<()> {
    let comments: String = description.lines().map(|line| line + "\n").collect();
    let texts = [description.recipe().as_bytes(), comments.as_bytes()];
    write_with(film, denoised, texts, &Head::of(film, texts), writer)
}

/// Writes a film file with the given head.
pub(super) fn write_with(
    film: &Film,
    denoised: Option<&Film>,
    [recipe, comments]: Texts,
    head: &Head,
    writer: &mut (impl Write + Seek),
) -> io::Result<()> {
    let planes = planes::channels(denoised.is_some());
    let channels: SmallVec<[ChannelDescription; 5]> =
        planes.iter().map(|(channel, _)| channel.clone()).collect();
    let size = (film.width() as usize, film.height() as usize);
    // RLE compresses the many bytes that are zero and keeps the others, which are noise. ZIP takes seven times as long
    // and saves a fifth.
    let mut header = Header::new(text(b"Weekender"), size, channels).with_encoding(
        Compression::RLE,
        BlockDescription::ScanLines,
        LineOrder::Increasing,
    );
    header.own_attributes.software_name = Some(text(SOFTWARE.as_bytes()));
    header.own_attributes.comments = Some(text(comments));
    let head = toml::to_string(head).map_err(io::Error::other)?;
    // One attribute in each of the two maps, so that the same film always gives the same bytes.
    let attribute = |bytes: &[u8]| AttributeValue::Text(text(bytes));
    header.own_attributes.other.insert(text(FILM_ATTRIBUTE.as_bytes()), attribute(head.as_bytes()));
    header.shared_attributes.other.insert(text(RECIPE_ATTRIBUTE.as_bytes()), attribute(recipe));

    let mut headers = SmallVec::new();
    headers.push(header);
    exr::block::write(writer, headers, true, |meta, chunks| {
        let blocks: Vec<(usize, BlockIndex)> = meta.enumerate_ordered_header_block_indices().collect();
        for batch in blocks.chunks(threads() * ROWS_AT_ONCE) {
            for (index, chunk) in compressed(film, denoised, &planes, &meta, batch)? {
                chunks.write_chunk(index, chunk)?;
            }
        }
        Ok(())
    })
    .map_err(io_error)
}

/// Compresses blocks with several threads. They keep their order, so the file does not depend on the threads.
fn compressed(
    film: &Film,
    denoised: Option<&Film>,
    planes: &[(ChannelDescription, Plane)],
    meta: &MetaData,
    blocks: &[(usize, BlockIndex)],
) -> exr::error::Result<Vec<(usize, Chunk)>> {
    let compress = |blocks: &[(usize, BlockIndex)]| -> exr::error::Result<Vec<(usize, Chunk)>> {
        let chunk = |(number, index): &(usize, BlockIndex)| {
            let mut data =
                Vec::with_capacity(film.width() as usize * meta.headers[0].channels.bytes_per_pixel);
            // With RLE, a block is a row.
            planes::append_row(film, denoised, planes, index.pixel_position.y(), &mut data);
            let block = UncompressedBlock { index: *index, data };
            Ok((*number, block.compress_to_chunk(&meta.headers)?))
        };
        blocks.iter().map(chunk).collect()
    };
    let shares = blocks.chunks(blocks.len().div_ceil(threads()).max(1)).collect();
    let failed = |_| Err(exr::error::Error::Invalid("a thread has failed".into()));
    let chunks: Result<Vec<_>, _> =
        shared(shares, compress).into_iter().map(|share| share.unwrap_or_else(failed)).collect();
    Ok(chunks?.into_iter().flatten().collect())
}

fn text(text: &[u8]) -> Text {
    // UTF-8 without conversion, which current readers expect.
    Text::from_slice_unchecked(text)
}

fn io_error(error: exr::error::Error) -> io::Error {
    match error {
        exr::error::Error::Io(error) => error,
        other => io::Error::other(other.to_string()),
    }
}
