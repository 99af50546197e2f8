//! The final figures of a run: lines for people, and the same figures as JSON.

use super::BatchOptions;
use super::picture::Rendered;
use crate::film::Film;
use crate::job::recipe::Recipe;
use crate::progressive::Phase;
use crate::progressive::describe::seconds;
use crate::system::console::printable;
use crate::system::memory;
use serde_json::{Value, json};
use std::fmt::Write;

/// A label, and pieces of the line after it. `{key}` in a piece stands for a figure; a piece that lacks one is left
/// out, and so is a line without pieces.
pub type Line = (&'static str, &'static [&'static str]);

/// The lines about `figures`, with their labels. Times and speeds have units.
pub fn lines(figures: &Value, lines: &[Line]) -> Vec<(&'static str, String)> {
    let filled = |piece: &&str| -> Option<String> {
        let mut parts = piece.split(['{', '}']);
        let mut text = parts.next()?.to_owned();
        while let (Some(key), Some(rest)) = (parts.next(), parts.next()) {
            text += &words(key, figures.pointer(&format!("/{key}"))?)?;
            text += rest;
        }
        Some(text)
    };
    let line = |(label, pieces): &Line| (*label, pieces.iter().filter_map(filled).collect::<String>());
    lines.iter().map(line).filter(|(_, text)| !text.is_empty()).collect()
}

/// A figure in words; `None` if there is none.
fn words(key: &str, value: &Value) -> Option<String> {
    Some(match (value, value.as_f64()) {
        (Value::Null, _) => return None,
        (Value::String(text), _) if key == "ended_by" => text.replace('_', " "),
        (Value::String(text), _) => printable(text).into_owned(),
        (Value::Array(list), _) if list.is_empty() => return None,
        (Value::Array(list), _) => {
            list.iter().filter_map(|item| words(key, item)).collect::<Vec<_>>().join(", ")
        }
        (_, Some(time)) if key.ends_with("_seconds") && time < 60.0 => format!("{time:.3} s"),
        (_, Some(time)) if key.ends_with("_seconds") => seconds(time),
        (_, Some(speed)) if key.ends_with("_per_second") => format!("{:.2} M", speed / 1e6),
        (_, Some(bytes)) if key == "bytes" => memory::words(bytes as u64),
        (_, Some(number)) if value.is_f64() && number != 0.0 && !(0.01..1e4).contains(&number.abs()) => {
            format!("{number:.2e}")
        }
        (_, Some(number)) if value.is_f64() => format!("{number:.3}"),
        _ => value.to_string(),
    })
}

/// Labelled lines in aligned columns.
pub fn aligned(lines: &[(&str, String)]) -> String {
    let width = lines.iter().map(|(label, _)| label.len()).max().unwrap_or(0) + 1;
    lines.iter().fold(String::new(), |mut text, (label, content)| {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{label:<width$} {content}");
        text
    })
}

/// The lines about a picture.
pub(super) const PICTURE: [Line; 10] = [
    ("scene", &["{scene}, {width}x{height}, depth {max_depth}, {sampler}, seed {seed}"]),
    ("backend", &["{backend} {device}, lanes {lanes}, threads {threads}"]),
    ("kernel", &["{kernel}"]),
    ("left out", &["{left_out}"]),
    ("samples", &["{samples_per_pixel} per pixel, {added_samples_per_pixel} of them new, end: {ended_by}"]),
    (
        "time",
        &[
            "{total_seconds} (prepare {prepare_seconds}, build hierarchy {hierarchy_seconds}, trace {trace_seconds}, \
           write {write_seconds})",
        ],
    ),
    (
        "speed",
        &["{paths_per_second}paths/s, {rays_per_second}rays/s", ", {lane_occupancy} of all lanes in use"],
    ),
    ("error", &["{error}, ", "rejected samples {rejected_samples}"]),
    ("denoised", &["{denoised}"]),
    ("files", &["{files}"]),
];

/// Time and quality of one picture. Times and counts are those of this run; samples per pixel, rejected samples and the
/// estimates are those of the film, including its earlier samples.
pub(super) fn figures(options: &BatchOptions, picture: &Rendered) -> Value {
    let Rendered { status, film, written, writing } = picture;
    let film = film.as_ref();
    let (backend, error) = (status.backend.as_ref(), status.error);
    let preparing = status.prepare.saturating_sub(status.hierarchy);
    let ended_by = match &status.phase {
        Phase::Done(reason) => json!(reason),
        Phase::Failed(_) => json!("failure"),
        _ => json!("nothing"),
    };
    let figures = json!({
        "stage": options.stage.map(|stage| stage.id),
        "backend": backend.map(|info| info.name),
        "device": backend.map(|info| &info.device),
        "lanes": backend.map(|info| info.lanes),
        "threads": backend.map(|info| info.threads),
        "kernel": status.kernel,
        "left_out": status.left_out,
        "samples_per_pixel": status.samples_per_pixel,
        "sample_ranges": film.map(|film| film.samples().to_string()).unwrap_or_default(),
        "added_samples_per_pixel": status.added(),
        "prepare_seconds": preparing.as_secs_f64(),
        "hierarchy_seconds": status.hierarchy.as_secs_f64(),
        "trace_seconds": status.trace.as_secs_f64(),
        "write_seconds": writing.as_secs_f64(),
        "total_seconds": (status.elapsed + *writing).as_secs_f64(),
        "paths": status.stats.paths,
        "rays": status.stats.rays,
        "paths_per_second": status.paths_per_second(),
        "rays_per_second": status.rays_per_second(),
        "lane_occupancy": status.lane_occupancy(),
        "error": film.map(Film::error_words),
        "rmse_estimate": error.map(|error| error.rmse),
        "rmse_deviation": error.map(|error| error.rmse_deviation),
        "rel_mse_estimate": error.map(|error| error.rel_mse),
        "denoised": written.denoised.map(|error| error.words()),
        "denoised_rmse_estimate": written.denoised.map(|error| error.rmse()),
        "denoised_rmse_deviation": written.denoised.map(|error| error.rmse_deviation()),
        "rejected_samples": status.rejected_samples,
        "ended_by": ended_by,
        "backends": status.contributions,
        "history": status.history,
        "warnings": status.messages,
        "files": written.files.iter().map(|file| file.to_string_lossy()).collect::<Vec<_>>(),
    });
    with_recipe(&options.recipe, figures)
}

/// Figures, with the name and the settings of their picture.
pub(super) fn with_recipe(recipe: &Recipe, mut figures: Value) -> Value {
    figures["scene"] = recipe.name.as_str().into();
    if let (Value::Object(figures), Value::Object(settings)) = (&mut figures, json!(recipe.settings)) {
        figures.extend(settings);
    }
    figures
}
