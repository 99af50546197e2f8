//! `weekender info`: the metadata of a film, picture or scene file.

use crate::cli::InfoOptions;
use crate::cli::terminal::{print, write_json};
use crate::film::{CheckpointError, checkpoint, key};
use crate::job::recipe::{Recipe, file};
use crate::job::saved::Saved;
use crate::progressive::describe::{counted, seconds};
use crate::system::console::printable;
use crate::system::failure::Failure;
use crate::system::files::{STANDARD, ShownPath};
use crate::system::memory;
use serde_json::{Value, json};
use std::path::Path;
use std::process::ExitCode;

/// Version of the JSON. Incremented when a key is removed or changes meaning.
const SCHEMA: u32 = 1;

/// Prints the metadata of a file.
///
/// # Errors
/// [`Failure::Input`] if the file cannot be read or does not say how it was made; [`Failure::Run`] if standard output
/// cannot be written.
pub fn run(options: &InfoOptions) -> Result<ExitCode, Failure> {
    let info = Info::of(&options.file).map_err(Failure::Input)?;
    let printed = if options.json {
        write_json(&info.json, Path::new(STANDARD))
    } else {
        print(&info.text(&options.file))
    };
    printed.map(|()| ExitCode::SUCCESS).map_err(Failure::Run)
}

/// The metadata of a file.
struct Info {
    json: Value,
    /// The estimated error of a picture, or why a film has none.
    error: Option<String>,
    /// Reason why a picture is no longer a film.
    note: Option<String>,
}

impl Info {
    fn of(path: &Path) -> anyhow::Result<Info> {
        if path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("toml")) {
            let recipe = file::load(path)?;
            let samples = json!({ "samples_per_pixel": recipe.samples_per_pixel });
            return Ok(Info::new("scene", path, &recipe).with(samples));
        }
        let saved = Saved::describe(path)?;
        let text = |key| saved.description.get(key);
        let mut info = Info::new("picture", path, &saved.recipe()?).with(json!({
            "stage": text(key::STAGE),
            "samples_per_pixel": saved.samples(),
            "trace_seconds": saved.seconds(),
            "denoised": text(key::DENOISED),
            "backend": text(key::BACKEND),
            "program": text(key::SOFTWARE),
            "command": text(key::COMMAND),
        }));
        info.error = text(key::ERROR).map(str::to_owned);
        info.with_film(path)
    }

    fn new(kind: &str, path: &Path, recipe: &Recipe) -> Info {
        let settings = &recipe.settings;
        let json = json!({
            "schema": SCHEMA,
            "kind": kind,
            "file": path.to_string_lossy(),
            "bytes": std::fs::metadata(path).map_or(0, |found| found.len()),
            "scene": recipe.name,
            "width": settings.width,
            "height": settings.height,
            "max_depth": settings.max_depth,
            "sampler": settings.sampler.name(),
            "seed": settings.seed,
        });
        Info { json, error: None, note: None }
    }

    /// Replaces values by those of `more`.
    fn with(mut self, mut more: Value) -> Info {
        if let (Some(own), Some(more)) = (self.json.as_object_mut(), more.as_object_mut()) {
            own.append(more);
        }
        self
    }

    /// Adds the metadata of a film and, if there is memory for its sums, its error.
    fn with_film(self, path: &Path) -> anyhow::Result<Info> {
        let head = match checkpoint::read_head(path) {
            Err(CheckpointError::NotExr { .. } | CheckpointError::NotFilm { .. }) => return Ok(self),
            Err(error @ CheckpointError::Resaved { .. }) => {
                return Ok(Info { note: Some(error.to_string()), ..self });
            }
            head => head?,
        };
        let (estimate, error) = match checkpoint::load(path) {
            Ok(read) => match read.film.error() {
                Some(error) => (Some(error), error.words()),
                None => (None, format!("not estimated: {}", read.film.why_no_error())),
            },
            Err(CheckpointError::Memory { reason, .. }) => (None, reason.to_string()),
            Err(error) => return Err(error.into()),
        };
        let info = self.with(json!({
            "kind": "film",
            "samples_per_pixel": head.samples.count(),
            "sample_ranges": head.samples.to_string(),
            "halves": head.halves,
            "rejected_samples": head.rejected,
            "film_version": checkpoint::VERSION,
            "sample_version": checkpoint::SAMPLE_VERSION,
            "rmse_estimate": estimate.map(|error| error.rmse),
            "rmse_deviation": estimate.map(|error| error.rmse_deviation),
        }));
        Ok(Info { error: Some(error), ..info })
    }

    /// One line per entry.
    fn text(&self, path: &Path) -> String {
        let text = |key: &str| match &self.json[key] {
            Value::Null => None,
            Value::String(text) => Some(text.clone()),
            other => Some(other.to_string()),
        };
        let number = |key: &str| self.json[key].as_u64();
        let [scene, width, height, depth, sampler, seed] =
            ["scene", "width", "height", "max_depth", "sampler", "seed"]
                .map(|key| text(key).unwrap_or_default());
        let size = memory::words(number("bytes").unwrap_or_default());
        let samples = [
            text("samples_per_pixel").map(|samples| format!("{samples} per pixel")),
            text("sample_ranges").map(|ranges| format!("samples {ranges}")),
            text("sample_version").map(|version| format!("version {version}")),
            number("rejected_samples").map(|count| counted(count, "rejected sample")),
        ];
        let film = text("film_version").map_or_else(String::new, |version| format!(", version {version}"));
        let kind = text("kind").unwrap_or_default();
        let time = self.json["trace_seconds"].as_f64();
        let lines = [
            (kind.as_str(), Some(format!("{}, {size}{film}", path.shown()))),
            ("scene", Some(format!("{scene}, {width}x{height}, depth {depth}, {sampler}, seed {seed}"))),
            ("stage", text("stage")),
            ("samples", Some(samples.into_iter().flatten().collect::<Vec<_>>().join(", "))),
            ("error", self.error.clone()),
            ("time", time.map(|time| format!("{} of tracing", seconds(time)))),
            ("denoised", text("denoised")),
            ("backend", text("backend")),
            ("program", text("program")),
            ("command", text("command")),
            ("note", self.note.clone()),
        ];
        let lines = lines.into_iter().filter_map(|(name, value)| Some((name, value?)));
        lines.map(|(name, value)| format!("{name:<8} {}\n", printable(&value))).collect()
    }
}
