//! Saves and opens files without blocking the window's thread: the render thread, which has the film, writes; a
//! separate thread reads.

use super::answers::Answers;
use super::kept::Subject;
use super::model::document::Document;
use super::scene_file::SceneFile;
use crate::film::{Film, key};
use crate::job::output::{Description, OutputFormat, write_image, write_part};
use crate::job::recipe::file;
use crate::job::render::RenderJob;
use crate::job::saved::{self, OpenError, Opened, SavedFilm};
use crate::progressive::describe::describe;
use crate::progressive::{FilmIdentity, ReferenceMeans};
use crate::system::files::replace_file;
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
    pub scene_file: SceneFile,
    /// The film of the command line, to go on with.
    pub pending_resume: Option<(PathBuf, RenderJob)>,
    /// To be saved once there are samples.
    pub pending_save: Option<(OutputFormat, PathBuf)>,
    /// To be copied once there are samples.
    pub pending_copy: bool,
    /// Files that were written.
    pub saved: Answers<Result<PathBuf, String>>,
    /// Files that were opened.
    pub opened: Answers<Result<Opened, NotOpened>>,
    /// Films to resume.
    pub resumed: Answers<Result<Resumed, String>>,
    /// Pictures for the clipboard, and what they are, in words.
    pub copied: Answers<(ColorImage, String)>,
    /// Films to compare with.
    pub references: Answers<Result<(PathBuf, ReferenceMeans), String>>,
}

impl Files {
    /// Whether the film is needed at the size that it has.
    pub fn needs_film(&self) -> bool {
        self.pending_save.is_some() || self.pending_copy
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
    pub fn save(&self, context: &Context, subject: &Subject<'_>, (format, path): (OutputFormat, PathBuf)) {
        let (transfer, describe) = (subject.document().rules().transfer, describer(subject));
        let answer = self.saved.answer_or(context, Err);
        subject.inspect(move |film| {
            answer.give(if film.sample_count() == 0 {
                Err("nothing has been traced yet; try again in a moment".to_owned())
            } else if OutputFormat::from_path(&path).is_ok_and(|of_name| of_name == format) {
                write_image(&path, film, transfer, &describe(film))
                    .map(|()| path)
                    .map_err(|error| error.to_string())
            } else {
                Err(format!("{} does not end in {}", path.display(), format.ending()))
            });
        });
    }

    /// Resolves the film on the screen, or a part of it, as it is saved with 8 bits, at the next end of a pass.
    pub fn copy(&self, context: &Context, subject: &Subject<'_>) {
        let transfer = subject.document().rules().transfer;
        let answer = self.copied.answer(context);
        subject.inspect(move |film| {
            let size = [film.width(), film.height()];
            let picture = ColorImage::from_rgb(size.map(|pixels| pixels as usize), &film.to_rgb8(transfer));
            answer.give((picture, format!("picture, {} × {}", size[0], size[1])));
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
        let substitute = |reason: String| Err(format!("the scene cannot be written: {reason}"));
        self.saved.ask("files", context, work, substitute);
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
        let substitute = move |reason: String| {
            let reason = format!("{} cannot be read: {reason}", opened.display());
            Err(NotOpened { path: opened, reason, is_picture: false })
        };
        self.opened.ask("files", context, work, substitute);
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

/// What makes the description of the film on the screen.
fn describer(subject: &Subject<'_>) -> impl FnOnce(&Film) -> Description + Send + 'static {
    let document = subject.document();
    let mut recipe = document.recipe();
    let stage = document.stage().filter(|_| !document.has_changed_scene());
    let (status, seconds_before) = (subject.status().clone(), subject.seconds_before());
    move |film| {
        recipe.samples_per_pixel = film.sample_count().max(1);
        describe(&recipe, stage, film, &status, seconds_before)
    }
}

/// Runs a read on its own thread.
fn read<T: Send + 'static>(
    answers: &Answers<Result<T, String>>,
    context: &Context,
    work: impl FnOnce() -> Result<T, OpenError> + Send + 'static,
) {
    let work = move || work().map_err(|error| error.to_string());
    answers.ask("files", context, work, |reason| Err(format!("the file cannot be read: {reason}")));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::kept::on_screen::{OnScreen, small_film};

    #[test]
    fn a_text_is_written_or_it_is_said_why_not() {
        let directory = tempfile::tempdir().unwrap();
        let (files, context) = (Files::default(), Context::default());
        let path = directory.path().join("plot.csv");
        files.save_text(&context, &path, "1,2\n");
        assert_eq!(files.saved.take(), Some(Ok(path.clone())));
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "1,2\n");
        files.save_text(&context, &path.join("plot.csv"), "1,2\n");
        assert!(matches!(files.saved.take(), Some(Err(_))), "a file is no folder");
    }

    #[test]
    fn a_film_is_saved_under_a_name_of_its_format() {
        let directory = tempfile::tempdir().unwrap();
        let (files, context) = (Files::default(), Context::default());
        let save = |format: OutputFormat, name: &str| {
            let path = directory.path().join(name);
            let screen = OnScreen::new(small_film(1, 0.5));
            screen.before_answers(|subject| files.save(&context, subject, (format, path.clone())));
            let outcome = files.saved.take().unwrap();
            assert_eq!(outcome.is_ok(), path.exists(), "{name}");
            outcome.map(|saved| assert_eq!(saved, path))
        };
        for (format, name) in
            [(OutputFormat::Png, "a.png"), (OutputFormat::P6, "a.PPM"), (OutputFormat::Exr, "a.exr")]
        {
            assert_eq!(save(format, name), Ok(()));
        }
        let refused = save(OutputFormat::Png, "b.exr").unwrap_err();
        assert!(refused.ends_with("b.exr does not end in .png"), "{refused}");
    }

    #[test]
    fn what_is_copied_or_cut_out_is_a_part_of_the_picture() {
        let directory = tempfile::tempdir().unwrap();
        let (files, context) = (Files::default(), Context::default());
        let screen = OnScreen::new(small_film(8, 2.0));
        let crop = |first| Some(Crop { first, size: [3, 2] });
        for (crop, size, words) in [
            (None, [4, 2], "picture: 4x2, 8 samples per pixel"),
            (crop([1, 0]), [3, 2], "crop: 3x2 at 1,0, 8 samples per pixel"),
            (crop([2, 1]), [2, 1], "crop: 2x1 at 2,1, 8 samples per pixel"),
            (crop([4, 0]), [4, 2], "picture: 4x2, 8 samples per pixel"),
        ] {
            screen.before_answers(|subject| files.copy(&context, subject, crop));
            let (picture, told) = files.copied.take().unwrap();
            assert_eq!((picture.size, told.as_str()), (size, words));
            // The root of a quarter.
            assert_eq!(picture.pixels.last().map(|pixel| pixel.to_array()), Some([128, 128, 128, 255]));
        }
        let path = directory.path().join("crop.png");
        let save = |first| {
            let crop = Crop { first, size: [3, 2] };
            screen.before_answers(|subject| files.save_crop(&context, subject, crop, path.clone()));
            files.saved.take().unwrap()
        };
        assert_eq!(save([4, 0]), Err("the crop, 3x2 at 4,0, is outside of the picture".to_owned()));
        assert_eq!(save([2, 0]), Ok(path.clone()));
        let read = image::open(&path).unwrap();
        assert_eq!([read.width(), read.height()], [2, 2]);
    }

    #[test]
    fn a_film_without_samples_is_not_saved() {
        let directory = tempfile::tempdir().unwrap();
        let (files, path) = (Files::default(), directory.path().join("a.png"));
        let (screen, context) = (OnScreen::new(Film::new(4, 2, 1)), Context::default());
        let named = (OutputFormat::Png, path.clone());
        screen.before_answers(|subject| files.save(&context, subject, named));
        let reason = "nothing has been traced yet; try again in a moment";
        assert_eq!(files.saved.take(), Some(Err(reason.to_owned())));
        assert!(!path.exists());
    }

    #[test]
    fn a_file_that_is_not_opened_may_be_a_picture_to_check() {
        let directory = tempfile::tempdir().unwrap();
        let (files, context) = (Files::default(), Context::default());
        let white = image::RgbImage::from_pixel(4, 2, image::Rgb([255; 3]));
        white.save(directory.path().join("a.png")).unwrap();
        std::fs::write(directory.path().join("a.toml"), "[camera").unwrap();
        for (name, is_picture) in [("a.png", true), ("a.toml", false), ("none.toml", false)] {
            let path = directory.path().join(name);
            files.open(&context, path.clone());
            let Some(Err(found)) = files.opened.wait() else { panic!("{name} was opened") };
            assert_eq!((found.path, found.is_picture), (path, is_picture), "{name}");
            assert!(found.reason.contains(name), "{}", found.reason);
        }
    }
}
