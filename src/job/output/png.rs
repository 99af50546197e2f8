//! 8-bit PNG. Each key of the description is the keyword of a text chunk; the recipe's chunk is compressed.

use super::limits::invalid;
use super::{Description, PngForm, RECIPE_KEY, RECIPE_LIMIT, write_rows};
use crate::film::Film;
use crate::stages::Transfer;
use ::png::EncodingError;
use std::io::{self, BufRead, Seek, Write};

pub(super) fn write(
    film: &Film,
    transfer: Transfer,
    description: &Description,
    form: PngForm,
    writer: &mut impl Write,
) -> io::Result<()> {
    let size = [film.width(), film.height()];
    writer.write_all(&encoded(size, description, form, |rows| write_rows(film, transfer, rows))?)
}

/// Writes a picture of `size` pixels from its bytes, three per pixel.
pub(super) fn write_bytes(
    size: [u32; 2],
    rgb8: &[u8],
    description: &Description,
    writer: &mut impl Write,
) -> io::Result<()> {
    writer.write_all(&encoded(size, description, PngForm::Fast, |rows| rows.write_all(rgb8))?)
}

/// Encodes the whole file in memory, because the encoder's stream would reduce a file system error to its text.
fn encoded(
    [width, height]: [u32; 2],
    description: &Description,
    form: PngForm,
    write: impl FnOnce(&mut ::png::StreamWriter<'_, &mut Vec<u8>>) -> io::Result<()>,
) -> io::Result<Vec<u8>> {
    let mut file = Vec::new();
    let mut encoder = ::png::Encoder::new(&mut file, width, height);
    encoder.set_color(::png::ColorType::Rgb);
    match form {
        PngForm::Fast => encoder.set_compression(::png::Compression::Fast),
        PngForm::Small => {
            encoder.set_compression(::png::Compression::High);
            encoder.set_filter(::png::Filter::MinEntropy);
        }
    }
    let mut writer = begin(encoder, description)?;
    let mut rows = writer.stream_writer()?;
    write(&mut rows)?;
    rows.finish()?;
    writer.finish()?;
    Ok(file)
}

/// Writes the head of a PNG with its description.
pub(super) fn begin<W: Write>(
    mut encoder: ::png::Encoder<'_, W>,
    description: &Description,
) -> Result<::png::Writer<W>, EncodingError> {
    // Readers keep the two kinds of text chunks apart, so all chunks are of one kind; otherwise their order would be
    // lost.
    let latin_1 = description.entries().all(|(_, value)| value.chars().all(|c| c <= 'ÿ'));
    for (key, value) in description.entries() {
        let (key, value) = (key.to_owned(), value.to_owned());
        if latin_1 { encoder.add_text_chunk(key, value)? } else { encoder.add_itxt_chunk(key, value)? }
    }
    let mut writer = encoder.write_header()?;
    let mut recipe = ::png::text_metadata::ITXtChunk::new(RECIPE_KEY, description.recipe());
    recipe.compressed = true;
    recipe.compress_text()?;
    writer.write_text_chunk(&recipe)?;
    Ok(writer)
}

/// A decoder that can read every description that [`begin`] writes. A chunk counts up to three times while it is read.
fn decoder<R: BufRead + Seek>(reader: R) -> ::png::Decoder<R> {
    ::png::Decoder::new_with_limits(reader, ::png::Limits { bytes: 4 * RECIPE_LIMIT })
}

/// Reads an 8-bit RGB picture of this size to its end, row by row from the top, three bytes a pixel.
pub(super) fn read_pixels(reader: impl BufRead + Seek, [width, height]: [u32; 2]) -> io::Result<Vec<u8>> {
    let mut reader = decoder(reader).read_info()?;
    let info = reader.info();
    let is_rgb = (info.color_type, info.bit_depth) == (::png::ColorType::Rgb, ::png::BitDepth::Eight);
    if (info.width, info.height) != (width, height) || !is_rgb || info.interlaced {
        return Err(invalid(format!("it is not an 8-bit RGB picture of {width}x{height} pixels")));
    }
    let mut pixels = vec![0; 3 * width as usize * height as usize];
    reader.next_frame(&mut pixels)?;
    reader.finish()?;
    Ok(pixels)
}

pub(super) fn read_description(reader: impl BufRead + Seek) -> io::Result<Option<Description>> {
    let reader = decoder(reader).read_info()?;
    let info = reader.info();
    let Some(recipe) = info.utf8_text.iter().find(|chunk| chunk.keyword == RECIPE_KEY) else {
        return Ok(None);
    };
    let mut recipe = recipe.clone();
    // The decompressor needs room for one more byte to find the end.
    recipe.decompress_text_with_limit(RECIPE_LIMIT + 1).map_err(|error| {
        invalid(format!("its recipe is damaged or longer than {RECIPE_LIMIT} bytes ({error})"))
    })?;
    let mut description = Description::new(&recipe.get_text()?);
    for chunk in &info.uncompressed_latin1_text {
        description.set(&chunk.keyword, &chunk.text);
    }
    for chunk in &info.utf8_text {
        description.set(&chunk.keyword, chunk.get_text()?);
    }
    Ok(Some(description))
}
