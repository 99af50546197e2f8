//! OpenEXR as any program writes it.

use super::decoded::{ReadPicture, Values, note_on_alpha, note_on_primaries, pixel_count};
use crate::film::checkpoint;
use anyhow::{Result, anyhow, bail};
use exr::error::Error;
use exr::image::{AnyChannels, FlatImage, FlatSamples, Layer as Part};
use exr::prelude::{MetaData, ReadChannels, ReadLayers, Vec2, read as reading};
use std::collections::BTreeMap;
use std::io::{BufRead, Seek};

/// Three channels that make a picture.
struct Layer<'a> {
    part: &'a Part<AnyChannels<FlatSamples>>,
    /// The part's name, if there are several, and what comes before the names of the channels; empty for the usual layer.
    name: String,
    /// Red, green and blue; for grey, the same channel three times.
    channels: [&'a FlatSamples; 3],
    alpha: Option<&'a FlatSamples>,
}

/// Reads the layer with this name, or the only one.
pub(super) fn read(mut reader: impl BufRead + Seek, length: u64, layer: Option<&str>) -> Result<ReadPicture> {
    let meta = MetaData::read_from_buffered(&mut reader, false).map_err(|error| unreadable(&error))?;
    for header in &meta.headers {
        checkpoint::check_length(header, length).map_err(|reason| anyhow!(reason))?;
        size(header.layer_size, header.channels.bytes_per_pixel)?;
    }
    // Each of the two ways refuses files that the other reads: the first those with a wrong number of chunks, the second
    // those with an odd header.
    let mut decoded = |is_pedantic: bool| -> exr::error::Result<FlatImage> {
        reader.rewind()?;
        let builder =
            reading().no_deep_data().largest_resolution_level().all_channels().all_layers().all_attributes();
        let builder = if is_pedantic { builder.pedantic() } else { builder };
        builder.non_parallel().from_buffered(&mut reader)
    };
    let image = decoded(false).or_else(|error| decoded(true).map_err(|_| error));
    let image = image.map_err(|error| unreadable(&error))?;
    let layers = layers(&image);
    let Layer { part, channels, alpha, .. } = choose(&layers, &image, layer)?;
    let compression = part.encoding.compression;
    let may_lose = compression.may_loose_data().then(|| format!("its {compression} may change the values"));
    let space = image.attributes.chromaticities;
    let primaries =
        space.map(|space| [space.red, space.green, space.blue, space.white].map(|Vec2(x, y)| [x, y]));
    let mut notes: Vec<String> = primaries.and_then(note_on_primaries).into_iter().chain(may_lose).collect();
    if layer.is_none() && layers.len() > 1 {
        notes.push(format!("it has other layers, which are ignored: {}", names(&layers)));
    }
    let translucent = alpha.map_or(0, |alpha| alpha.values_as_f32().filter(|alpha| *alpha != 1.0).count());
    notes.extend(note_on_alpha(translucent));
    let window = image.attributes.display_window;
    let Vec2(columns, rows) = part.size;
    let Vec2(left, top) = part.attributes.layer_position - window.position;
    let (width, height) = size(window.size, 0)?;
    let is_whole = (left, top, width as usize, height as usize) == (0, 0, columns, rows);
    if !is_whole {
        notes.push(format!(
            "it has data for {columns}x{rows} pixels at {left},{top} of {width}x{height}; the others are black"
        ));
    }
    let mut rgb = vec![[0.0; 3]; width as usize * height as usize];
    for (colour, channel) in channels.iter().enumerate() {
        for (place, value) in (0..).zip(channel.values_as_f32()) {
            let (x, y) = (i64::from(left) + place % columns as i64, i64::from(top) + place / columns as i64);
            if (0..i64::from(width)).contains(&x) && (0..i64::from(height)).contains(&y) {
                rgb[(y * i64::from(width) + x) as usize][colour] = value;
            }
        }
    }
    let values =
        Values::Floats { rgb, halves: channels.map(|channel| matches!(channel, FlatSamples::F16(_))) };
    Ok(ReadPicture { width, height, format: "EXR", values, damages: Vec::new(), notes, stated: None })
}

/// All layers with red, green and blue; if there are none, all with luminance.
fn layers(image: &FlatImage) -> Vec<Layer<'_>> {
    let (mut colour, mut grey) = (Vec::new(), Vec::new());
    for part in &image.layer_data {
        let mut groups: BTreeMap<String, [Option<&FlatSamples>; 5]> = BTreeMap::new();
        for channel in &part.channel_data.list {
            let name = channel.name.to_string();
            let (group, own) = name.rsplit_once('.').unwrap_or(("", &name));
            let own = own.to_ascii_lowercase();
            let names = [["r", "red"], ["g", "green"], ["b", "blue"], ["a", "alpha"], ["y", "y"]];
            if let Some(place) = names.iter().position(|names| names.contains(&own.as_str())) {
                groups.entry(group.to_owned()).or_default()[place] = Some(&channel.sample_data);
            }
        }
        let own = part.attributes.layer_name.as_ref().filter(|_| image.layer_data.len() > 1);
        let own = own.map_or_else(String::new, ToString::to_string);
        for (group, [r, g, b, alpha, y]) in groups {
            let name = match (own.is_empty(), group.is_empty()) {
                (false, false) if !group.starts_with(&own) => format!("{own}.{group}"),
                (false, true) => own.clone(),
                _ => group,
            };
            let (layers, channels) = match (r, g, b, y) {
                (Some(r), Some(g), Some(b), _) => (&mut colour, [r, g, b]),
                (_, _, _, Some(y)) => (&mut grey, [y; 3]),
                _ => continue,
            };
            layers.push(Layer { part, name, channels, alpha });
        }
    }
    if colour.is_empty() { grey } else { colour }
}

fn choose<'a>(layers: &'a [Layer], image: &FlatImage, name: Option<&str>) -> Result<&'a Layer<'a>> {
    if layers.is_empty() {
        let channels = image.layer_data.iter().flat_map(|part| &part.channel_data.list);
        let channels: Vec<String> = channels.map(|channel| channel.name.to_string()).collect();
        bail!(
            "it has no channels R, G and B, nor Y, but {}; save the picture with these names",
            channels.join(", ")
        )
    }
    let mut found = layers.iter().filter(|layer| layer.name == name.unwrap_or_default());
    match (layers, name, found.next(), found.next()) {
        ([only], None, ..) | (_, Some(_), Some(only), _) | (_, None, Some(only), None) => Ok(only),
        (_, Some(name), ..) if names(layers).is_empty() => bail!("it has no layer {name:?}; name none"),
        (_, Some(name), ..) => {
            bail!("it has no layer {name:?}; choose one of {} after FILE:", names(layers))
        }
        _ => bail!("it has several layers; choose one as FILE:LAYER: {}", names(layers)),
    }
}

fn names(layers: &[Layer]) -> String {
    let names = layers.iter().map(|layer| layer.name.as_str()).filter(|name| !name.is_empty());
    names.collect::<Vec<_>>().join(", ")
}

/// Width and height, if there is memory for the picture and `bytes` more per pixel.
fn size(Vec2(width, height): Vec2<usize>, bytes: usize) -> Result<(u32, u32)> {
    let [width, height] = [width, height].map(|side| u32::try_from(side).unwrap_or(u32::MAX));
    pixel_count(width, height, bytes as u64)?;
    Ok((width, height))
}

fn unreadable(error: &Error) -> anyhow::Error {
    let text = error.to_string();
    let remedy = match error {
        Error::NotSupported(_) if text.contains("compression") => "save it with another, such as ZIP",
        Error::NotSupported(_) => "save it as a flat picture with R, G and B of the same size",
        _ => "check whether the file is complete",
    };
    anyhow!("{text}; {remedy}")
}
