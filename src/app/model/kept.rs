//! The pictures that the user has kept to compare with. They live in memory until the window closes.

use super::Document;
use crate::film::Film;
use crate::progressive::ReferenceMeans;
use eframe::egui::{ColorImage, Context, TextureHandle, TextureOptions};
use image::{RgbImage, imageops};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// The longer side of a small copy, pixels.
const SMALL: u32 = 264;

/// A small copy of the picture of a film.
fn small_copy(context: &Context, film: &Film, document: &Document) -> TextureHandle {
    let (width, height) = (film.width(), film.height());
    let rgb8 = film.to_rgb8(document.rules().transfer);
    let full = RgbImage::from_raw(width, height, rgb8).unwrap_or_default();
    let scale = (f64::from(SMALL) / f64::from(width.max(height))).min(1.0);
    let [width, height] = [width, height].map(|side| ((f64::from(side) * scale).round() as u32).max(1));
    let small = imageops::thumbnail(&full, width, height);
    let small = ColorImage::from_rgb([width as usize, height as usize], &small);
    context.load_texture("kept", small, TextureOptions::LINEAR)
}

/// A picture that was kept. It never changes.
pub struct Kept {
    /// A number that no other kept picture has.
    pub number: u64,
    /// The document that it shows.
    pub document: Document,
    /// Its exact sums.
    pub film: Arc<Film>,
    /// Tracing time of its samples, if known.
    pub seconds: Option<f64>,
    /// Its picture to subtract from another.
    pub means: Arc<ReferenceMeans>,
    /// A small picture of it.
    pub thumbnail: TextureHandle,
}

impl Kept {
    /// Keeps a film of `document` that has samples.
    pub fn new(context: &Context, document: Document, film: Film, seconds: Option<f64>) -> Self {
        static COUNT: AtomicU64 = AtomicU64::new(0);
        Kept {
            number: COUNT.fetch_add(1, Ordering::Relaxed),
            thumbnail: small_copy(context, &film, &document),
            means: Arc::new(ReferenceMeans::of(&film)),
            document,
            film: Arc::new(film),
            seconds,
        }
    }

    /// Samples per pixel.
    pub fn samples(&self) -> u64 {
        self.film.sample_count()
    }

    /// Pixels across and down.
    pub fn size(&self) -> [u32; 2] {
        [self.film.width(), self.film.height()]
    }

    /// Bytes that it takes.
    pub fn bytes(&self) -> u64 {
        let [width, height] = self.size();
        let of_means = size_of_val(self.means.means.as_slice()) as u64;
        Film::bytes(width, height, self.film.halves().len()) + of_means
    }
}

/// The list of kept pictures, oldest first. Places count from 0; the user sees them from 1.
#[derive(Clone, Default)]
pub struct KeptList {
    pictures: Vec<Arc<Kept>>,
    chosen: Option<usize>,
}

impl KeptList {
    pub fn iter(&self) -> impl Iterator<Item = &Arc<Kept>> {
        self.pictures.iter()
    }

    pub fn get(&self, place: usize) -> Option<&Arc<Kept>> {
        self.pictures.get(place)
    }

    /// As a kept picture is called in sentences.
    pub fn title(&self, kept: &Kept) -> String {
        format!("{}: {}", self.place(kept) + 1, kept.document.title())
    }

    /// As a kept picture is called where there is little room.
    pub fn short_title(&self, kept: &Kept) -> String {
        format!("kept {}", self.place(kept) + 1)
    }

    fn place(&self, kept: &Kept) -> usize {
        self.pictures.iter().position(|other| other.number == kept.number).unwrap_or_default()
    }

    /// The place of the picture that commands mean.
    pub fn chosen(&self) -> Option<usize> {
        self.chosen
    }

    /// The picture that commands mean.
    pub fn meant(&self) -> Option<&Arc<Kept>> {
        self.get(self.chosen?)
    }

    pub fn choose(&mut self, place: usize) {
        if place < self.pictures.len() {
            self.chosen = Some(place);
        }
    }

    /// Adds a picture. Returns its place.
    pub fn add(&mut self, kept: Kept) -> usize {
        self.pictures.push(Arc::new(kept));
        self.pictures.len() - 1
    }

    /// Removes a picture; later ones move up.
    pub fn delete(&mut self, place: usize) {
        if place >= self.pictures.len() {
            return;
        }
        self.pictures.remove(place);
        let after = |other: usize| (other != place).then(|| other - usize::from(other > place));
        self.chosen = self.chosen.and_then(after).or_else(|| self.pictures.len().checked_sub(1));
    }

    /// Memory of all of them, bytes.
    pub fn bytes(&self) -> u64 {
        self.iter().map(|kept| kept.bytes()).sum()
    }
}
