//! 8-bit PNG. Each key of the description is the keyword of a text chunk; the recipe's chunk is compressed.

use super::decoded::note_on_primaries;
use super::{Description, Encoding, RECIPE_KEY, RECIPE_LIMIT, write_rows};
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

/// What a PNG says about its transfer curve and its primaries: the meaning of its values if it is one that this program
/// knows, and notes on what is ignored. The chunk that comes first here overrides the others, as in the specification.
pub(super) fn colours(reader: &mut (impl BufRead + Seek)) -> (Option<Encoding>, Vec<String>) {
    // Damage is reported when the pixels are read.
    let Ok(decoder) = ::png::Decoder::new(reader).read_info() else { return (None, Vec::new()) };
    let info = decoder.info();
    if let Some(codes) = info.coding_independent_code_points {
        let (stated, curve) = match codes.transfer_function {
            8 => (Some(Encoding::Book(Transfer::Linear)), None),
            13 => (Some(Encoding::Srgb), None),
            4 => (Some(Encoding::Gamma(2.2)), None),
            16 => (None, Some("PQ".to_owned())),
            18 => (None, Some("HLG".to_owned())),
            other => (None, Some(format!("number {other}"))),
        };
        let curve = curve.map(|curve| {
            format!(
                "it says (cICP) that its transfer curve is {curve}, which is ignored; choose with --encoding"
            )
        });
        let primaries = (codes.color_primaries != 1).then(|| {
            let name = match codes.color_primaries {
                9 => "those of BT.2020".to_owned(),
                12 => "those of Display P3".to_owned(),
                other => format!("number {other}"),
            };
            format!("it says (cICP) that its primaries are {name}, not those of sRGB; they are not converted")
        });
        return (stated, curve.into_iter().chain(primaries).collect());
    }
    if info.icc_profile.is_some() {
        let note = "it has an ICC profile, which is ignored";
        return (None, vec![note.to_owned()]);
    }
    if info.srgb.is_some() {
        return (Some(Encoding::Srgb), Vec::new());
    }
    let place = |(x, y): (::png::ScaledFloat, ::png::ScaledFloat)| [x.into_value(), y.into_value()];
    let primaries = info.chrm_chunk.map(|found| [found.red, found.green, found.blue, found.white].map(place));
    let notes = primaries.and_then(note_on_primaries).into_iter().collect();
    let exponent = info.gama_chunk.map(|gamma| 1.0 / f64::from(gamma.into_value()));
    let is_near = |exponent: f64, usual: f64| (exponent / usual - 1.0).abs() < 1e-3;
    let stated = exponent.filter(|exponent| exponent.is_finite()).map(|exponent| match exponent {
        // Written beside or instead of the sRGB chunk.
        _ if is_near(exponent, 2.2) => Encoding::Srgb,
        _ if is_near(exponent, 1.0) => Encoding::Book(Transfer::Linear),
        _ if is_near(exponent, 2.0) => Encoding::Book(Transfer::Gamma2),
        _ => Encoding::Gamma(exponent),
    });
    (stated, notes)
}
