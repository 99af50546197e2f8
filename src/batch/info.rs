//! `weekender info`: the metadata of a film, picture or scene file.

use super::summary::with_recipe;
use super::{Line, SCHEMA, aligned, lines};
use crate::film::{CheckpointError, FilmFile, FilmHead, checkpoint, key};
use crate::job::saved::{self, Kind};
use crate::system::failure::Failure;
use crate::system::files::STANDARD;
use crate::system::terminal::{print, write_figures};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

const LINES: [Line; 11] = [
    ("file", &["{kind} {file}, {bytes}", ", version {film_version}"]),
    ("scene", &["{scene}, {width}x{height}, depth {max_depth}, {sampler}, seed {seed}"]),
    ("stage", &["{stage}"]),
    (
        "samples",
        &[
            "{samples_per_pixel} per pixel",
            ", samples {sample_ranges}",
            ", version {sample_version}",
            ", {rejected_samples} rejected",
        ],
    ),
    ("error", &["{error}"]),
    ("time", &["{trace_seconds} of tracing"]),
    ("denoised", &["{denoised}"]),
    ("backend", &["{backend}"]),
    ("program", &["{program}"]),
    ("command", &["{command}"]),
    ("note", &["{note}"]),
];

/// Options of `weekender info`.
#[derive(Clone, Debug, clap::Args)]
pub struct InfoOptions {
    /// A film, picture or scene file
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
    /// Print it as JSON
    #[arg(long)]
    pub json: bool,
}

/// Prints the metadata of a file.
///
/// # Errors
/// [`Failure::Input`] if the file cannot be read or does not say how it was made; [`Failure::Run`] if standard output
/// cannot be written.
pub fn run(options: &InfoOptions) -> Result<ExitCode, Failure> {
    let figures = figures(&options.file).map_err(Failure::Input)?;
    let printed = if options.json {
        write_figures(SCHEMA, &figures, Path::new(STANDARD))
    } else {
        print(&aligned(&lines(&figures, &LINES)))
    };
    printed.map(|()| ExitCode::SUCCESS).map_err(Failure::Run)
}

fn figures(path: &Path) -> anyhow::Result<Value> {
    let saved = saved::open(path)?;
    let (kind, head, samples) = match &saved.kind {
        Kind::Scene => ("scene", None, Some(saved.recipe.samples_per_pixel)),
        Kind::Picture(_) => ("picture", None, saved.samples()),
        Kind::Film(head) => ("film", Some(head), Some(head.samples.count())),
    };
    // A film's error needs memory for its sums.
    let (estimate, error) = match head.map(|_| checkpoint::load(path)) {
        None => (None, None),
        Some(Ok(FilmFile { film, .. })) => (film.error(), Some(film.error_words())),
        Some(Err(CheckpointError::Memory { reason, .. })) => (None, Some(reason.to_string())),
        Some(Err(error)) => return Err(error.into()),
    };
    let of_film = |value: fn(&FilmHead) -> Value| head.map(value);
    let unread = checkpoint::read_head(path).err();
    let resaved = unread.filter(|error| matches!(error, CheckpointError::Resaved { .. }));
    let figures = json!({
        "kind": kind,
        "file": path.to_string_lossy(),
        "bytes": std::fs::metadata(path).map_or(0, |found| found.len()),
        "stage": saved.kind.text(key::STAGE),
        "samples_per_pixel": samples,
        "sample_ranges": of_film(|head| head.samples.to_string().into()),
        "rejected_samples": of_film(|head| head.rejected.into()),
        "film_version": of_film(|_| checkpoint::VERSION.into()),
        "sample_version": of_film(|_| checkpoint::SAMPLE_VERSION.into()),
        "error": error,
        "rmse_estimate": estimate.map(|error| error.rmse),
        "rmse_deviation": estimate.map(|error| error.rmse_deviation),
        "trace_seconds": saved.seconds(),
        "denoised": saved.kind.text(key::DENOISED),
        "backend": saved.kind.text(key::BACKEND),
        "program": saved.kind.text(key::SOFTWARE),
        "command": saved.kind.text(key::COMMAND),
        "note": resaved.map(|error| error.to_string()),
    });
    Ok(with_recipe(&saved.recipe, figures))
}
