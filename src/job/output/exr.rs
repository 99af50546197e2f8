//! OpenEXR as any program writes it.

use super::limits::{check_memory, invalid, pixel_count};
use super::read::{ReadPicture, Values};
use crate::film::checkpoint;
use exr::block::lines::LineRef;
use exr::block::reader::{ChunksReader, Reader};
use exr::error::Error;
use exr::meta::header::Header;
use exr::prelude::{Compression, SampleType, Vec2, f16};
use std::collections::BTreeMap;
use std::io::{self, BufRead, Seek};

/// Three channels that make a picture.
struct Layer {
    /// Index of the part that has it.
    part: usize,
    /// The part's name, if there are several, and what comes before the names of the channels; empty for the usual layer.
    name: String,
    /// Indices of red, green and blue; of grey, three times the same.
    channels: [usize; 3],
    alpha: Option<usize>,
}

/// Reads the layer with this name, or the only one.
pub(super) fn read(
    mut reader: impl BufRead + Seek,
    length: u64,
    layer: Option<&str>,
) -> io::Result<ReadPicture> {
    // Each of the two ways refuses files that the other reads: this one those with a wrong number of chunks, the pedantic
    // one those with an odd header.
    let is_pedantic = match Reader::read_from_buffered(&mut reader, false) {
        Ok(_) => false,
        Err(error) => {
            reader.rewind()?;
            Reader::read_from_buffered(&mut reader, true).map_err(|_| unreadable(&error))?;
            true
        }
    };
    reader.rewind()?;
    let reader = Reader::read_from_buffered(reader, is_pedantic).map_err(|error| unreadable(&error))?;
    let layers = layers(reader.headers());
    let chosen = choose(&layers, reader.headers(), layer)?;
    let header = reader.headers()[chosen.part].clone();
    checkpoint::check_length(&header, length).map_err(invalid)?;
    let mut notes = notes(&header);
    if layer.is_none() && layers.len() > 1 {
        notes.push(format!("it has other layers, which are ignored: {}", names(&layers)));
    }
    let data = read_layer(reader, chosen, &header)?;
    if data.translucent > 0 {
        notes
            .push(format!("{} of its pixels have an alpha other than 1, which is ignored", data.translucent));
    }
    let window = header.shared_attributes.display_window;
    let Vec2(columns, rows) = header.layer_size;
    let Vec2(left, top) = header.own_attributes.layer_position - window.position;
    let (width, height) = size(window.size)?;
    let rgb = if (left, top, width as usize, height as usize) == (0, 0, columns, rows) {
        data.rgb
    } else {
        let mut rgb = vec![[0.0; 3]; width as usize * height as usize];
        for (y, row) in (i64::from(top)..).zip(data.rgb.chunks_exact(columns)) {
            for (x, pixel) in (i64::from(left)..).zip(row) {
                if (0..i64::from(width)).contains(&x) && (0..i64::from(height)).contains(&y) {
                    rgb[(y * i64::from(width) + x) as usize] = *pixel;
                }
            }
        }
        notes.push(format!(
            "it has data for {columns}x{rows} pixels at {left},{top} of {width}x{height}; the others are black"
        ));
        rgb
    };
    let halves = chosen.channels.map(|channel| header.channels.list[channel].sample_type == SampleType::F16);
    let values = Values::Floats { rgb, halves };
    Ok(ReadPicture { width, height, format: "EXR", values, damages: Vec::new(), notes })
}

/// What a layer holds.
struct Data {
    rgb: Vec<[f32; 3]>,
    /// Pixels whose alpha is not 1.
    translucent: usize,
}

fn read_layer<R: BufRead + Seek>(reader: Reader<R>, layer: &Layer, header: &Header) -> io::Result<Data> {
    let (width, height) = size(header.layer_size)?;
    let width = width as usize;
    let mut data = Data { rgb: vec![[0.0; 3]; width * height as usize], translucent: 0 };
    let is_wanted = |part: usize, level: Vec2<usize>| part == layer.part && level == Vec2(0, 0);
    let chunks = reader.filter_chunks(false, |_, _, block| is_wanted(block.layer, block.level));
    let mut blocks = chunks.map_err(|error| unreadable(&error))?.sequential_decompressor(false);
    while let Some(block) = blocks.decompress_next_block() {
        let block = block.map_err(|error| unreadable(&error))?;
        for line in block.lines(&header.channels) {
            let at = line.location;
            let of_alpha = layer.alpha == Some(at.channel);
            if !of_alpha && !layer.channels.contains(&at.channel) {
                continue;
            }
            let samples = samples(&line, header.channels.list[at.channel].sample_type)?;
            if of_alpha {
                data.translucent += samples.iter().filter(|alpha| **alpha != 1.0).count();
            }
            let begin = at.position.y() * width + at.position.x();
            for (pixel, sample) in data.rgb[begin..begin + samples.len()].iter_mut().zip(samples) {
                for (value, channel) in pixel.iter_mut().zip(layer.channels) {
                    if channel == at.channel {
                        *value = sample;
                    }
                }
            }
        }
    }
    Ok(data)
}

fn samples(line: &LineRef, kind: SampleType) -> io::Result<Vec<f32>> {
    let samples: exr::error::Result<Vec<f32>> = match kind {
        SampleType::F16 => line.read_samples::<f16>().map(|sample| Ok(sample?.to_f32())).collect(),
        SampleType::F32 => line.read_samples::<f32>().collect(),
        SampleType::U32 => line.read_samples::<u32>().map(|sample| Ok(sample? as f32)).collect(),
    };
    samples.map_err(|error| unreadable(&error))
}

/// All layers with red, green and blue; if there are none, all with luminance.
fn layers(headers: &[Header]) -> Vec<Layer> {
    let (mut colour, mut grey) = (Vec::new(), Vec::new());
    for (part, header) in headers.iter().enumerate() {
        let mut groups: BTreeMap<String, [Option<usize>; 5]> = BTreeMap::new();
        for (index, channel) in header.channels.list.iter().enumerate() {
            let name = channel.name.to_string();
            let (group, own) = name.rsplit_once('.').unwrap_or(("", &name));
            let own = own.to_ascii_lowercase();
            let names = [["r", "red"], ["g", "green"], ["b", "blue"], ["a", "alpha"], ["y", "y"]];
            if let Some(place) = names.iter().position(|names| names.contains(&own.as_str())) {
                groups.entry(group.to_owned()).or_default()[place] = Some(index);
            }
        }
        let own = header.own_attributes.layer_name.as_ref().map_or_else(String::new, ToString::to_string);
        let own = if headers.len() > 1 { own } else { String::new() };
        for (group, [r, g, b, alpha, y]) in groups {
            let name = match (own.is_empty(), group.is_empty()) {
                (false, false) if !group.starts_with(&own) => format!("{own}.{group}"),
                (false, true) => own.clone(),
                _ => group,
            };
            match (r, g, b, y) {
                (Some(r), Some(g), Some(b), _) => {
                    colour.push(Layer { part, name, channels: [r, g, b], alpha });
                }
                (_, _, _, Some(y)) => grey.push(Layer { part, name, channels: [y; 3], alpha }),
                _ => {}
            }
        }
    }
    if colour.is_empty() { grey } else { colour }
}

fn choose<'a>(layers: &'a [Layer], headers: &[Header], name: Option<&str>) -> io::Result<&'a Layer> {
    if let Some(name) = name {
        let found = layers.iter().find(|layer| layer.name == name);
        return found.ok_or_else(|| {
            invalid(format!("it has no layer {name:?}; choose one of {} after FILE:", names(layers)))
        });
    }
    let usual: Vec<&Layer> = layers.iter().filter(|layer| layer.name.is_empty()).collect();
    match (layers, usual.as_slice()) {
        ([only], _) => Ok(only),
        (_, [usual]) => Ok(usual),
        ([], _) => {
            let channels = headers.iter().flat_map(|header| &header.channels.list);
            let channels: Vec<String> = channels.map(|channel| channel.name.to_string()).collect();
            Err(invalid(format!(
                "it has no channels R, G and B, nor Y, but {}; save the picture with these names",
                channels.join(", ")
            )))
        }
        _ => Err(invalid(format!("it has several layers; choose one as FILE:LAYER: {}", names(layers)))),
    }
}

fn names(layers: &[Layer]) -> String {
    let names = layers.iter().map(|layer| layer.name.as_str()).filter(|name| !name.is_empty());
    names.collect::<Vec<_>>().join(", ")
}

/// What makes the numbers of a picture mean something else than usual.
fn notes(header: &Header) -> Vec<String> {
    let mut notes = Vec::new();
    if let Some(space) = &header.shared_attributes.chromaticities {
        let found = [space.red, space.green, space.blue, space.white];
        let usual = [[0.64, 0.33], [0.3, 0.6], [0.15, 0.06], [0.3127, 0.329]];
        let is_near = |(found, usual): (&Vec2<f32>, [f32; 2])| {
            (found.x() - usual[0]).abs() < 2e-3 && (found.y() - usual[1]).abs() < 2e-3
        };
        if !found.iter().zip(usual).all(is_near) {
            let [red, ..] = found;
            notes.push(format!(
                "its colours are not those of sRGB (its red is at {},{} instead of 0.64,0.33); they are not converted",
                red.x(),
                red.y()
            ));
        }
    }
    let is_lossy = matches!(
        header.compression,
        Compression::B44 | Compression::B44A | Compression::DWAA(_) | Compression::DWAB(_)
    );
    if is_lossy {
        notes.push(format!("its {} changes the values", header.compression));
    }
    notes
}

fn size(Vec2(width, height): Vec2<usize>) -> io::Result<(u32, u32)> {
    let side = |side: usize| u32::try_from(side).unwrap_or(u32::MAX);
    let (width, height) = (side(width), side(height));
    pixel_count(width, height)?;
    check_memory(width, height)?;
    Ok((width, height))
}

fn unreadable(error: &Error) -> io::Error {
    let text = error.to_string();
    let remedy = match error {
        Error::NotSupported(_) if text.contains("compression") => "save it with another, such as ZIP",
        Error::NotSupported(_) => "save it as a flat picture with R, G and B of the same size",
        _ => "check whether the file is complete",
    };
    invalid(format!("{text}; {remedy}"))
}
