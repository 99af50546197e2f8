//! The measurements as text of at most 100 columns.

use super::figures::{BenchFigures, Row, ScaleFigures, SceneFigures};
use super::machine::counted;

/// Longest name of a row.
const NAME_WIDTH: usize = 34;

/// All tables and warnings as text.
pub fn text(figures: &BenchFigures) -> String {
    let mut lines = vec![figures.machine.words()];
    for scene in &figures.scenes {
        lines.push(String::new());
        lines.extend(scene_lines(scene));
    }
    if !figures.scale.is_empty() {
        lines.push(String::new());
        lines.extend(scale_lines(&figures.scale));
    }
    if figures.interrupted {
        lines.push(String::new());
        lines.push("Interrupted: only the runs finished so far are shown.".to_owned());
    }
    if !figures.warnings.is_empty() {
        lines.push(String::new());
        lines.extend(figures.warnings.iter().map(|warning| format!("warning: {warning}")));
    }
    lines.push(String::new());
    lines.join("\n")
}

fn scene_lines(scene: &SceneFigures) -> Vec<String> {
    let SceneFigures { scene: name, width, height, max_depth, sampler, spheres, .. } = scene;
    let title =
        format!("{name}, {width}x{height}, depth {max_depth}, {sampler}, {}", counted(*spheres, "sphere"));
    let runs = scene.rows.iter().map(|row| row.runs.len()).max().unwrap_or(0);
    let of_runs = if runs == 1 { "1 run".to_owned() } else { format!("medians of {runs} runs") };
    let mut lines = vec![format!("{title}; {of_runs}")];
    let heads = ["spp", "Mpaths/s", "min", "max", "x C89", "Mrays/s", "lanes %", "1/(MSE s)"];
    lines.push(line("", &heads.map(str::to_owned)));
    lines.extend(scene.rows.iter().map(row_line));
    lines
}

fn row_line(row: &Row) -> String {
    if let (Some(reason), true) = (&row.skipped, row.runs.is_empty()) {
        return format!("{:NAME_WIDTH$} skipped: {reason}", shortened(&row.name));
    }
    let dash = || "-".to_owned();
    let millions = |number: f64| format!("{:.*}", if number < 1e8 { 2 } else { 1 }, number / 1e6);
    let paths = |part: fn(super::figures::Spread) -> f64| {
        row.paths_per_second.map_or_else(dash, |spread| millions(part(spread)))
    };
    line(
        &row.name,
        &[
            row.samples_per_pixel.to_string(),
            paths(|spread| spread.median),
            paths(|spread| spread.min),
            paths(|spread| spread.max),
            row.ratio_to_baseline.map_or_else(dash, |ratio| format!("{ratio:.2}")),
            row.rays_per_second.map_or_else(dash, |spread| millions(spread.median)),
            row.lanes_in_use.map_or_else(dash, |share| format!("{:.1}", 100.0 * share)),
            row.efficiency.map_or_else(dash, |efficiency| format!("{efficiency:.2e}")),
        ],
    )
}

fn line(name: &str, cells: &[String; 8]) -> String {
    let widths = [5, 9, 8, 8, 7, 8, 8, 10];
    let cells = cells.iter().zip(widths).map(|(cell, width)| format!("{cell:>width$}"));
    format!("{:NAME_WIDTH$}{}", shortened(name), cells.collect::<String>())
}

fn shortened(name: &str) -> String {
    if name.chars().count() <= NAME_WIDTH {
        return name.to_owned();
    }
    let kept: String = name.chars().take(NAME_WIDTH - 3).collect();
    format!("{kept}...")
}

fn scale_lines(rows: &[ScaleFigures]) -> Vec<String> {
    let head = [
        "spheres",
        "generate s",
        "build s",
        "hierarchy s",
        "bytes",
        "peak MiB",
        "spp",
        "Mpaths/s",
        "Mrays/s",
    ];
    let widths = [9, 12, 10, 13, 8, 10, 6, 10, 10];
    let joined = |cells: [String; 9]| -> String {
        cells.iter().zip(widths).map(|(cell, width)| format!("{cell:>width$}")).collect()
    };
    let title = "Fields of spheres; bytes per sphere in the prepared scene, hierarchy included".to_owned();
    let mut lines = vec![title, joined(head.map(str::to_owned))];
    for row in rows {
        let dash = || "-".to_owned();
        let millions = |spread: Option<super::figures::Spread>| {
            spread.map_or_else(dash, |spread| format!("{:.2}", spread.median / 1e6))
        };
        lines.push(joined([
            row.spheres.to_string(),
            format!("{:.3}", row.generate_seconds),
            format!("{:.4}", row.build_seconds),
            format!("{:.4}", row.hierarchy_seconds),
            format!("{:.1}", row.table_bytes_per_sphere),
            row.peak_memory_bytes.map_or_else(dash, |bytes| (bytes >> 20).to_string()),
            row.samples_per_pixel.to_string(),
            millions(row.paths_per_second),
            millions(row.rays_per_second),
        ]));
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn peak_memory_is_in_mib() {
        let row = ScaleFigures {
            spheres: 1000,
            generate_seconds: 0.25,
            build_seconds: 0.5,
            hierarchy_seconds: 0.125,
            scene_bytes_per_sphere: 40.0,
            table_bytes_per_sphere: 96.5,
            peak_memory_bytes: Some(300 << 20),
            samples_per_pixel: 4,
            paths_per_second: None,
            rays_per_second: None,
        };
        let lines = scale_lines(&[row]);
        let cells: Vec<&str> = lines[2].split_whitespace().collect();
        assert_eq!(cells, ["1000", "0.250", "0.5000", "0.1250", "96.5", "300", "4", "-", "-"]);
    }
}
