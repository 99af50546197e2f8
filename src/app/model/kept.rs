//! The pictures that the user has kept to compare with, and those of files. They live in memory until the window closes.

use super::Document;
use crate::comparison::Picture;
use crate::comparison::check::Mine;
use crate::film::{Film, fixed_point};
use crate::job::output::{Encoding, Linear, ReadPicture, Values};
use crate::progressive::ReferenceMeans;
use crate::stages::Transfer;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// A picture that was kept. It never changes.
pub struct Kept {
    /// A number that no other kept picture has.
    pub number: u64,
    /// What it shows, in words.
    pub name: String,
    /// The document that it shows; none for the picture of a file.
    pub document: Option<Document>,
    /// How its light becomes bytes.
    pub transfer: Transfer,
    /// Its exact sums. The picture of a file counts as one sample.
    pub film: Arc<Film>,
    /// The picture of a file, with the steps of its format.
    pub picture: Option<Picture>,
    /// Its picture to subtract from another.
    pub means: Arc<ReferenceMeans>,
}

impl Kept {
    /// Keeps a film of `document` that has samples.
    pub fn new(document: Document, film: Film) -> Self {
        let (name, transfer) = (document.title(), document.rules().transfer);
        Kept { document: Some(document), ..Kept::of(name, Arc::new(film), transfer) }
    }

    /// Reads the picture of a file. Where it says nothing else, its light has become bytes by `transfer`.
    ///
    /// # Errors
    /// If it cannot be read or does not fit into memory.
    pub fn read(path: &Path, transfer: Transfer) -> Result<Self, String> {
        let picture =
            Picture::read(path, Some(Encoding::Book(transfer))).map_err(|error| error.to_string())?;
        let name = path.file_name().unwrap_or(path.as_os_str()).display().to_string();
        Kept::of_picture(name, picture, transfer)
    }

    /// The picture of the user's own program, whose bytes mean what those of its stage mean.
    ///
    /// # Errors
    /// If it does not fit into memory.
    pub fn of_mine(name: String, mine: &Mine, transfer: Transfer) -> Result<Self, String> {
        let &Mine { width, height, format, .. } = mine;
        let rgb = mine.bytes.iter().map(|pixel| pixel.map(u16::from)).collect();
        let values = Values::Integers { most: 255, rgb };
        let (damages, notes) = (Vec::new(), Vec::new());
        let read = ReadPicture { width, height, format, values, damages, notes, stated: None };
        let Linear { pixels, steps, limit } = read.linear(Encoding::Book(transfer));
        let (about, notes, film) = (format.to_owned(), Vec::new(), None);
        let picture = Picture { name: name.clone(), about, width, height, pixels, steps, limit, notes, film };
        Kept::of_picture(name, picture, transfer)
    }

    fn of_picture(name: String, picture: Picture, transfer: Transfer) -> Result<Self, String> {
        let words = |error: &dyn std::fmt::Display| error.to_string();
        let film = match &picture.film {
            Some(film) => Arc::clone(film),
            None => {
                let film = Film::try_new(picture.width, picture.height);
                let mut film = film.map_err(|error| words(&error))?;
                // A file stores no light above white, and marks white so.
                let known = |x: f64| if x.is_nan() { 1.0 } else { x.max(0.0) };
                for (sum, pixel) in film.halves_mut()[0].iter_mut().zip(&picture.pixels) {
                    *sum = fixed_point(pixel.map(known)).unwrap_or_default();
                }
                film.record(0..1, 0).map_err(|error| words(&error))?;
                Arc::new(film)
            }
        };
        Ok(Kept { picture: Some(picture), ..Kept::of(name, film, transfer) })
    }

    fn of(name: String, film: Arc<Film>, transfer: Transfer) -> Self {
        static COUNT: AtomicU64 = AtomicU64::new(0);
        Kept {
            number: COUNT.fetch_add(1, Ordering::Relaxed),
            means: Arc::new(ReferenceMeans::of(&film)),
            document: None,
            picture: None,
            name,
            transfer,
            film,
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
}

/// The list of kept pictures, oldest first. Places count from 0; the user sees them from 1.
#[derive(Clone, Default)]
pub struct KeptList {
    pictures: Vec<Arc<Kept>>,
    /// The picture of the user's own program, which is checked. It is not in the list.
    pub mine: Option<Arc<Kept>>,
}

impl KeptList {
    pub fn iter(&self) -> impl Iterator<Item = &Arc<Kept>> {
        self.pictures.iter()
    }

    /// The picture of this number.
    pub fn find(&self, number: u64) -> Option<&Arc<Kept>> {
        self.iter().chain(&self.mine).find(|kept| kept.number == number)
    }

    /// As a kept picture is called in sentences.
    pub fn title(&self, kept: &Kept) -> String {
        format!("{}: {}", self.place(kept) + 1, kept.name)
    }

    pub fn place(&self, kept: &Kept) -> usize {
        self.pictures.iter().position(|other| other.number == kept.number).unwrap_or_default()
    }

    pub fn add(&mut self, kept: Kept) -> Arc<Kept> {
        let kept = Arc::new(kept);
        self.pictures.push(Arc::clone(&kept));
        kept
    }

    /// Removes a picture; later ones move up.
    pub fn delete(&mut self, number: u64) {
        self.pictures.retain(|kept| kept.number != number);
    }
}
