//! A picture in linear radiance, from a film, any program's file, or a backend.

use crate::film::checkpoint::DENOISED_LAYER;
use crate::film::{CheckpointError, Film, key};
use crate::job::output::{Encoding, Linear, Values, read_picture};
use crate::job::recipe::Recipe;
use crate::job::saved::{Kind, OpenError, Saved, open};
use crate::stages::Transfer;
use crate::system::memory;
use anyhow::Result;
use std::path::Path;
use std::sync::Arc;

#[derive(Clone, Debug)]
pub struct Picture {
    /// Name of the file or backend.
    pub name: String,
    /// Description for the reader.
    pub about: String,
    pub width: u32,
    pub height: u32,
    /// Linear RGB, row by row from the top. With a finite limit, NaN stands for it or anything above it.
    pub pixels: Vec<[f64; 3]>,
    /// Largest quantisation error of each channel, either way; `None` if the format has none.
    pub steps: Option<Vec<[f64; 3]>>,
    /// The limit of an integer format, at and above which a channel is NaN; infinite for floats.
    pub limit: f64,
    /// Notes on what the reader of the file left out or assumed.
    pub notes: Vec<String>,
    pub film: Option<Arc<Film>>,
}

impl Picture {
    /// Reads a file, or a layer of one (`FILE:LAYER`). `encoding` applies to integer pictures without a description;
    /// if it is `None`, what a PNG says does, or else the book's square root.
    pub fn read(path: &Path, encoding: Option<Encoding>) -> Result<Self> {
        let name = path.display().to_string();
        let (path, layer) = match name.rsplit_once(':') {
            Some((file, layer)) if !path.exists() && Path::new(file).exists() => {
                (Path::new(file), Some(layer))
            }
            _ => (path, None),
        };
        let saved = match open(path) {
            Ok(saved) => Some(saved),
            // Most pictures have no description, and the pixels can be compared without one. Reading the picture below
            // reports its own errors.
            Err(
                OpenError::Picture(_)
                | OpenError::Recipe(_)
                | OpenError::Film(CheckpointError::Resaved { .. }),
            ) => None,
            Err(error) => return Err(error.into()),
        };
        let described = |key| Some(saved.as_ref()?.kind.text(key)?.to_owned());
        let samples = described(key::SAMPLES).map_or_else(String::new, |count| format!(", {count} samples"));
        let is_denoised = layer == Some(DENOISED_LAYER)
            || saved.as_ref().is_some_and(|saved| matches!(saved.kind, Kind::Picture(_)));
        let denoised = described(key::DENOISED).filter(|_| is_denoised);
        let denoised = denoised.or_else(|| (layer == Some(DENOISED_LAYER)).then(String::new));
        // A film's layers are pictures.
        if let Some(saved @ Saved { kind: Kind::Film(head), .. }) = saved.as_ref().filter(|_| layer.is_none())
        {
            check_memory(head.width, head.height, 1)?;
            match saved.film() {
                Ok(read) => return Picture::of_rendered(name, Some(&saved.recipe), read.film.into()),
                // Another program lost the sums, but the picture is there.
                Err(OpenError::Film(CheckpointError::Resaved { .. })) => {}
                Err(error) => return Err(error.into()),
            }
        }
        let recipe = saved.map(|saved| saved.recipe);
        let read = read_picture(path, layer)?;
        let described = recipe.as_ref().map(|recipe| Encoding::Book(recipe.rules.transfer));
        let is_stated = described.or(encoding).is_none() && read.stated.is_some();
        let encoding = described.or(encoding).or(read.stated).unwrap_or(Encoding::Book(Transfer::Gamma2));
        let stated = is_stated.then(|| {
            format!(
                "it says that its values are {}; if they are square roots as in the book, add --encoding gamma2",
                encoding.name()
            )
        });
        let kind = match &read.values {
            Values::Integers { .. } => "integers",
            Values::Floats { halves, .. } if halves.contains(&true) => "16-bit floats",
            Values::Floats { .. } => "floats",
        };
        let Linear { pixels, steps, limit } = read.linear(encoding);
        let damages = read.damages.into_iter().map(|damage| damage.title);
        let bias = denoised.as_ref().map(|error| {
            let error = if error.is_empty() { String::new() } else { format!(", estimated as {error}") };
            format!("it is denoised: besides noise it has an error of its own{error}")
        });
        let what = if denoised.is_some() { "denoised picture" } else { "picture" };
        Ok(Picture {
            about: format!("{what}, {}x{}, {kind}{samples}", read.width, read.height),
            name,
            width: read.width,
            height: read.height,
            pixels,
            steps,
            limit,
            notes: damages.chain(read.notes.into_iter().map(advised)).chain(stated).chain(bias).collect(),
            film: None,
        })
    }

    pub fn of_film(name: String, about: String, film: impl Into<Arc<Film>>) -> Self {
        let film = film.into();
        let (width, height) = (film.width(), film.height());
        let pixels = film.exact_means().collect();
        let (limit, film) = (f64::INFINITY, Some(film));
        Picture { name, about, width, height, pixels, steps: None, limit, notes: Vec::new(), film }
    }

    /// The picture of a film, and what its recipe says about it. Fails if a comparison of this size does not fit into
    /// memory.
    pub fn of_rendered(name: String, recipe: Option<&Recipe>, film: Arc<Film>) -> Result<Self> {
        let (width, height) = (film.width(), film.height());
        check_memory(width, height, 0)?;
        let size = format!("{width}x{height}, {} samples", film.sample_count());
        let about = match recipe {
            Some(Recipe { name, settings, .. }) => {
                format!("film, {name}, {size}, {}, seed {}", settings.sampler.name(), settings.seed)
            }
            None => format!("film, {size}"),
        };
        Ok(Picture::of_film(name, about, film))
    }

    /// A channel's value; `None` if it is at or above an integer format's limit.
    pub(super) fn value(&self, pixel: usize, channel: usize) -> Option<f64> {
        let value = self.pixels[pixel][channel];
        (self.limit.is_infinite() || !value.is_nan()).then_some(value)
    }
}

/// Checks whether a comparison of this size fits into memory, with this number of films that are not read yet.
fn check_memory(width: u32, height: u32, films: u64) -> Result<()> {
    let bytes = u64::from(width) * u64::from(height) * BYTES_PER_PIXEL + films * Film::bytes(width, height);
    let what = || format!("comparing pictures of {width}x{height}");
    Ok(memory::check(what, bytes, "compare smaller pictures")?)
}

/// A note, with what the user can do about it.
fn advised(note: String) -> String {
    if note.contains("ICC") { format!("{note}; choose the transfer curve with --encoding") } else { note }
}

/// Bytes per pixel during a comparison, without films: both pictures, the difference, the halves' differences or the
/// steps and bounds, and the noise.
const BYTES_PER_PIXEL: u64 = 8 * 18;
