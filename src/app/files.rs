//! Saves and opens files without blocking the window's thread: the render thread, which has the film, writes; a
//! separate thread reads.

use super::answers::Answers;
use super::model::document::Document;
use super::tracer::Tracer;
use crate::describe::describe;
use crate::files::replace_file;
use crate::output::{OutputFormat, write_image};
use crate::progressive::{FilmIdentity, ReferenceMeans};
use crate::recipe::file;
use crate::render::RenderJob;
use crate::saved::{self, OpenError, Opened, SavedFilm};
use eframe::egui::{ColorImage, Context};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The film that the window resumes at startup.
pub struct Resumed {
    /// The file.
    pub path: PathBuf,
    /// The document shown when the film was requested.
    pub begun: Document,
    /// The film that was read.
    pub film: SavedFilm,
}

/// A file that was not opened.
pub struct NotOpened {
    /// The file.
    pub path: PathBuf,
    /// Why, in words.
    pub reason: String,
    /// It may be a picture of another program, which says nothing about how it was made.
    pub is_picture: bool,
}

/// Files being read and written. The answers are the path, or why it failed.
#[derive(Default)]
pub struct Files {
    /// Files that were written.
    pub saved: Answers<Result<PathBuf, String>>,
    /// Files that were opened.
    pub opened: Answers<Result<Opened, NotOpened>>,
    /// Films to resume.
    pub resumed: Answers<Result<Resumed, String>>,
    /// Pictures for the clipboard, and their samples per pixel.
    pub copied: Answers<(ColorImage, u64)>,
    /// Films to compare with.
    pub references: Answers<Result<(PathBuf, ReferenceMeans), String>>,
}

impl Files {
    /// Writes the film of `document` at the next end of a pass. `seconds_before` is the tracing time of the samples
    /// from before this render, if known.
    pub fn save(
        &self,
        context: &Context,
        (document, main): (&Document, &Tracer),
        seconds_before: Option<f64>,
        (format, path): (OutputFormat, PathBuf),
    ) {
        let mut recipe = document.recipe();
        let stage = document.stage().filter(|_| !document.has_changed_scene());
        let status = main.status().clone();
        let answer = self.saved.answer(context);
        main.inspect(move |film| {
            recipe.samples_per_pixel = film.sample_count().max(1);
            let description = describe(&recipe, stage, film, &status, seconds_before);
            answer.give(if film.sample_count() == 0 {
                Err("nothing has been traced yet; try again in a moment".to_owned())
            } else if OutputFormat::from_path(&path).is_ok_and(|of_name| of_name == format) {
                write_image(&path, film, recipe.rules.transfer, &description)
                    .map(|()| path)
                    .map_err(|error| error.to_string())
            } else {
                Err(format!("{} does not end in {}", path.display(), format.ending()))
            });
        });
    }

    /// Resolves the film of `document` as it is saved with 8 bits, at the next end of a pass.
    pub fn copy(&self, context: &Context, document: &Document, main: &Tracer) {
        let transfer = document.rules().transfer;
        let answer = self.copied.answer(context);
        main.inspect(move |film| {
            let size = [film.width(), film.height()].map(|pixels| pixels as usize);
            answer.give((ColorImage::from_rgb(size, &film.to_rgb8(transfer)), film.sample_count()));
        });
    }

    /// Writes a text.
    pub fn save_text(&self, context: &Context, path: &Path, text: &str) {
        let outcome = replace_file(path, |writer| writer.write_all(text.as_bytes()));
        let outcome = outcome.map(|()| path.to_owned()).map_err(|error| error.to_string());
        self.saved.answer(context).give(outcome);
    }

    /// Writes a scene file. The text of a large scene takes seconds.
    pub fn save_scene(&self, context: &Context, path: PathBuf, document: &Document) {
        let (recipe, checked) = (document.recipe(), Arc::clone(&document.checked));
        let work = move || {
            let text = file::to_toml(&recipe);
            replace_file(&path, |writer| writer.write_all(text.as_bytes()))
                .map_err(|error| error.to_string())?;
            checked.note_file(&std::path::absolute(&path).unwrap_or_else(|_| path.clone()));
            Ok(path)
        };
        if let Err(error) = self.saved.ask("files", context, work) {
            let reason = format!("the scene cannot be written: no thread could be started ({error})");
            self.saved.answer(context).give(Err(reason));
        }
    }

    /// Reads a scene file, picture or film.
    pub fn open(&self, context: &Context, path: PathBuf) {
        let opened = path.clone();
        let work = move || {
            saved::open(&path).map_err(|error| NotOpened {
                is_picture: matches!(error, OpenError::Picture(_)),
                reason: error.to_string(),
                path,
            })
        };
        if let Err(error) = self.opened.ask("files", context, work) {
            let reason = format!("the file cannot be read: no thread could be started ({error})");
            self.opened.answer(context).give(Err(NotOpened { path: opened, reason, is_picture: false }));
        }
    }

    /// Reads the film of `job`, which is the job of `document`.
    pub fn resume(&self, context: &Context, path: PathBuf, job: RenderJob, document: &Document) {
        let begun = document.clone();
        read(&self.resumed, context, move || {
            saved::resume(&path, &job).map(|film| Resumed { path, begun, film })
        });
    }

    /// Reads a film to compare with.
    pub fn load_reference(&self, context: &Context, path: PathBuf) {
        read(&self.references, context, move || {
            let (_, read) = saved::open_film(&path)?;
            let identity = Some(FilmIdentity::of(&read.film));
            Ok((path, ReferenceMeans { identity, ..ReferenceMeans::of(&read.film) }))
        });
    }
}

/// Runs a read on its own thread.
fn read<T: Send + 'static>(
    answers: &Answers<Result<T, String>>,
    context: &Context,
    work: impl FnOnce() -> Result<T, OpenError> + Send + 'static,
) {
    let work = move || work().map_err(|error| error.to_string());
    if let Err(error) = answers.ask("files", context, work) {
        let reason = format!("the file cannot be read: no thread could be started ({error})");
        answers.answer(context).give(Err(reason));
    }
}
