//! `weekender info`: what a film, picture, scene file or plan says about itself.

use crate::cli::{InfoOptions, JsonTarget};
use crate::console::printable;
use crate::describe::{counted, seconds};
use crate::failure::Failure;
use crate::files::ShownPath;
use crate::film::{CheckpointError, ErrorEstimate, FilmHead, checkpoint, key};
use crate::memory;
use crate::output::{FrameRate, animation_in};
use crate::plan::{AnyPlan, Frames, Plan, Samples, Work};
use crate::recipe::{Recipe, file};
use crate::saved::Saved;
use crate::terminal::{print, write_json};
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
    let info = Info::of(&options.file)?;
    let printed =
        if options.json { write_json(&info, &JsonTarget::StandardOutput) } else { print(&info.to_string()) };
    printed.map(|()| ExitCode::SUCCESS).map_err(Failure::Run)
}

/// What a file says about itself.
#[derive(Debug, Serialize)]
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
    error_words: Option<String>,
    /// The number of frames of an animated PNG.
    #[serde(skip)]
    frame_count: Option<u32>,
}

impl Info {
    fn of(path: &Path) -> Result<Info, Failure> {
        if AnyPlan::is_at(path) || path.is_dir() {
            return Ok(match AnyPlan::load(path).map_err(Failure::input)? {
                AnyPlan::Samples(plan) => Info::of_samples(&plan),
                AnyPlan::Frames(plan) => Info::of_frames(&plan),
            });
        }
        if path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("toml")) {
            let recipe = file::load(path).map_err(Failure::input)?;
            let samples = Some(recipe.samples_per_pixel);
            return Ok(Info { samples_per_pixel: samples, ..Info::new("scene", path, &recipe) });
        }
        let saved = Saved::describe(path).map_err(Failure::input)?;
        let recipe = saved.recipe().map_err(Failure::input)?;
        let text = |key| saved.description.get(key).map(str::to_owned);
        let mut info = Info {
            stage: text(key::STAGE),
            samples_per_pixel: saved.samples(),
            trace_seconds: saved.seconds(),
            backend: text(key::BACKEND),
            program: text(key::SOFTWARE),
            command: text(key::COMMAND),
            ..Info::new("picture", path, &recipe)
        };
        if let Some((count, rate)) = animation_in(path) {
            (info.kind, info.frame_count) = ("animation", Some(count));
            info.frames = Some(format!("0..{count}"));
            info.frames_per_second = rate.map(FrameRate::per_second);
        }
        match checkpoint::read_head(path) {
            Ok(head) => info.add_film(path, &head).map_err(Failure::input)?,
            Err(CheckpointError::NotExr { .. } | CheckpointError::NotFilm { .. }) => {}
            Err(error) => return Err(Failure::input(error)),
        }
        Ok(info)
    }

    fn new(kind: &'static str, path: &Path, recipe: &Recipe) -> Info {
        let settings = &recipe.settings;
        Info {
            schema: SCHEMA,
            kind,
            file: path.to_string_lossy().into_owned(),
            bytes: std::fs::metadata(path).map_or(0, |found| found.len()),
            scene: recipe.name.clone(),
            stage: None,
            width: settings.width,
            height: settings.height,
            max_depth: settings.max_depth,
            sampler: settings.sampler.name(),
            seed: settings.seed,
            samples_per_pixel: None,
            sample_ranges: None,
            halves: None,
            rejected_samples: None,
            rmse_estimate: None,
            rmse_deviation: None,
            trace_seconds: None,
            backend: None,
            program: None,
            film_version: None,
            sample_version: None,
            frames: None,
            frames_per_second: None,
            parts: None,
            command: None,
            error_words: None,
            frame_count: None,
        }
    }

    fn of_samples(plan: &Plan<Samples>) -> Info {
        let [start, end] = plan.manifest.work.samples;
        Info {
            samples_per_pixel: Some(end - start),
            sample_ranges: Some(format!("{start}..{end}")),
            halves: Some(plan.job.settings().half_count()),
            ..Info::of_plan(plan)
        }
    }

    fn of_frames(plan: &Plan<Frames>) -> Info {
        let [start, end] = plan.manifest.work.frames;
        Info {
            samples_per_pixel: Some(plan.recipe.samples_per_pixel),
            frames: Some(format!("{start}..{end}")),
            ..Info::of_plan(plan)
        }
    }

    fn of_plan<W: Work>(plan: &Plan<W>) -> Info {
        let manifest = &plan.manifest;
        Info {
            stage: manifest.stage.clone(),
            program: Some(manifest.program.clone()),
            sample_version: Some(manifest.sample_version),
            parts: Some(manifest.work.count()),
            command: Some(manifest.command.clone()),
            ..Info::new("plan", &plan.path, &plan.recipe)
        }
    }

    /// Adds what a film's head says, and the error that its sums tell, if there is memory for them.
    fn add_film(&mut self, path: &Path, head: &FilmHead) -> Result<(), CheckpointError> {
        self.kind = "film";
        self.samples_per_pixel = Some(head.samples.count());
        self.sample_ranges = Some(head.samples.to_string());
        (self.halves, self.rejected_samples) = (Some(head.halves), Some(head.rejected));
        (self.film_version, self.sample_version) =
            (Some(checkpoint::VERSION), Some(checkpoint::SAMPLE_VERSION));
        match checkpoint::load(path) {
            Ok(read) => {
                let error: Option<ErrorEstimate> = read.film.error();
                (self.rmse_estimate, self.rmse_deviation) =
                    (error.map(|error| error.rmse), error.map(|error| error.rmse_deviation));
                let unknown = || format!("not estimated: {}", read.film.why_no_error());
                self.error_words = Some(error.map_or_else(unknown, |error| error.words()));
            }
            Err(CheckpointError::Memory { reason, .. }) => self.error_words = Some(reason.to_string()),
            Err(error) => return Err(error),
        }
        Ok(())
    }
}

impl fmt::Display for Info {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:<8} {}, {}", self.kind, self.file.shown(), memory::words(self.bytes))?;
        if let Some(version) = self.film_version {
            write!(f, ", version {version}")?;
        }
        let Info { scene, width, height, max_depth, sampler, seed, .. } = self;
        let scene = printable(scene);
        writeln!(f, "\nscene    {scene}, {width}x{height}, depth {max_depth}, {sampler}, seed {seed}")?;
        if let Some(stage) = &self.stage {
            writeln!(f, "stage    {}", printable(stage))?;
        }
        if let Some(samples) = self.samples_per_pixel {
            write!(f, "samples  {samples} per pixel")?;
            if let Some(ranges) = &self.sample_ranges {
                write!(f, " ({ranges})")?;
            }
            match (&self.frames, self.frame_count) {
                (_, Some(count)) => write!(f, " of each of {}", counted(u64::from(count), "frame"))?,
                (Some(frames), None) => write!(f, " of the frames {frames}")?,
                (None, None) => {}
            }
            if let Some(rate) = self.frames_per_second {
                write!(f, ", {} frames per second", (rate * 1e5).round() / 1e5)?;
            }
            if let Some(parts) = self.parts {
                write!(f, " in {}", counted(parts as u64, "part"))?;
            }
            if let Some(version) = self.sample_version {
                write!(f, ", version {version}")?;
            }
            if let Some(rejected) = self.rejected_samples {
                write!(f, ", {}", counted(rejected, "rejected sample"))?;
            }
            writeln!(f)?;
        }
        if self.kind == "film" {
            writeln!(f, "error    {}", self.error_words.as_deref().unwrap_or("not estimated"))?;
        }
        let lines = [
            ("time", self.trace_seconds.map(|time| format!("{} of tracing", seconds(time)))),
            ("backend", self.backend.clone()),
            ("program", self.program.clone()),
            ("command", self.command.clone()),
        ];
        for (name, value) in lines {
            if let Some(value) = value {
                writeln!(f, "{name:<9}{}", printable(&value))?;
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::animation::Turn;
    use crate::film::{Description, Film};
    use crate::output::{write_animation, write_image};
    use crate::plan::{Manifest, divide};

    /// What is told of a plan that divides `work` of a small picture with 6 samples per pixel.
    fn told<W: Work>(work: W, estimate_error: bool) -> (Info, String) {
        let directory = tempfile::tempdir().unwrap();
        let mut recipe = Recipe::find("three-spheres").unwrap();
        (recipe.settings.width, recipe.settings.height, recipe.samples_per_pixel) = (16, 9, 6);
        recipe.settings.estimate_error = estimate_error;
        let manifest = Manifest {
            command: "weekender plan".to_owned(),
            scene: recipe.name.clone(),
            ..Manifest::new(work)
        };
        Plan::write(directory.path(), &recipe, &recipe.job().unwrap(), manifest).unwrap();
        let info = Info::of(directory.path()).unwrap();
        let text = info.to_string();
        (info, text)
    }

    #[test]
    fn a_plan_has_the_samples_of_its_range_wherever_that_begins() {
        for (range, parts, estimate_error, words) in [
            (7..50, 2, true, "samples  43 per pixel (7..50) in 2 parts"),
            (0..50, 1, false, "samples  50 per pixel (0..50) in 1 part"),
            (4096..4097, 1, true, "samples  1 per pixel (4096..4097) in 1 part"),
        ] {
            let division = divide(range.clone(), parts).unwrap();
            let (info, text) = told(Samples::new(&range, &division), estimate_error);
            assert_eq!(info.samples_per_pixel, Some(range.end - range.start));
            assert_eq!(info.halves, Some(if estimate_error { 2 } else { 1 }));
            assert!(text.contains(words) && text.contains("three-spheres, 16x9, "), "{text}");
        }
    }

    #[test]
    fn an_animated_png_has_frames_and_a_rate_and_a_still_has_none() {
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
            assert!(text.starts_with("animation ") && text.contains(" of each of 5 frames"), "{text}");
            assert!(text.contains(words), "{text}");
        }
    }

    #[test]
    fn a_plan_of_frames_has_the_samples_of_each_frame() {
        let rate = FrameRate { frames: 30, seconds: 1 };
        let work = Frames::new(&(5..9), Some(Turn::FramesPerTurn(12)), rate, 2).unwrap();
        let (info, text) = told(work, true);
        assert_eq!((info.samples_per_pixel, info.parts), (Some(6), Some(2)));
        assert!(text.contains("samples  6 per pixel of the frames 5..9 in 2 parts"), "{text}");
    }
}
