//! Tables and charts of stored measurements, each with its command and machine.

use super::fault::Fault;
use super::library::{FOLDER, Library};
use crate::measure;
use crate::measure::report::{self, CurveSummary};
use crate::numbers::chart::{self, UNTITLED_TOP};
use crate::progressive::describe::counted;
use anyhow::{Context, Result, ensure};
use maud::{Markup, PreEscaped, html};
use serde::Deserialize;
use serde_json::Value;
use std::collections::BTreeMap;

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
    /// The machine, if the file does not name it.
    machine: Option<String>,
    /// The day of the measurement.
    date: Option<String>,
    #[serde(skip)]
    text: String,
    /// The stored text, which the prose speaks of, even if a reader's own replaces it in the tables.
    #[serde(skip)]
    kept: String,
}

/// All measurements by name.
#[derive(Clone, Debug, Default)]
pub struct Measured(BTreeMap<String, Kept>);

impl Measured {
    pub fn read(library: &Library) -> Result<Self, Fault> {
        let mut kept: BTreeMap<String, Kept> = library.toml(FILE)?;
        for kept in kept.values_mut() {
            kept.kept = library.read(&format!("{FOLDER}/{}", kept.file))?.into_owned();
            kept.text = kept.kept.clone();
        }
        Ok(Measured(kept))
    }

    /// Replaces the tables of speed by another `weekender bench` JSON.
    pub fn set_bench(&mut self, text: String) -> Result<()> {
        let command = "weekender bench --json FILE".to_owned();
        let kept = self.find(BENCH)?.kept.clone();
        let kept = Kept { file: String::new(), command, machine: None, date: None, text, kept };
        speed_tables(&kept)?;
        self.0.insert(BENCH.to_owned(), kept);
        Ok(())
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
        let (digits, wanted) = wanted.split_once(' ').context("give the number of digits and the value")?;
        let (above, below) = wanted.split_once(" over ").unwrap_or((wanted, "1"));
        let number = self.value(above)? / self.value(below)?;
        let digits: f64 = digits.parse()?;
        let places = digits - 1.0 - number.abs().log10().floor();
        let unit = 10_f64.powf(-places);
        let rounded = (number / unit).round() * unit;
        Ok(if places > 0.0 {
            format!("{rounded:.0$}", places as usize)
        } else {
            grouped(&format!("{rounded:.0}"))
        })
    }

    fn value(&self, path: &str) -> Result<f64> {
        if let Ok(number) = path.parse() {
            return Ok(number);
        }
        let (name, keys) = path.split_once('/').unwrap_or((path, ""));
        let json: Value = serde_json::from_str(&self.find(name)?.kept)?;
        let is = |item: &&Value, key: &str| ["name", "scene"].iter().any(|field| item[*field] == key);
        let found = keys.split('/').try_fold(&json, |at, key| match at {
            Value::Array(items) => items.iter().find(|item| is(item, key)),
            at => at.get(key),
        });
        found.and_then(Value::as_f64).with_context(|| format!("{path} is no number of the measurements"))
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
    pub fn chart(&self, name: &str) -> Result<Markup> {
        ensure!(name == REPORT, "there is no chart {name:?}; use {REPORT}");
        error_chart(self.find(name)?)
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
    let json: Value = serde_json::from_str(&kept.text).unwrap_or_default();
    let is_known = json["schema"] == measure::SCHEMA;
    let scenes = json["scenes"].as_array().filter(|scenes| is_known && !scenes.is_empty());
    let scenes = scenes.with_context(|| {
        let (version, needed) = (&json["schema"], measure::SCHEMA);
        format!(
            "is no benchmark of version {needed}, but {version}; make it with weekender bench --json FILE"
        )
    })?;
    let machine = &json["machine"];
    let machine = format!("{}, {} cores", text(&machine["processor"]), machine["cores"]);
    Ok(html! { @for scene in scenes { (speed_table(kept, &machine, scene)) } })
}

fn speed_table(kept: &Kept, machine: &str, scene: &Value) -> Markup {
    let name = text(&scene["scene"]);
    let rows = rows(scene);
    let body = html! {
        @for row in rows {
            tr {
                th scope="row" { (tracer(row)) }
                @if let Some(reason) = row["skipped"].as_str() {
                    td .skipped colspan="5" { "not measured: " (reason) }
                } @else {
                    td { @if row["kind"] != "gpu" { (row["threads"].to_string()) } }
                    (speed_cell(row, rows))
                    td { (shown(row["ratio_to_baseline"].as_f64(), |ratio| format!("{ratio:.2}"))) }
                    td { (shown(row["lanes_in_use"].as_f64(), percent)) }
                    td { (shown(row["efficiency"].as_f64(), two_digits)) }
                }
            }
        }
    };
    let [width, height, depth, spheres] = ["width", "height", "max_depth", "spheres"].map(|key| &scene[key]);
    let caption = html! {
        strong { (name) }
        (format!(", {width} × {height}, at most {depth} rays per path, {spheres} spheres. "))
        "Median and range of the runs. " (origin(kept, Some(machine)))
    };
    let columns = ["tracer", "threads", SPEED, "× C89", "lanes in use", "1/(MSE s)"];
    table(&format!("Speed of {name}"), &caption, &columns, &body)
}

/// Ways of doing the same work, compared with the first, from the JSON of `examples/mappings`.
fn comparison(kept: &Kept) -> Result<Markup> {
    let json: Value = serde_json::from_str(&kept.text)?;
    let (about, rows) = (text(&json["about"]), rows(&json));
    let first = rows.first().and_then(median).context("the first row has no speed")?;
    let has_use = rows.iter().any(|row| row["in_use"].is_f64());
    let body = html! {
        @for row in rows {
            tr {
                th scope="row" { (text(&row["name"])) }
                (speed_cell(row, rows))
                td { (shown(median(row), |speed| format!("{:.2}", speed / first))) }
                @if has_use { td { (shown(row["in_use"].as_f64(), percent)) } }
            }
        }
    };
    let machine = json["machine"].as_str();
    let caption = html! { (about) " Median and range of the runs. " (origin(kept, machine)) };
    let columns = ["who traces what", SPEED, "× the first", "lanes in use"];
    Ok(table(about, &caption, &columns[..if has_use { 4 } else { 3 }], &body))
}

/// Times to both errors in all scenes, from the JSON of `weekender report`.
fn error_table(kept: &Kept) -> Result<Markup> {
    let data = report_of(kept)?;
    let curves = report::curves(&data, &TARGETS);
    let time = |curve: &CurveSummary| curve.times[0].as_ref().map(|crossing| crossing.time);
    let is_base = |curve: &&CurveSummary| curve.curve.backend == "c89";
    let body = html! {
        @for scene in curves.chunk_by(|a, b| a.curve.scene == b.curve.scene) {
            tr .group { th scope="colgroup" colspan="6" { (scene[0].curve.scene) } }
            @let base = curves.iter().filter(is_base).find(|base| base.curve.scene == scene[0].curve.scene).and_then(time);
            @for curve in scene {
                tr {
                    th scope="row" { (backend(&curve.curve.backend)) }
                    td .text { (curve.curve.sampler) }
                    td { (shown(curve.slope, |[slope, _]| format!("{slope:.2}").replace('-', "−"))) }
                    @for crossing in &curve.times {
                        td {
                            @if let Some(crossing) = crossing {
                                @if crossing.is_extrapolated { "~" } (three_digits(crossing.time)) " s"
                            }
                        }
                    }
                    td { (shown(base.zip(time(curve)), |(base, own)| format!("{:.1}", base / own))) }
                }
            }
        }
    };
    let (width, height) = data.settings.size;
    let caption = html! {
        "Time until the RMSE has fallen to .01 and to .001, "
        (format!("{width} × {height}, {} pictures each. ", data.settings.seeds))
        "Times with ~ are extrapolated. The last column compares the times to .01. " (origin(kept, None))
    };
    let columns = ["tracer", "numbers", "slope", "to .01", "to .001", "× C89"];
    Ok(table("Time to an error", &caption, &columns, &body))
}

/// The chart of the same data, in the page's colours.
fn error_chart(kept: &Kept) -> Result<Markup> {
    let drawn = report::chart(&report_of(kept)?, TARGETS[0]);
    let figure = chart::Figure {
        // The caption already says both.
        title: String::new(),
        about: String::new(),
        size: [640, UNTITLED_TOP + 470 * drawn.panels.len() as u32],
        columns: 1,
        panels: drawn.panels,
    };
    let about = "Error against time for each tracer; the table below has the times.";
    let svg = chart::page_svg(&figure, about)?;
    Ok(html! {
        figure .chart id="chart-error" {
            div .scroll tabindex="0" role="group" aria-label="Chart of error against time" { (PreEscaped(svg)) }
            figcaption {
                "Error against time. Lower and further left is better. "
                em { "cpu" } ": packets on all threads; " em { "scalar" } ": one lane on all threads; "
                em { "c89" } ": the C program on one thread. " (origin(kept, None))
            }
        }
    })
}

fn report_of(kept: &Kept) -> Result<report::Data> {
    report::parse(kept.text.as_bytes())
        .map_err(|error| anyhow::anyhow!("{error}; make the file with weekender report --out DIR"))
}

/// Heading of the column whose cells have bars.
const SPEED: &str = "million paths per second";

/// A table that scrolls in its own box where it is wider than the page.
fn table(name: &str, caption: &Markup, columns: &[&str], body: &Markup) -> Markup {
    html! {
        figure .measured {
            div .scroll tabindex="0" role="group" aria-label=(name) {
                table .numbers {
                    thead {
                        tr {
                            @for column in columns {
                                th class=[(*column == SPEED).then_some("bars")] scope="col" { (column) }
                            }
                        }
                    }
                    tbody { (body) }
                }
            }
            figcaption { (caption) }
        }
    }
}

/// The line below a table: where and how it was measured.
fn origin(kept: &Kept, machine: Option<&str>) -> Markup {
    let machine = machine.or(kept.machine.as_deref());
    html! {
        "Measured"
        @if let Some(date) = &kept.date { " on " (date) }
        @if let Some(machine) = machine { ", " (machine) }
        ", by "
        // Don't break a flag after its first hyphen.
        code { @for word in kept.command.split(' ') { span .nb { (word) } " " } }
        "."
    }
}

/// A cell with the median, a bar of its share of the longest, and the range.
fn speed_cell(row: &Value, rows: &[Value]) -> Markup {
    let longest = rows.iter().filter_map(median).fold(0.0, f64::max);
    let end = |key: &str| shown(row["paths_per_second"][key].as_f64(), millions);
    html! {
        @match median(row) {
            None => td .bar { "not measured" },
            Some(speed) => td .bar style={ "--share:" (format!("{:.3}", speed / longest)) } {
                strong { (millions(speed)) } " " span .range { (end("min")) "–" (end("max")) }
            }
        }
    }
}

fn rows(json: &Value) -> &[Value] {
    json["rows"].as_array().map_or(&[], Vec::as_slice)
}

fn median(row: &Value) -> Option<f64> {
    row["paths_per_second"]["median"].as_f64()
}

fn text(json: &Value) -> &str {
    json.as_str().unwrap_or_default()
}

fn shown<T>(value: Option<T>, words: impl FnOnce(T) -> String) -> String {
    value.map(words).unwrap_or_default()
}

/// The tracer's name. A benchmark puts the level before lanes and threads.
fn tracer(row: &Value) -> String {
    let name = text(&row["name"]);
    let level = name.split(',').next().unwrap_or_default();
    match (text(&row["kind"]), row["lanes"].as_u64()) {
        ("baseline", _) => level.to_owned(),
        ("gpu", _) | (_, None) => name.to_owned(),
        (_, Some(lanes)) => format!("{}, {level}", counted(lanes, "lane")),
    }
}

fn backend(name: &str) -> &str {
    match name {
        "cpu" => "packets, all threads",
        "scalar" => "1 lane, all threads",
        "c89" => "C89, 1 thread",
        "gpu" => "GPU",
        other => other,
    }
}

fn percent(share: f64) -> String {
    format!("{:.1} %", 100.0 * share)
}

/// Millions with three digits.
fn millions(number: f64) -> String {
    let millions = number / 1e6;
    let digits = (2.0 - millions.log10().floor()).clamp(0.0, 2.0) as usize;
    format!("{millions:.digits$}")
}

fn three_digits(seconds: f64) -> String {
    let digits = (2.0 - seconds.max(1e-9).log10().floor()).clamp(0.0, 6.0) as usize;
    format!("{seconds:.digits$}")
}

/// Two significant digits: `410` or `2,300`.
fn two_digits(number: f64) -> String {
    let unit = 10_f64.powf((number.log10().floor() - 1.0).max(0.0));
    grouped(&format!("{:.0}", (number / unit).round() * unit))
}

/// Digits with commas between thousands.
fn grouped(digits: &str) -> String {
    let mut grouped = String::new();
    for (place, digit) in digits.chars().enumerate() {
        if place > 0 && (digits.len() - place).is_multiple_of(3) {
            grouped.push(',');
        }
        grouped.push(digit);
    }
    grouped
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn kept(json: &Value) -> Kept {
        let (file, command) = ("a.json".to_owned(), "make it".to_owned());
        Kept {
            file,
            command,
            machine: None,
            date: Some("1 May".to_owned()),
            text: json.to_string(),
            kept: String::new(),
        }
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
        let row = |name: &str, kind: &str, lanes: usize, speed: Value, skipped: Option<&str>| {
            json!({"name": name, "kind": kind, "lanes": lanes, "threads": 3, "paths_per_second": speed, "skipped": skipped,
                   "lanes_in_use": 0.875, "ratio_to_baseline": 8.0, "efficiency": 1234.0})
        };
        let bench = |schema: u32| {
            let rows = [
                row("C89, cc -O2, 1 thread", "baseline", 1, speeds(5e6), None),
                row("avx2, 8 lanes, 3 threads", "threads", 8, speeds(40e6), None),
                row("other GPU", "gpu", 64, Value::Null, Some("it has no memory")),
            ];
            let scene = json!({"scene": "book", "width": 200, "height": 113, "max_depth": 50, "spheres": 485, "rows": rows});
            json!({"schema": schema, "machine": {"processor": "A CPU", "cores": 4}, "scenes": [scene]})
        };
        let html = speed_tables(&kept(&bench(measure::SCHEMA))).unwrap().into_string();
        assert_eq!(
            rows(&html),
            [
                &["C89", "3", "5.00 2.50–10.0", "8.00", "87.5 %", "1,200"][..],
                &["8 lanes, avx2", "3", "40.0 20.0–80.0", "8.00", "87.5 %", "1,200"],
                &["other GPU", "not measured: it has no memory"],
            ]
        );
        assert!(
            html.contains("--share:0.125") && html.contains("Measured on 1 May, A CPU, 4 cores, by "),
            "{html}"
        );
        let refused = speed_tables(&kept(&bench(99))).unwrap_err().to_string();
        assert!(refused.contains("but 99") && refused.contains("weekender bench --json"), "{refused}");
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
        assert_eq!([5.214e6, 10e6, 54.62e6, 154.2e6].map(millions), ["5.21", "10.0", "54.6", "154"]);
        let times = [1234.6, 12.34, 0.1234, 0.000_012_34, 0.0].map(three_digits);
        assert_eq!(times, ["1235", "12.3", "0.123", "0.000012", "0.000000"]);
        let rounded = [0.4, 5.5, 99.6, 412.0, 12_600.0, 999_999.0].map(two_digits);
        assert_eq!(rounded, ["0", "6", "100", "410", "13,000", "1,000,000"]);
    }
}
