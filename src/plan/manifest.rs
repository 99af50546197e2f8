//! The manifest of a plan: a JSON file that names the job, its parts and their files.

use crate::files::{self, InputError, WriteError, write_text};
use crate::film::checkpoint::SAMPLE_VERSION;
use crate::film::{Checksum, SampleRanges};
use crate::recipe::{Recipe, file};
use crate::render::{JobError, RenderJob};
use crate::stages::Stage;
use serde::{Deserialize, Serialize};
use std::ops::Range;
use std::path::{Path, PathBuf};

/// Version of the manifest.
const VERSION: u32 = 1;

/// Name of the manifest in the directory of a plan.
pub const MANIFEST: &str = "plan.json";

/// Name of the scene file.
const SCENE: &str = "scene.toml";

/// Name of the merged film.
pub const RESULT: &str = "picture.exr";

/// Longest manifest that is read, bytes.
const LENGTH_LIMIT: u64 = 256 << 20;

/// The content of the manifest.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Manifest {
    /// Version of the manifest.
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
    /// First sample, and one past the last.
    pub samples: [u64; 2],
    /// Parts begin and end at multiples of this power of two.
    pub block: u64,
    /// Flags of every part's command.
    pub flags: Vec<String>,
    /// The parts.
    pub parts: Vec<Part>,
    /// The merged film, beside the manifest.
    pub result: String,
}

/// A part of a plan.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Part {
    /// The film file, beside the manifest.
    pub file: String,
    /// First sample, and one past the last.
    pub samples: [u64; 2],
}

impl Part {
    /// The part's samples.
    pub fn range(&self) -> Range<u64> {
        self.samples[0]..self.samples[1]
    }

    /// What `found` lacks of the part: the number of samples per pixel.
    pub fn missing(&self, found: &SampleRanges) -> u64 {
        let (mut missing, mut from) = (0, self.samples[0]);
        while let Some(gap) = found.first_gap(from..self.samples[1], u64::MAX) {
            missing += gap.end - gap.start;
            from = gap.end;
        }
        missing
    }

    /// Whether `found` has samples that do not belong to the part.
    pub fn is_exceeded_by(&self, found: &SampleRanges) -> bool {
        found.iter().any(|range| range.start < self.samples[0] || range.end > self.samples[1])
    }
}

/// Why a plan cannot be read or written.
#[derive(Debug, thiserror::Error)]
pub enum PlanError {
    /// The manifest or its scene cannot be read.
    #[error(transparent)]
    Input(#[from] InputError),
    /// A file cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// The scene file cannot be read.
    #[error(transparent)]
    Scene(#[from] file::FileError),
    /// The scene cannot be rendered.
    #[error(transparent)]
    Job(#[from] JobError),
    /// The manifest is not one.
    #[error("{} is not a plan, or is damaged: {what}; make it again with `weekender plan`", path.display())]
    Damaged {
        /// The manifest.
        path: PathBuf,
        /// What is wrong.
        what: String,
    },
    /// The plan is for another version of the program.
    #[error(
        "{} is a plan for samples of version {version}, made by {program}, but this program ({}) traces version {SAMPLE_VERSION}; use {program} on every machine, or plan into another directory with this one",
        path.display(), concat!("Weekender ", env!("CARGO_PKG_VERSION"))
    )]
    SampleVersion {
        /// The manifest.
        path: PathBuf,
        /// The version of the samples.
        version: u32,
        /// The program that made the plan.
        program: String,
    },
    /// The directory holds another plan.
    #[error(
        "{} holds the plan of another picture, or of other parts; plan into another directory, or delete it",
        path.display()
    )]
    Taken {
        /// The manifest that is there.
        path: PathBuf,
    },
    /// There is no such part.
    #[error("there is no part {index} in {}: it has the parts 0 to {}", path.display(), count - 1)]
    NoPart {
        /// The manifest.
        path: PathBuf,
        /// The number that was given.
        index: u64,
        /// The number of parts.
        count: usize,
    },
}

/// A plan that was read and checked.
#[derive(Clone, Debug)]
pub struct Plan {
    /// The manifest's path.
    pub path: PathBuf,
    /// Its content.
    pub manifest: Manifest,
    /// The recipe in the scene file.
    pub recipe: Recipe,
    /// Its job.
    pub job: RenderJob,
}

impl Plan {
    /// The manifest that `path` names: itself, or the directory that it is in.
    pub fn manifest_path(path: &Path) -> PathBuf {
        if path.is_dir() { path.join(MANIFEST) } else { path.to_owned() }
    }

    /// Whether `path` names a plan rather than a film.
    pub fn is_at(path: &Path) -> bool {
        path.join(MANIFEST).exists()
            || path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("json"))
    }

    /// Reads a plan and its scene.
    ///
    /// # Errors
    /// [`PlanError`].
    pub fn load(path: &Path) -> Result<Plan, PlanError> {
        let path = Plan::manifest_path(path);
        let manifest = read_manifest(&path)?;
        let scene_path = beside(&path, &manifest.scene_file);
        let text = files::read(&scene_path, "a scene file", LENGTH_LIMIT * 8)?;
        if checksum(&text) != manifest.scene_checksum {
            let what = format!("{} was changed since the plan was made", scene_path.display());
            return Err(PlanError::Damaged { path, what });
        }
        let recipe = Recipe { name: manifest.scene.clone(), ..file::load(&scene_path)? };
        let job = recipe.job()?;
        Ok(Plan { path, manifest, recipe, job })
    }

    /// Writes a plan of `recipe` into `directory`, which must exist. An equal plan that is there stays.
    ///
    /// # Errors
    /// [`PlanError::Taken`] if the directory holds another plan; [`PlanError::Write`].
    pub fn write(
        directory: &Path,
        recipe: &Recipe,
        job: &RenderJob,
        manifest: Manifest,
    ) -> Result<Plan, PlanError> {
        let path = directory.join(MANIFEST);
        let text = file::to_toml(recipe);
        let manifest =
            Manifest { scene_file: SCENE.to_owned(), scene_checksum: checksum(text.as_bytes()), ..manifest };
        if path.symlink_metadata().is_ok() {
            let theirs = Plan::load(&path).map_err(|_| PlanError::Taken { path: path.clone() })?;
            let is_same = theirs.job == *job && theirs.manifest.parts == manifest.parts;
            if !is_same {
                return Err(PlanError::Taken { path });
            }
        }
        write_text(&beside(&path, &manifest.scene_file), &text)?;
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

    /// The stage that the picture comes from.
    pub fn stage(&self) -> Option<&'static Stage> {
        self.manifest.stage.as_deref().and_then(|id| Stage::find(id).ok())
    }

    /// The film file of a part.
    pub fn part_path(&self, part: &Part) -> PathBuf {
        beside(&self.path, &part.file)
    }

    /// A part by its number, from 0.
    ///
    /// # Errors
    /// [`PlanError::NoPart`].
    pub fn part(&self, index: u64) -> Result<&Part, PlanError> {
        let parts = &self.manifest.parts;
        usize::try_from(index).ok().and_then(|index| parts.get(index)).ok_or_else(|| PlanError::NoPart {
            path: self.path.clone(),
            index,
            count: parts.len(),
        })
    }
}

impl Manifest {
    /// The parts of a division, and the names of their files.
    pub fn parts_of(ranges: &[Range<u64>]) -> Vec<Part> {
        let digits = ranges.len().saturating_sub(1).to_string().len();
        let part = |(index, range): (usize, &Range<u64>)| Part {
            file: format!("part-{index:0digits$}.exr"),
            samples: [range.start, range.end],
        };
        ranges.iter().enumerate().map(part).collect()
    }

    /// A manifest of this version, without what [`Plan::write`] adds.
    pub fn new(samples: &Range<u64>, block: u64, parts: Vec<Part>) -> Self {
        Manifest {
            plan_version: VERSION,
            sample_version: SAMPLE_VERSION,
            program: concat!("Weekender ", env!("CARGO_PKG_VERSION")).to_owned(),
            command: String::new(),
            scene: String::new(),
            stage: None,
            scene_file: String::new(),
            scene_checksum: String::new(),
            samples: [samples.start, samples.end],
            block,
            flags: Vec::new(),
            parts,
            result: RESULT.to_owned(),
        }
    }

    fn check(&self) -> Result<(), String> {
        let mut next = self.samples[0];
        for (index, part) in self.parts.iter().enumerate() {
            if part.samples[0] != next || part.samples[1] <= next {
                let [start, end] = part.samples;
                return Err(format!("part {index} has the samples {start}..{end}, but {next} comes next"));
            }
            next = part.samples[1];
        }
        if next != self.samples[1] || self.parts.is_empty() {
            return Err(format!("its parts end at sample {next}, but it has {}", self.samples[1]));
        }
        let all = self.samples[0]..self.samples[1];
        SampleRanges::default().insert(all).map_err(|error| error.to_string())?;
        let files = self.parts.iter().map(|part| &part.file).chain([&self.scene_file, &self.result]);
        for name in files {
            let path = Path::new(name);
            if path.file_name().is_none_or(|file| file != path.as_os_str()) {
                return Err(format!("{name:?} is not the name of a file beside it"));
            }
        }
        Ok(())
    }
}

/// Reads a manifest without its scene.
fn read_manifest(path: &Path) -> Result<Manifest, PlanError> {
    let bytes = files::read(path, "a plan", LENGTH_LIMIT)?;
    let damaged = |what: String| PlanError::Damaged { path: path.to_owned(), what };
    // Check the versions first: other versions may have other keys.
    let value: serde_json::Value =
        serde_json::from_slice(&bytes).map_err(|error| damaged(error.to_string()))?;
    let number = |key: &str| value.get(key).and_then(serde_json::Value::as_u64);
    let text = |key: &str| value.get(key).and_then(serde_json::Value::as_str);
    let (Some(version), Some(samples)) = (number("plan_version"), number("sample_version")) else {
        return Err(damaged("it has no version".to_owned()));
    };
    if samples != u64::from(SAMPLE_VERSION) {
        let program = text("program").unwrap_or("another program").to_owned();
        let version = u32::try_from(samples).unwrap_or(u32::MAX);
        return Err(PlanError::SampleVersion { path: path.to_owned(), version, program });
    }
    if version != u64::from(VERSION) {
        return Err(damaged(format!("it has version {version}, but this program reads version {VERSION}")));
    }
    let manifest: Manifest = serde_json::from_value(value).map_err(|error| damaged(error.to_string()))?;
    manifest.check().map_err(damaged)?;
    Ok(manifest)
}

/// The file of this name in the directory of `path`.
fn beside(path: &Path, name: &str) -> PathBuf {
    path.with_file_name(name)
}

fn checksum(text: &[u8]) -> String {
    let mut sum = Checksum::default();
    sum.text(text);
    sum.finish()
}
