//! The measurements as text of at most 100 columns.

use super::figures::{BenchFigures, DeviceFigures, GainRow, Row, ScaleFigures, SceneFigures, Spread};
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
    for device in &figures.features {
        lines.push(String::new());
        lines.extend(device_lines(device));
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
    let paths =
        |part: fn(Spread) -> f64| row.paths_per_second.map_or_else(dash, |spread| millions(part(spread)));
    line(
        &row.name,
        &[
            row.samples_per_pixel.to_string(),
            paths(|spread| spread.median),
            paths(|spread| spread.min),
            paths(|spread| spread.max),
            row.ratio_to_baseline.map_or_else(dash, short),
            row.rays_per_second.map_or_else(dash, |spread| millions(spread.median)),
            row.lanes_in_use.map_or_else(dash, |share| format!("{:.1}", 100.0 * share)),
            row.efficiency.map_or_else(dash, |efficiency| format!("{efficiency:.2e}")),
        ],
    )
}

fn millions(number: f64) -> String {
    short(number / 1e6)
}

/// A number with at least three digits, in at most five characters below 100,000.
fn short(number: f64) -> String {
    let decimals = if number < 100.0 {
        2
    } else if number < 1000.0 {
        1
    } else {
        0
    };
    format!("{number:.decimals$}")
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
        let millions =
            |spread: Option<Spread>| spread.map_or_else(dash, |spread| format!("{:.2}", spread.median / 1e6));
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

/// Longest line of a table.
const TEXT_WIDTH: usize = 100;

fn device_lines(device: &DeviceFigures) -> Vec<String> {
    let DeviceFigures { device: name, rows, skipped } = device;
    if let Some(reason) = skipped {
        return vec![format!("{name} skipped: {reason}")];
    }
    let runs = rows.iter().map(|row| row.own_runs.len()).max().unwrap_or(0);
    let runs = counted(runs, "pair");
    let mut lines = vec![
        format!("Each scene's own kernel and the general one, {name}; {runs} of runs"),
        gain_line("", ["size", "spp", "Mpaths/s", "general", "gain", "min", "max"].map(str::to_owned)),
    ];
    for (is_stage, heading) in [(true, "stages of the book"), (false, "scenes")] {
        let group: Vec<&GainRow> = rows.iter().filter(|row| row.is_stage == is_stage).collect();
        if !group.is_empty() {
            lines.push(format!("-- {heading}"));
            lines.extend(group.into_iter().flat_map(gain_lines));
        }
    }
    lines
}

fn gain_lines(row: &GainRow) -> Vec<String> {
    if let (Some(reason), None) = (&row.skipped, row.gain) {
        return vec![format!("{} skipped: {reason}", row.name)];
    }
    let dash = || "-".to_owned();
    let speed = |spread: Option<Spread>| spread.map_or_else(dash, |spread| millions(spread.median));
    let gain = |part: fn(Spread) -> f64| row.gain.map_or_else(dash, |spread| format!("{:.2}", part(spread)));
    let mut lines = vec![gain_line(
        &row.name,
        [
            format!("{}x{}", row.width, row.height),
            row.samples_per_pixel.to_string(),
            speed(row.own_paths_per_second),
            speed(row.general_paths_per_second),
            gain(|spread| spread.median),
            gain(|spread| spread.min),
            gain(|spread| spread.max),
        ],
    )];
    let left_out = if row.left_out.is_empty() { "nothing".to_owned() } else { row.left_out.join(", ") };
    let [kernel, left_out] = [format!("kernel: {}", row.kernel), format!("left out: {left_out}")];
    let together = format!("    {kernel}; {left_out}");
    if together.chars().count() <= TEXT_WIDTH {
        lines.push(together);
    } else {
        lines.extend([format!("    {kernel}"), format!("    {left_out}")]);
    }
    if row.same_bits == Some(false) {
        lines.push("    the films differ".to_owned());
    }
    lines
}

fn gain_line(name: &str, cells: [String; 7]) -> String {
    let widths = [10, 11, 11, 10, 8, 8, 8];
    let cells = cells.iter().zip(widths).map(|(cell, width)| format!("{cell:>width$}"));
    format!("{:NAME_WIDTH$}{}", shortened(name), cells.collect::<String>())
}

#[cfg(test)]
mod tests {
    use super::super::figures::{Kind, Run};
    use super::super::machine::Machine;
    use super::*;

    fn run(seconds: f64) -> Run {
        Run { seconds, paths: 6_000_000, rays: 1, busy_lanes: 1, offered_lanes: 1, rmse: None }
    }

    fn row() -> GainRow {
        let mut row = GainRow {
            name: "three-spheres".to_owned(),
            is_stage: true,
            width: 200,
            height: 113,
            samples_per_pixel: 256,
            kernel: "glass".to_owned(),
            left_out: vec!["lens", "extremes"],
            own_runs: vec![run(0.25), run(0.1), run(0.2)],
            general_runs: vec![run(0.25), run(0.3), run(0.4)],
            same_bits: Some(true),
            ..GainRow::default()
        };
        row.sum_up();
        row
    }

    #[test]
    fn gains_are_those_of_pairs() {
        let device = DeviceFigures { device: "avx2".to_owned(), rows: vec![row()], skipped: None };
        assert_eq!(
            device_lines(&device),
            [
                "Each scene's own kernel and the general one, avx2; 3 pairs of runs",
                "                                        size        spp   Mpaths/s   general    gain     min     max",
                "-- stages of the book",
                "three-spheres                        200x113        256      30.00     20.00    2.00    1.00    3.00",
                "    kernel: glass; left out: lens, extremes",
            ]
        );
    }

    #[test]
    fn a_row_says_what_went_wrong() {
        let differing = GainRow { same_bits: Some(false), left_out: Vec::new(), ..row() };
        let lines = gain_lines(&differing);
        assert_eq!(lines[1..], ["    kernel: glass; left out: nothing", "    the films differ"]);
        let failed = GainRow {
            name: "book".to_owned(),
            skipped: Some("out of memory".to_owned()),
            ..GainRow::default()
        };
        assert_eq!(gain_lines(&failed), ["book skipped: out of memory"]);
        let device = DeviceFigures {
            device: "GPU".to_owned(),
            rows: Vec::new(),
            skipped: Some("no graphics adapter was found".to_owned()),
        };
        assert_eq!(device_lines(&device), ["GPU skipped: no graphics adapter was found"]);
    }

    #[test]
    fn long_words_take_two_lines() {
        let words = vec!["anchored", "eye on a surface", "cavity", "specks", "steep glass", "hierarchy"];
        let kernel = "lambertian, metal, fuzz, glass, two roots, 5 spheres in constants".to_owned();
        let lines = gain_lines(&GainRow { kernel, left_out: words, ..row() });
        assert_eq!(lines.len(), 3);
        assert!(lines[2].starts_with("    left out: anchored"), "{lines:?}");
        assert!(lines.iter().all(|line| line.chars().count() <= TEXT_WIDTH), "{lines:?}");
    }

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
        assert_eq!(
            scale_lines(&[row])[1..],
            [
                "  spheres  generate s   build s  hierarchy s   bytes  peak MiB   spp  Mpaths/s   Mrays/s",
                "     1000       0.250    0.5000       0.1250    96.5       300     4         -         -",
            ]
        );
    }

    #[test]
    fn a_row_has_its_figures_in_the_columns_of_the_head() {
        let spread = |median: f64| Some(Spread { median, min: 0.5 * median, max: 3.0 * median });
        let row = Row {
            name: "avx2, 8 lanes".to_owned(),
            kind: Kind::Packets,
            lanes: 8,
            threads: 1,
            samples_per_pixel: 64,
            runs: vec![run(0.25)],
            paths_per_second: spread(2e6),
            rays_per_second: spread(250e6),
            lanes_in_use: Some(0.875),
            ratio_to_baseline: Some(7.0),
            efficiency: Some(1234.0),
            skipped: None,
        };
        let gpu = Row {
            paths_per_second: spread(12_514e6),
            rays_per_second: spread(38_866e6),
            ratio_to_baseline: Some(2696.52),
            ..row.clone()
        };
        let none = Row { paths_per_second: None, rays_per_second: None, ..row.clone() };
        let none = Row { lanes_in_use: None, ratio_to_baseline: None, efficiency: None, ..none };
        let scene = SceneFigures {
            scene: "book".to_owned(),
            width: 200,
            height: 113,
            max_depth: 50,
            sampler: "sobol",
            spheres: 485,
            rows: vec![row, gpu, none],
        };
        assert_eq!(
            scene_lines(&scene),
            [
                "book, 200x113, depth 50, sobol, 485 spheres; 1 run",
                "                                    spp Mpaths/s     min     max  x C89 Mrays/s lanes % 1/(MSE s)",
                "avx2, 8 lanes                        64     2.00    1.00    6.00   7.00   250.0    87.5    1.23e3",
                "avx2, 8 lanes                        64    12514    6257   37542   2697   38866    87.5    1.23e3",
                "avx2, 8 lanes                        64        -       -       -      -       -       -         -",
            ]
        );
    }

    #[test]
    fn an_interrupted_measurement_shows_what_it_has_and_its_warnings() {
        let row = Row {
            name: "a graphics card with a name of forty-two letters".to_owned(),
            kind: Kind::Gpu,
            lanes: 0,
            threads: 0,
            samples_per_pixel: 64,
            runs: vec![run(0.25), run(0.25)],
            paths_per_second: None,
            rays_per_second: None,
            lanes_in_use: None,
            ratio_to_baseline: None,
            efficiency: None,
            skipped: None,
        };
        let scene = SceneFigures {
            scene: "sky".to_owned(),
            width: 8,
            height: 4,
            max_depth: 50,
            sampler: "sobol",
            spheres: 1,
            rows: vec![row],
        };
        let machine = Machine {
            version: "1.2.3",
            processor: "a processor".to_owned(),
            cores: 1,
            levels: vec!["portable"],
            load_at_start: Some(0.25),
        };
        let figures = BenchFigures {
            schema: 1,
            machine,
            scenes: vec![scene],
            scale: Vec::new(),
            features: Vec::new(),
            warnings: vec!["the machine was busy".to_owned()],
            interrupted: true,
        };
        assert_eq!(
            text(&figures).split('\n').collect::<Vec<_>>(),
            [
                "Weekender 1.2.3, a processor, 1 thread, portable, load 0.25 at the start",
                "",
                "sky, 8x4, depth 50, sobol, 1 sphere; medians of 2 runs",
                "                                    spp Mpaths/s     min     max  x C89 Mrays/s lanes % 1/(MSE s)",
                "a graphics card with a name of ...   64        -       -       -      -       -       -         -",
                "",
                "Interrupted: only the runs finished so far are shown.",
                "",
                "warning: the machine was busy",
                "",
            ]
        );
    }
}
