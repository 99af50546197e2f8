//! The manifest of a plan: a JSON file that names the job, its parts and their files.

use super::error::PlanError;
use crate::files::{self, write_text};
use crate::film::checkpoint::SAMPLE_VERSION;
use crate::film::{Checksum, SOFTWARE};
use crate::recipe::{Recipe, file};
use crate::render::RenderJob;
use crate::stages::Stage;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::collections::HashSet;
use std::path::{Path, PathBuf};

/// Name of the manifest in the directory of a plan.
pub const MANIFEST: &str = "plan.json";

/// Name of the scene file.
pub(super) const SCENE: &str = "scene.toml";

/// Longest manifest that is read, bytes.
const LENGTH_LIMIT: u64 = 256 << 20;

/// Work that is divided into parts.
pub trait Work: Clone + PartialEq + Serialize + DeserializeOwned {
    /// Version of its manifest; each kind of work has its own.
    const VERSION: u32;

    /// Name of the file that the parts are merged into, beside the manifest.
    const RESULT: &str;

    /// The number of parts.
    fn count(&self) -> usize;

    /// The names in it of files beside the manifest.
    fn files(&self) -> Vec<&str>;

    /// Checks that the parts are the whole.
    ///
    /// # Errors
    /// What is wrong, in words.
    fn check(&self) -> Result<(), String>;
}

/// The content of the manifest.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Manifest<W> {
    /// Version of the manifest: [`Work::VERSION`].
    pub plan_version: u32,
    /// Version of the samples: [`SAMPLE_VERSION`].
    pub sample_version: u32,
    /// The program that made the plan, and its version.
    pub program: String,
    /// The command that made it.
    pub command: String,
    /// Name of the scene.
    pub scene: String,
    /// Id of the stage that the scene comes from.
    pub stage: Option<String>,
    /// The scene file, beside the manifest.
    pub scene_file: String,
    /// Checksum of the scene file.
    pub scene_checksum: String,
    /// What is divided, and its parts.
    #[serde(flatten)]
    pub work: W,
    /// Flags of every part's command.
    pub flags: Vec<String>,
    /// What the parts are merged into, beside the manifest.
    pub result: String,
}

impl<W: Work> Manifest<W> {
    /// A manifest of this version, without what [`Plan::write`] adds.
    pub fn new(work: W) -> Self {
        Manifest {
            plan_version: W::VERSION,
            sample_version: SAMPLE_VERSION,
            program: SOFTWARE.to_owned(),
            command: String::new(),
            scene: String::new(),
            stage: None,
            scene_file: String::new(),
            scene_checksum: String::new(),
            work,
            flags: Vec::new(),
            result: W::RESULT.to_owned(),
        }
    }

    fn check(&self) -> Result<(), String> {
        self.work.check()?;
        let mut names = HashSet::from([MANIFEST.to_owned()]);
        for name in self.work.files().into_iter().chain([self.scene_file.as_str(), &self.result]) {
            let path = Path::new(name);
            if path.file_name().is_none_or(|file| file != path.as_os_str()) {
                return Err(format!("{name:?} is not the name of a file beside it"));
            }
            // Some file systems ignore the letter case.
            if !names.insert(name.to_lowercase()) {
                return Err(format!(
                    "{name:?} is the name of two of its files; the plan, its scene, each part and the result need one each"
                ));
            }
        }
        Ok(())
    }
}

/// A plan that was read and checked.
#[derive(Clone, Debug)]
pub struct Plan<W> {
    /// The manifest's path.
    pub path: PathBuf,
    /// Its content.
    pub manifest: Manifest<W>,
    /// The recipe in the scene file.
    pub recipe: Recipe,
    /// Its job.
    pub job: RenderJob,
}

impl<W: Work> Plan<W> {
    /// The plan whose manifest at `path` has this JSON.
    pub(super) fn of(path: PathBuf, value: serde_json::Value) -> Result<Self, PlanError> {
        let manifest: Manifest<W> = match parse(value) {
            Ok(manifest) => manifest,
            Err(what) => return Err(PlanError::Damaged { path, what }),
        };
        let scene_path = path.with_file_name(&manifest.scene_file);
        let text = files::read(&scene_path, "a scene file", LENGTH_LIMIT * 8)?;
        if checksum(&text) != manifest.scene_checksum {
            return Err(PlanError::SceneChanged { scene: scene_path, path });
        }
        let recipe = Recipe { name: manifest.scene.clone(), ..file::load(&scene_path)? };
        let job = recipe.job()?;
        Ok(Plan { path, manifest, recipe, job })
    }

    /// Writes a plan of `recipe` into `directory`, which must exist. An equal plan that is there stays.
    ///
    /// # Errors
    /// [`PlanError::Taken`] if the directory holds another plan, [`PlanError::InTheWay`] if it holds a scene file of
    /// another origin; those of reading the plan that is there; [`PlanError::Write`].
    pub fn write(
        directory: &Path,
        recipe: &Recipe,
        job: &RenderJob,
        manifest: Manifest<W>,
    ) -> Result<Self, PlanError> {
        let path = directory.join(MANIFEST);
        let text = file::to_toml(recipe);
        let manifest =
            Manifest { scene_file: SCENE.to_owned(), scene_checksum: checksum(text.as_bytes()), ..manifest };
        let scene = path.with_file_name(&manifest.scene_file);
        let is_own = path.symlink_metadata().is_ok()
            && same_plan(&path, recipe, job, &manifest)?.scene_file == manifest.scene_file;
        // A run that was ended between the two files has left the same text.
        if !is_own && !is_free(&scene, |there| there == text) {
            return Err(PlanError::InTheWay { path: scene });
        }
        write_text(&scene, &text)?;
        // The manifest comes last: whoever finds it finds its scene.
        let json = serde_json::to_string_pretty(&manifest)
            .map_err(|error| PlanError::Damaged { path: path.clone(), what: error.to_string() })?;
        write_text(&path, &(json + "\n"))?;
        Ok(Plan { path, manifest, recipe: recipe.clone(), job: job.clone() })
    }

    /// The directory of the plan.
    pub fn directory(&self) -> &Path {
        let parent = self.path.parent().unwrap_or(Path::new("."));
        if parent.as_os_str().is_empty() { Path::new(".") } else { parent }
    }

    /// The file of this name in the directory of the plan.
    pub fn beside(&self, name: &str) -> PathBuf {
        self.path.with_file_name(name)
    }

    /// The stage that the picture comes from.
    pub fn stage(&self) -> Option<&'static Stage> {
        self.manifest.stage.as_deref().and_then(|id| Stage::find(id).ok())
    }

    /// The index of a part from its number, which counts from 0.
    pub(super) fn index(&self, number: u64) -> Result<usize, PlanError> {
        let count = self.manifest.work.count();
        usize::try_from(number).ok().filter(|index| *index < count).ok_or_else(|| PlanError::NoPart {
            path: self.path.clone(),
            index: number,
            count,
        })
    }
}

/// Whether nothing is lost if a file is written to `path`: nothing is there, or a text that `may_go`.
pub(super) fn is_free(path: &Path, may_go: impl FnOnce(&str) -> bool) -> bool {
    path.symlink_metadata().is_err()
        || files::read(path, "a file of the plan", LENGTH_LIMIT * 8)
            .is_ok_and(|bytes| std::str::from_utf8(&bytes).is_ok_and(may_go))
}

/// The manifest at `path`, if its plan is of this recipe and has the same work as `manifest`. Its scene file may have been
/// changed or removed, because it is written again.
fn same_plan<W: Work>(
    path: &Path,
    recipe: &Recipe,
    job: &RenderJob,
    manifest: &Manifest<W>,
) -> Result<Manifest<W>, PlanError> {
    let (version, value) = read_value(path)?;
    if version == W::VERSION {
        let is_of_same = |theirs: &Manifest<W>| {
            theirs.scene_checksum == manifest.scene_checksum && theirs.work == manifest.work
        };
        if let Some(theirs) = parse(value.clone()).ok().filter(is_of_same) {
            return Ok(theirs);
        }
        let theirs = Plan::<W>::of(path.to_owned(), value)?;
        if theirs.job == *job
            && theirs.recipe.samples_per_pixel == recipe.samples_per_pixel
            && theirs.recipe.keyframes == recipe.keyframes
            && theirs.manifest.work == manifest.work
        {
            return Ok(theirs.manifest);
        }
    }
    Err(PlanError::Taken { path: path.to_owned() })
}

/// Reads the JSON of a manifest and its version. Other versions may have other keys.
pub(super) fn read_value(path: &Path) -> Result<(u32, serde_json::Value), PlanError> {
    let bytes = files::read(path, "a plan", LENGTH_LIMIT)?;
    let damaged = |what: String| PlanError::Damaged { path: path.to_owned(), what };
    let value: serde_json::Value =
        serde_json::from_slice(&bytes).map_err(|error| damaged(error.to_string()))?;
    let number = |key: &str| value.get(key).and_then(serde_json::Value::as_u64);
    let (Some(version), Some(samples)) = (number("plan_version"), number("sample_version")) else {
        return Err(damaged("it has no version".to_owned()));
    };
    let short = |version: u64| u32::try_from(version).unwrap_or(u32::MAX);
    if samples != u64::from(SAMPLE_VERSION) {
        let program = value.get("program").and_then(serde_json::Value::as_str).unwrap_or("another program");
        return Err(PlanError::SampleVersion {
            path: path.to_owned(),
            version: short(samples),
            program: program.to_owned(),
        });
    }
    Ok((short(version), value))
}

/// The manifest of this JSON, or what is wrong with it, in words.
pub(super) fn parse<W: Work>(value: serde_json::Value) -> Result<Manifest<W>, String> {
    let manifest: Manifest<W> = serde_json::from_value(value.clone()).map_err(|error| error.to_string())?;
    // serde cannot refuse unknown keys beside flattened ones.
    let known = serde_json::to_value(&manifest).map_err(|error| error.to_string())?;
    let keys = value.as_object().into_iter().flatten().map(|(key, _)| key);
    if let Some(key) = keys.into_iter().find(|key| known.get(key.as_str()).is_none()) {
        return Err(format!("it has the key {key:?}, which is unknown"));
    }
    manifest.check()?;
    Ok(manifest)
}

fn checksum(text: &[u8]) -> String {
    let mut sum = Checksum::default();
    sum.text(text);
    sum.finish()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::animation::{Keyframe, Turn};
    use crate::output::FrameRate;
    use crate::plan::Frames;

    fn recipe() -> Recipe {
        let mut recipe = Recipe::find("three-spheres").unwrap();
        (recipe.settings.width, recipe.settings.height, recipe.samples_per_pixel) = (4, 3, 6);
        recipe
    }

    /// Plans four frames of a recipe.
    fn write(directory: &Path, recipe: &Recipe, frames_per_turn: u32) -> Result<Plan<Frames>, PlanError> {
        let rate = FrameRate { frames: 30, seconds: 1 };
        let work = Frames::new(&(0..4), Some(Turn::FramesPerTurn(frames_per_turn)), rate, 2).unwrap();
        Plan::write(directory, recipe, &recipe.job().unwrap(), Manifest::new(work))
    }

    #[test]
    fn a_directory_keeps_the_plan_of_one_picture_with_its_samples_and_keyframes() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path();
        write(path, &recipe(), 8).unwrap();
        let changes: [fn(&mut Recipe); 3] = [
            |recipe| recipe.samples_per_pixel = 7,
            |recipe| recipe.settings.seed = 1,
            |recipe| recipe.keyframes.push(Keyframe { frame: 2, camera: recipe.camera }),
        ];
        for (index, change) in changes.into_iter().enumerate() {
            let mut other = recipe();
            change(&mut other);
            assert!(matches!(write(path, &other, 8), Err(PlanError::Taken { .. })), "{index}");
        }
        assert!(matches!(write(path, &recipe(), 9), Err(PlanError::Taken { .. })));
        // The name is not part of the picture.
        write(path, &Recipe { name: "other".to_owned(), ..recipe() }, 8).unwrap();
    }

    #[test]
    fn a_plan_without_a_directory_is_in_the_current_one() {
        let directory = tempfile::tempdir().unwrap();
        let mut plan = write(directory.path(), &recipe(), 8).unwrap();
        assert_eq!((plan.directory(), plan.beside("x")), (directory.path(), directory.path().join("x")));
        plan.path = PathBuf::from(MANIFEST);
        assert_eq!((plan.directory(), plan.beside("x")), (Path::new("."), PathBuf::from("x")));
    }
}
