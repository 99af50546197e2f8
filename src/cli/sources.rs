//! Where a picture comes from (a built-in scene, a stage, a scene file or a film), with the changes of the flags.

use super::error::CliError;
use super::raw::RawPicture;
use crate::recipe::{Recipe, file};
use crate::saved::Saved;
use crate::stages::Stage;
use std::path::Path;

/// The scene that is rendered if none is named.
pub const DEFAULT_SCENE: &str = "three-spheres";

/// A recipe and, if it comes from one, its stage.
#[derive(Clone, Debug)]
pub(super) struct ChosenRecipe {
    pub recipe: Recipe,
    pub stage: Option<&'static Stage>,
}

/// The source that the flags name, before the changes of other flags.
pub(super) fn find(raw: &RawPicture, resume: Option<&Path>) -> Result<ChosenRecipe, CliError> {
    match (&raw.stage, &raw.scene, resume) {
        (Some(id), _, _) => {
            let stage = Stage::find(id)?;
            Ok(ChosenRecipe { recipe: stage.recipe(), stage: Some(stage) })
        }
        (None, Some(name), _) => Ok(ChosenRecipe { recipe: scene(name)?, stage: None }),
        (None, None, Some(film)) => of_film(film),
        (None, None, None) => Ok(ChosenRecipe { recipe: scene(DEFAULT_SCENE)?, stage: None }),
    }
}

/// The scene with this name or in this file.
pub(super) fn scene(name: &str) -> Result<Recipe, CliError> {
    if is_file(name) { Ok(file::load(Path::new(name))?) } else { Ok(Recipe::find(name)?) }
}

/// The example scene `near-glass`, which is part of the program for use in reports.
pub(super) const NEAR_GLASS: &str = "near-glass";

/// A built-in scene, or [`NEAR_GLASS`].
pub(super) fn carried(name: &str) -> Result<Recipe, CliError> {
    if name != NEAR_GLASS {
        return scene(name);
    }
    let recipe = file::parse(include_str!("../../assets/scenes/near-glass.toml"), NEAR_GLASS)?;
    Ok(Recipe { name: name.to_owned(), ..recipe })
}

/// Whether `--scene` names a file: the name has an extension or a directory.
pub(super) fn is_file(scene: &str) -> bool {
    let path = Path::new(scene);
    path.extension().is_some() || path.components().count() > 1
}

/// The scene file that `--scene` names, if it is a file.
pub(super) fn scene_file(scene: Option<&str>) -> Option<&Path> {
    scene.filter(|scene| is_file(scene)).map(Path::new)
}

/// Returns an error unless the file name ends in `ending`, with the dot, in upper or lower case.
pub(super) fn check_ending(
    flag: &'static str,
    path: &Path,
    what: &'static str,
    ending: &'static str,
) -> Result<(), CliError> {
    let is_so = path.extension().is_some_and(|own| own.eq_ignore_ascii_case(ending.trim_start_matches('.')));
    if is_so { Ok(()) } else { Err(CliError::Ending { flag, path: path.to_owned(), what, ending }) }
}

/// Reduces the picture to at most `width` pixels across, keeping its shape, unless its size was given.
pub(super) fn narrow(recipe: &mut Recipe, raw: &RawPicture, width: u32) {
    let settings = &mut recipe.settings;
    if raw.size.is_none() && settings.width > width {
        let height = f64::from(settings.height) * f64::from(width) / f64::from(settings.width);
        (settings.width, settings.height) = (width, (height.round() as u32).max(1));
    }
}

fn of_film(path: &Path) -> Result<ChosenRecipe, CliError> {
    let saved = Saved::describe(path)?;
    Ok(ChosenRecipe { recipe: saved.recipe()?, stage: saved.stage() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wide_picture_is_narrowed_unless_its_size_was_given() {
        let narrowed = |size, raw_size| {
            let mut recipe = Recipe::builtin(DEFAULT_SCENE).unwrap();
            (recipe.settings.width, recipe.settings.height) = size;
            narrow(&mut recipe, &RawPicture { size: raw_size, ..RawPicture::default() }, 100);
            (recipe.settings.width, recipe.settings.height)
        };
        for (size, expected) in [
            ((99, 50), (99, 50)),
            ((100, 50), (100, 50)),
            ((101, 50), (100, 50)),
            ((400, 222), (100, 56)),
            ((400, 221), (100, 55)),
            ((1000, 1), (100, 1)),
        ] {
            assert_eq!(narrowed(size, None), expected, "{size:?}");
            assert_eq!(narrowed(size, Some(size)), size);
        }
    }

    #[test]
    fn a_name_has_its_ending_in_any_case() {
        let check = |name: &str| check_ending("--log", Path::new(name), "the log", ".log");
        assert!(check("a.log").is_ok() && check("b/a.b.LOG").is_ok());
        for name in ["a", "log", ".log", "a.logs", "a.log.txt", "a.log/b"] {
            assert!(check(name).is_err(), "{name}");
        }
    }

    #[test]
    fn a_scene_with_an_ending_or_a_directory_is_a_file() {
        for (scene, expected) in [
            ("three-spheres", false),
            ("field:20", false),
            ("s.toml", true),
            ("s.TOML", true),
            ("./metals", true),
            ("scenes/metals", true),
            (".toml", false),
        ] {
            assert_eq!(is_file(scene), expected, "{scene}");
            assert_eq!(scene_file(Some(scene)), expected.then_some(Path::new(scene)));
        }
        assert_eq!(scene_file(None), None);
    }
}
