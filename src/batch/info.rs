//! `weekender info`: what a film, picture, scene file or plan says about itself.

use crate::cli::terminal::{print, write_json};
use crate::cli::{InfoOptions, JsonTarget};
use crate::film::{CheckpointError, checkpoint, key};
use crate::job::output::{FrameRate, animation_in};
use crate::job::plan::{Plan, Work};
use crate::job::recipe::{Recipe, file};
use crate::job::saved::Saved;
use crate::progressive::describe::{counted, seconds};
use crate::system::console::printable;
use crate::system::failure::Failure;
use crate::system::files::ShownPath;
use crate::system::memory;
use serde::Serialize;
use std::fmt;
use std::path::Path;
use std::process::ExitCode;

/// Version of the JSON. It is raised when a key changes its meaning or is removed.
const SCHEMA: u32 = 1;

/// Prints what the file says about itself.
///
/// # Errors
/// [`Failure::Input`] if the file cannot be read or does not say how it was made; [`Failure::Run`] if standard output
/// cannot be written.
pub fn run(options: &InfoOptions) -> Result<ExitCode, Failure> {
    let info = Info::of(&options.file).map_err(Failure::Input)?;
    let printed =
        if options.json { write_json(&info, &JsonTarget::StandardOutput) } else { print(&info.to_string()) };
    printed.map(|()| ExitCode::SUCCESS).map_err(Failure::Run)
}

/// What a file says about itself.
#[derive(Debug, Default, Serialize)]
struct Info {
    schema: u32,
    kind: &'static str,
    file: String,
    bytes: u64,
    scene: String,
    stage: Option<String>,
    width: u32,
    height: u32,
    max_depth: u32,
    sampler: &'static str,
    seed: u32,
    samples_per_pixel: Option<u64>,
    sample_ranges: Option<String>,
    halves: Option<usize>,
    rejected_samples: Option<u64>,
    rmse_estimate: Option<f64>,
    rmse_deviation: Option<f64>,
    trace_seconds: Option<f64>,
    backend: Option<String>,
    program: Option<String>,
    film_version: Option<u32>,
    sample_version: Option<u32>,
    frames: Option<String>,
    frames_per_second: Option<f64>,
    parts: Option<usize>,
    command: Option<String>,
    #[serde(skip)]
    error_text: Option<String>,
}

impl Info {
    fn of(path: &Path) -> anyhow::Result<Info> {
        if Plan::is_at(path) {
            return Ok(Info::of_plan(&Plan::load(path)?));
        }
        if path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("toml")) {
            let recipe = file::load(path)?;
            let samples = Some(recipe.samples_per_pixel);
            return Ok(Info { samples_per_pixel: samples, ..Info::new("scene", path, &recipe) });
        }
        let saved = Saved::describe(path)?;
        let text = |key| saved.description.get(key).map(str::to_owned);
        let info = Info {
            stage: text(key::STAGE),
            samples_per_pixel: saved.samples(),
            trace_seconds: saved.seconds(),
            backend: text(key::BACKEND),
            program: text(key::SOFTWARE),
            command: text(key::COMMAND),
            ..Info::new("picture", path, &saved.recipe()?)
        };
        if let Some((count, rate)) = animation_in(path) {
            let frames_per_second = rate.map(FrameRate::per_second);
            return Ok(Info {
                kind: "animation",
                frames: Some(format!("0..{count}")),
                frames_per_second,
                ..info
            });
        }
        info.with_film(path)
    }

    fn new(kind: &'static str, path: &Path, recipe: &Recipe) -> Info {
        let settings = &recipe.settings;
        Info {
            schema: SCHEMA,
            kind,
            file: path.to_string_lossy().into_owned(),
            bytes: std::fs::metadata(path).map_or(0, |found| found.len()),
            scene: recipe.name.clone(),
            width: settings.width,
            height: settings.height,
            max_depth: settings.max_depth,
            sampler: settings.sampler.name(),
            seed: settings.seed,
            ..Info::default()
        }
    }

    fn of_plan(plan: &Plan) -> Info {
        let manifest = &plan.manifest;
        let info = Info {
            stage: manifest.stage.clone(),
            program: Some(manifest.program.clone()),
            sample_version: Some(manifest.sample_version),
            parts: Some(manifest.work.count()),
            command: Some(manifest.command.clone()),
            ..Info::new("plan", &plan.path, &plan.recipe)
        };
        match &manifest.work {
            Work::Samples(work) => Info {
                samples_per_pixel: Some(work.samples[1] - work.samples[0]),
                sample_ranges: Some(format!("{}..{}", work.samples[0], work.samples[1])),
                halves: Some(plan.job.settings().half_count()),
                ..info
            },
            Work::Frames(work) => Info {
                samples_per_pixel: Some(plan.recipe.samples_per_pixel),
                frames: Some(format!("{}..{}", work.frames[0], work.frames[1])),
                ..info
            },
        }
    }

    /// Adds what a film says and, if there is memory for its sums, its error.
    fn with_film(self, path: &Path) -> anyhow::Result<Info> {
        let head = match checkpoint::read_head(path) {
            Err(CheckpointError::NotExr { .. } | CheckpointError::NotFilm { .. }) => return Ok(self),
            head => head?,
        };
        let (error, error_text) = match checkpoint::load(path) {
            Ok(read) => match read.film.error() {
                Some(error) => (Some(error), error.words()),
                None => (None, format!("not estimated: {}", read.film.why_no_error())),
            },
            Err(CheckpointError::Memory { reason, .. }) => (None, reason.to_string()),
            Err(error) => return Err(error.into()),
        };
        Ok(Info {
            kind: "film",
            samples_per_pixel: Some(head.samples.count()),
            sample_ranges: Some(head.samples.to_string()),
            halves: Some(head.halves),
            rejected_samples: Some(head.rejected),
            film_version: Some(checkpoint::VERSION),
            sample_version: Some(checkpoint::SAMPLE_VERSION),
            rmse_estimate: error.map(|error| error.rmse),
            rmse_deviation: error.map(|error| error.rmse_deviation),
            error_text: Some(error_text),
            ..self
        })
    }

    /// The samples, with everything said about them.
    fn samples_text(&self) -> Option<String> {
        let version = self.sample_version.map(|version| format!("version {version}"));
        let rejected = self.rejected_samples.map(|count| counted(count, "rejected sample"));
        let rate =
            self.frames_per_second.map(|rate| format!("{} frames per second", (rate * 1e5).round() / 1e5));
        let text = [
            Some(format!("{} per pixel", self.samples_per_pixel?)),
            self.sample_ranges.as_ref().map(|ranges| format!(" ({ranges})")),
            self.frames.as_ref().map(|frames| format!(" of the frames {frames}")),
            self.parts.map(|parts| format!(" in {}", counted(parts as u64, "part"))),
        ];
        let text: String = text.into_iter().flatten().collect();
        Some([Some(text), rate, version, rejected].into_iter().flatten().collect::<Vec<_>>().join(", "))
    }
}

impl fmt::Display for Info {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Info { kind, scene, width, height, max_depth, sampler, seed, .. } = self;
        let version = self.film_version.map_or_else(String::new, |version| format!(", version {version}"));
        let lines = [
            (*kind, Some(format!("{}, {}{version}", self.file.shown(), memory::words(self.bytes)))),
            ("scene", Some(format!("{scene}, {width}x{height}, depth {max_depth}, {sampler}, seed {seed}"))),
            ("stage", self.stage.clone()),
            ("samples", self.samples_text()),
            ("error", self.error_text.clone()),
            ("time", self.trace_seconds.map(|time| format!("{} of tracing", seconds(time)))),
            ("backend", self.backend.clone()),
            ("program", self.program.clone()),
            ("command", self.command.clone()),
        ];
        lines
            .into_iter()
            .filter_map(|(name, value)| Some((name, value?)))
            .try_for_each(|(name, value)| writeln!(f, "{name:<8} {}", printable(&value)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::{Description, Film};
    use crate::job::output::{write_animation, write_image};

    #[test]
    fn animated_png_has_frames_and_a_rate() {
        let directory = tempfile::tempdir().unwrap();
        let mut recipe = Recipe::find("three-spheres").unwrap();
        (recipe.settings.width, recipe.settings.height) = (4, 3);
        let mut description = Description::new(&file::to_picture_toml(&recipe));
        description.set(key::SAMPLES, 6);
        let [still, turn] = ["still.png", "turn.png"].map(|name| directory.path().join(name));
        let mut film = Film::new(4, 3, 1);
        film.record(0..1, 0).unwrap();
        write_image(&still, &film, recipe.rules.transfer, &description).unwrap();
        let info = Info::of(&still).unwrap();
        assert_eq!((info.kind, info.frames), ("picture", None));
        for (rate, words) in [
            (FrameRate { frames: 30, seconds: 1 }, "30 frames per second"),
            (FrameRate { frames: 30_000, seconds: 1001 }, "29.97003 frames per second"),
        ] {
            write_animation(&turn, [4, 3], rate, vec![still.clone(); 5].into_iter(), &description).unwrap();
            let info = Info::of(&turn).unwrap();
            assert_eq!((info.kind, info.frames.as_deref()), ("animation", Some("0..5")));
            assert_eq!(info.frames_per_second, Some(rate.per_second()));
            let text = info.to_string();
            assert!(text.starts_with("animation ") && text.contains(" of the frames 0..5"), "{text}");
            assert!(text.contains(words), "{text}");
        }
    }
}
