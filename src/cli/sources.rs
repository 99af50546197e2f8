//! Where a picture comes from: a built-in scene, a stage, a scene file or a film; and what flags change in it.

use super::error::CliError;
use super::raw::{RawPicture, RawSwitch};
use crate::recipe::{Recipe, file};
use crate::saved::Saved;
use crate::stages::Stage;
use std::path::Path;

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
    let saved = Saved::describe(path)?;
    Ok(Source { recipe: saved.recipe()?, stage: saved.stage() })
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
