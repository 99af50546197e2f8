//! 8-bit PNG. Each key of the description is the keyword of a text chunk; the recipe's chunk is compressed.

use super::{Description, RECIPE_KEY, RECIPE_LIMIT, write_rows};
use crate::film::Film;
use crate::stages::Transfer;
use anyhow::{Result, anyhow};
use std::io::{self, BufRead, Seek, Write};

/// `is_small` makes the file a quarter smaller, which takes several times as long.
pub(super) fn write(
    film: &Film,
    transfer: Transfer,
    description: &Description,
    is_small: bool,
    writer: &mut impl Write,
) -> io::Result<()> {
    // Encoded in memory, because the encoder's stream would reduce a file system error to its text.
    let mut file = Vec::new();
    let mut encoder = ::png::Encoder::new(&mut file, film.width(), film.height());
    encoder.set_color(::png::ColorType::Rgb);
    if is_small {
        encoder.set_compression(::png::Compression::High);
        encoder.set_filter(::png::Filter::MinEntropy);
    } else {
        encoder.set_compression(::png::Compression::Fast);
    }
    // Readers keep the two kinds of text chunks apart, so all chunks are of one kind; otherwise their order would be
    // lost.
    let latin_1 = description.entries().all(|(_, value)| value.chars().all(|c| c <= 'ÿ'));
    for (key, value) in description.entries() {
        let (key, value) = (key.to_owned(), value.to_owned());
        if latin_1 { encoder.add_text_chunk(key, value)? } else { encoder.add_itxt_chunk(key, value)? }
    }
    let mut picture = encoder.write_header()?;
    let mut recipe = ::png::text_metadata::ITXtChunk::new(RECIPE_KEY, description.recipe());
    recipe.compressed = true;
    recipe.compress_text()?;
    picture.write_text_chunk(&recipe)?;
    let mut rows = picture.stream_writer()?;
    write_rows(film, transfer, &mut rows)?;
    rows.finish()?;
    picture.finish()?;
    writer.write_all(&file)
}

pub(super) fn read_description(reader: impl BufRead + Seek) -> Result<Option<Description>> {
    // A chunk counts up to three times while it is read.
    let limits = ::png::Limits { bytes: 4 * RECIPE_LIMIT };
    let reader = ::png::Decoder::new_with_limits(reader, limits).read_info()?;
    let info = reader.info();
    let Some(recipe) = info.utf8_text.iter().find(|chunk| chunk.keyword == RECIPE_KEY) else {
        return Ok(None);
    };
    let mut recipe = recipe.clone();
    // The decompressor needs room for one more byte to find the end.
    recipe
        .decompress_text_with_limit(RECIPE_LIMIT + 1)
        .map_err(|error| anyhow!("its recipe is damaged or longer than {RECIPE_LIMIT} bytes ({error})"))?;
    let mut description = Description::new(&recipe.get_text()?);
    for chunk in &info.uncompressed_latin1_text {
        description.set(&chunk.keyword, &chunk.text);
    }
    for chunk in &info.utf8_text {
        description.set(&chunk.keyword, chunk.get_text()?);
    }
    Ok(Some(description))
}
