//! The measurements as text of at most 100 columns.

use super::super::machine::Machine;
use super::super::table::{counted, or_dash, text_row};
use super::figures::{BenchFigures, Row, SceneFigures, Spread};
use crate::job::render::RenderSettings;

/// Longest name of a row.
const NAME_WIDTH: usize = 34;

const SCENE_WIDTHS: [i32; 9] = [-33, 5, 8, 7, 7, 6, 7, 7, 9];

pub fn text(machine: &Machine, figures: &BenchFigures) -> String {
    let mut parts = vec![machine.words() + "\n"];
    parts.extend(figures.scenes.iter().map(scene));
    if figures.interrupted {
        parts.push("Interrupted: only the runs finished so far are shown.\n".to_owned());
    }
    if !figures.warnings.is_empty() {
        parts.push(figures.warnings.iter().map(|warning| format!("warning: {warning}\n")).collect());
    }
    parts.join("\n")
}

fn scene(scene: &SceneFigures) -> String {
    let SceneFigures { scene: name, settings, spheres, rows } = scene;
    let RenderSettings { width, height, max_depth, sampler, .. } = settings;
    let (sampler, spheres) = (sampler.name(), counted(*spheres, "sphere"));
    let runs = counted(rows.iter().map(|row| row.runs.len()).max().unwrap_or(0), "run");
    let heads = ["", "spp", "Mpaths/s", "min", "max", "x C89", "Mrays/s", "lanes %", "1/(MSE s)"];
    format!(
        "{name}, {width}x{height}, depth {max_depth}, {sampler}, {spheres}; medians of {runs}\n{}{}",
        text_row(&SCENE_WIDTHS, &heads),
        rows.iter().map(scene_row).collect::<String>()
    )
}

fn scene_row(row: &Row) -> String {
    if let (Some(reason), true) = (&row.skipped, row.runs.is_empty()) {
        return format!("{:.NAME_WIDTH$} skipped: {reason}\n", row.name);
    }
    let cells = [
        format!("{:.NAME_WIDTH$}", row.name),
        row.samples_per_pixel.to_string(),
        millions(row.paths_per_second, |spread| spread.median),
        millions(row.paths_per_second, |spread| spread.min),
        millions(row.paths_per_second, |spread| spread.max),
        or_dash(row.ratio_to_baseline, short),
        millions(row.rays_per_second, |spread| spread.median),
        or_dash(row.lanes_in_use, |share| format!("{:.1}", 100.0 * share)),
        or_dash(row.efficiency, |efficiency| format!("{efficiency:.2e}")),
    ];
    text_row(&SCENE_WIDTHS, &cells)
}

fn millions(spread: Option<Spread>, part: fn(Spread) -> f64) -> String {
    or_dash(spread, |spread| short(part(spread) / 1e6))
}

/// At least three digits, in at most five characters below 100,000.
fn short(number: f64) -> String {
    let decimals = match number {
        ..100.0 => 2,
        ..1000.0 => 1,
        _ => 0,
    };
    format!("{number:.decimals$}")
}
