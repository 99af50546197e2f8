//! The manifest of a plan: a JSON file that names the scene, the parts and their files. With the scene file and the
//! parts' own files it is the whole state of a plan.

use super::Division;
use crate::film::checkpoint::SAMPLE_VERSION;
use crate::film::{Checksum, SOFTWARE, SampleRanges};
use crate::job::output::FrameRate;
use crate::job::recipe::{Recipe, file};
use crate::job::render::{RenderJob, SAMPLE_LIMIT};
use crate::scene::animation::{CameraPath, FRAME_LIMIT, FrameNames, Turn};
use crate::stages::Stage;
use crate::system::files::{self, ShownPath, write_text};
use anyhow::{Result, anyhow, ensure};
use serde::{Deserialize, Serialize};
use std::ops::Range;
use std::path::{Path, PathBuf};

/// File name of the manifest in a plan's directory.
pub const MANIFEST: &str = "plan.json";

const SCENE: &str = "scene.toml";

/// Longest manifest and longest scene file that are read, bytes.
const LENGTH_LIMITS: [u64; 2] = [256 << 20, 2 << 30];

/// The content of the manifest.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Manifest {
    /// Version of the manifest; each kind of work has its own.
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
    #[serde(flatten)]
    pub work: Work,
    /// Flags for every part's command.
    pub flags: Vec<String>,
    /// What the parts are merged into, beside the manifest.
    pub result: String,
}

/// The work and its parts.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Work {
    Samples(Samples),
    Frames(Frames),
}

/// Samples of a picture, in parts.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Samples {
    /// First sample, and one past the last.
    pub samples: [u64; 2],
    /// Parts begin and end at multiples of this power of two.
    pub block: u64,
    pub parts: Vec<Part>,
}

/// A part of a picture: a film.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Part {
    /// The film file, beside the manifest.
    pub file: String,
    /// First sample, and one past the last.
    pub samples: [u64; 2],
}

/// Frames of an animation, in parts.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Frames {
    /// First frame, and one past the last.
    pub frames: [u32; 2],
    /// How the camera circles; if it does not, it follows the keyframes of the scene file.
    pub turntable: Option<Turn>,
    /// The rate of the animated PNG.
    pub rate: FrameRate,
    pub parts: Vec<FramePart>,
}

/// A part of an animation.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FramePart {
    /// First frame, and one past the last.
    pub frames: [u32; 2],
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

impl Samples {
    /// The parts of a division of `samples`, with the names of their files.
    pub fn new(samples: &Range<u64>, division: &Division) -> Self {
        let count = division.parts.len();
        let part = |(index, range): (usize, &Range<u64>)| Part {
            file: part_file(index, count),
            samples: [range.start, range.end],
        };
        let parts = division.parts.iter().enumerate().map(part).collect();
        Samples { samples: [samples.start, samples.end], block: division.block, parts }
    }
}

/// The film file of a part, with as many digits as the last of `count` parts needs.
fn part_file(index: usize, count: usize) -> String {
    let digits = count.saturating_sub(1).to_string().len();
    format!("part-{index:0digits$}.exr")
}

impl FramePart {
    pub fn range(&self) -> Range<u32> {
        self.frames[0]..self.frames[1]
    }
}

impl Frames {
    /// Frames in `parts` parts of about the same length; `None` if there are fewer frames than parts, or no parts.
    pub fn new(frames: &Range<u32>, turntable: Option<Turn>, rate: FrameRate, parts: u64) -> Option<Self> {
        let count = u64::from(frames.end.checked_sub(frames.start)?);
        if parts == 0 || count < parts {
            return None;
        }
        let border = |part: u64| frames.start + (count * part / parts) as u32;
        let parts = (0..parts).map(|part| FramePart { frames: [border(part), border(part + 1)] }).collect();
        Some(Frames { frames: [frames.start, frames.end], turntable, rate, parts })
    }

    pub fn range(&self) -> Range<u32> {
        self.frames[0]..self.frames[1]
    }

    /// How the camera of `recipe` moves.
    pub fn camera_path(&self, recipe: &Recipe) -> CameraPath {
        match self.turntable {
            Some(turn) => CameraPath::Turntable { start: recipe.camera, turn },
            None => CameraPath::Keyframes { still: recipe.camera, keyframes: recipe.keyframes.clone() },
        }
    }
}

impl Work {
    pub fn count(&self) -> usize {
        match self {
            Work::Samples(work) => work.parts.len(),
            Work::Frames(work) => work.parts.len(),
        }
    }

    /// Version of the manifest, and the name of the file that the parts are merged into.
    fn kind(&self) -> (u32, &'static str) {
        match self {
            Work::Samples(_) => (1, "picture.exr"),
            Work::Frames(_) => (2, "animation.png"),
        }
    }

    /// The files of the parts that the manifest names.
    fn files(&self) -> impl Iterator<Item = &str> {
        let parts = if let Work::Samples(work) = self { work.parts.as_slice() } else { &[] };
        parts.iter().map(|part| part.file.as_str())
    }

    /// Samples per pixel or frames of each part.
    pub fn lengths(&self) -> Vec<u64> {
        self.ranges().1.iter().map(|[start, end]| end - start).collect()
    }

    /// The whole, its parts, and the limit on both.
    fn ranges(&self) -> ([u64; 2], Vec<[u64; 2]>, u64) {
        match self {
            Work::Samples(work) => {
                (work.samples, work.parts.iter().map(|part| part.samples).collect(), SAMPLE_LIMIT)
            }
            Work::Frames(work) => {
                let parts = work.parts.iter().map(|part| part.frames.map(u64::from)).collect();
                (work.frames.map(u64::from), parts, u64::from(FRAME_LIMIT))
            }
        }
    }
}

impl Manifest {
    /// A manifest of this version, without the scene.
    pub fn new(work: Work) -> Self {
        let (plan_version, result) = work.kind();
        Manifest {
            plan_version,
            sample_version: SAMPLE_VERSION,
            program: SOFTWARE.to_owned(),
            command: String::new(),
            scene: String::new(),
            stage: None,
            scene_file: SCENE.to_owned(),
            scene_checksum: String::new(),
            work,
            flags: Vec::new(),
            result: result.to_owned(),
        }
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
            serde_json::from_slice(&bytes).map_err(|error| damaged(error.to_string()))?;
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

    /// Checks that the parts cover the whole, and that the files have the names that this program gives them.
    fn check(&self) -> Result<(), String> {
        let (version, result) = self.work.kind();
        if self.plan_version != version {
            return Err(format!(
                "it has version {}, but this program reads version {version}",
                self.plan_version
            ));
        }
        let (whole, parts, limit) = self.work.ranges();
        let mut next = whole[0];
        for (index, [start, end]) in parts.iter().enumerate() {
            if *start != next || end <= start {
                return Err(format!("part {index} has {start}..{end}, but {next} comes next"));
            }
            next = *end;
        }
        if parts.is_empty() || next != whole[1] || next > limit {
            return Err(format!(
                "its parts end at {next}, but it ends at {}, and {limit} is the limit",
                whole[1]
            ));
        }
        let own = [(self.scene_file.as_str(), SCENE.to_owned()), (self.result.as_str(), result.to_owned())];
        let of_parts =
            self.work.files().enumerate().map(|(index, name)| (name, part_file(index, parts.len())));
        match own.into_iter().chain(of_parts).find(|(name, expected)| name != expected) {
            Some((name, expected)) => Err(format!("a file is called {name:?} instead of {expected:?}")),
            None => Ok(()),
        }
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
                (&there.scene_checksum, &there.work) == (&manifest.scene_checksum, &manifest.work),
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

    pub fn directory(&self) -> &Path {
        let parent = self.path.parent().unwrap_or(Path::new("."));
        if parent.as_os_str().is_empty() { Path::new(".") } else { parent }
    }

    pub fn beside(&self, name: &str) -> PathBuf {
        self.path.with_file_name(name)
    }

    /// The files of the frames, beside the manifest.
    pub fn frame_names(&self) -> FrameNames {
        FrameNames::in_directory(self.directory())
    }

    /// All files of the plan except its result: manifest, scene, and parts or frames.
    pub fn files(&self) -> Vec<PathBuf> {
        let mut files = vec![self.path.clone(), self.beside(&self.manifest.scene_file)];
        files.extend(self.manifest.work.files().map(|name| self.beside(name)));
        if let Work::Frames(work) = &self.manifest.work {
            let names = self.frame_names();
            files.extend(work.range().map(|frame| names.path(frame)));
        }
        files
    }

    pub fn stage(&self) -> Option<&'static Stage> {
        self.manifest.stage.as_deref().and_then(|id| Stage::find(id).ok())
    }

    /// Converts a part's number, which counts from 0, to its index.
    ///
    /// # Errors
    /// If there is no such part.
    pub fn index(&self, number: u64) -> Result<usize> {
        let count = self.manifest.work.count();
        usize::try_from(number).ok().filter(|index| *index < count).ok_or_else(|| {
            anyhow!("there is no part {number} in {}: it has the parts 0 to {}", self.path.shown(), count - 1)
        })
    }
}

/// Refuses to replace a foreign or changed file.
fn check_free(path: &Path, text: &str) -> Result<()> {
    let is_same = || {
        files::read(path, "a file of the plan", LENGTH_LIMITS[1]).is_ok_and(|there| there == text.as_bytes())
    };
    ensure!(
        path.symlink_metadata().is_err() || is_same(),
        "{} is in the way: the plan would replace it; move it away, or plan into another directory",
        path.shown()
    );
    Ok(())
}

fn checksum(text: &[u8]) -> String {
    let mut sum = Checksum::default();
    sum.text(text);
    sum.finish()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::job::plan::divide;
    use proptest::prelude::*;

    fn samples(parts: &[[u64; 2]]) -> Manifest {
        let part = |(index, samples): (usize, &[u64; 2])| Part {
            file: part_file(index, parts.len()),
            samples: *samples,
        };
        let parts = parts.iter().enumerate().map(part).collect();
        Manifest::new(Work::Samples(Samples { samples: [4, 12], block: 1, parts }))
    }

    #[test]
    fn parts_must_be_the_whole_without_gaps_and_overlaps() {
        assert_eq!(samples(&[[4, 8], [8, 12]]).check(), Ok(()));
        for parts in [
            &[][..],
            &[[4, 8]],
            &[[4, 8], [7, 12]],
            &[[4, 8], [9, 12]],
            &[[4, 4], [4, 12]],
            &[[4, 13]],
            &[[3, 12]],
        ] {
            assert!(samples(parts).check().is_err(), "{parts:?}");
        }
        let rate = FrameRate { frames: 30, seconds: 1 };
        let frames =
            |start, end| Manifest::new(Work::Frames(Frames::new(&(start..end), None, rate, 2).unwrap()));
        assert_eq!(frames(FRAME_LIMIT - 9, FRAME_LIMIT).check(), Ok(()));
        assert!(frames(FRAME_LIMIT - 9, FRAME_LIMIT + 1).check().is_err());
    }

    #[test]
    fn manifests_round_trip() {
        let division = divide(7..50, 3).unwrap();
        let turn = Some(Turn::DegreesPerFrame(-1.1));
        let rate = FrameRate { frames: 30_000, seconds: 1001 };
        for work in [
            Work::Samples(Samples::new(&(7..50), &division)),
            Work::Frames(Frames::new(&(3..9), turn, rate, 2).unwrap()),
        ] {
            let manifest = Manifest::new(work);
            let text = serde_json::to_string(&manifest).unwrap();
            assert_eq!(serde_json::from_str::<Manifest>(&text).unwrap(), manifest);
        }
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

    proptest! {
        #[test]
        fn frames_are_divided_evenly_and_without_gaps(start in 0_u32..90_000, count in 0_u32..10_000, parts in 0_u64..99) {
            let frames = start..start + count;
            let rate = FrameRate { frames: 30, seconds: 1 };
            let Some(work) = Frames::new(&frames, None, rate, parts) else {
                prop_assert!(parts == 0 || u64::from(count) < parts);
                return Ok(());
            };
            let work = Work::Frames(work);
            prop_assert_eq!(work.count() as u64, parts);
            let lengths = work.lengths();
            prop_assert!(lengths.iter().max().unwrap() - lengths.iter().min().unwrap() <= 1);
            prop_assert_eq!(Manifest::new(work).check(), Ok(()));
        }
    }
}
