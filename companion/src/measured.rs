//! Tables and charts of stored measurements, each with its command and machine.

use crate::library::{FOLDER, Fault, Library};
use crate::uses::Uses;
use crate::words::{code_words, numbered};
use anyhow::{Context, Result, ensure};
use maud::{Markup, PreEscaped, html};
use serde::Deserialize;
use serde_json::Value;
use std::collections::BTreeMap;
use weekender::measure;
use weekender::measure::report::{self, CurveSummary};
use weekender::numbers::chart::{self, UNTITLED_TOP};

/// Lists the stored measurements.
const FILE: &str = "docs/companion/measured.toml";

/// Name of the benchmark among the measurements.
const BENCH: &str = "speed";

/// Name of the measurement of error against time, which also has a chart.
const REPORT: &str = "error";

/// Errors to give times for.
const TARGETS: [f64; 2] = [0.01, 0.001];

/// A stored measurement and its origin.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Kept {
    /// Its file in `docs/companion`.
    file: String,
    /// The command that produces such a file.
    command: String,
    /// The day of the measurement.
    date: String,
    /// The machine as its owner describes it, and the compiler of the C program.
    system: String,
    compiler: Option<String>,
    /// Warm-ups and runs of each row.
    method: String,
    #[serde(skip)]
    json: Value,
}

/// All measurements by name.
#[derive(Clone, Debug, Default)]
pub struct Measured(BTreeMap<String, Kept>);

impl Measured {
    pub fn read(library: &Library) -> Result<Self, Fault> {
        let mut kept: BTreeMap<String, Kept> = library.toml(FILE)?;
        for kept in kept.values_mut() {
            let file = format!("{FOLDER}/{}", kept.file);
            kept.json = serde_json::from_str(&library.read(&file)?)
                .map_err(|error| Fault::new(&file, error.line(), error))?;
        }
        Ok(Measured(kept))
    }

    /// A text with its `{{value DIGITS VALUE}}` and `{{value DIGITS VALUE over VALUE}}` as numbers. A value is a number,
    /// or the name of a measurement and keys of its JSON with slashes between; an item of an array has its `name` or
    /// `scene` as the key. An error comes with its position.
    pub fn filled(&self, text: &str) -> Result<String, (usize, anyhow::Error)> {
        let (mut filled, mut rest) = (String::new(), text);
        while let Some((before, after)) = rest.split_once("{{value ") {
            filled.push_str(before);
            let at = text.len() - after.len();
            let (wanted, after) = after.split_once("}}").unwrap_or((after, ""));
            filled += &self.number(wanted).map_err(|error| (at, error))?;
            rest = after;
        }
        Ok(filled + rest)
    }

    fn number(&self, wanted: &str) -> Result<String> {
        let (count, wanted) = wanted.split_once(' ').context("give the number of digits and the value")?;
        let (above, below) = wanted.split_once(" over ").unwrap_or((wanted, "1"));
        Ok(digits(self.value(above)? / self.value(below)?, count.parse()?))
    }

    fn value(&self, path: &str) -> Result<f64> {
        if let Ok(number) = path.parse() {
            return Ok(number);
        }
        let (name, keys) = path.split_once('/').unwrap_or((path, ""));
        let is = |item: &&Value, key: &str| ["name", "scene"].iter().any(|field| item[*field] == key);
        let found = keys.split('/').try_fold(&self.find(name)?.json, |at, key| match at {
            Value::Array(items) => items.iter().find(|item| is(item, key)),
            at => at.get(key),
        });
        found.and_then(Value::as_f64).with_context(|| format!("{path} is not a number in the measurements"))
    }

    /// The table with this name.
    pub fn table(&self, name: &str) -> Result<Markup> {
        let kept = self.find(name)?;
        match name {
            BENCH => speed_tables(kept),
            REPORT => error_table(kept),
            _ => comparison(kept),
        }
        .with_context(|| format!("{FOLDER}/{}", kept.file))
    }

    /// The chart with this name.
    pub fn chart(&self, name: &str, uses: &mut Uses) -> Result<Markup> {
        ensure!(name == REPORT, "there is no chart {name:?}; use {REPORT}");
        error_chart(self.find(name)?, uses)
    }

    fn find(&self, name: &str) -> Result<&Kept> {
        self.0.get(name).with_context(|| {
            let known: Vec<&str> = self.0.keys().map(String::as_str).collect();
            format!("there is no measurement {name:?}; measured.toml has {}", known.join(", "))
        })
    }
}

/// One table per scene, from the JSON of `weekender bench`.
fn speed_tables(kept: &Kept) -> Result<Markup> {
    let json = &kept.json;
    ensure!(json["schema"] == measure::SCHEMA, "is no benchmark of version {}", measure::SCHEMA);
    let columns = ["tracer", "samples per pixel", SPEED, "× C89", "lanes in use"];
    let table = |scene: &Value| {
        let rows = items(&scene["rows"]);
        let row = |row: &Value| match row["skipped"].as_str() {
            Some(reason) => vec![html! { (text(&row["name"])) }, html! { "not measured: " (reason) }],
            None => vec![
                html! { (text(&row["name"])) },
                shown(row["samples_per_pixel"].as_u64(), |samples| samples.to_string()),
                speed(row, rows),
                shown(row["ratio_to_baseline"].as_f64(), |ratio| format!("{ratio:.2}")),
                shown(row["lanes_in_use"].as_f64(), percent),
            ],
        };
        let name = text(&scene["scene"]);
        let [width, height, depth, spheres] =
            ["width", "height", "max_depth", "spheres"].map(|key| &scene[key]);
        let caption = html! {
            strong { (name) } ", " (width) " × " (height) ", at most " (depth.as_u64().unwrap_or(1) - 1) " bounces, " (spheres) " spheres. "
            "Median and range of the runs. " (origin(kept))
        };
        table(&format!("Speed of {name}"), &caption, &columns, rows.iter().map(row))
    };
    Ok(html! { @for scene in items(&json["scenes"]) { (table(scene)) } })
}

/// Ways of doing the same work, compared with the first, from the JSON of `examples/mappings`.
fn comparison(kept: &Kept) -> Result<Markup> {
    let (about, rows) = (text(&kept.json["about"]), items(&kept.json["rows"]));
    let first = rows.first().and_then(median).context("the first row has no speed")?;
    let has_use = rows.iter().any(|row| row["in_use"].is_f64());
    let row = |row: &Value| {
        let ratio = shown(median(row), |speed| format!("{:.2}", speed / first));
        let mut cells = vec![html! { (text(&row["name"])) }, speed(row, rows), ratio];
        cells.extend(has_use.then(|| shown(row["in_use"].as_f64(), percent)));
        cells
    };
    let caption = html! { (about) " Median and range of the runs. " (origin(kept)) };
    let columns = ["who traces what", SPEED, "× the first", "lanes in use"];
    Ok(table(about, &caption, &columns[..if has_use { 4 } else { 3 }], rows.iter().map(row)))
}

/// Times to both errors in all scenes, from the JSON of `weekender report`.
fn error_table(kept: &Kept) -> Result<Markup> {
    let data = report_of(kept)?;
    let curves = report::curves(&data, &TARGETS);
    let time = |curve: &CurveSummary| curve.times[0].as_ref().map(|crossing| crossing.time);
    let mut rows = Vec::new();
    for scene in curves.chunk_by(|a, b| a.curve.scene == b.curve.scene) {
        let base = scene.iter().find(|curve| curve.curve.backend == "c89").and_then(time);
        rows.push(vec![html! { (scene[0].curve.scene) }]);
        for curve in scene {
            let about = &curve.curve;
            let mut row = vec![
                html! { (about.backend) ", " (about.sampler) },
                shown(curve.slope, |[slope, _]| format!("{slope:.2}").replace('-', "−")),
            ];
            row.extend(curve.times.iter().map(|crossing| {
                let mark = |is_extrapolated| if is_extrapolated { "~" } else { "" };
                shown(crossing.as_ref(), |at| format!("{}{} s", mark(at.is_extrapolated), digits(at.time, 3)))
            }));
            row.push(shown(base.zip(time(curve)), |(base, own)| format!("{:.1}", base / own)));
            rows.push(row);
        }
    }
    let (width, height) = data.settings.size;
    let caption = html! {
        "Time until the RMSE has fallen to 0.01 and to 0.001, " (width) " × " (height) ", " (data.settings.seeds) " pictures each. \
         Times with ~ are extrapolated. The last column compares the times to 0.01. " (origin(kept))
    };
    let columns = ["tracer, random numbers", "slope", "to 0.01", "to 0.001", "× C89"];
    Ok(table("Time to an error", &caption, &columns, rows.into_iter()))
}

/// The chart of the same data, in the page's colours.
fn error_chart(kept: &Kept, uses: &mut Uses) -> Result<Markup> {
    let mut drawn = report::chart(&report_of(kept)?, TARGETS[0]);
    // The caption already says both.
    (drawn.title, drawn.about, drawn.columns) = (String::new(), String::new(), 1);
    let about = "Error against time for each tracer; the table below has the times.";
    // For a window and for a phone.
    let svgs = [[640, 470], [360, 330]].map(|[width, height]| {
        let size = [width, UNTITLED_TOP + height * drawn.panels.len() as u32];
        chart::page_svg(&chart::Figure { size, ..drawn.clone() }, about)
    });
    Ok(html! {
        figure .chart id="chart-error" {
            @for svg in svgs { (PreEscaped(svg?)) }
            (numbered(&html! {
                "Error against time. Lower and further left is better; the dashed slope is half the error in four times the time. "
                em { "cpu" } ": packets on all threads; " em { "scalar" } ": one lane on all threads; "
                em { "c89" } ": the C program on one thread. " (origin(kept))
            }, uses))
        }
    })
}

/// The report's curves without those of denoised pictures, which the page treats later.
fn report_of(kept: &Kept) -> Result<report::Data> {
    let json = kept.json.clone();
    let mut data: report::Data =
        serde_json::from_value(json).context("is not a report; make one with weekender report --out DIR")?;
    data.runs.retain(|run| !run.curve.is_denoised());
    Ok(data)
}

/// Heading of the column whose cells have bars.
const SPEED: &str = "million paths per second";

/// A table that scrolls in its own box where it is wider than the page. A row's first cell is its head; a row of one is
/// the head of those below it, and the last cell of a short one is as wide as the rest.
fn table(name: &str, caption: &Markup, columns: &[&str], rows: impl Iterator<Item = Vec<Markup>>) -> Markup {
    html! {
        figure .measured {
            div .scroll tabindex="0" role="group" aria-label=(name) {
                table .numbers {
                    thead { tr { @for column in columns { th scope="col" .bars[*column == SPEED] { (column) } } } }
                    tbody {
                        @for row in rows {
                            tr .group[row.len() == 1] {
                                @let rest = columns.len() + 1 - row.len();
                                @for (place, cell) in row.iter().enumerate() {
                                    @let span = (rest > 1 && place + 1 == row.len()).then_some(rest);
                                    @if place == 0 {
                                        th scope=(if row.len() == 1 { "colgroup" } else { "row" }) colspan=[span] { (cell) }
                                    } @else {
                                        td .text[span.is_some()] colspan=[span] { (cell) }
                                    }
                                }
                            }
                        }
                    }
                }
            }
            figcaption { (caption) }
        }
    }
}

/// The line below a table: where and how it was measured.
fn origin(kept: &Kept) -> Markup {
    let machine = &kept.json["machine"];
    html! {
        "Measured on " (kept.date) ", " (text(machine))
        @if machine.is_object() { (text(&machine["processor"])) ", " (machine["cores"]) " cores" }
        ", " (kept.system) ", by " (code_words(&kept.command)) ". " (kept.method) "."
        @if let Some(compiler) = &kept.compiler { " The C program: " (code_words(compiler)) "." }
    }
}

/// The median, a bar of its share of the longest, and the range.
fn speed(row: &Value, rows: &[Value]) -> Markup {
    let longest = rows.iter().filter_map(median).fold(0.0, f64::max);
    let end = |key: &str| digits(row["paths_per_second"][key].as_f64().unwrap_or_default() / 1e6, 3);
    html! {
        @match median(row) {
            None => "not measured",
            Some(speed) => span .bar style={ "--share:" (format!("{:.3}", speed / longest)) } {
                strong { (end("median")) } " " span .range { (end("min")) "–" (end("max")) }
            }
        }
    }
}

fn items(json: &Value) -> &[Value] {
    json.as_array().map_or(&[], Vec::as_slice)
}

fn median(row: &Value) -> Option<f64> {
    row["paths_per_second"]["median"].as_f64()
}

fn text(json: &Value) -> &str {
    json.as_str().unwrap_or_default()
}

fn shown<T>(value: Option<T>, words: impl FnOnce(T) -> String) -> Markup {
    html! { (value.map(words).unwrap_or_default()) }
}

fn percent(share: f64) -> String {
    format!("{:.1} %", 100.0 * share)
}

/// A number with this many significant digits, and commas between thousands: `0.0120` or `2,300`.
fn digits(number: f64, count: i32) -> String {
    let places = count - 1 - number.abs().max(1e-9).log10().floor() as i32;
    if places > 0 {
        return format!("{number:.0$}", places as usize);
    }
    let unit = 10_f64.powi(-places);
    measure::grouped(((number / unit).round() * unit) as u64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn kept(json: &Value) -> Kept {
        let (file, command) = ("a.json".to_owned(), "make it".to_owned());
        let (system, method) = ("Debian".to_owned(), "One run".to_owned());
        Kept { file, command, date: "1 May".to_owned(), system, compiler: None, method, json: json.clone() }
    }

    /// The text of each row's cells.
    fn rows(html: &str) -> Vec<Vec<String>> {
        let (_, body) = html.split_once("<tbody>").unwrap();
        let cells = |row: &str| -> Vec<String> {
            let cells = row.split("</t").filter(|cell| cell.contains('<'));
            cells
                .map(|cell| {
                    cell.split('<').map(|part| part.split_once('>').map_or("", |part| part.1)).collect()
                })
                .collect()
        };
        body.split("<tr").skip(1).map(|row| cells(row.split("</tr>").next().unwrap())).collect()
    }

    #[test]
    fn benchmark_table_rows() {
        let speeds = |median: f64| json!({"median": median, "min": 0.5 * median, "max": 2.0 * median});
        let row = |name: &str, speed: Value, skipped: Option<&str>| json!({"name": name, "paths_per_second": speed, "skipped": skipped, "lanes_in_use": 0.875, "samples_per_pixel": 14, "ratio_to_baseline": 8.0});
        let bench = |schema: u32| {
            let rows = [
                row("C89, cc -O2, 1 thread", speeds(5e6), None),
                row("avx2, 8 lanes, 3 threads", speeds(40e6), None),
                row("other GPU", Value::Null, Some("it has no memory")),
            ];
            let scene = json!({"scene": "book", "width": 200, "height": 113, "max_depth": 50, "spheres": 485, "rows": rows});
            json!({"schema": schema, "machine": {"processor": "A CPU", "cores": 4}, "scenes": [scene]})
        };
        let html = speed_tables(&kept(&bench(measure::SCHEMA))).unwrap().into_string();
        assert_eq!(
            rows(&html),
            [
                &["C89, cc -O2, 1 thread", "14", "5.00 2.50–10.0", "8.00", "87.5 %"][..],
                &["avx2, 8 lanes, 3 threads", "14", "40.0 20.0–80.0", "8.00", "87.5 %"],
                &["other GPU", "not measured: it has no memory"],
            ]
        );
        assert!(
            html.contains("--share:0.125") && html.contains("Measured on 1 May, A CPU, 4 cores, Debian, by "),
            "{html}"
        );
        let refused = speed_tables(&kept(&bench(99))).unwrap_err().to_string();
        assert!(refused.contains("no benchmark of version"), "{refused}");
    }

    #[test]
    fn comparison_uses_first_row() {
        let row = |name: &str, median: f64, in_use: Option<f64>| json!({"name": name, "paths_per_second": {"median": median, "min": 1e6, "max": 9e6}, "in_use": in_use});
        let html = |rows: &[Value]| {
            let json = json!({"about": "Mappings.", "machine": "a GPU", "rows": rows});
            comparison(&kept(&json)).map(Markup::into_string)
        };
        let found = rows(&html(&[row("one", 2e6, None), row("two", 8e6, Some(0.625))]).unwrap());
        assert_eq!(
            found,
            [["one", "2.00 1.00–9.00", "1.00", ""], ["two", "8.00 1.00–9.00", "4.00", "62.5 %"]]
        );
        assert!(!html(&[row("one", 2e6, None)]).unwrap().contains("lanes in use"));
        assert!(html(&[]).is_err());
    }

    #[test]
    fn numbers_have_significant_digits() {
        let numbers = [(5.214, 3), (154.2, 3), (0.000_012_34, 3), (0.0, 2), (412.0, 2), (999_999.0, 2)];
        let shown = numbers.map(|(number, count)| digits(number, count));
        assert_eq!(shown, ["5.21", "154", "0.0000123", "0.0000000000", "410", "1,000,000"]);
    }
}
