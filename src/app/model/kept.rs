//! The pictures that the user has kept to compare with. They live in memory until the window closes.

use super::Document;
use crate::film::Film;
use crate::progressive::{ReferenceMeans, Status};
use eframe::egui::{ColorImage, Context, TextureHandle, TextureOptions};
use image::{RgbImage, imageops};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, OnceLock};

/// The longer side of a small copy, pixels.
const SMALL: u32 = 264;

/// A small copy of the picture of a film.
fn small_copy(film: &Film, document: &Document) -> ColorImage {
    let (width, height) = (film.width(), film.height());
    let rgb8 = film.to_rgb8(document.rules().transfer);
    let full = RgbImage::from_raw(width, height, rgb8).unwrap_or_default();
    let scale = (f64::from(SMALL) / f64::from(width.max(height))).min(1.0);
    let [width, height] = [width, height].map(|side| ((f64::from(side) * scale).round() as u32).max(1));
    ColorImage::from_rgb([width as usize, height as usize], &imageops::thumbnail(&full, width, height))
}

/// A picture that was kept. It never changes.
pub struct Kept {
    /// A number that no other kept picture has.
    pub number: u64,
    /// What it shows.
    pub document: Document,
    /// Its exact sums.
    pub film: Arc<Film>,
    /// The status of its render.
    pub status: Arc<Status>,
    /// Tracing time of the samples from before that render, if known.
    pub seconds_before: Option<f64>,
    small: ColorImage,
    texture: OnceLock<TextureHandle>,
    means: OnceLock<Arc<ReferenceMeans>>,
}

impl std::fmt::Debug for Kept {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(formatter, "Kept {}", self.number)
    }
}

impl Kept {
    /// Keeps a film of `document` that has samples.
    pub fn new(document: Document, film: Film, status: Arc<Status>, seconds_before: Option<f64>) -> Self {
        static COUNT: AtomicU64 = AtomicU64::new(0);
        Kept {
            number: COUNT.fetch_add(1, Ordering::Relaxed),
            small: small_copy(&film, &document),
            document,
            film: Arc::new(film),
            status,
            seconds_before,
            texture: OnceLock::new(),
            means: OnceLock::new(),
        }
    }

    /// A small picture of it.
    pub fn thumbnail(&self, context: &Context) -> &TextureHandle {
        let load = || context.load_texture("kept", self.small.clone(), TextureOptions::LINEAR);
        self.texture.get_or_init(load)
    }

    /// Samples per pixel.
    pub fn samples(&self) -> u64 {
        self.film.sample_count()
    }

    /// Pixels across and down.
    pub fn size(&self) -> [u32; 2] {
        [self.film.width(), self.film.height()]
    }

    /// The linear radiance of a pixel, column and row.
    pub fn mean(&self, [x, y]: [u32; 2]) -> Option<[f64; 3]> {
        let is_inside = x < self.film.width() && y < self.film.height();
        is_inside.then(|| self.film.mean(y as usize * self.film.width() as usize + x as usize))
    }

    /// Its picture to subtract from another, if that was computed.
    pub fn known_means(&self) -> Option<&Arc<ReferenceMeans>> {
        self.means.get()
    }

    /// Its picture to subtract from another. The first call takes as long as resolving the picture.
    pub fn means(&self) -> &Arc<ReferenceMeans> {
        self.means.get_or_init(|| Arc::new(ReferenceMeans::of(&self.film)))
    }

    /// Bytes that it takes.
    pub fn bytes(&self) -> u64 {
        let [width, height] = self.size();
        let of_means = self.means.get().map_or(0, |means| size_of_val(means.means.as_slice()) as u64);
        Film::bytes(width, height, self.film.halves().len()) + of_means
    }
}

/// The list of kept pictures, oldest first. Places count from 0; the user sees them from 1.
#[derive(Clone, Debug, Default)]
pub struct KeptList {
    pictures: Vec<Arc<Kept>>,
    looked: Option<usize>,
    chosen: Option<usize>,
}

impl KeptList {
    pub fn iter(&self) -> impl Iterator<Item = &Arc<Kept>> {
        self.pictures.iter()
    }

    pub fn get(&self, place: usize) -> Option<&Arc<Kept>> {
        self.pictures.get(place)
    }

    /// As it is called in sentences.
    pub fn title(&self, place: usize) -> String {
        self.get(place).map_or_else(String::new, |kept| format!("{}: {}", place + 1, kept.document.title()))
    }

    /// The place of the picture that is shown instead of the traced one.
    pub fn looked(&self) -> Option<usize> {
        self.looked
    }

    /// The kept picture that is shown instead of the traced one.
    pub fn shown(&self) -> Option<&Arc<Kept>> {
        self.get(self.looked?)
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

    /// Shows a kept picture, or the traced one.
    pub fn look(&mut self, place: Option<usize>) {
        self.looked = place.filter(|place| *place < self.pictures.len());
        self.chosen = self.looked.or(self.chosen);
    }

    /// Adds a picture and chooses it. Returns its place.
    pub fn add(&mut self, kept: Kept) -> usize {
        self.pictures.push(Arc::new(kept));
        let place = self.pictures.len() - 1;
        self.chosen = Some(place);
        place
    }

    /// Removes a picture; later ones move up.
    pub fn delete(&mut self, place: usize) {
        if place >= self.pictures.len() {
            return;
        }
        self.pictures.remove(place);
        let after = |other: usize| (other != place).then(|| other - usize::from(other > place));
        self.looked = self.looked.and_then(after);
        self.chosen = self.chosen.and_then(after).or_else(|| self.pictures.len().checked_sub(1));
    }

    /// What all of them take in memory.
    pub fn bytes(&self) -> u64 {
        self.iter().map(|kept| kept.bytes()).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::model::Origin;
    use crate::film::PixelSum;
    use crate::stages::Stage;

    fn film(width: u32, height: u32, value: u64) -> Film {
        let mut film = Film::new(width, height, 1);
        film.halves_mut()[0].iter_mut().for_each(|sum| *sum = PixelSum([value << 16; 3]));
        film.record(0..1, 0).unwrap();
        film
    }

    #[test]
    fn a_pixel_of_a_kept_picture_is_found_by_its_column_and_row() {
        let document = Document::new(Origin::of_stage(Stage::find("metal").unwrap()));
        let mut film = film(4, 2, 1);
        film.halves_mut()[0].iter_mut().zip(1..).for_each(|(sum, value)| *sum = PixelSum([value << 16; 3]));
        let kept = Kept::new(document, film, Arc::default(), None);
        let unit = kept.mean([0, 0]).unwrap()[0];
        let found = [[3, 0], [0, 1], [3, 1]].map(|at| (kept.mean(at).unwrap()[0] / unit).round());
        assert_eq!(found, [4.0, 5.0, 8.0]);
        assert_eq!([kept.mean([4, 0]), kept.mean([0, 2])], [None, None]);
    }

    #[test]
    fn the_picture_to_subtract_is_made_once_and_knows_its_film() {
        let document = Document::new(Origin::of_stage(Stage::find("metal").unwrap()));
        let mut two_halves = Film::new(4, 2, 2);
        two_halves.record(0..2, 0).unwrap();
        let kept = Kept::new(document, two_halves, Arc::default(), None);
        assert_eq!((kept.bytes(), kept.samples(), kept.size()), (8 * 48, 2, [4, 2]));
        assert!(kept.known_means().is_none());
        let means = Arc::clone(kept.means());
        assert!(kept.known_means().is_some_and(|known| Arc::ptr_eq(known, &means)));
    }
}
