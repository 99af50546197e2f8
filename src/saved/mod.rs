//! Saved files, read: a scene file, a picture that says how it was made, or a film with its samples. Whatever opens
//! or resumes one does so here.

mod difference;

pub use difference::{difference, same_job};

use crate::film::{CheckpointError, Description, Film, checkpoint, key};
use crate::output::{OutputError, OutputFormat, read_description};
use crate::recipe::{Recipe, file};
use crate::render::{JobError, RenderJob};
use crate::stages::Stage;
use std::path::{Path, PathBuf};

/// A file that cannot be opened or resumed. The message names the file and what to do.
#[derive(Debug, thiserror::Error)]
pub enum OpenError {
    /// A scene file that cannot be read.
    #[error(transparent)]
    Scene(#[from] file::FileError),
    /// A film that is damaged, of another version, or cannot be read.
    #[error(transparent)]
    Film(CheckpointError),
    /// A file that is named like a film but is none, and does not say how it was made.
    #[error(transparent)]
    NotFilm(CheckpointError),
    /// A picture that cannot be read or does not say how it was made.
    #[error(transparent)]
    Picture(OutputError),
    /// What it says that it was made from cannot be understood.
    #[error("the recipe in {} cannot be read: {reason}", path.display())]
    Recipe {
        /// The file.
        path: PathBuf,
        /// What is wrong with the recipe.
        reason: Box<file::FileError>,
    },
    /// What it says that it was made from is no picture.
    #[error("the recipe in {} cannot be rendered: {reason}", path.display())]
    Job {
        /// The file.
        path: PathBuf,
        /// What is wrong with the recipe.
        reason: Box<JobError>,
    },
    /// The film does not belong to its recipe.
    #[error("{} holds a film of another shape than its recipe says; render it again", path.display())]
    Shape {
        /// The file.
        path: PathBuf,
    },
    /// The film of a picture other than the one that is to go on.
    #[error(
        "{} is a film of another picture: {difference}; leave out the flags that differ, or render without --resume",
        path.display()
    )]
    OtherPicture {
        /// The file.
        path: PathBuf,
        /// The first thing in which the two differ.
        difference: String,
    },
}

/// What a picture or a film says about itself, and the film.
#[derive(Debug)]
pub struct Saved {
    /// The file.
    pub path: PathBuf,
    /// What it says about itself.
    pub description: Description,
    /// The film, if the file has one and it was read.
    pub film: Option<Film>,
}

impl Saved {
    /// Reads a picture or film. What the file is shows in its first bytes.
    ///
    /// # Errors
    /// [`OpenError::Film`], [`OpenError::NotFilm`] or [`OpenError::Picture`].
    pub fn read(path: &Path) -> Result<Self, OpenError> {
        match checkpoint::load(path) {
            Ok(read) => {
                Ok(Saved { path: path.to_owned(), description: read.description, film: Some(read.film) })
            }
            Err(error @ (CheckpointError::NotExr { .. } | CheckpointError::NotFilm { .. })) => {
                let is_named_film = OutputFormat::from_path(path).is_ok_and(|of| of == OutputFormat::Exr);
                match Self::describe(path) {
                    // Whoever named it so takes it for a film.
                    Err(OpenError::Picture(OutputError::NoDescription { .. })) if is_named_film => {
                        Err(OpenError::NotFilm(error))
                    }
                    outcome => outcome,
                }
            }
            Err(error) => Err(OpenError::Film(error)),
        }
    }

    /// Reads what a picture or film says about itself and leaves its samples alone, which is quick.
    ///
    /// # Errors
    /// [`OpenError::Picture`].
    pub fn describe(path: &Path) -> Result<Self, OpenError> {
        let description = read_description(path).map_err(OpenError::Picture)?;
        Ok(Saved { path: path.to_owned(), description, film: None })
    }

    /// The recipe. It has the name that the file says, otherwise the file's own without its ending.
    ///
    /// # Errors
    /// [`OpenError::Recipe`].
    pub fn recipe(&self) -> Result<Recipe, OpenError> {
        let label = self.path.display().to_string();
        let recipe = file::parse(self.description.recipe(), &label)
            .map_err(|reason| OpenError::Recipe { path: self.path.clone(), reason: Box::new(reason) })?;
        let stem = self.path.file_stem().map(|stem| stem.to_string_lossy().into_owned());
        let name = self.description.get(key::SCENE).map(str::to_owned).or(stem).unwrap_or(label);
        Ok(Recipe { name, ..recipe })
    }

    /// The stage that it says it shows.
    pub fn stage(&self) -> Option<&'static Stage> {
        self.description.get(key::STAGE).and_then(|id| Stage::find(id).ok())
    }

    /// Samples per pixel, if it says so.
    pub fn samples(&self) -> Option<u64> {
        self.description.get(key::SAMPLES)?.parse().ok().filter(|samples| *samples > 0)
    }

    /// Seconds of tracing, if it says so.
    pub fn seconds(&self) -> Option<f64> {
        self.description.get(key::SECONDS)?.parse().ok()
    }

    /// What rendered it, if it says so.
    pub fn backend(&self) -> Option<&str> {
        self.description.get(key::BACKEND)
    }

    /// The film with what it says of its tracing; `None` for a picture.
    fn into_film(self) -> Option<SavedFilm> {
        let (seconds, backend) = (self.seconds(), self.backend().map(str::to_owned));
        self.film.map(|film| SavedFilm { film, seconds, backend })
    }
}

/// A film that was read.
#[derive(Debug)]
pub struct SavedFilm {
    /// Its samples.
    pub film: Film,
    /// Seconds that tracing them took, if the file says so.
    pub seconds: Option<f64>,
    /// What traced them, if the file says so.
    pub backend: Option<String>,
}

/// What is in a file besides its recipe.
#[derive(Debug)]
pub enum Content {
    /// Nothing: a scene file.
    Scene,
    /// A picture of so many samples per pixel, if it says so.
    Picture {
        /// Samples per pixel.
        samples: Option<u64>,
    },
    /// A film, which has the recipe's shape.
    Film(SavedFilm),
}

/// A file that was opened.
#[derive(Debug)]
pub struct Opened {
    /// The file.
    pub path: PathBuf,
    /// What it shows. The name is the one that the file says, otherwise the file's own without its ending.
    pub recipe: Recipe,
    /// The recipe, checked.
    pub job: RenderJob,
    /// The stage that it says it shows. The recipe may have been changed since.
    pub stage: Option<&'static Stage>,
    /// What else it holds.
    pub content: Content,
}

/// Opens a scene file (its name ends in .toml), a picture or a film.
///
/// # Errors
/// [`OpenError`]; a film must have the shape that its recipe says.
pub fn open(path: &Path) -> Result<Opened, OpenError> {
    if path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("toml")) {
        let recipe = file::load(path)?;
        let job = job_of(path, &recipe)?;
        return Ok(Opened { path: path.to_owned(), recipe, job, stage: None, content: Content::Scene });
    }
    let saved = Saved::read(path)?;
    let recipe = saved.recipe()?;
    let job = job_of(path, &recipe)?;
    let (stage, samples) = (saved.stage(), saved.samples());
    let content = saved.into_film().map_or(Content::Picture { samples }, Content::Film);
    if let Content::Film(saved) = &content
        && !job.fits(&saved.film)
    {
        return Err(OpenError::Shape { path: path.to_owned() });
    }
    Ok(Opened { path: path.to_owned(), recipe, job, stage, content })
}

/// Opens a film: the job that it is of, and the film.
///
/// # Errors
/// [`OpenError`]; a picture or scene file is refused.
pub fn open_film(path: &Path) -> Result<(RenderJob, SavedFilm), OpenError> {
    let Opened { job, content, .. } = open(path)?;
    match content {
        Content::Film(film) => Ok((job, film)),
        _ => Err(OpenError::NotFilm(CheckpointError::NotFilm { path: path.to_owned() })),
    }
}

/// Reads the film of `job` that is to go on.
///
/// # Errors
/// [`OpenError`]; [`OpenError::OtherPicture`] for the film of another job.
pub fn resume(path: &Path, job: &RenderJob) -> Result<SavedFilm, OpenError> {
    let (theirs, film) = open_film(path)?;
    check_same(path, job, &theirs)?;
    Ok(film)
}

/// Refuses a film that [`resume`] would refuse for being of another job, without reading its samples.
///
/// # Errors
/// As [`resume`].
pub fn check_resume(path: &Path, job: &RenderJob) -> Result<(), OpenError> {
    let theirs = job_of(path, &Saved::describe(path)?.recipe()?)?;
    check_same(path, job, &theirs)
}

fn job_of(path: &Path, recipe: &Recipe) -> Result<RenderJob, OpenError> {
    recipe.job().map_err(|reason| OpenError::Job { path: path.to_owned(), reason: Box::new(reason) })
}

fn check_same(path: &Path, mine: &RenderJob, theirs: &RenderJob) -> Result<(), OpenError> {
    match difference(mine, theirs) {
        Some(difference) => Err(OpenError::OtherPicture { path: path.to_owned(), difference }),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::write_image;
    use std::path::PathBuf;
    use tempfile::TempDir;

    /// A small recipe, its film of four samples, and what the film says with `entries`.
    fn film(entries: &[(&str, &str)]) -> (Recipe, Film, Description) {
        let mut recipe = Recipe::builtin("three-spheres").unwrap();
        (recipe.settings.width, recipe.settings.height) = (4, 3);
        let mut film = recipe.job().unwrap().new_film();
        film.record(0..4, 0).unwrap();
        let mut description = Description::new(&file::to_toml(&recipe));
        entries.iter().for_each(|(key, value)| description.set(key, value));
        (recipe, film, description)
    }

    fn written(directory: &TempDir, name: &str, entries: &[(&str, &str)]) -> PathBuf {
        let (recipe, film, description) = film(entries);
        let path = directory.path().join(name);
        write_image(&path, &film, recipe.rules.transfer, &description).unwrap();
        path
    }

    #[test]
    fn a_film_is_opened_with_its_samples_and_what_it_says() {
        let directory = tempfile::tempdir().unwrap();
        let said =
            [(key::SCENE, "balls"), (key::STAGE, "metal"), (key::SECONDS, "2.5"), (key::BACKEND, "cpu")];
        let path = written(&directory, "a.exr", &said);
        let opened = open(&path).unwrap();
        assert_eq!(
            (opened.recipe.name.as_str(), opened.stage.map(|stage| stage.id)),
            ("balls", Some("metal"))
        );
        let Content::Film(read) = opened.content else { panic!("no film") };
        assert_eq!(read.film, film(&[]).1);
        assert_eq!((read.seconds, read.backend.as_deref()), (Some(2.5), Some("cpu")));
        assert_eq!(opened.job, film(&[]).0.job().unwrap());
        // Its name does not matter.
        let renamed = directory.path().join("renamed.png");
        std::fs::rename(&path, &renamed).unwrap();
        assert!(matches!(open(&renamed).unwrap().content, Content::Film(_)));
    }

    #[test]
    fn what_has_no_name_is_called_as_its_file() {
        let directory = tempfile::tempdir().unwrap();
        for name in ["plain.exr", "plain.png", "plain.ppm"] {
            let path = written(&directory, name, &[]);
            assert_eq!(open(&path).unwrap().recipe.name, "plain", "{name}");
            assert_eq!(Saved::describe(&path).unwrap().recipe().unwrap().name, "plain", "{name}");
        }
        let scene = directory.path().join("mine.toml");
        std::fs::write(&scene, file::to_toml(&film(&[]).0)).unwrap();
        let opened = open(&scene).unwrap();
        assert_eq!((opened.recipe.name.as_str(), matches!(opened.content, Content::Scene)), ("mine", true));
        assert!(open_film(&scene).is_err());
    }

    #[test]
    fn a_picture_has_the_samples_that_it_says() {
        let directory = tempfile::tempdir().unwrap();
        for (said, samples) in [("7", Some(7)), ("0", None), ("-1", None), ("many", None)] {
            let path = written(&directory, "a.png", &[(key::SAMPLES, said)]);
            let Content::Picture { samples: found } = open(&path).unwrap().content else { panic!("{said}") };
            assert_eq!(found, samples);
            assert!(matches!(open_film(&path), Err(OpenError::NotFilm(_))));
        }
    }

    #[test]
    fn only_the_film_of_the_same_picture_goes_on() {
        let directory = tempfile::tempdir().unwrap();
        let path = written(&directory, "a.exr", &[]);
        let mut recipe = film(&[]).0;
        let job = recipe.job().unwrap();
        assert_eq!(resume(&path, &job).unwrap().film.sample_count(), 4);
        check_resume(&path, &job).unwrap();
        recipe.settings.seed = 5;
        let job = recipe.job().unwrap();
        for refused in [resume(&path, &job).map(|_| ()), check_resume(&path, &job)] {
            let told = refused.unwrap_err().to_string();
            assert!(told.contains("a.exr") && told.contains("seed is 5 here, 0 there"), "{told}");
        }
    }

    #[test]
    fn a_film_that_its_recipe_does_not_fit_is_refused() {
        let directory = tempfile::tempdir().unwrap();
        let (mut recipe, film, _) = film(&[]);
        let path = directory.path().join("a.exr");
        for (width, estimate_error) in [(5, true), (4, false)] {
            recipe.settings.width = width;
            recipe.settings.estimate_error = estimate_error;
            let description = Description::new(&file::to_toml(&recipe));
            write_image(&path, &film, recipe.rules.transfer, &description).unwrap();
            assert!(matches!(open(&path), Err(OpenError::Shape { .. })));
            let job = recipe.job().unwrap();
            assert!(matches!(resume(&path, &job), Err(OpenError::Shape { .. })));
        }
    }
}
