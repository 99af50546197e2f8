//! Tables and charts of stored measurements, each with its command and machine.

use crate::library::{FOLDER, Fault, Library};
use crate::uses::Uses;
use crate::words::{code_words, numbered};
use anyhow::{Context, Result, ensure};
use maud::{Markup, PreEscaped, html};
use serde::Deserialize;
use serde_json::Value;
use std::collections::BTreeMap;
use std::slice;
use weekender::measure;
use weekender::measure::report::{self, CurveSummary};
use weekender::numbers::chart::{self, UNTITLED_TOP};

/// Lists the stored measurements.
const FILE: &str = "docs/companion/measured.toml";

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
        let table = if name == REPORT { error_table(kept) } else { speed_tables(kept) };
        table.with_context(|| format!("{FOLDER}/{}", kept.file))
    }

    /// The chart with this name.
    pub fn chart(&self, name: &str, uses: &mut Uses) -> Result<Markup> {
        ensure!(name == REPORT, "there is no chart {name:?}; use {REPORT}");
        error_chart(self.find(name)?, uses)
    }

    fn find(&self, name: &str) -> Result<&Kept> {
        self.0.get(name).with_context(|| format!("there is no measurement {name:?} in {FILE}"))
    }
}

/// Ways of doing the same work, compared with the first: a table for each scene of `weekender bench`, or one from
/// `examples/mappings`.
fn speed_tables(kept: &Kept) -> Result<Markup> {
    let scenes = kept.json["scenes"].as_array().map_or(slice::from_ref(&kept.json), Vec::as_slice);
    let tables: Result<Vec<Markup>> = scenes.iter().map(|scene| speed_table(kept, scene)).collect();
    Ok(html! { @for table in tables? { (table) } })
}

/// A number as a cell shows it.
type Words = fn(f64) -> String;

fn speed_table(kept: &Kept, scene: &Value) -> Result<Markup> {
    let rows = scene["rows"].as_array().map_or(&[][..], Vec::as_slice);
    let first = rows.first().and_then(median).context("the first row has no speed")?;
    let mut more: Vec<(&str, &str, Words)> = vec![
        ("samples per pixel", "samples_per_pixel", |samples| samples.to_string()),
        ("lanes in use", "lanes_in_use", percent),
        ("lanes in use", "in_use", percent),
    ];
    more.retain(|(_, key, _)| rows.iter().any(|row| row[*key].is_number()));
    let row = |row: &Value| {
        let ratio = shown(median(row), |speed| format!("{:.2}", speed / first));
        let mut cells = vec![html! { (text(&row["name"])) }, speed(row, rows), ratio];
        cells.extend(more.iter().map(|(_, key, words)| shown(row[*key].as_f64(), words)));
        cells
    };
    let [width, height, depth, spheres] = ["width", "height", "max_depth", "spheres"].map(|key| &scene[key]);
    let name = text(&scene["scene"]);
    let bounces = depth.as_u64().unwrap_or(1) - 1;
    let about = match scene["about"].as_str() {
        Some(about) => about.to_owned(),
        None => format!("{name}, {width} × {height}, at most {bounces} bounces, {spheres} spheres."),
    };
    let caption = html! { (about) " Median and range of the runs. " (origin(kept)) };
    let mut columns = vec!["way of tracing", SPEED, "× the first"];
    columns.extend(more.iter().map(|(heading, ..)| heading));
    Ok(table(&about, &caption, &columns, rows.iter().map(row)))
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
                shown(crossing.as_ref(), |at| {
                    format!("{}{} s", if at.is_extrapolated { "~" } else { "" }, digits(at.time, 3))
                })
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
/// the head of those below it.
fn table(name: &str, caption: &Markup, columns: &[&str], rows: impl Iterator<Item = Vec<Markup>>) -> Markup {
    html! {
        figure .measured {
            div .scroll tabindex="0" role="group" aria-label=(name) {
                table .numbers {
                    thead { tr { @for column in columns { th scope="col" .bars[*column == SPEED] { (column) } } } }
                    tbody {
                        @for row in rows {
                            @if let [head] = row.as_slice() {
                                tr .group { th scope="colgroup" colspan=(columns.len()) { (head) } }
                            } @else {
                                tr { th scope="row" { (row[0]) } @for cell in &row[1..] { td { (cell) } } }
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
    fn tables_compare_with_first_row() {
        let row = |name: &str, speed: f64, used: Option<f64>| json!({"name": name, "paths_per_second": {"median": speed, "min": 0.5 * speed, "max": 2.0 * speed}, "in_use": used});
        let table = |json: Value| speed_tables(&kept(&json)).map(Markup::into_string);
        let mut c = row("C89, cc -O2, 1 thread", 5e6, None);
        c["samples_per_pixel"] = 14.into();
        let bench = json!({"scene": "book", "max_depth": 50, "rows": [c, row("8 lanes", 40e6, Some(0.875))]});
        let machine = json!({"processor": "A CPU", "cores": 4});
        let html = table(json!({"machine": machine, "scenes": [bench]})).unwrap();
        assert_eq!(
            rows(&html),
            [
                ["C89, cc -O2, 1 thread", "5.00 2.50–10.0", "1.00", "14", ""],
                ["8 lanes", "40.0 20.0–80.0", "8.00", "", "87.5 %"]
            ]
        );
        for part in ["--share:0.125", "at most 49 bounces", "Measured on 1 May, A CPU, 4 cores, Debian, by "]
        {
            assert!(html.contains(part), "{part}: {html}");
        }
        let html = table(json!({"about": "Ways.", "rows": [row("one", 2e6, None)]})).unwrap();
        assert!(html.contains("Ways.") && !html.contains("lanes in use"), "{html}");
        assert!(table(json!({"rows": []})).is_err());
    }

    #[test]
    fn numbers_have_significant_digits() {
        let numbers = [(5.214, 3), (154.2, 3), (0.000_012_34, 3), (0.0, 2), (412.0, 2), (999_999.0, 2)];
        let shown = numbers.map(|(number, count)| digits(number, count));
        assert_eq!(shown, ["5.21", "154", "0.0000123", "0.0000000000", "410", "1,000,000"]);
    }
}
