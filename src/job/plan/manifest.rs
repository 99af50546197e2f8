//! The manifest of a plan: a JSON file that names the scene, the parts and their files. With the scene file and the
//! parts' own films it is the whole state of a plan.

use super::division::divide;
use crate::film::checkpoint::SAMPLE_VERSION;
use crate::film::{Checksum, SOFTWARE, SampleRanges};
use crate::job::recipe::{Recipe, file};
use crate::job::render::{RenderJob, SAMPLE_LIMIT};
use crate::stages::Stage;
use crate::system::files::{self, ShownPath, write_text};
use anyhow::{Result, anyhow, ensure};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// File name of the manifest in a plan's directory.
pub const MANIFEST: &str = "plan.json";

const SCENE: &str = "scene.toml";
const RESULT: &str = "picture.exr";
const VERSION: u32 = 1;

/// Longest manifest and longest scene file that are read, bytes.
const LENGTH_LIMITS: [u64; 2] = [256 << 20, 2 << 30];

/// The content of the manifest.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Manifest {
    pub plan_version: u32,
    pub sample_version: u32,
    /// The program that made the plan, and its version.
    pub program: String,
    pub command: String,
    pub scene: String,
    /// Id of the scene's stage.
    pub stage: Option<String>,
    /// The scene file, beside the manifest.
    pub scene_file: String,
    pub scene_checksum: String,
    /// First sample, and one past the last.
    pub samples: [u64; 2],
    /// Parts begin and end at multiples of this power of two.
    pub block: u64,
    pub parts: Vec<Part>,
    /// Flags for every part's command.
    pub flags: Vec<String>,
    /// The file of the merged film, beside the manifest.
    pub result: String,
}

/// A part of a picture.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Part {
    /// The film file, beside the manifest.
    pub file: String,
    /// First sample, and one past the last.
    pub samples: [u64; 2],
}

impl Part {
    /// Samples per pixel of the part that `found` lacks.
    pub fn missing(&self, found: &SampleRanges) -> u64 {
        let (mut missing, mut from) = (0, self.samples[0]);
        while let Some(gap) = found.first_gap(from..self.samples[1], u64::MAX) {
            missing += gap.end - gap.start;
            from = gap.end;
        }
        missing
    }

    /// Whether `found` has samples outside the part.
    pub fn is_exceeded_by(&self, found: &SampleRanges) -> bool {
        found.iter().any(|range| range.start < self.samples[0] || range.end > self.samples[1])
    }
}

impl Manifest {
    /// A manifest of this version, without the scene. `None` if there are fewer samples than parts, or no parts.
    pub fn new(samples: &Range<u64>, parts: u64) -> Option<Self> {
        let (block, ranges) = divide(samples.clone(), parts)?;
        // As many digits as the last part needs.
        let digits = (ranges.len() - 1).to_string().len();
        let part = |(index, range): (usize, &Range<u64>)| Part {
            file: format!("part-{index:0digits$}.exr"),
            samples: [range.start, range.end],
        };
        Some(Manifest {
            plan_version: VERSION,
            sample_version: SAMPLE_VERSION,
            program: SOFTWARE.to_owned(),
            scene_file: SCENE.to_owned(),
            samples: [samples.start, samples.end],
            block,
            parts: ranges.iter().enumerate().map(part).collect(),
            result: RESULT.to_owned(),
            ..Manifest::default()
        })
    }

    fn read(path: &Path) -> Result<Manifest> {
        let bytes = files::read(path, "a plan", LENGTH_LIMITS[0])?;
        let damaged = |what: String| {
            anyhow!(
                "{} is not a plan, or is damaged: {what}; check that it is the right file; if so, move it away and make \
                 the plan again with `weekender plan`",
                path.shown()
            )
        };
        let manifest: Manifest =
            serde_json::from_slice(&as_written(&bytes)).map_err(|error| damaged(error.to_string()))?;
        let Manifest { sample_version, program, .. } = &manifest;
        ensure!(
            *sample_version == SAMPLE_VERSION,
            "{} is a plan for samples of version {sample_version}, made by {program}, but this program ({SOFTWARE}) \
             traces version {SAMPLE_VERSION}; use {program} on every machine, or plan into another directory with this one",
            path.shown()
        );
        manifest.check().map_err(damaged)?;
        Ok(manifest)
    }

    /// Checks that it has the parts and the names that this program gives them.
    fn check(&self) -> Result<(), String> {
        let version = self.plan_version;
        if version != VERSION {
            return Err(format!("it has version {version}, but this program reads version {VERSION}"));
        }
        let [start, end] = self.samples;
        let made =
            (end <= SAMPLE_LIMIT).then(|| Manifest::new(&(start..end), self.parts.len() as u64)).flatten();
        let names = |plan: &Manifest| [plan.scene_file.clone(), plan.result.clone()];
        let is_made = |made: &Manifest| {
            (made.block, &made.parts, names(made)) == (self.block, &self.parts, names(self))
        };
        let what = "its parts are not those of the samples";
        made.filter(is_made)
            .map(drop)
            .ok_or_else(|| format!("{what} {start}..{end}, or its files have other names"))
    }
}

/// A plan that was read and checked.
#[derive(Clone, Debug)]
pub struct Plan {
    pub path: PathBuf,
    pub manifest: Manifest,
    pub recipe: Recipe,
    pub job: RenderJob,
}

impl Plan {
    /// Whether `path` names a plan rather than a film.
    pub fn is_at(path: &Path) -> bool {
        path.is_dir() || path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("json"))
    }

    /// Reads a plan and its scene. `path` is the manifest, or the directory that it is in.
    ///
    /// # Errors
    /// If there is none, it was changed, or it has another version; the message says what to do.
    pub fn load(path: &Path) -> Result<Plan> {
        let in_directory = path.join(MANIFEST);
        ensure!(
            !path.is_dir() || in_directory.exists(),
            "{} is a directory without a {MANIFEST}; a plan's directory or a file is needed",
            path.shown()
        );
        let path = if path.is_dir() { in_directory } else { path.to_owned() };
        let manifest = Manifest::read(&path)?;
        let scene = path.with_file_name(&manifest.scene_file);
        ensure!(
            checksum(&files::read(&scene, "a scene file", LENGTH_LIMITS[1])?) == manifest.scene_checksum,
            "{} was changed since {} was made; undo the change or make the same plan again, or plan the changed scene \
             into another directory",
            scene.shown(),
            path.shown()
        );
        let recipe = Recipe { name: manifest.scene.clone(), ..file::load(&scene)? };
        let job = recipe.job()?;
        Ok(Plan { path, manifest, recipe, job })
    }

    /// Writes a plan of `recipe`, and the `scripts` that start it, into `directory`, which must exist. An equal plan
    /// may already be there, even with other flags.
    ///
    /// # Errors
    /// If the directory holds another plan, a foreign file would be replaced, or a file cannot be written.
    pub fn write(
        directory: &Path,
        recipe: &Recipe,
        job: &RenderJob,
        manifest: Manifest,
        scripts: &[(&str, String)],
    ) -> Result<Plan> {
        let path = directory.join(MANIFEST);
        let text = file::to_toml(recipe);
        let manifest = Manifest { scene_checksum: checksum(text.as_bytes()), ..manifest };
        let scene = path.with_file_name(&manifest.scene_file);
        if path.symlink_metadata().is_ok() {
            let there = Manifest::read(&path)?;
            ensure!(
                (&there.scene_checksum, &there.samples, &there.parts)
                    == (&manifest.scene_checksum, &manifest.samples, &manifest.parts),
                "{} holds the plan of another picture, or of other parts; plan into another directory, or delete it",
                path.shown()
            );
        } else {
            check_free(&scene, &text)?;
        }
        let scripts = scripts.iter().map(|(name, text)| (path.with_file_name(name), text));
        scripts.clone().try_for_each(|(path, text)| check_free(&path, text))?;
        write_text(&scene, &text)?;
        // The manifest comes after its scene, so whoever finds it finds both.
        write_text(&path, &(serde_json::to_string_pretty(&manifest)? + "\n"))?;
        for (path, text) in scripts {
            write_text(&path, text)?;
        }
        Ok(Plan { path, manifest, recipe: recipe.clone(), job: job.clone() })
    }

    pub fn beside(&self, name: &str) -> PathBuf {
        self.path.with_file_name(name)
    }

    /// All files of the plan except its result: manifest, scene and films.
    pub fn files(&self) -> Vec<PathBuf> {
        let films = self.manifest.parts.iter().map(|part| self.beside(&part.file));
        [self.path.clone(), self.beside(&self.manifest.scene_file)].into_iter().chain(films).collect()
    }

    pub fn stage(&self) -> Option<&'static Stage> {
        self.manifest.stage.as_deref().and_then(|id| Stage::find(id).ok())
    }

    /// Converts a part's number, which counts from 0, to its index.
    ///
    /// # Errors
    /// If there is no such part.
    pub fn index(&self, number: u64) -> Result<usize> {
        let count = self.manifest.parts.len();
        usize::try_from(number).ok().filter(|index| *index < count).ok_or_else(|| {
            anyhow!("there is no part {number} in {}: it has the parts 0 to {}", self.path.shown(), count - 1)
        })
    }
}

/// Refuses to replace a foreign or changed file.
fn check_free(path: &Path, text: &str) -> Result<()> {
    let is_same = || {
        let there = files::read(path, "a file of the plan", LENGTH_LIMITS[1]);
        there.is_ok_and(|there| as_written(&there) == text.as_bytes())
    };
    ensure!(
        path.symlink_metadata().is_err() || is_same(),
        "{} is in the way: the plan would replace it; move it away, or plan into another directory",
        path.shown()
    );
    Ok(())
}

/// A text as this program writes it, without what Windows' editors and git's `autocrlf` change: a byte order mark at the
/// start, and a carriage return before each line end.
fn as_written(text: &[u8]) -> Cow<'_, [u8]> {
    let text = text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(text);
    if !text.contains(&b'\r') {
        return Cow::Borrowed(text);
    }
    let is_kept = |place: &usize| !text[*place..].starts_with(b"\r\n");
    Cow::Owned((0..text.len()).filter(is_kept).map(|place| text[place]).collect())
}

fn checksum(text: &[u8]) -> String {
    let mut sum = Checksum::default();
    sum.text(&as_written(text));
    sum.finish()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_must_be_those_of_the_samples() {
        let good = Manifest::new(&(4..12), 2).unwrap();
        assert_eq!(good.check(), Ok(()));
        let wrong: [fn(&mut Manifest); 7] = [
            |plan| plan.parts.clear(),
            |plan| plan.parts.truncate(1),
            |plan| plan.parts[1].samples[0] -= 1,
            |plan| plan.parts[0].samples[1] -= 1,
            |plan| plan.parts[1].file = "../part-1.exr".to_owned(),
            |plan| plan.samples[1] = SAMPLE_LIMIT + 1,
            |plan| plan.result = "plan.json".to_owned(),
        ];
        for change in wrong {
            let mut plan = good.clone();
            change(&mut plan);
            assert!(plan.check().is_err(), "{plan:?}");
        }
        let text = serde_json::to_string(&good).unwrap();
        assert_eq!(serde_json::from_str::<Manifest>(&text).unwrap(), good);
    }

    #[test]
    fn missing_samples_of_a_part() {
        let part = Part { file: String::new(), samples: [8, 16] };
        let of = |ranges: &[[u64; 2]]| {
            let found = SampleRanges::from_ranges(ranges.iter().map(|[start, end]| *start..*end)).unwrap();
            (part.missing(&found), part.is_exceeded_by(&found))
        };
        assert_eq!(of(&[]), (8, false));
        assert_eq!(of(&[[8, 16]]), (0, false));
        assert_eq!(of(&[[9, 10], [12, 16]]), (3, false));
        assert_eq!(of(&[[7, 9]]), (7, true));
        assert_eq!(of(&[[8, 17]]), (0, true));
    }
}
