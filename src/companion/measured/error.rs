//! Error against time, from the JSON of `weekender report`.

use super::{Kept, origin, scrolling};
use crate::chart::{self, UNTITLED_TOP};
use crate::measure::report::{self, CurveSummary};
use maud::{Markup, PreEscaped, html};

/// The errors to which times are given.
const TARGETS: [f64; 2] = [0.01, 0.001];

fn data(kept: &Kept) -> Result<report::Data, String> {
    let remedy = "make the file with weekender report --out DIR";
    report::parse(kept.text.as_bytes()).map_err(|error| format!("{error}; {remedy}"))
}

/// A table with the times of all scenes.
pub fn table(kept: &Kept) -> Result<Markup, String> {
    let data = data(kept)?;
    let curves = report::curves(&data, &TARGETS);
    let base = |curve: &CurveSummary| {
        let is_base =
            |other: &&CurveSummary| other.curve.scene == curve.curve.scene && other.curve.backend == "c89";
        curves.iter().find(is_base).and_then(|base| base.times[0]).map(|crossing| crossing.time)
    };
    let mut scene = "";
    let rows = curves.iter().map(|curve| {
        let is_new = std::mem::replace(&mut scene, curve.curve.scene.as_str()) != curve.curve.scene;
        let crossing = |place: usize| match &curve.times[place] {
            Some(crossing) => {
                let mark = if crossing.is_extrapolated { "~" } else { "" };
                format!("{mark}{} s", three_digits(crossing.time))
            }
            None => String::new(),
        };
        let ratio = base(curve).zip(curve.times[0].as_ref()).map(|(base, own)| base / own.time);
        html! {
            @if is_new { tr .group { th scope="colgroup" colspan="6" { (curve.curve.scene) } } }
            tr {
                th scope="row" { (backend(&curve.curve.backend)) }
                td .text { (curve.curve.sampler) }
                td { @if let Some([slope, _]) = curve.slope { (format!("{slope:.2}").replace('-', "−")) } }
                td { (crossing(0)) }
                td { (crossing(1)) }
                td { @if let Some(ratio) = ratio { (format!("{ratio:.1}")) } }
            }
        }
    });
    let table = html! {
        table .numbers {
            thead {
                tr {
                    th scope="col" { "tracer" }
                    th scope="col" { "numbers" }
                    th scope="col" { "slope" }
                    th scope="col" { "to .01" }
                    th scope="col" { "to .001" }
                    th scope="col" { "× C89" }
                }
            }
            tbody { @for row in rows { (row) } }
        }
    };
    let (width, height) = data.settings.size;
    let caption = html! {
        "Time until the RMSE has fallen to .01 and to .001, "
        (format!("{width} × {height}, {} pictures each. ", data.settings.seeds))
        "Times with ~ are extrapolated. The last column compares the times to .01. " (origin(kept, None))
    };
    Ok(scrolling("Time to an error", &caption, &table))
}

/// The chart, in the colours of the page.
pub fn chart(kept: &Kept) -> Result<Markup, String> {
    let data = data(kept)?;
    let drawn = report::chart(&data, TARGETS[0]);
    let figure = chart::Figure {
        // The caption says both.
        title: String::new(),
        about: String::new(),
        size: [640, UNTITLED_TOP + 470 * drawn.panels.len() as u32],
        columns: 1,
        panels: drawn.panels,
    };
    let svg = chart::page_svg(&figure, "Error against time for each tracer; the table below has the times.")?;
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

fn backend(name: &str) -> &str {
    match name {
        "cpu" => "packets, all threads",
        "scalar" => "1 lane, all threads",
        "c89" => "C89, 1 thread",
        "gpu" => "GPU",
        other => other,
    }
}

fn three_digits(seconds: f64) -> String {
    let digits = (2.0 - seconds.max(1e-9).log10().floor()).clamp(0.0, 6.0) as usize;
    format!("{seconds:.digits$}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::{Value, json};

    /// The measurements of curves: scene, tracer and seconds per sample. All have the error .04 with one sample.
    fn kept(curves: &[(&str, &str, f64)]) -> Kept {
        let point = |samples: u64, seconds: f64| {
            let mse = 0.0016 / samples as f64;
            json!({
                "samples": samples, "trace_seconds": seconds, "wall_seconds": seconds, "device_seconds": null,
                "mse": mse, "rel_mse": mse, "flip": 0.1, "mse_estimate": null, "rejected": 0,
            })
        };
        let run = |(scene, backend, seconds): &(&str, &str, f64)| {
            let points: Vec<Value> =
                (0..7).map(|power| 1_u64 << power).map(|n| point(n, seconds * n as f64)).collect();
            json!({
                "scene": scene, "backend": backend, "sampler": "sobol", "seed": 0, "about": backend,
                "prepare_seconds": 0.0, "points": points,
            })
        };
        let report = json!({
            "schema": 1,
            "settings": {
                "software": "Weekender", "size": [48, 27], "seeds": 1, "time_limit": 10.0, "max_samples": 64,
                "estimate_error": true, "reference_samples": 512, "reference": "cpu",
            },
            "references": [],
            "runs": curves.iter().map(run).collect::<Vec<Value>>(),
            "rounding": [],
        });
        let (file, command) = ("error.json".to_owned(), "weekender report".to_owned());
        Kept { file, command, machine: None, date: None, text: report.to_string() }
    }

    /// The texts of the cells of each row.
    fn rows(html: &str) -> Vec<Vec<String>> {
        let (_, body) = html.split_once("<tbody>").unwrap();
        let text = |cell: &str| cell.rsplit('>').next().unwrap_or_default().to_owned();
        let cells = |row: &str| -> Vec<String> {
            let (cells, _) = row.rsplit_once("</t").unwrap();
            cells.split("</t").map(text).collect()
        };
        let rows = body.split("<tr").skip(1);
        rows.map(|row| cells(row.split("</tr>").next().unwrap_or_default())).collect()
    }

    #[test]
    fn each_tracer_is_compared_with_c89_in_its_own_scene() {
        // The error is .01 with 16 samples, and would be .001 with 1600.
        let kept = kept(&[
            ("book", "cpu", 0.01),
            ("book", "c89", 0.5),
            ("metals", "c89", 2.0),
            ("metals", "gpu", 0.001),
            ("dust", "cpu", 0.04),
        ]);
        let html = table(&kept).unwrap().into_string();
        let expected: [&[&str]; 8] = [
            &["book"],
            &["packets, all threads", "sobol", "−0.50", "0.160 s", "~16.0 s", "50.0"],
            &["C89, 1 thread", "sobol", "−0.50", "8.00 s", "~800 s", "1.0"],
            &["metals"],
            &["C89, 1 thread", "sobol", "−0.50", "32.0 s", "~3200 s", "1.0"],
            &["GPU", "sobol", "−0.50", "0.0160 s", "~1.60 s", "2000.0"],
            &["dust"],
            &["packets, all threads", "sobol", "−0.50", "0.640 s", "~64.0 s", ""],
        ];
        assert_eq!(rows(&html), expected, "{html}");
        assert!(html.contains("48 × 27, 1 pictures each. "), "{html}");
    }

    #[test]
    fn times_have_three_digits_but_at_most_six_decimals() {
        let times = [1234.6, 123.4, 12.34, 1.234, 0.1234, 0.012_34, 0.000_012_34, 1e-9, 0.0];
        let expected = ["1235", "123", "12.3", "1.23", "0.123", "0.0123", "0.000012", "0.000000", "0.000000"];
        assert_eq!(times.map(three_digits), expected);
    }

    #[test]
    fn a_chart_is_as_high_as_its_scenes_need() {
        let drawn = |curves: &[(&str, &str, f64)]| chart(&kept(curves)).unwrap().into_string();
        let one = drawn(&[("book", "cpu", 0.01), ("book", "c89", 0.5)]);
        assert!(one.starts_with("<figure class=\"chart\" id=\"chart-error\">"), "{one}");
        assert!(one.contains("viewBox=\"0 0 640 510\""), "{one}");
        let two = drawn(&[("book", "cpu", 0.01), ("metals", "c89", 0.5)]);
        assert!(two.contains("viewBox=\"0 0 640 980\""), "{two}");
        assert!(two.contains("<code><span class=\"nb\">weekender</span>"), "the command: {two}");
    }
}
