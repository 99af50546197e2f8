//! The table of speed, from the JSON of `weekender bench`.

use super::{Kept, Spread, origin, scrolling, speed_cell};
use crate::measure;
use maud::{Markup, html};
use serde::Deserialize;

/// The part of the JSON that the table shows.
#[derive(Debug, Deserialize)]
pub struct Figures {
    schema: u32,
    machine: Machine,
    scenes: Vec<Scene>,
}

#[derive(Debug, Deserialize)]
struct Machine {
    processor: String,
    cores: usize,
}

#[derive(Debug, Deserialize)]
struct Scene {
    scene: String,
    width: u32,
    height: u32,
    max_depth: u32,
    spheres: usize,
    rows: Vec<Row>,
}

#[derive(Debug, Deserialize)]
struct Row {
    name: String,
    kind: String,
    lanes: usize,
    threads: usize,
    paths_per_second: Option<Spread>,
    lanes_in_use: Option<f64>,
    ratio_to_baseline: Option<f64>,
    efficiency: Option<f64>,
    skipped: Option<String>,
}

impl Figures {
    /// Reads the JSON.
    ///
    /// # Errors
    /// If the text is something else.
    pub fn parse(text: &str) -> Result<Self, String> {
        let remedy = "make the file with weekender bench --json FILE";
        let figures: Figures = serde_json::from_str(text).map_err(|error| format!("{error}; {remedy}"))?;
        match figures.schema {
            measure::SCHEMA if figures.scenes.is_empty() => Err(format!("no scene was measured; {remedy}")),
            measure::SCHEMA => Ok(figures),
            other => Err(format!("has version {other}, but {} is needed; {remedy}", measure::SCHEMA)),
        }
    }
}

/// One table per scene.
pub fn tables(kept: &Kept) -> Result<Markup, String> {
    let figures = Figures::parse(&kept.text)?;
    let Machine { processor, cores } = &figures.machine;
    let machine = format!("{processor}, {cores} cores");
    Ok(html! { @for scene in &figures.scenes { (table(kept, &machine, scene)) } })
}

fn table(kept: &Kept, machine: &str, scene: &Scene) -> Markup {
    let Scene { scene: name, width, height, max_depth, spheres, rows } = scene;
    let speeds = rows.iter().filter_map(|row| row.paths_per_second);
    let longest = speeds.map(|spread| spread.median).fold(0.0, f64::max);
    let table = html! {
        table .numbers {
            thead {
                tr {
                    th scope="col" { "tracer" }
                    th scope="col" { "threads" }
                    th .bars scope="col" { "million paths per second" }
                    th scope="col" { "× C89" }
                    th scope="col" { "lanes in use" }
                    th scope="col" { "1/(MSE s)" }
                }
            }
            tbody {
                @for row in rows {
                    tr {
                        th scope="row" { (name_of(row)) }
                        @if let Some(reason) = &row.skipped {
                            td .skipped colspan="5" { "not measured: " (reason) }
                        } @else {
                            td { @if row.kind != "gpu" { (row.threads) } }
                            (speed_cell(row.paths_per_second, longest))
                            td { @if let Some(ratio) = row.ratio_to_baseline { (format!("{ratio:.2}")) } }
                            td { @if let Some(share) = row.lanes_in_use { (format!("{:.1} %", 100.0 * share)) } }
                            td { @if let Some(efficiency) = row.efficiency { (rounded(efficiency)) } }
                        }
                    }
                }
            }
        }
    };
    let caption = html! {
        strong { (name) }
        (format!(", {width} × {height}, at most {max_depth} rays per path, {spheres} spheres. Median and range of the runs. "))
        (origin(kept, Some(machine)))
    };
    scrolling(&format!("Speed of {name}"), &caption, &table)
}

/// The row's name: bench puts the level first, which lanes and threads follow.
fn name_of(row: &Row) -> String {
    let lanes = if row.lanes == 1 { "1 lane".to_owned() } else { format!("{} lanes", row.lanes) };
    let level = row.name.split(',').next().unwrap_or_default();
    match row.kind.as_str() {
        "baseline" => level.to_owned(),
        "gpu" => row.name.clone(),
        _ => format!("{lanes}, {level}"),
    }
}

/// Two digits that count, as `410` or `2,300`.
fn rounded(number: f64) -> String {
    let unit = 10_f64.powf((number.log10().floor() - 1.0).max(0.0));
    let whole = (number / unit).round() * unit;
    let digits = format!("{whole:.0}");
    let mut grouped = String::new();
    for (place, digit) in digits.chars().enumerate() {
        if place > 0 && (digits.len() - place) % 3 == 0 {
            grouped.push(',');
        }
        grouped.push(digit);
    }
    grouped
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::{Value, json};

    #[test]
    fn large_numbers_have_two_digits_that_count() {
        assert_eq!([41.6, 412.0, 23_456.0, 1_270_000.0].map(rounded), ["42", "410", "23,000", "1,300,000"]);
    }

    #[test]
    fn other_json_is_refused() {
        for (text, word) in [
            ("{}", "missing field"),
            ("{\"schema\":99,\"machine\":{\"processor\":\"x\",\"cores\":1},\"scenes\":[]}", "version 99"),
        ] {
            let message = Figures::parse(text).unwrap_err();
            assert!(message.contains(word) && message.contains("weekender bench --json"), "{message}");
        }
    }

    #[test]
    fn small_numbers_are_whole_and_thousands_have_a_comma() {
        let numbers = [0.4, 5.4, 5.5, 96.4, 99.6, 996.0, 1000.0, 12_600.0, 999_999.0, 123_456_789.0];
        let expected = ["0", "5", "6", "96", "100", "1,000", "1,000", "13,000", "1,000,000", "120,000,000"];
        assert_eq!(numbers.map(rounded), expected);
    }

    #[test]
    fn lanes_come_before_the_level() {
        let name = |kind: &str, lanes, name: &str| {
            name_of(&Row {
                name: name.to_owned(),
                kind: kind.to_owned(),
                lanes,
                threads: 1,
                paths_per_second: None,
                lanes_in_use: None,
                ratio_to_baseline: None,
                efficiency: None,
                skipped: None,
            })
        };
        assert_eq!(name("scalar", 1, "avx2, 1 lane, 1 thread"), "1 lane, avx2");
        assert_eq!(name("packets", 8, "avx2, 8 lanes, 1 thread"), "8 lanes, avx2");
        assert_eq!(name("baseline", 1, "C89, cc -O2, 1 thread"), "C89");
        assert_eq!(name("gpu", 64, "a GPU, fast"), "a GPU, fast");
    }

    #[test]
    fn a_table_has_the_figures_of_each_row() {
        let speeds = |median: f64| json!({"median": median, "min": 0.5 * median, "max": 2.0 * median});
        let row = |name: &str, kind: &str, lanes: usize, figures: [Value; 4], skipped: Option<&str>| {
            let [paths, share, ratio, efficiency] = figures;
            json!({
                "name": name, "kind": kind, "lanes": lanes, "threads": 3, "paths_per_second": paths,
                "lanes_in_use": share, "ratio_to_baseline": ratio, "efficiency": efficiency, "skipped": skipped,
            })
        };
        let null = || Value::Null;
        let scene = json!({
            "scene": "book", "width": 200, "height": 113, "max_depth": 50, "spheres": 485,
            "rows": [
                row("C89, cc -O2, 1 thread", "baseline", 1, [speeds(5e6), null(), json!(1.0), null()], None),
                row("avx2, 8 lanes, 3 threads", "threads", 8, [speeds(40e6), json!(0.875), json!(8.0), json!(1234.0)], None),
                row("a GPU", "gpu", 64, [null(), null(), null(), null()], None),
                row("other GPU", "gpu", 64, [null(), null(), null(), null()], Some("it has no memory")),
            ],
        });
        let machine = json!({"processor": "A CPU", "cores": 4});
        let text = json!({"schema": measure::SCHEMA, "machine": machine, "scenes": [scene]}).to_string();
        let (file, command) = ("speed.json".to_owned(), "weekender bench".to_owned());
        let (machine, date) = (Some("another machine".to_owned()), Some("1 May".to_owned()));
        let html = tables(&Kept { file, command, machine, date, text }).unwrap().into_string();
        let bar = |share: &str, speed: &str, range: &str| {
            let words = format!("<strong>{speed}</strong> <span class=\"range\">{range}</span>");
            format!("<td class=\"bar\" style=\"--share:{share}\">{words}</td>")
        };
        let [slow, fast] = [bar("0.125", "5.00", "2.50–10.0"), bar("1.000", "40.0", "20.0–80.0")];
        let rows = [
            format!("<th scope=\"row\">C89</th><td>3</td>{slow}<td>1.00</td><td></td><td></td>"),
            format!("<th scope=\"row\">8 lanes, avx2</th><td>3</td>{fast}<td>8.00</td><td>87.5 %</td><td>1,200</td>"),
            "<th scope=\"row\">a GPU</th><td></td><td class=\"bar\">not measured</td><td></td><td></td><td></td>".to_owned(),
            "<th scope=\"row\">other GPU</th><td class=\"skipped\" colspan=\"5\">not measured: it has no memory</td>".to_owned(),
        ];
        let rows: String = rows.iter().map(|row| format!("<tr>{row}</tr>")).collect();
        assert!(html.contains(&format!("<tbody>{rows}</tbody>")), "{html}");
        let caption = "<strong>book</strong>, 200 × 113, at most 50 rays per path, 485 spheres. Median and range of the runs. \
                       Measured on 1 May, A CPU, 4 cores, by <code><span class=\"nb\">weekender</span> \
                       <span class=\"nb\">bench</span> </code>.";
        assert!(html.contains(caption) && html.contains("aria-label=\"Speed of book\""), "{html}");
    }
}
