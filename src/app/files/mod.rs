//! Saves and opens files without blocking the window's thread: the render thread, which has the film, writes; a
//! separate thread reads. A size that is not on the screen is rendered first, beside the picture.

pub mod edits;
pub mod scene_file;
pub mod store;

use crate::app::commands::Command;
use crate::app::model::{Document, Wish};
use crate::app::toolkit::{Answers, Toasts};
use crate::app::tracing::subject::Subject;
use crate::backends::BackendChoice;
use crate::batch::{FramesOptions, Studio, write_frames};
use crate::comparison::Picture;
use crate::denoise::{self, Denoised};
use crate::film::Film;
use crate::job::output::{Description, OutputFormat, is_named_picture, key, write_image};
use crate::job::recipe::file;
use crate::job::saved::{Kind, OpenError, Saved, SavedFilm, open};
use crate::progressive::describe::{counted, describe};
use crate::progressive::{Phase, Status};
use crate::system::console;
use crate::system::files::replace_file;
use crate::system::interrupt::Interrupt;
use eframe::egui::{ColorImage, Context};
use scene_file::SceneFile;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::Duration;

/// A file that the window shows, and the film, if it has one.
pub type Opened = (Saved, Option<SavedFilm>);

/// A picture that was to be saved, and as what.
pub type Lost = (Document, (OutputFormat, PathBuf));

/// Something that was written or made.
pub enum Made {
    /// A file; with its picture if it is a scene.
    File(PathBuf, Option<Box<Document>>),
    /// An animation of this number of frames in this folder.
    Frames(u32, PathBuf),
}

/// Something that takes long to make in the background.
struct Making {
    interrupt: Arc<Interrupt>,
    /// The work, in words.
    words: String,
    /// How much of it is done, if that is known.
    percent: Arc<AtomicU32>,
    /// The name of the file that would be lost.
    name: Option<String>,
}

/// Files being read and written. The answers are the path, or why it failed.
#[derive(Default)]
pub struct Files {
    pub scene_file: SceneFile,
    /// To be saved and copied once there are samples.
    pub save: Wish<(OutputFormat, PathBuf)>,
    pub copy: Wish<()>,
    /// Files that were written.
    saved: Answers<Made>,
    /// Results of work in the background.
    made: Answers<Made>,
    making: Option<Making>,
    /// Work that was stopped, until it has ended.
    stopped: Answers<Made>,
    /// Files that were opened, and pictures of other programs, which say nothing about how they were made.
    pub opened: Answers<Result<Opened, PathBuf>>,
    /// Pictures for the clipboard, and what they are, in words.
    pub copied: Answers<(ColorImage, String)>,
}

impl Files {
    /// Whether the film is needed at the size that it has.
    pub fn needs_film(&self) -> bool {
        self.save.open().is_some() || self.copy.open().is_some()
    }

    /// Renders the document with this many samples per pixel, and saves it.
    ///
    /// # Errors
    /// Why it cannot be rendered.
    pub fn save_rendered(
        &mut self,
        context: &Context,
        (document, samples): (Document, u64),
        backend: BackendChoice,
        named: (OutputFormat, PathBuf),
    ) -> Result<(), String> {
        let job = document.job(1).map_err(|error| error.to_string())?;
        let ([width, height], name) = (document.size(), name_of(&named.1));
        let words = format!("Rendering {width} × {height} to save it");
        self.make(context, words, Some(name), move |interrupt, look| {
            let mut studio = Studio::open(&backend, interrupt).map_err(|failure| failure.to_string())?;
            let (status, film) = studio.render(job, Studio::plan(samples), None, |_, status| {
                look(status.samples_per_pixel as f64 / samples.max(1) as f64);
            });
            let film = film.filter(|film| film.sample_count() > 0).ok_or_else(|| match &status.phase {
                Phase::Failed(reason) => reason.clone(),
                _ => "nothing was traced".to_owned(),
            })?;
            let describe = describer(&document, &status, Some(0.0));
            write(&film, false, &document, describe, named)
        })
    }

    /// Renders the frames of an animation that are missing.
    ///
    /// # Errors
    /// Why it cannot begin.
    pub fn save_frames(&mut self, context: &Context, options: FramesOptions) -> Result<(), String> {
        let (count, folder) = (options.frames.end, name_of(&options.names.directory));
        let words = format!("Rendering {} for {folder}", counted(count.into(), "frame"));
        self.make(context, words, Some(folder), move |interrupt, look| {
            let look = |done| look(f64::from(done) / f64::from(count));
            write_frames(&options, interrupt, look).map_err(|failure| failure.to_string())?;
            Ok(Made::Frames(count, options.names.directory))
        })
    }

    /// Makes something in the background, which can be stopped. `work` tells its share that is done.
    fn make(
        &mut self,
        context: &Context,
        words: String,
        name: Option<String>,
        work: impl FnOnce(&Interrupt, &dyn Fn(f64)) -> Result<Made, String> + Send + 'static,
    ) -> Result<(), String> {
        if let Some(making) = &self.making {
            return Err(format!("wait until this has ended, or stop it: {}", making.words));
        }
        if self.stopped.is_open() {
            return Err("what was stopped is still ending; try again in a moment".to_owned());
        }
        let (interrupt, percent) = (Arc::new(Interrupt::unheard()), Arc::new(AtomicU32::new(0)));
        self.making =
            Some(Making { interrupt: Arc::clone(&interrupt), words, percent: Arc::clone(&percent), name });
        let look = move |share: f64| percent.store((100.0 * share) as u32, Ordering::Relaxed);
        self.made.ask("files", context, move || work(&interrupt, &look));
        Ok(())
    }

    /// Stops what is made in the background. Its answer does not matter then.
    pub fn stop_saving(&mut self) {
        self.save = Wish::default();
        if let Some(making) = self.making.take() {
            making.interrupt.flag().store(true, Ordering::Relaxed);
            self.stopped = std::mem::take(&mut self.made);
        }
    }

    /// The oldest result that has not been taken yet, or why there is none.
    pub fn take_made(&mut self) -> Option<Result<Made, String>> {
        let made = self.made.take().inspect(|_| self.making = None);
        made.or_else(|| self.saved.take())
    }

    /// The name of the file that is saved once its picture has been rendered.
    pub fn unsaved(&self) -> Option<String> {
        let name = self.making.as_ref().and_then(|making| making.name.clone());
        name.or_else(|| Some(name_of(&self.save.open()?.1)))
    }

    /// Whether something is still rendered to be saved, or written.
    pub fn is_saving(&self) -> bool {
        self.unsaved().is_some() || self.saved.is_open()
    }

    /// Waits for the files that are being written, at the end of the window.
    pub fn end(&mut self) {
        if let Some(name) = self.unsaved() {
            console::note(&format!("weekender: {name} was not saved: its picture was still being rendered"));
        }
        self.stop_saving();
        while let Some(outcome) = self.saved.wait() {
            outcome
                .err()
                .into_iter()
                .for_each(|reason| console::note(&format!("weekender: not saved: {reason}")));
        }
    }

    /// Reports how far something is that is made in the background, and whether the window closes then.
    pub fn follow_making(&mut self, context: &Context, toasts: &mut Toasts, leaves: bool) {
        toasts.withdraw(Command::StopSaving);
        let Some(Making { words, percent, .. }) = &self.making else { return };
        let then = if leaves { ". Then the window closes" } else { "" };
        let percent = percent.load(Ordering::Relaxed);
        toasts.offer(format!("{words}, {percent} %{then}"), &[Command::StopSaving]);
        context.request_repaint_after(Duration::from_millis(250));
    }

    /// Saves and copies what was asked for, once there are samples; returns the picture to save that was left before.
    pub fn follow(&mut self, context: &Context, subject: &Subject<'_>) -> Option<Lost> {
        let (document, is_there) = (subject.document(), subject.has_samples());
        if let Some(Ok(())) = self.copy.take(document, is_there) {
            self.copy(context, subject);
        }
        match self.save.take(document, is_there)? {
            Ok(named) => self.save(context, subject, named),
            Err(lost) => return Some(lost),
        }
        None
    }

    /// Writes the film on the screen as it is at the next end of a pass.
    fn save(&mut self, context: &Context, subject: &Subject<'_>, named: (OutputFormat, PathBuf)) {
        let (document, tracing) = (subject.document().clone(), subject.tracing);
        let describe = describer(&document, tracing.main.status(), tracing.main.seconds_before);
        let answer = self.saved.promise(context);
        let is_denoised = subject.model.view.shows_denoised();
        tracing.main.inspect(move |film| {
            let copy = film.try_copy().map_err(|error| error.to_string());
            answer.give_from("save", move || write(&copy?, is_denoised, &document, describe, named));
        });
    }

    /// Resolves the film on the screen as it is saved with 8 bits, at the next end of a pass.
    fn copy(&mut self, context: &Context, subject: &Subject<'_>) {
        let transfer = subject.document().rules().transfer;
        let is_denoised = subject.model.view.shows_denoised();
        let answer = self.copied.answer(context);
        subject.tracing.main.inspect(move |film| {
            let copy = film.try_copy().map_err(|error| error.to_string());
            answer.give_from("copy", move || {
                let film = copy?;
                let denoised = denoised(&film, is_denoised);
                let film = denoised.as_ref().map_or(&film, |denoised| &denoised.film);
                let size = [film.width(), film.height()];
                let picture = ColorImage::from_rgb(size.map(|side| side as usize), &film.to_rgb8(transfer));
                Ok((picture, format!("picture, {} × {}", size[0], size[1])))
            });
        });
    }

    /// Writes a scene file. The text of a large scene takes seconds.
    pub fn save_scene(&mut self, context: &Context, path: PathBuf, document: &Document) {
        let document = document.clone();
        let work = move || {
            let text = file::to_toml(&document.recipe());
            replace_file(&path, |writer| writer.write_all(text.as_bytes()))
                .map_err(|error| error.to_string())?;
            Ok(Made::File(path, Some(Box::new(document))))
        };
        self.saved.ask("files", context, work);
    }

    /// Reads a scene file, picture or film.
    pub fn open(&mut self, context: &Context, path: PathBuf) {
        let opened = |saved: Saved| {
            saved.job()?;
            let film = matches!(saved.kind, Kind::Film(_)).then(|| saved.film()).transpose()?;
            Ok((saved, film))
        };
        let work = move || match open(&path).and_then(opened) {
            Err(_) if !path.exists() => {
                let [name, folder] = [path.file_name(), path.parent().map(Path::as_os_str)]
                    .map(|part| part.unwrap_or_default().display().to_string());
                Err(format!("there is no file {name} in {folder}"))
            }
            Ok(opened) => Ok(Ok(opened)),
            Err(OpenError::Picture(_)) if is_named_picture(&path) => Ok(Err(path)),
            Err(OpenError::Picture(_) | OpenError::Film(_)) if Picture::read(&path, None).is_ok() => {
                Err(format!(
                    "{} is the picture of another program, in floating point; Compare with a file shows it",
                    name_of(&path)
                ))
            }
            Err(OpenError::Picture(_)) => {
                Err(format!("{} is not a picture, film or scene (PNG, PPM, EXR, TOML)", path.display()))
            }
            Err(error) => Err(error.to_string()),
        };
        self.opened.ask("files", context, work);
    }
}

/// The denoised picture of all samples of a film, which has more of them than that on the screen; the raw one if that is
/// better, or wanted.
fn denoised(film: &Film, is_wanted: bool) -> Option<Denoised> {
    is_wanted.then(|| denoise::of_film(film).ok()).flatten()
}

fn write(
    film: &Film,
    is_denoised: bool,
    document: &Document,
    describe: impl FnOnce(&Film) -> Description,
    (format, path): (OutputFormat, PathBuf),
) -> Result<Made, String> {
    if film.sample_count() == 0 {
        return Err("nothing has been traced yet; try again in a moment".to_owned());
    }
    // A film is saved as it is.
    let denoised = denoised(film, is_denoised && format != OutputFormat::Exr);
    let film = denoised.as_ref().map_or(film, |denoised| &denoised.film);
    let mut description = describe(film);
    if let Some(denoised) = &denoised {
        description.set(key::DENOISED, denoised.error.words());
    }
    let written = write_image(&path, film, document.rules().transfer, &description);
    written.map(|()| Made::File(path, None)).map_err(|error| error.to_string())
}

/// The last part of a path.
pub fn name_of(path: &Path) -> String {
    path.file_name().unwrap_or(path.as_os_str()).display().to_string()
}

/// Makes the description of a film of the document, whose render has this status.
pub fn describer(
    document: &Document,
    status: &Status,
    seconds_before: Option<f64>,
) -> impl FnOnce(&Film) -> Description + Send + use<> {
    let mut recipe = document.recipe();
    let stage = document.stage().filter(|_| !document.has_changed_scene());
    let (status, held_before) = (status.clone(), status.samples_per_pixel.saturating_sub(status.added()));
    move |film| {
        recipe.samples_per_pixel = film.sample_count().max(1);
        describe(&recipe, stage, film, &status.of_film(film, held_before), seconds_before)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    #[test]
    fn unknown_pictures_are_offered_to_the_check() {
        let directory = tempfile::tempdir().unwrap();
        let (mut files, context) = (Files::default(), Context::default());
        let white = image::RgbImage::from_pixel(4, 2, image::Rgb([255; 3]));
        white.save(directory.path().join("a.png")).unwrap();
        std::fs::write(directory.path().join("a.toml"), "[camera").unwrap();
        for (name, is_picture) in [("a.png", true), ("a.toml", false), ("none.toml", false)] {
            let path = directory.path().join(name);
            files.open(&context, path.clone());
            match files.opened.wait() {
                Some(Ok(Err(found))) => assert!(is_picture && found == path, "{name}"),
                Some(Err(reason)) => assert!(!is_picture && reason.contains(name), "{reason}"),
                _ => panic!("{name} was opened"),
            }
        }
    }
}
