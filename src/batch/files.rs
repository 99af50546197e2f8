//! Writes the picture and the film with their descriptions.

use crate::cli::RenderOptions;
use crate::describe::describe;
use crate::files::{FileIdentity, LockedError, ShownPath};
use crate::film::{Description, Film, LockedFilm, key};
use crate::output::{Forms, OutputFormat, write_image_as};
use crate::progressive::Status;
use crate::render::panic_text;
use crate::saved::rescue;
use anyhow::anyhow;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// The film files of a render. They are locked from the start, so that no other run writes them.
pub(super) struct Places {
    /// The film of `--checkpoint`.
    pub checkpoint: Option<SharedPlace>,
    out: Out,
}

/// What `--out` is.
enum Out {
    /// A film of its own.
    Film(SharedPlace),
    /// The film of `--checkpoint`.
    Checkpoint,
    Picture,
}

/// A film file that the threads of the render share.
#[derive(Clone)]
pub(super) struct SharedPlace(Arc<Mutex<LockedFilm>>);

impl SharedPlace {
    fn new(path: &Path) -> Result<Self, LockedError> {
        Ok(SharedPlace(Arc::new(Mutex::new(LockedFilm::new(path)?))))
    }

    /// Locks the place. Its state is valid after every statement, so a panic of another user does not matter.
    pub fn lock(&self) -> MutexGuard<'_, LockedFilm> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Places {
    /// Locks the places. The film to be resumed must be read after this.
    ///
    /// # Errors
    /// [`LockedError`] if another run is writing one of them.
    pub fn of(render: &RenderOptions) -> Result<Places, LockedError> {
        let out = match &render.checkpoint {
            Some(checkpoint) if *checkpoint == render.out => Out::Checkpoint,
            _ if is_film(&render.out) => Out::Film(SharedPlace::new(&render.out)?),
            _ => Out::Picture,
        };
        Ok(Places { checkpoint: render.checkpoint.as_deref().map(SharedPlace::new).transpose()?, out })
    }

    /// Both films, each with its flag and its path.
    pub fn films<'a>(
        &'a self,
        render: &'a RenderOptions,
    ) -> impl Iterator<Item = (&'static str, &'a Path, &'a SharedPlace)> {
        let out = match &self.out {
            Out::Film(place) => Some(("--out", render.out.as_path(), place)),
            Out::Checkpoint | Out::Picture => None,
        };
        let checkpoint = render.checkpoint.as_deref().zip(self.checkpoint.as_ref());
        checkpoint.map(|(path, place)| ("--checkpoint", path, place)).into_iter().chain(out)
    }

    /// Records that the render resumes `film`, if the film was read from one of the places.
    pub fn go_on(&self, render: &RenderOptions, film: &Film) {
        let resumed = render.resume.as_deref().and_then(FileIdentity::of);
        for (_, path, place) in self.films(render) {
            if let (Some(resumed), Some(identity)) = (&resumed, FileIdentity::of(path))
                && identity.is_same_as(resumed)
            {
                place.lock().holds(film.samples());
            }
        }
    }
}

/// The files that were written, and why others were not.
#[derive(Debug, Default)]
pub(super) struct Written {
    pub files: Vec<PathBuf>,
    /// Notes on the files, for the user.
    pub notes: Vec<String>,
    pub failure: Option<anyhow::Error>,
}

/// Writes the film and the picture, calling `say` before each. If one cannot be written, the other still is. If no
/// film could be written, it is saved in some other place, since its samples may have taken hours. `seconds_before`
/// is the tracing time of the film's earlier samples, if known.
pub(super) fn write(
    render: &RenderOptions,
    places: &Places,
    film: &Film,
    status: &Status,
    seconds_before: Option<f64>,
    mut say: impl FnMut(&Path),
) -> Written {
    let description = described(render, film, status, seconds_before);
    let mut written = Written::default();
    let mut failures = Vec::new();
    let mut is_film_kept = false;
    for (_, path, place) in places.films(render) {
        let saved = caught(path, || {
            say(path);
            place.lock().save(film, &description).map_err(|error| error.to_string())
        });
        match saved {
            Ok(note) => {
                is_film_kept = true;
                written.files.push(path.to_owned());
                written.notes.extend(note);
            }
            Err(reason) => failures.push(reason),
        }
    }
    if matches!(places.out, Out::Picture) {
        let saved = caught(&render.out, || {
            say(&render.out);
            let transfer = render.job.rules().transfer;
            let forms = Forms { ppm: render.ppm, ..Forms::default() };
            write_image_as(&render.out, film, transfer, &description, forms)
                .map_err(|error| error.to_string())
        });
        match saved {
            Ok(()) => written.files.push(render.out.clone()),
            Err(reason) => failures.push(reason),
        }
    }
    if !failures.is_empty() && !is_film_kept {
        match rescue(&beside(render), &render.recipe.name, film, &description) {
            Ok(path) => {
                failures.push(format!(
                    "the samples were saved in {}; {}",
                    path.shown(),
                    go_on(render, &path)
                ));
                written.files.push(path);
            }
            Err(lost) => failures.push(lost),
        }
    }
    written.failure = (!failures.is_empty()).then(|| anyhow!("{}", failures.join("; ")));
    written
}

/// Does `write`, which writes `path`. A panic there is a reason like others, because the samples can still be written to
/// another place or later.
pub(super) fn caught<T>(path: &Path, write: impl FnOnce() -> Result<T, String>) -> Result<T, String> {
    catch_unwind(AssertUnwindSafe(write)).unwrap_or_else(|payload| {
        let reason = panic_text(payload.as_ref());
        Err(format!("cannot write {}: the program failed ({reason})", path.shown()))
    })
}

/// How to go on with a film that was saved in `rescued`.
fn go_on(render: &RenderOptions, rescued: &Path) -> String {
    match render.is_part {
        true => format!(
            "once {} can be written, move the film there and run the same command again",
            render.out.shown()
        ),
        false => format!("continue with --resume {}", rescued.shown()),
    }
}

/// The description of a render's film.
pub(super) fn described(
    render: &RenderOptions,
    film: &Film,
    status: &Status,
    seconds_before: Option<f64>,
) -> Description {
    let mut description = describe(&render.recipe, render.stage, film, status, seconds_before);
    description.set(key::COMMAND, &render.command);
    description
}

/// The directories of the files that the render writes.
fn beside(render: &RenderOptions) -> Vec<PathBuf> {
    let files = [Some(&render.out), render.checkpoint.as_ref()];
    let directory = |path: &PathBuf| match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent.to_owned(),
        _ => PathBuf::from("."),
    };
    files.into_iter().flatten().map(directory).collect()
}

/// Whether the name is that of a film.
pub(super) fn is_film(path: &Path) -> bool {
    OutputFormat::from_path(path).is_ok_and(|format| format == OutputFormat::Exr)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::batch::tests::options;
    use crate::film::checkpoint;

    fn write_two_samples(render: &RenderOptions) -> (Film, Written) {
        write_two_samples_and_say(render, |_| {})
    }

    fn write_two_samples_and_say(render: &RenderOptions, say: impl FnMut(&Path)) -> (Film, Written) {
        let mut film = render.job.new_film();
        film.record(0..2, 0).unwrap();
        let written = write(render, &Places::of(render).unwrap(), &film, &Status::default(), None, say);
        (film, written)
    }

    #[test]
    fn a_panic_in_writing_a_file_does_not_lose_the_film() {
        let directory = tempfile::tempdir().unwrap();
        let [out, film] = ["picture.png", "film.exr"].map(|name| directory.path().join(name));
        let render = options(&["--out", out.to_str().unwrap(), "--checkpoint", film.to_str().unwrap()]);
        let (film, written) = write_two_samples_and_say(&render, |_| panic!("injected fault"));
        let [rescued] = written.files.as_slice() else { panic!("{written:?}") };
        assert_eq!(rescued.parent(), Some(directory.path()));
        assert!(checkpoint::load(rescued).unwrap().film == film);
        let told = written.failure.unwrap().to_string();
        for part in ["film.exr", "picture.png", "injected fault", "--resume"] {
            assert!(told.contains(part), "{told} should say {part}");
        }
    }

    #[test]
    fn a_film_that_cannot_be_written_is_rescued_and_all_failures_are_told() {
        let directory = tempfile::tempdir().unwrap();
        let [out, film] = ["gone/picture.png", "missing/film.exr"].map(|name| directory.path().join(name));
        let render = options(&["--out", out.to_str().unwrap(), "--checkpoint", film.to_str().unwrap()]);
        let (film, written) = write_two_samples(&render);
        let told = written.failure.unwrap().to_string();
        let [path] = written.files.as_slice() else { panic!("{told}") };
        let rescued = format!("in {}", path.display());
        for part in ["gone", "missing", "--resume", &rescued] {
            assert!(told.contains(part), "{told} should say {part}");
        }
        let read = checkpoint::load(path);
        std::fs::remove_file(path).unwrap();
        assert!(read.unwrap().film == film);
    }

    #[test]
    fn the_rescue_is_beside_the_output_if_there_is_room() {
        let directory = tempfile::tempdir().unwrap();
        let out = directory.path().join("picture.png");
        let render = options(&["--out", out.to_str().unwrap()]);
        std::fs::create_dir(&out).unwrap();
        let (film, written) = write_two_samples(&render);
        let [path] = written.files.as_slice() else { panic!("{written:?}") };
        assert_eq!(path.parent(), Some(directory.path()));
        assert!(checkpoint::load(path).unwrap().film == film);
    }

    #[test]
    fn a_rescued_film_of_a_part_is_to_go_to_the_part_s_file() {
        let directory = tempfile::tempdir().unwrap();
        let film = directory.path().join("missing/part-0.exr");
        let name = film.to_str().unwrap();
        let render = options(&["--out", name]);
        let render = RenderOptions { checkpoint: Some(film.clone()), is_part: true, ..render };
        let (_, written) = write_two_samples(&render);
        let [rescued] = written.files.as_slice() else { panic!("{written:?}") };
        std::fs::remove_file(rescued).unwrap();
        let told = written.failure.unwrap().to_string();
        let words = format!("once {name} can be written, move the film there and run the same command again");
        assert!(told.contains(&words), "{told}");
        assert!(!told.contains("--resume"), "{told}");
    }

    #[test]
    fn a_film_that_is_written_needs_no_rescue() {
        let directory = tempfile::tempdir().unwrap();
        let [out, film] = ["gone/picture.png", "film.exr"].map(|name| directory.path().join(name));
        let render = options(&["--out", out.to_str().unwrap(), "--checkpoint", film.to_str().unwrap()]);
        let (_, written) = write_two_samples(&render);
        assert_eq!(written.files, [film]);
        let told = written.failure.unwrap().to_string();
        assert!(told.contains("gone") && !told.contains("--resume"), "{told}");
    }

    #[test]
    fn a_picture_that_is_written_does_not_save_the_film() {
        let directory = tempfile::tempdir().unwrap();
        let [out, film] = ["picture.png", "missing/film.exr"].map(|name| directory.path().join(name));
        let render = options(&["--out", out.to_str().unwrap(), "--checkpoint", film.to_str().unwrap()]);
        let (film, written) = write_two_samples(&render);
        let [picture, rescued] = written.files.as_slice() else { panic!("{written:?}") };
        assert_eq!((picture, rescued.parent()), (&out, Some(directory.path())));
        assert!(checkpoint::load(rescued).unwrap().film == film);
    }

    #[test]
    fn a_film_that_another_run_writes_is_locked() {
        let directory = tempfile::tempdir().unwrap();
        let at = |name: &str| directory.path().join(name).to_str().unwrap().to_owned();
        let run = |flags: &[&str]| Places::of(&options(flags));
        let first = run(&["--checkpoint", &at("g.exr"), "--out", &at("a.png")]).unwrap();
        for flags in
            [["--checkpoint", &at("g.exr"), "--out", &at("b.png")].as_slice(), &["--out", &at("g.exr")]]
        {
            let told = run(flags).err().unwrap().to_string();
            assert!(told.contains("g.exr is locked: another run is writing it"), "{told}");
        }
        drop(first);
        assert!(run(&["--out", &at("g.exr")]).is_ok());
    }

    #[test]
    fn a_film_that_the_render_goes_on_with_is_not_replaced_by_a_shorter_one() {
        for (goes_on, held) in [(true, 4), (false, 2)] {
            let directory = tempfile::tempdir().unwrap();
            let [out, path] = ["picture.png", "film.exr"].map(|name| directory.path().join(name));
            let names = [&path, &out].map(|path| path.to_str().unwrap());
            let first = options(&["--out", names[0]]);
            let mut film = first.job.new_film();
            film.record(0..4, 0).unwrap();
            let description = described(&first, &film, &Status::default(), None);
            checkpoint::save(&path, &film, &description).unwrap();
            let render = options(&["--checkpoint", names[0], "--continue", "--out", names[1]]);
            let places = Places::of(&render).unwrap();
            if goes_on {
                places.go_on(&render, &film);
            }
            // A render that lost its film and began anew.
            let mut shorter = render.job.new_film();
            shorter.record(0..2, 0).unwrap();
            let written = write(&render, &places, &shorter, &Status::default(), None, |_| {});
            assert!(written.failure.is_none(), "{written:?}");
            assert_eq!(checkpoint::load(&path).unwrap().film.sample_count(), held);
        }
    }

    #[test]
    fn rescued_films_go_to_the_directories_of_the_files() {
        let render = options(&["--out", "a.png", "--checkpoint", "d/k.exr"]);
        assert_eq!(beside(&render), [".", "d"].map(PathBuf::from));
    }
}
