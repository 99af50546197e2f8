//! The films and the picture of a render: locked and checked before it begins, and written at its end.

use super::{BatchOptions, Output};
use crate::denoise::{self, Denoised, DenoisedError};
use crate::film::{Description, Film, LockedFilm, SampleRanges, key};
use crate::job::output::{OutputFormat, write_image_as};
use crate::job::recipe::file;
use crate::job::render::panic_text;
use crate::job::saved::{Replaced, SavedFilm, rescue};
use crate::progressive::Status;
use crate::progressive::describe::describe;
use crate::system::failure::Failure;
use crate::system::files::ShownPath;
use anyhow::anyhow;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

/// The files of a render. No other run may write its films.
pub(super) struct Files {
    pub options: BatchOptions,
    /// The film of each output, if it has one.
    films: Vec<Option<Mutex<LockedFilm>>>,
    /// Samples per pixel of the film that the render continues.
    pub held_before: u64,
    /// Tracing time of these samples, if known.
    seconds_before: Option<f64>,
}

/// Which files were written, and why others were not.
#[derive(Debug, Default)]
pub(super) struct Written {
    pub files: Vec<PathBuf>,
    /// Notes on the files, for the user.
    pub notes: Vec<String>,
    pub failures: Vec<String>,
    /// The error of the denoised picture.
    pub denoised: Option<DenoisedError>,
}

impl Files {
    /// Locks the films of a render, and the file of a frame. A film to be resumed must be read after this.
    ///
    /// # Errors
    /// [`Failure::Input`] if another run writes one of them for as long as `patience`.
    pub fn lock(options: BatchOptions, patience: Duration) -> Result<Files, Failure> {
        let lock = |output: &Output| {
            let is_locked = output.format == OutputFormat::Exr || options.frame.is_some();
            is_locked.then(|| LockedFilm::new(&output.path, patience).map(Mutex::new)).transpose()
        };
        let films = options.outputs.iter().map(lock).collect::<Result<_, _>>().map_err(Failure::input)?;
        Ok(Files { options, films, held_before: 0, seconds_before: Some(0.0) })
    }

    /// Checks the films that a render would replace. Returns warnings for the user.
    ///
    /// # Errors
    /// [`Failure::Input`] if the checkpoint is a file that the render does not continue.
    pub fn check(&mut self, resumed: Option<&SavedFilm>) -> Result<Vec<String>, Failure> {
        let Files { options, films, held_before, seconds_before } = self;
        if let Some(saved) = resumed {
            (*held_before, *seconds_before) = (saved.film.sample_count(), saved.seconds);
        }
        let resumed = resumed.map(|saved| &saved.film);
        let mut warnings = Vec::new();
        for (Output { path, is_checkpoint, .. }, file) in options.outputs.iter().zip(films) {
            let Some(file) = file else { continue };
            let file = file.get_mut().unwrap_or_else(PoisonError::into_inner);
            let found = Replaced::at(path, &file::to_picture_toml(&options.recipe));
            let Some(found) = found else { continue };
            let is_same = |other: &PathBuf| same_file::is_same_file(other, path).unwrap_or(false);
            if *is_checkpoint && !options.resume.as_ref().is_some_and(is_same) {
                return Err(Failure::Input(anyhow!(found.refusal(path))));
            }
            let is_kept = |samples: &SampleRanges| {
                let planned = options.plan.range();
                samples.iter().all(|range| planned.start <= range.start && range.end <= planned.end)
                    || resumed.is_some_and(|film| film.samples().contains(samples))
            };
            warnings.extend(found.warning(path, is_kept));
            // A render that stops early must not replace it either.
            found.samples.iter().filter(|samples| is_kept(samples)).for_each(|samples| file.holds(samples));
        }
        Ok(warnings)
    }

    /// Writes the checkpoint. Returns a note for the user if the file already holds more.
    pub fn save_checkpoint(&self, film: &Film, status: &Status) -> Result<Option<String>, String> {
        let mut outputs = self.options.outputs.iter().zip(&self.films);
        let Some(checkpoint) = outputs.find(|(output, _)| output.is_checkpoint) else { return Ok(None) };
        let description = self.described(film, &status.of_film(film, self.held_before));
        let note = self.save(checkpoint, (film, None), &description)?;
        log::info!("checkpoint: {} samples per pixel", film.sample_count());
        Ok(note)
    }

    /// Writes a film with its denoised picture, or either as a picture. Returns a note for the user.
    fn save(
        &self,
        (Output { path, format, .. }, file): (&Output, &Option<Mutex<LockedFilm>>),
        (film, denoised): (&Film, Option<&Film>),
        description: &Description,
    ) -> Result<Option<String>, String> {
        let write = || {
            if let Some(file) = file.as_ref().filter(|_| *format == OutputFormat::Exr) {
                let mut file = file.lock().unwrap_or_else(PoisonError::into_inner);
                return file.save(film, denoised, description).map_err(|error| error.to_string());
            }
            let transfer = self.options.job.rules().transfer;
            let wrote = write_image_as(path, *format, (film, denoised), transfer, description);
            wrote.map(|()| None).map_err(|error| error.to_string())
        };
        // A panic counts as a failure, because the samples can still be written elsewhere or later.
        catch_unwind(AssertUnwindSafe(write)).unwrap_or_else(|payload| {
            let reason = panic_text(payload.as_ref());
            Err(format!("cannot write {}: the program failed ({reason})", path.shown()))
        })
    }

    /// Writes the outputs, calling `say` before each. A failed write does not stop the others. If no film could be
    /// written, it is saved elsewhere, since its samples may have taken hours. If the film cannot be denoised as
    /// requested, the picture is that of the film, and a note says so.
    pub fn write(&self, film: &Film, status: &Status, mut say: impl FnMut(&Path)) -> Written {
        let (options, mut written) = (&self.options, Written::default());
        let denoised = denoised(film, options.denoise, |reason| written.notes.push(reason));
        written.denoised = denoised.as_ref().map(|denoised| denoised.error);
        let description = self.described(film, status);
        let mut of_picture = description.clone();
        if let Some(error) = &written.denoised {
            of_picture.set(key::DENOISED, error.words());
        }
        let mut is_film_kept = false;
        for (output, file) in options.outputs.iter().zip(&self.films) {
            say(&output.path);
            let picture = denoised.as_ref().map(|denoised| &denoised.film).filter(|_| !output.is_checkpoint);
            let description = if output.is_checkpoint { &description } else { &of_picture };
            let saved = self.save((output, file), (film, picture), description);
            is_film_kept |= saved.is_ok() && output.format == OutputFormat::Exr;
            match saved {
                Ok(None) => written.files.push(output.path.clone()),
                // The file holds more, and is left unchanged.
                Ok(Some(note)) => written.notes.push(note),
                Err(reason) => written.failures.push(reason),
            }
        }
        if !written.failures.is_empty() && !is_film_kept && options.frame.is_none() {
            let directory = |output: &Output| Some(Path::new(".").join(output.path.parent()?));
            let directories: Vec<PathBuf> = options.outputs.iter().filter_map(directory).collect();
            match rescue(&directories, film, &description) {
                Ok(path) => {
                    let rescued = path.shown();
                    written.failures.push(format!(
                        "the samples were saved in {rescued}; continue with --resume {rescued}"
                    ));
                    written.files.push(path);
                }
                Err(lost) => written.failures.push(lost),
            }
        }
        written
    }

    fn described(&self, film: &Film, status: &Status) -> Description {
        let Files { options, seconds_before, .. } = self;
        let mut description = describe(&options.recipe, options.stage, film, status, *seconds_before);
        if !options.command.is_empty() {
            description.set(key::COMMAND, &options.command);
        }
        if let Some(frame) = options.frame {
            description.set(key::FRAME, frame);
            description.set(key::UNTIL, options.until());
        }
        description
    }
}

/// The denoised film, if it is wanted. If it cannot be had, `say` gets the reason.
pub(super) fn denoised(film: &Film, is_wanted: bool, say: impl FnOnce(String)) -> Option<Denoised> {
    let denoised = is_wanted.then(|| denoise::of_film(film))?;
    denoised.map_err(|reason| say(format!("the picture is not denoised: {reason}"))).ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::batch::tests::options;
    use crate::film::checkpoint;
    use std::ops::Range;

    /// Writes a film of `render` with these samples to `path`.
    fn put(path: &Path, render: &BatchOptions, samples: Range<u64>) -> Film {
        let mut film = render.job.new_film();
        film.record(samples, 0).unwrap();
        let description =
            Files::lock(render.clone(), Duration::ZERO).unwrap().described(&film, &Status::default());
        checkpoint::save(path, &film, &description).unwrap();
        film
    }

    fn write_two_samples(render: &BatchOptions) -> (Film, Written, String) {
        let mut film = render.job.new_film();
        film.record(0..2, 0).unwrap();
        let written =
            Files::lock(render.clone(), Duration::ZERO).unwrap().write(&film, &Status::default(), |_| {});
        let failures = written.failures.join("; ");
        (film, written, failures)
    }

    #[test]
    fn no_film_is_rescued_if_one_is_written() {
        let directory = tempfile::tempdir().unwrap();
        let at = |name: &str| directory.path().join(name).to_str().unwrap().to_owned();
        std::fs::create_dir(at("picture.png")).unwrap();
        let flags = ["--out", &at("picture.png"), "--checkpoint", &at("film.exr")];
        let (_, written, failures) = write_two_samples(&options(&flags));
        assert_eq!(written.files, [PathBuf::from(at("film.exr"))]);
        assert!(failures.contains("picture.png") && !failures.contains("--resume"), "{failures}");
    }

    #[test]
    fn continued_film_is_never_replaced_by_a_shorter_one() {
        let directory = tempfile::tempdir().unwrap();
        let [out, film] =
            ["a.png", "film.exr"].map(|name| directory.path().join(name).to_str().unwrap().to_owned());
        let path = Path::new(&film);
        let held = put(path, &options(&[]), 0..32);
        for flags in
            [&["--checkpoint", &film, "--continue", "--out", &out][..], &["--out", &film, "--samples", "64"]]
        {
            let render = options(flags);
            let held = SavedFilm { film: held.clone(), seconds: None };
            let mut files = Files::lock(render.clone(), Duration::ZERO).unwrap();
            assert!(files.check(render.resume.is_some().then_some(&held)).unwrap().is_empty());
            for (end, expected) in [(8, 32), (40, 40)] {
                let mut film = render.job.new_film();
                film.record(0..end, 0).unwrap();
                let written = files.write(&film, &Status::default(), |_| {});
                assert!(
                    written.failures.is_empty() && written.notes.is_empty() == (end == 40),
                    "{written:?}"
                );
                assert_eq!(checkpoint::load(path).unwrap().film.sample_count(), expected);
            }
            drop(files);
            put(path, &options(&[]), 0..32);
        }
    }

    #[test]
    fn loss_of_samples_causes_a_warning() {
        let directory = tempfile::tempdir().unwrap();
        let film = directory.path().join("k.exr").to_str().unwrap().to_owned();
        put(Path::new(&film), &options(&[]), 0..32);
        let check = |flags: &[&str]| Files::lock(options(flags), Duration::ZERO).unwrap().check(None);
        let warned = |flags: &[&str]| check(flags).unwrap().join("; ");
        assert_eq!(warned(&["--out", &film, "--samples", "32"]), "");
        assert!(warned(&["--out", &film, "--samples", "8"]).contains("32 samples"));
        assert!(warned(&["--out", &film, "--sample-range", "1..64"]).contains("--out"));
        let other = warned(&["--out", &film, "--seed", "3"]);
        assert!(other.contains("of another picture") && other.contains("seed"), "{other}");
        let foreign = directory.path().join("foreign.exr").to_str().unwrap().to_owned();
        std::fs::write(&foreign, "a picture").unwrap();
        assert!(warned(&["--out", &foreign]).contains("is not an EXR file"));
        let refused = check(&["--checkpoint", &film, "--samples", "64"]).unwrap_err().to_string();
        assert!(refused.contains("--continue"), "{refused}");
    }
}
