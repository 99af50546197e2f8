//! Where a picture comes from: a built-in scene, a stage, a scene file or a film; and what flags change in it.

use super::raw::{RawPicture, RawSwitch};
use crate::film::key;
use crate::memory::MemoryError;
use crate::output::{OutputError, read_description};
use crate::recipe::{Recipe, SceneNameError, file};
use crate::render::JobError;
use crate::stages::{Stage, UnknownStage};
use std::path::{Path, PathBuf};

/// Flags that cannot be carried out.
#[derive(Debug, thiserror::Error)]
pub enum CliError {
    /// No such scene.
    #[error(transparent)]
    SceneName(#[from] SceneNameError),
    /// No such stage.
    #[error(transparent)]
    StageName(#[from] UnknownStage),
    /// A scene file that cannot be read.
    #[error(transparent)]
    SceneFile(#[from] file::FileError),
    /// A value that no picture can be made with.
    #[error(transparent)]
    Job(#[from] JobError),
    /// A picture or a scene that does not fit into memory.
    #[error(transparent)]
    Memory(#[from] MemoryError),
    /// The file's name or what it says of itself.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// No such device here.
    #[error(transparent)]
    Backend(#[from] crate::backends::BackendError),
    /// A chart's name.
    #[error(transparent)]
    Chart(#[from] crate::chart::ChartError),
    /// Two flags that do not go together.
    #[error("{flag} cannot be used with {other}: {reason}")]
    Together {
        /// A flag.
        flag: &'static str,
        /// Another, with its value if that matters.
        other: &'static str,
        /// Why, and what to do.
        reason: &'static str,
    },
    /// A flag that needs another.
    #[error("{flag} needs {other}: {reason}")]
    Needs {
        /// A flag.
        flag: &'static str,
        /// What is missing.
        other: &'static str,
        /// Why, and what to do.
        reason: &'static str,
    },
    /// A pixel beside the picture.
    #[error("--pixel is {x},{y}, but the picture has {width}x{height} pixels: the last is {},{}", width - 1, height - 1)]
    Pixel {
        /// Column.
        x: u32,
        /// Row.
        y: u32,
        /// Pixels across.
        width: u32,
        /// Pixels down.
        height: u32,
    },
    /// No such backend.
    #[error("there is no backend {name:?}; choose among {choices}")]
    BackendName {
        /// What was asked for.
        name: String,
        /// What there is.
        choices: String,
    },
    /// Two outputs in one file.
    #[error("{first} and {second} are one file, {}; give them different names", both(path, other))]
    SameFile {
        /// A flag.
        first: &'static str,
        /// Another.
        second: &'static str,
        /// The first's file.
        path: PathBuf,
        /// The same file as the other names it.
        other: PathBuf,
    },
    /// An output in the place of an input.
    #[error("{output} {} would replace the file that {input} reads; give it another name", path.display())]
    Overwrites {
        /// The output's flag.
        output: &'static str,
        /// Its file.
        path: PathBuf,
        /// The input's flag.
        input: &'static str,
    },
    /// A file whose name says that it is something else.
    #[error("{flag} is {}, but the name of {what} must end in {ending}", path.display())]
    Ending {
        /// The flag.
        flag: &'static str,
        /// The file.
        path: PathBuf,
        /// What the file is.
        what: &'static str,
        /// What its name must end in, with the dot.
        ending: &'static str,
    },
    /// Two scenes of one name, which the report could not tell apart.
    #[error("--scenes has two of the name {name}; leave one out, or give its file another name")]
    SameScene {
        /// Their name.
        name: String,
    },
}

fn both(path: &Path, other: &Path) -> String {
    if path == other {
        path.display().to_string()
    } else {
        format!("{} and {}", path.display(), other.display())
    }
}

/// The scene that is rendered if none is asked for.
const DEFAULT_SCENE: &str = "three-spheres";

/// A recipe and the stage that it is from, if from one.
#[derive(Clone, Debug)]
pub(super) struct Source {
    pub recipe: Recipe,
    pub stage: Option<&'static Stage>,
}

/// The source that the flags name, before other flags change it.
pub(super) fn find(raw: &RawPicture, resume: Option<&Path>) -> Result<Source, CliError> {
    match (&raw.stage, &raw.scene, resume) {
        (Some(id), _, _) => {
            let stage = Stage::find(id)?;
            Ok(Source { recipe: stage.recipe(), stage: Some(stage) })
        }
        (None, Some(name), _) => Ok(Source { recipe: scene(name)?, stage: None }),
        (None, None, Some(film)) => of_film(film),
        (None, None, None) => Ok(Source { recipe: scene(DEFAULT_SCENE)?, stage: None }),
    }
}

/// The scene of this name or in this file.
pub(super) fn scene(name: &str) -> Result<Recipe, CliError> {
    if is_file(name) { Ok(file::load(Path::new(name))?) } else { Ok(Recipe::find(name)?) }
}

/// The example scene `near-glass`, which the program carries for reports.
pub(super) const NEAR_GLASS: &str = "near-glass";

/// A built-in scene, or [`NEAR_GLASS`].
pub(super) fn carried(name: &str) -> Result<Recipe, CliError> {
    if name != NEAR_GLASS {
        return scene(name);
    }
    let recipe = file::parse(include_str!("../../assets/scenes/near-glass.toml"), NEAR_GLASS)?;
    Ok(Recipe { name: name.to_owned(), ..recipe })
}

/// Whether `--scene` names a file: a name with an ending or a directory.
pub(super) fn is_file(scene: &str) -> bool {
    let path = Path::new(scene);
    path.extension().is_some() || path.components().count() > 1
}

/// The scene file that `--scene` names, if it names one.
pub(super) fn scene_file(scene: Option<&str>) -> Option<&Path> {
    scene.filter(|scene| is_file(scene)).map(Path::new)
}

/// Refuses a file whose name does not end in `ending`, with the dot, in capitals or not.
pub(super) fn check_ending(
    flag: &'static str,
    path: &Path,
    what: &'static str,
    ending: &'static str,
) -> Result<(), CliError> {
    let is_so = path.extension().is_some_and(|own| own.eq_ignore_ascii_case(ending.trim_start_matches('.')));
    if is_so { Ok(()) } else { Err(CliError::Ending { flag, path: path.to_owned(), what, ending }) }
}

/// Makes a picture at most `width` pixels wide, of the same shape, unless its size was asked for.
pub(super) fn narrow(recipe: &mut Recipe, raw: &RawPicture, width: u32) {
    let settings = &mut recipe.settings;
    if raw.size.is_none() && settings.width > width {
        let height = f64::from(settings.height) * f64::from(width) / f64::from(settings.width);
        (settings.width, settings.height) = (width, (height.round() as u32).max(1));
    }
}

fn of_film(path: &Path) -> Result<Source, CliError> {
    let description = read_description(path)?;
    let name = description.get(key::SCENE).unwrap_or("film");
    let mut recipe = file::parse(description.recipe(), &path.display().to_string())?;
    recipe.name = name.to_owned();
    let stage = description.get(key::STAGE).and_then(|id| Stage::find(id).ok());
    Ok(Source { recipe, stage })
}

/// Puts the flags' values in place of the recipe's.
pub(super) fn change(recipe: &mut Recipe, raw: &RawPicture, estimate_error: Option<RawSwitch>) {
    fn set<T: Copy>(value: &mut T, flag: Option<T>) {
        if let Some(flag) = flag {
            *value = flag;
        }
    }
    let settings = &mut recipe.settings;
    set(&mut settings.width, raw.size.map(|(width, _)| width));
    set(&mut settings.height, raw.size.map(|(_, height)| height));
    set(&mut settings.max_depth, raw.depth);
    set(&mut settings.sampler, raw.sampler);
    set(&mut settings.seed, raw.seed);
    set(&mut settings.estimate_error, estimate_error.map(|switch| switch == RawSwitch::On));
    let camera = &mut recipe.camera;
    set(&mut camera.look_from, raw.look_from);
    set(&mut camera.look_at, raw.look_at);
    set(&mut camera.vup, raw.vup);
    set(&mut camera.vfov_degrees, raw.vfov);
    set(&mut camera.defocus_angle_degrees, raw.defocus_angle);
    if raw.focus_distance.is_some() {
        camera.focus_distance = raw.focus_distance;
    }
}
