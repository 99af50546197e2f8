//! The files of kept pictures: a film (`ID.exr`) and a note (`ID.json`) for each, which never change, and a list
//! (`slots.json`) of the slots that they are in. No two pictures have the same ID, so a film can never meet the note of
//! another. A film in the folder is a kept picture even if the list does not mention it.

use super::bounded::Bounded;
use super::note::PictureNote;
use crate::app::answers::caught;
use crate::app::model::document::Document;
use crate::app::model::kept::Kept;
use crate::app::model::slots::{Coming, Slot, SlotNumber};
use crate::film::{checkpoint, key};
use crate::job::saved::{self, Content, SavedFilm};
use crate::progressive::describe::{SOFTWARE, describe};
use crate::system::files::{InputError, check_writable, read, replace_file, write_text};
use serde::{Deserialize, Serialize};
use std::fs;
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};
use std::time::SystemTime;

/// How the names of all such folders end.
const ENDING: &str = "slots";

/// The longest list or note that is read, in bytes.
const TEXT_LIMIT: u64 = 64 << 20;

/// A slot in the list.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Entry {
    /// The slot; `None` for a film that the list does not mention.
    pub number: Option<SlotNumber>,
    /// [`Kept::id`].
    pub id: String,
    /// The name of the slot.
    pub name: String,
    /// Pixels across and down.
    pub size: [u32; 2],
    /// Samples per pixel.
    pub samples: u64,
    /// The size is the picture's own.
    pub has_own_size: bool,
}

impl Entry {
    /// A slot in use.
    pub fn of(number: SlotNumber, slot: &Slot) -> Entry {
        Entry {
            number: Some(number),
            id: slot.kept.id.clone(),
            name: slot.name.clone(),
            size: slot.kept.size(),
            samples: slot.kept.samples(),
            has_own_size: slot.kept.document.has_own_size,
        }
    }

    /// A slot that waits for its picture.
    pub fn awaited(number: SlotNumber, coming: &Coming) -> Entry {
        let Coming { name, id, size, samples, has_own_size } = coming.clone();
        Entry { number: Some(number), id, name, size, samples, has_own_size }
    }

    /// What is known of the picture before it is read.
    pub fn coming(&self) -> Coming {
        let Entry { id, name, size, samples, has_own_size, .. } = self.clone();
        Coming { name, id, size, samples, has_own_size }
    }
}

#[derive(Default, Serialize, Deserialize)]
#[serde(default)]
struct List {
    software: String,
    slots: Vec<Entry>,
}

/// What is in a folder.
#[derive(Debug, Default, PartialEq, Eq)]
pub struct Listing {
    /// The pictures.
    pub entries: Vec<Entry>,
    /// What is wrong with the list, in words.
    pub faults: Vec<String>,
}

/// Why a picture could not be written.
#[derive(Debug)]
pub enum WriteFault {
    /// It takes this many bytes, more than there is room for.
    TooLarge(u64),
    /// The system's reason, in words.
    Failed(String),
}

/// The folder with the kept pictures of one window.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Folder(PathBuf);

impl Folder {
    /// The folder of the window whose files have this name. It need not exist.
    pub fn of(directory: &Path, name: &str) -> Folder {
        Folder(directory.join(format!("{name}.{ENDING}")))
    }

    /// Its path.
    pub fn path(&self) -> &Path {
        &self.0
    }

    /// Whether there is anything in it, or may be: it cannot be looked at.
    pub fn exists(&self) -> bool {
        match fs::read_dir(&self.0) {
            Ok(mut entries) => entries.next().is_some(),
            Err(error) => error.kind() != ErrorKind::NotFound,
        }
    }

    /// Whether the film of a picture is there, or may be: its place cannot be looked at.
    pub fn may_have(&self, id: &str) -> bool {
        !matches!(self.film(id).try_exists(), Ok(false))
    }

    /// The film of a picture.
    pub fn film(&self, id: &str) -> PathBuf {
        self.0.join(format!("{id}.exr"))
    }

    pub(super) fn note(&self, id: &str) -> PathBuf {
        self.0.join(format!("{id}.json"))
    }

    pub(super) fn list(&self) -> PathBuf {
        self.0.join("slots.json")
    }

    /// When the list was written last.
    pub fn changed(&self) -> Option<SystemTime> {
        fs::metadata(self.list()).or_else(|_| fs::metadata(&self.0)).ok()?.modified().ok()
    }

    /// The pictures. Deletes what killed windows have not finished.
    ///
    /// # Errors
    /// Why the folder or its list cannot be read, in words that name it. Nothing is deleted then.
    pub fn listing(&self) -> Result<Listing, String> {
        let Some(files) = self.files()? else { return Ok(Listing::default()) };
        let (listed, mut faults) = self.read_list()?;
        // If it cannot be tidied, the next film that is written says so.
        let _ = check_writable(&self.list());
        let mut films = self.stems(&files, "exr");
        for note in self.stems(&files, "json").into_iter().filter(|id| !films.contains(id)) {
            // The film was not written to its end.
            let _ = fs::remove_file(self.note(&note));
        }
        let mut entries: Vec<Entry> = Vec::new();
        for mut entry in listed {
            match films.iter().position(|id| *id == entry.id) {
                Some(place) => {
                    films.swap_remove(place);
                    if entries.iter().any(|other| other.number == entry.number) {
                        entry.number = None;
                    }
                    entries.push(entry);
                }
                None => {
                    let of = entry.number.map_or_else(String::new, |number| format!(" of slot {number}"));
                    faults.push(format!(
                        "the film{of}, {}, is missing: there is no {}.exr in {}",
                        entry.name,
                        entry.id,
                        self.0.display()
                    ));
                }
            }
        }
        films.sort();
        entries.extend(films.into_iter().map(|id| self.unlisted(id)));
        Ok(Listing { entries, faults })
    }

    /// All files, none or all of which are known; `None` without a folder.
    fn files(&self) -> Result<Option<Vec<PathBuf>>, String> {
        let files = fs::read_dir(&self.0)
            .and_then(|entries| entries.map(|entry| entry.map(|entry| entry.path())).collect());
        match files {
            Ok(files) => Ok(Some(files)),
            Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
            Err(error) => Err(format!("cannot list {}: {error}", self.0.display())),
        }
    }

    /// The names of files of this ending, without the list.
    fn stems(&self, files: &[PathBuf], ending: &str) -> Vec<String> {
        let is_it =
            |path: &&PathBuf| path.extension().is_some_and(|own| own == ending) && **path != self.list();
        let stems = files.iter().filter(is_it).filter_map(|path| path.file_stem()?.to_str());
        stems.map(str::to_owned).collect()
    }

    /// The slots in the list, or none and what is wrong with it.
    fn read_list(&self) -> Result<(Vec<Entry>, Vec<String>), String> {
        let path = self.list();
        if let Ok(false) = path.try_exists() {
            return Ok((Vec::new(), Vec::new()));
        }
        let bytes = match read(&path, "a list of kept pictures", TEXT_LIMIT) {
            Ok(bytes) => bytes,
            Err(error @ InputError::Unreadable { .. }) => return Err(error.to_string()),
            Err(error) => return Ok((Vec::new(), vec![error.to_string()])),
        };
        Ok(match serde_json::from_slice::<List>(&bytes) {
            Ok(list) => (list.slots, Vec::new()),
            Err(error) => (Vec::new(), vec![format!("{} cannot be understood: {error}", path.display())]),
        })
    }

    /// What a film says of itself that is not in the list.
    fn unlisted(&self, id: String) -> Entry {
        let head = checkpoint::read_head(&self.film(&id)).ok();
        let name = head.as_ref().and_then(|head| head.description.get(key::SCENE));
        let name = name.unwrap_or("a kept picture").to_owned();
        let (size, samples) =
            head.map_or(([0, 0], 0), |head| ([head.width, head.height], head.samples.count()));
        // Nothing follows the size of a picture that may be damaged.
        Entry { number: None, id, name, size, samples, has_own_size: true }
    }

    /// Writes film and note of a picture, in no more than `room` bytes. Returns their bytes.
    ///
    /// # Errors
    /// [`WriteFault`]; nothing is left of the picture then.
    pub fn write(&self, kept: &Kept, room: u64) -> Result<u64, WriteFault> {
        let outcome =
            caught(|| self.try_write(kept, room)).unwrap_or_else(|reason| Err(WriteFault::Failed(reason)));
        if outcome.is_err() {
            let _ = fs::remove_file(self.note(&kept.id));
            let _ = fs::remove_dir(&self.0);
        }
        outcome
    }

    fn try_write(&self, kept: &Kept, room: u64) -> Result<u64, WriteFault> {
        let failed = |reason: &dyn ToString| WriteFault::Failed(reason.to_string());
        let create = |error| WriteFault::Failed(format!("cannot write to {}: {error}", self.0.display()));
        fs::create_dir_all(&self.0).map_err(create)?;
        let note = serde_json::to_string_pretty(&PictureNote::of(kept)).map_err(|error| failed(&error))?;
        let room = room.saturating_sub(note.len() as u64);
        write_text(&self.note(&kept.id), &note).map_err(|error| failed(&error))?;
        let document = &kept.document;
        let mut recipe = document.recipe();
        recipe.samples_per_pixel = kept.samples().max(1);
        let stage = document.stage().filter(|_| !document.has_changed_scene());
        let description = describe(&recipe, stage, &kept.film, &kept.status, kept.seconds_before);
        let (mut bytes, mut is_over) = (0, false);
        let written = replace_file(&self.film(&kept.id), |writer| {
            let mut bounded = Bounded::new(writer, room);
            checkpoint::write(&kept.film, &description, &mut bounded)?;
            (bytes, is_over) = (bounded.bytes() + note.len() as u64, bounded.is_over());
            // The file is then not put in place.
            if is_over { Err(ErrorKind::FileTooLarge.into()) } else { Ok(()) }
        });
        match written {
            Ok(()) => Ok(bytes),
            Err(_) if is_over => Err(WriteFault::TooLarge(bytes)),
            Err(error) => Err(failed(&error)),
        }
    }

    /// Writes the list. An empty one is deleted, with the folder.
    ///
    /// # Errors
    /// Why it cannot be written.
    pub fn write_list(&self, slots: &[Entry]) -> Result<(), String> {
        if slots.is_empty() {
            // If it cannot be deleted, it says nothing of films that are gone.
            let _ = fs::remove_file(self.list());
            let _ = fs::remove_dir(&self.0);
            return Ok(());
        }
        fs::create_dir_all(&self.0)
            .map_err(|error| format!("cannot write to {}: {error}", self.0.display()))?;
        let list = List { software: SOFTWARE.to_owned(), slots: slots.to_vec() };
        let text = serde_json::to_string_pretty(&list).map_err(|error| error.to_string())?;
        write_text(&self.list(), &text).map_err(|error| error.to_string())
    }

    /// Deletes film and note of a picture.
    pub fn delete(&self, id: &str) {
        // If it cannot be deleted, the next window shows it in a free slot.
        let _ = fs::remove_file(self.film(id));
        let _ = fs::remove_file(self.note(id));
    }

    /// Deletes all pictures.
    ///
    /// # Errors
    /// Why the folder or its list cannot be read. Nothing is deleted then.
    pub fn delete_all(&self) -> Result<(), String> {
        self.listing()?.entries.iter().for_each(|entry| self.delete(&entry.id));
        self.clear();
        Ok(())
    }

    /// Deletes the folder if there is nothing in it but perhaps a list.
    pub fn clear(&self) {
        let is_bare = |files: Vec<PathBuf>| files.iter().all(|path| *path == self.list());
        if self.files().is_ok_and(|files| files.is_some_and(is_bare)) {
            let _ = fs::remove_file(self.list());
            let _ = fs::remove_dir(&self.0);
        }
    }

    /// Reads a picture. `known` are documents whose scenes it shares where they are equal.
    ///
    /// # Errors
    /// Why its film cannot be read, in words that name the file.
    pub fn read(&self, id: &str, known: &[Document]) -> Result<Kept, String> {
        let opened = saved::open(&self.film(id)).map_err(|error| error.to_string())?;
        let Content::Film(SavedFilm { film, seconds, .. }) = opened.content else {
            return Err(format!("{} holds no film", opened.path.display()));
        };
        // Without its note, the picture is as its film describes it.
        let note = read(&self.note(id), "a note of a kept picture", TEXT_LIMIT).ok();
        let note = note.and_then(|bytes| serde_json::from_slice::<PictureNote>(&bytes).ok());
        let seconds = note.as_ref().map_or(seconds, |note| note.seconds_before);
        let note = note.unwrap_or_default();
        let mut document = note.session.document_of_film(&opened.recipe, opened.stage);
        known.iter().for_each(|other| document.share_with(other));
        let status = note.status(film.sample_count());
        Ok(Kept::new(document, film, status.into(), seconds).with_id(id.to_owned()))
    }

    /// Makes a picture of another folder this one's.
    ///
    /// # Errors
    /// Errors of the file system; the picture then stays where it is.
    pub fn take(&self, other: &Folder, id: &str) -> io::Result<()> {
        fs::create_dir_all(&self.0)?;
        // The film last: without it, a note is nothing.
        match fs::rename(other.note(id), self.note(id)) {
            Err(error) if error.kind() != ErrorKind::NotFound => return Err(error),
            _ => {}
        }
        fs::rename(other.film(id), self.film(id))
    }

    /// Moves a film out of the folder, without its note.
    ///
    /// # Errors
    /// Errors of the file system.
    pub fn move_film(&self, id: &str, to: &Path) -> io::Result<()> {
        fs::rename(self.film(id), to)?;
        let _ = fs::remove_file(self.note(id));
        Ok(())
    }

    /// Bytes that the kept pictures of all windows take whose files are beside this one's.
    pub fn bytes_of_all(&self) -> u64 {
        let entries = |path: &Path| fs::read_dir(path).into_iter().flatten().flatten();
        let folders = self.0.parent().into_iter().flat_map(entries).map(|entry| entry.path());
        let folders = folders.filter(|path| path.extension().is_some_and(|ending| ending == ENDING));
        folders.flat_map(|path| entries(&path)).filter_map(|file| Some(file.metadata().ok()?.len())).sum()
    }
}
