//! Saves and opens files without blocking the window's thread: the render thread, which has the film, writes; a
//! separate thread reads. A size that is not on the screen is rendered first, beside the picture.

pub mod autosave;
pub mod edits;
pub mod scene_file;

use crate::app::commands::Command;
use crate::app::model::Document;
use crate::app::toolkit::{Answers, Toasts};
use crate::app::tracing::subject::Subject;
use crate::backends::BackendChoice;
use crate::cli::{CompanionOptions, ProgressChoice};
use crate::denoise::Denoised;
use crate::film::Film;
use crate::job::output::{Description, OutputFormat, is_named_picture, key, write_image};
use crate::job::recipe::file;
use crate::job::render::RenderJob;
use crate::job::saved::{self, OpenError, Opened, SavedFilm};
use crate::page::companion;
use crate::progressive::describe::describe;
use crate::progressive::{Phase, Plan, Progressive, RenderRequest, Status, Stop};
use crate::render_cpu::CpuOptions;
use crate::system::console;
use crate::system::files::{cache_directory, replace_file};
use crate::system::interrupt::Interrupt;
use eframe::egui::{ColorImage, Context};
use scene_file::SceneFile;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::Duration;

/// The film that the window resumes at startup.
pub struct Resumed {
    /// The file.
    pub path: PathBuf,
    /// The document shown when the film was requested.
    pub begun: Document,
    /// The film that was read.
    pub film: SavedFilm,
}

/// A picture that is rendered at its own size, to be saved.
struct Sized {
    progressive: Progressive,
    document: Document,
    samples: u64,
    named: (OutputFormat, PathBuf),
}

/// Files being read and written. The answers are the path, or why it failed.
#[derive(Default)]
pub struct Files {
    pub scene_file: SceneFile,
    /// The film of the command line, to resume.
    pub pending_resume: Option<(PathBuf, RenderJob)>,
    /// To be saved once there are samples.
    pub pending_save: Option<(OutputFormat, PathBuf)>,
    /// To be copied once there are samples.
    pub pending_copy: bool,
    /// Files that were written.
    pub saved: Answers<PathBuf>,
    /// Files that were opened, and pictures of other programs, which say nothing about how they were made.
    pub opened: Answers<Result<Opened, PathBuf>>,
    /// Films to resume.
    pub resumed: Answers<Resumed>,
    /// Pictures for the clipboard, and what they are, in words.
    pub copied: Answers<(ColorImage, String)>,
    /// Whether the companion that was written is the full one.
    pub companions: Answers<bool>,
    /// Where the companion is written, if not in the usual folder.
    pub companion: Option<PathBuf>,
    /// Stops the companion that is being written.
    companion_stop: Option<Arc<Interrupt>>,
    sized: Option<Sized>,
}

impl Files {
    /// Whether the film is needed at the size that it has.
    pub fn needs_film(&self) -> bool {
        self.pending_save.is_some() || self.pending_copy
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
        let mut progressive = Progressive::spawn().map_err(|error| error.to_string())?;
        let waker = context.clone();
        progressive.set_notice(move || waker.request_repaint());
        progressive.start(RenderRequest::new(job, backend, Plan::until(Stop::at_samples(samples))));
        self.sized = Some(Sized { progressive, document, samples, named });
        Ok(())
    }

    pub fn stop_saving(&mut self) {
        (self.sized, self.pending_save) = (None, None);
    }

    /// The name of the file that is saved once its picture has been rendered.
    pub fn unsaved(&self) -> Option<String> {
        let path = self.sized.as_ref().map(|sized| &sized.named.1);
        let path = path.or(self.pending_save.as_ref().map(|(_, path)| path))?;
        Some(path.file_name().unwrap_or(path.as_os_str()).display().to_string())
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
        while let Some(outcome) = self.saved.wait() {
            outcome
                .err()
                .into_iter()
                .for_each(|reason| console::note(&format!("weekender: not saved: {reason}")));
        }
    }

    /// Reports how far the picture is that is rendered to be saved, and saves it at the end.
    pub fn follow_sized(&mut self, context: &Context, toasts: &mut Toasts) {
        let Some(sized) = &self.sized else { return };
        let status = sized.progressive.status();
        toasts.withdraw(Command::StopSaving);
        if !status.phase.is_over() {
            let [width, height] = sized.document.size();
            let percent = 100 * status.samples_per_pixel.min(sized.samples) / sized.samples.max(1);
            let words = format!("Rendering {width} × {height} to save it, {percent} %");
            toasts.offer(words, &[Command::StopSaving]);
            context.request_repaint_after(Duration::from_millis(250));
            return;
        }
        let Some(Sized { progressive, document, named: (format, path), .. }) = self.sized.take() else {
            return;
        };
        let work = move || {
            let film = progressive.finish().filter(|film| film.sample_count() > 0);
            let film = film.ok_or_else(|| match &status.phase {
                Phase::Failed(reason) => reason.clone(),
                _ => "nothing was traced".to_owned(),
            })?;
            let describe = describer(&document, &status, Some(0.0));
            write(&film, None, &document, describe, (format, path))
        };
        self.saved.ask("files", context, work);
    }

    /// Writes the companion, a quick one with small figures or the full one.
    ///
    /// # Errors
    /// If there is no place for it.
    pub fn write_companion(&mut self, context: &Context, is_quick: bool) -> Result<(), &'static str> {
        if self.companion_stop.is_some() {
            return Ok(());
        }
        let out = self.companion_folder().ok_or("There is no home directory to write the companion in")?;
        let interrupt = Arc::new(Interrupt::unheard());
        self.companion_stop = Some(Arc::clone(&interrupt));
        let options = CompanionOptions {
            out,
            source: None,
            watch: false,
            quick: is_quick,
            progress: ProgressChoice::Off,
            backend: BackendChoice::Cpu(CpuOptions::default()),
        };
        let work = move || {
            let written = companion::write(&options, &interrupt);
            written.map(|_| !is_quick).map_err(|failure| failure.to_string())
        };
        self.companions.ask("companion", context, work);
        Ok(())
    }

    pub fn companion_folder(&self) -> Option<PathBuf> {
        self.companion.clone().or_else(|| Some(cache_directory()?.join("companion")))
    }

    pub fn stop_companion(&mut self) {
        if let Some(interrupt) = &self.companion_stop {
            interrupt.flag().store(true, Ordering::Relaxed);
        }
    }

    /// Notes that the companion was written. Returns whether it was stopped before.
    pub fn end_companion(&mut self) -> bool {
        self.companion_stop.take().is_some_and(|interrupt| interrupt.is_set())
    }

    /// Saves and copies what was asked for, once there are samples.
    pub fn follow(&mut self, context: &Context, subject: &Subject<'_>) {
        if !subject.has_samples() {
            return;
        }
        if let Some(named) = self.pending_save.take() {
            self.save(context, subject, named);
        }
        if std::mem::take(&mut self.pending_copy) {
            self.copy(context, subject);
        }
    }

    /// Writes the film on the screen at the next end of a pass.
    pub fn save(&mut self, context: &Context, subject: &Subject<'_>, named: (OutputFormat, PathBuf)) {
        let (document, tracing) = (subject.document.clone(), subject.tracing);
        let describe = describer(&document, tracing.main.status(), tracing.seconds_before);
        let answer = self.saved.promise(context);
        let denoised = subject.denoised.map(Arc::clone);
        let work = move |film: &Film| write(film, denoised.as_deref(), &document, describe, named);
        tracing.main.inspect(move |film| answer.give(work(film)));
    }

    /// Resolves the film on the screen, or a part of it, as it is saved with 8 bits, at the next end of a pass.
    pub fn copy(&mut self, context: &Context, subject: &Subject<'_>) {
        let transfer = subject.document.rules().transfer;
        let answer = self.copied.answer(context);
        subject.inspect(move |film| {
            let size = [film.width(), film.height()];
            let picture = ColorImage::from_rgb(size.map(|pixels| pixels as usize), &film.to_rgb8(transfer));
            answer.give(Ok((picture, format!("picture, {} × {}", size[0], size[1]))));
        });
    }

    /// Writes a scene file. The text of a large scene takes seconds.
    pub fn save_scene(&mut self, context: &Context, path: PathBuf, document: &Document) {
        let (recipe, checked) = (document.recipe(), Arc::clone(&document.checked));
        let work = move || {
            let text = file::to_toml(&recipe);
            replace_file(&path, |writer| writer.write_all(text.as_bytes()))
                .map_err(|error| error.to_string())?;
            checked.note_file(&std::path::absolute(&path).unwrap_or_else(|_| path.clone()));
            Ok(path)
        };
        self.saved.ask("files", context, work);
    }

    /// Reads a scene file, picture or film.
    pub fn open(&mut self, context: &Context, path: PathBuf) {
        let work = move || match saved::open(&path) {
            Err(_) if !path.exists() => {
                let [name, folder] = [path.file_name(), path.parent().map(Path::as_os_str)]
                    .map(|part| part.unwrap_or_default().display().to_string());
                Err(format!("there is no file {name} in {folder}"))
            }
            Ok(opened) => Ok(Ok(opened)),
            Err(OpenError::Picture(_)) if is_named_picture(&path) => Ok(Err(path)),
            Err(OpenError::Picture(_)) => {
                Err(format!("{} is not a picture, film or scene (PNG, PPM, EXR, TOML)", path.display()))
            }
            Err(error) => Err(error.to_string()),
        };
        self.opened.ask("files", context, work);
    }

    /// Reads the film of `job`, which is the job of `document`.
    pub fn resume(&mut self, context: &Context, path: PathBuf, job: RenderJob, document: &Document) {
        let begun = document.clone();
        let work = move || match saved::resume(&path, &job) {
            Ok(film) => Ok(Resumed { path, begun, film }),
            Err(error) => Err(error.to_string()),
        };
        self.resumed.ask("files", context, work);
    }
}

fn write(
    film: &Film,
    denoised: Option<&Denoised>,
    document: &Document,
    describe: impl FnOnce(&Film) -> Description,
    (format, path): (OutputFormat, PathBuf),
) -> Result<PathBuf, String> {
    if film.sample_count() == 0 {
        return Err("nothing has been traced yet; try again in a moment".to_owned());
    }
    // A film is saved as it is.
    let denoised = denoised.filter(|_| format != OutputFormat::Exr);
    let film = denoised.map_or(film, |denoised| &denoised.film);
    let mut description = describe(film);
    if let Some(denoised) = denoised {
        description.set(key::DENOISED, denoised.error.words());
    }
    let written = write_image(&path, film, document.rules().transfer, &description);
    written.map(|()| path).map_err(|error| error.to_string())
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
