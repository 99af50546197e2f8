//! `report.md`.

use super::calibration::{Calibration, TOLERANCE};
use super::data::{Curve, Data};
use super::summary::{CurvePoint, CurveSummary, SamplerRatio};
use crate::statistics::fit::{Crossing, Point, time_to};
use std::fmt::Write;

/// Backends that others are compared with, if they were measured.
const BASES: [&str; 2] = ["c89", "scalar"];

/// What the tables show.
pub struct Findings<'a> {
    /// The measurements.
    pub data: &'a Data,
    /// The curves.
    pub curves: &'a [CurveSummary],
    /// Target errors.
    pub targets: &'a [f64],
    /// Estimated and true errors.
    pub calibration: &'a [Calibration],
    /// Comparisons of the samplers.
    pub sampler_ratios: &'a [SamplerRatio],
}

/// The report as Markdown. `command` is the command that made it.
pub fn markdown(findings: &Findings<'_>, command: &str) -> String {
    let Findings { data, curves, targets, calibration: calibrations, sampler_ratios } = *findings;
    let mut text = String::from("# Error against time\n\n");
    let settings = &data.settings;
    let _ = writeln!(
        text,
        "How the error of a picture falls with time, as measured by\n\n    {command}\n\n\
         with {}. Pictures per curve, with different random numbers: {}. Seconds of tracing for all of them: {}. \
         Samples per pixel: at most {}.\n\n![Error against time](error-vs-time.png)\n",
        settings.software, settings.seeds, settings.time_limit, settings.max_samples
    );
    text.push_str(HOW_TO_READ);
    for scene in scenes(curves) {
        let of_scene: Vec<&CurveSummary> = curves.iter().filter(|c| c.curve.scene == scene).collect();
        let _ = writeln!(text, "\n## {scene}\n");
        if let Some(reference) = data.references.iter().find(|r| r.scene == scene) {
            let _ = writeln!(
                text,
                "The reference has {} samples per pixel by {}. Its own RMSE of {:.1e} has been \
                 subtracted.\n",
                reference.samples,
                reference.about,
                reference.mse.sqrt()
            );
        }
        overview(&mut text, &of_scene, targets);
        for curve in &of_scene {
            points(&mut text, curve);
        }
    }
    samplers(&mut text, sampler_ratios);
    calibration(&mut text, calibrations);
    rounding(&mut text, data, curves);
    text
}

const HOW_TO_READ: &str = "\
**How to read it.** *RMSE* is the root mean square difference from the reference over pixels and channels, in linear
radiance, where white is 1. At .05 a picture is grainy, at .01 nearly clean, and at .001 no screen shows the difference.
*relMSE* gives more weight to errors in dark areas. *FLIP*, from 0 to 1, is how different the displayed pictures look to
someone who flips between them. The *slope* is the exponent of the seconds in the RMSE: -.5 means that halving the error
takes four times as long. *Efficiency* is 1/(RMSE^2 seconds) at the last point: twice the efficiency gives the same
picture in half the time. Times with ~ are extrapolated. *Trace* seconds are those of the tracer, *wall* seconds
include adding to the film, and *device* seconds are measured by the GPU's clock. Seconds are medians over the pictures,
errors are means. An RMSE of 0 means that the pictures are better than the reference.
";

fn scenes(curves: &[CurveSummary]) -> Vec<&str> {
    let mut scenes: Vec<&str> = Vec::new();
    for curve in curves {
        if !scenes.contains(&curve.curve.scene.as_str()) {
            scenes.push(&curve.curve.scene);
        }
    }
    scenes
}

/// The overview of a scene, with one row per curve.
fn overview(text: &mut String, curves: &[&CurveSummary], targets: &[f64]) {
    let bases: Vec<&str> =
        BASES.into_iter().filter(|base| curves.iter().any(|c| c.curve.backend == *base)).collect();
    let mut head = "| backend | sampler | slope | efficiency |".to_owned();
    for target in targets {
        let _ = write!(head, " to RMSE {target} |");
    }
    for base in &bases {
        let _ = write!(head, " times {base} |");
    }
    let _ = writeln!(text, "{head}\n|{}", " --- |".repeat(4 + targets.len() + bases.len()));
    for curve in curves {
        let slope =
            curve.slope.map_or("-".to_owned(), |[slope, deviation]| format!("{slope:.2} ± {deviation:.2}"));
        let _ = write!(
            text,
            "| {} | {} | {slope} | {} |",
            curve.curve.backend,
            curve.curve.sampler,
            number(curve.efficiency)
        );
        for time in &curve.times {
            let _ = write!(text, " {} |", crossing(*time));
        }
        for base in &bases {
            let _ = write!(text, " {} |", ratio(curve, curves, base));
        }
        text.push('\n');
    }
    if let (false, [target, ..]) = (bases.is_empty(), targets) {
        let _ = writeln!(
            text,
            "\n*times X*: how many times as long X takes to reach an RMSE of {target} with its best sampler."
        );
    }
}

/// How many times as long `base` takes to reach the first target.
fn ratio(curve: &CurveSummary, curves: &[&CurveSummary], base: &str) -> String {
    let first = |curve: &CurveSummary| curve.times.first().copied().flatten();
    let of_base = curves.iter().filter(|c| c.curve.backend == base).filter_map(|c| first(c));
    let best = of_base.min_by(|a, b| a.time.total_cmp(&b.time));
    match (best, first(curve)) {
        (Some(base), Some(mine)) => {
            let mark = if base.is_extrapolated || mine.is_extrapolated { "~" } else { "" };
            format!("{mark}{:.2}", base.time / mine.time)
        }
        _ => "-".to_owned(),
    }
}

fn crossing(crossing: Option<Crossing>) -> String {
    crossing.map_or("-".to_owned(), |c| {
        format!("{}{} s", if c.is_extrapolated { "~" } else { "" }, number(c.time))
    })
}

/// The points of a curve, with one row per number of samples.
fn points(text: &mut String, curve: &CurveSummary) {
    let _ = writeln!(
        text,
        "\n### {}: {}, {}\n\n{}\n\n| samples | trace s | wall s | device s | RMSE | min to max | relMSE | FLIP | estimate / actual |\n|{}",
        curve.curve.scene,
        curve.curve.backend,
        curve.curve.sampler,
        curve.about,
        " ---: |".repeat(9)
    );
    for point in &curve.points {
        let CurvePoint {
            samples, trace_seconds, wall_seconds, rmse, range: [low, high], rel_mse, flip, ..
        } = point;
        let device = point.device_seconds.map_or("-".to_owned(), |seconds| format!("{seconds:.4}"));
        let estimate = point.estimate_ratio.map_or("-".to_owned(), |ratio| format!("{ratio:.3}"));
        let _ = writeln!(
            text,
            "| {samples} | {trace_seconds:.4} | {wall_seconds:.4} | {device} | {rmse:.2e} | {low:.2e} to {high:.2e} | {rel_mse:.2e} | {flip:.4} | {estimate} |"
        );
    }
}

fn samplers(text: &mut String, ratios: &[SamplerRatio]) {
    if ratios.is_empty() {
        return;
    }
    text.push_str(
        "\n## Sobol points against independent samples\n\nThe squared error of \
         independent samples relative to that of Sobol points, which are best at powers of two.\n\n\
         | scene | backend | samples | at equal samples | at equal time |\n| --- | --- | ---: | ---: | ---: |\n",
    );
    for ratio in ratios.iter().filter(|ratio| ratio.samples >= 4) {
        let _ = writeln!(
            text,
            "| {} | {} | {} | {:.2} | {:.2} |",
            ratio.scene, ratio.backend, ratio.samples, ratio.at_equal_samples, ratio.at_equal_time
        );
    }
}

fn calibration(text: &mut String, rows: &[Calibration]) {
    if rows.is_empty() {
        return;
    }
    let off = rows.iter().filter(|row| !row.holds()).count();
    let largest = rows.iter().map(|row| (row.ratio - 1.0).abs()).fold(0.0, f64::max);
    let _ = writeln!(
        text,
        "\n## Is the error estimate accurate?\n\nThe RMSE that a picture's two halves predict without a reference, and the \
         actual RMSE, over all pictures of a curve. {} of {} ratios are within 1 ± {TOLERANCE}; the largest deviation is \
         {largest:.3}.\n\n| scene | backend | sampler | samples | pictures | predicted | actual | predicted / actual |\n\
         | --- | --- | --- | ---: | ---: | ---: | ---: | ---: |",
        rows.len() - off,
        rows.len()
    );
    for row in rows {
        let Curve { scene, backend, sampler } = &row.curve;
        let _ = writeln!(
            text,
            "| {scene} | {backend} | {sampler} | {} | {} | {} | {} | {:.3} ± {:.3} |",
            row.samples,
            row.seeds,
            number(row.predicted_rmse),
            number(row.actual_rmse),
            row.ratio,
            row.deviation
        );
    }
}

fn rounding(text: &mut String, data: &Data, curves: &[CurveSummary]) {
    if data.rounding.is_empty() {
        return;
    }
    text.push_str(
        "\n## The effect of rounding\n\nThe same samples in double precision and on each backend. The *difference* is that of \
         the pictures. Nearly all of it comes from paths that rounding sent another way. They are as good as the original \
         paths, and like noise, this part falls with more samples. The *floor* is the part that never falls; \
         more samples help until the noise is as low as the floor.\n\n\
         | scene | backend | samples | mean difference | RMS difference | floor | samples until noise is as low |\n\
         | --- | --- | ---: | ---: | ---: | ---: | ---: |\n",
    );
    for row in &data.rounding {
        let floor = row.floor.map_or(format!("< {:.1e}", row.floor_limit), |floor| format!("{floor:.1e}"));
        let best = curves
            .iter()
            .filter(|c| (&c.curve.scene, &c.curve.backend) == (&row.scene, &row.backend))
            .filter_map(|c| samples_to(c, row.floor.unwrap_or(row.floor_limit)))
            .reduce(f64::min);
        let more = if row.floor.is_some() { "" } else { "> " };
        let samples = best.map_or("-".to_owned(), |samples| format!("~{more}{samples:.0e}"));
        let _ = writeln!(
            text,
            "| {} | {} | {} | {:+.1e} | {:.1e} | {floor} | {samples} |",
            row.scene, row.backend, row.samples, row.bias, row.rms
        );
    }
}

/// Number of samples at which the error of a curve would be `error`.
fn samples_to(curve: &CurveSummary, error: f64) -> Option<f64> {
    let known = curve.points.iter().filter(|p| p.rmse > 0.0);
    let points: Vec<Point> = known.map(|p| Point { time: p.samples as f64, error: p.rmse }).collect();
    time_to(&points, error).map(|crossing| crossing.time)
}

/// A number with three significant digits.
fn number(x: f64) -> String {
    match x.abs() {
        size if !size.is_finite() => "-".to_owned(),
        size if !(1e-3..1e5).contains(&size) => format!("{x:.2e}"),
        size => format!("{x:.*}", (2 - size.log10().floor() as i32).max(0) as usize),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::data::{Rounding, Settings};

    #[test]
    fn numbers_have_three_digits() {
        let found = [1234.5, 12.34, 1.234, 0.1234, 0.001_234, 1.234e-5, 1.234e7].map(number);
        assert_eq!(found, ["1234", "12.3", "1.23", "0.123", "0.00123", "1.23e-5", "1.23e7"]);
    }

    fn curve(backend: &str, sampler: &str, seconds: f64) -> CurveSummary {
        CurveSummary {
            curve: Curve { scene: "s".to_owned(), backend: backend.to_owned(), sampler: sampler.to_owned() },
            about: "a machine".to_owned(),
            points: vec![CurvePoint {
                samples: 16,
                seeds: 4,
                trace_seconds: 0.5,
                wall_seconds: 0.75,
                device_seconds: None,
                rmse: 0.02,
                range: [0.01, 0.03],
                rel_mse: 0.04,
                flip: 0.125,
                estimate_ratio: Some(1.5),
            }],
            slope: Some([-0.5, 0.01]),
            efficiency: 2.0,
            times: vec![Some(Crossing { time: seconds, is_extrapolated: seconds > 30.0 })],
        }
    }

    #[test]
    fn backends_are_compared_with_the_best_sampler_of_the_baseline() {
        let curves = [
            curve("c89", "independent", 40.0),
            curve("c89", "sobol", 20.0),
            curve("cpu", "sobol", 5.0),
            curve("cpu", "independent", 50.0),
        ];
        let mut text = String::new();
        overview(&mut text, &curves.each_ref(), &[0.01]);
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(
            lines[..6],
            [
                "| backend | sampler | slope | efficiency | to RMSE 0.01 | times c89 |",
                "| --- | --- | --- | --- | --- | --- |",
                "| c89 | independent | -0.50 ± 0.01 | 2.00 | ~40.0 s | ~0.50 |",
                "| c89 | sobol | -0.50 ± 0.01 | 2.00 | 20.0 s | 1.00 |",
                "| cpu | sobol | -0.50 ± 0.01 | 2.00 | 5.00 s | 4.00 |",
                "| cpu | independent | -0.50 ± 0.01 | 2.00 | ~50.0 s | ~0.40 |",
            ]
        );
    }

    #[test]
    fn a_point_has_its_figures_in_the_columns_of_the_head() {
        let mut text = String::new();
        points(&mut text, &curve("cpu", "sobol", 5.0));
        let cells = |line: &str| line.split('|').map(|cell| cell.trim().to_owned()).collect::<Vec<_>>();
        let lines: Vec<&str> = text.lines().filter(|line| line.starts_with('|')).collect();
        let named: Vec<(String, String)> = cells(lines[0]).into_iter().zip(cells(lines[2])).collect();
        for (head, value) in [
            ("samples", "16"),
            ("trace s", "0.5000"),
            ("wall s", "0.7500"),
            ("device s", "-"),
            ("RMSE", "2.00e-2"),
            ("min to max", "1.00e-2 to 3.00e-2"),
            ("relMSE", "4.00e-2"),
            ("FLIP", "0.1250"),
            ("estimate / actual", "1.500"),
        ] {
            assert!(named.contains(&(head.to_owned(), value.to_owned())), "{head}: {text}");
        }
    }

    #[test]
    fn the_other_tables_have_their_figures_in_the_columns_of_their_heads() {
        let mut text = String::new();
        let ratio = SamplerRatio {
            scene: "s".to_owned(),
            backend: "cpu".to_owned(),
            samples: 64,
            at_equal_samples: 4.0,
            at_equal_time: 3.0,
        };
        samplers(&mut text, &[ratio]);
        assert!(text.contains("| scene | backend | samples | at equal samples | at equal time |"), "{text}");
        assert!(text.ends_with("| s | cpu | 64 | 4.00 | 3.00 |\n"), "{text}");
        let row = Calibration {
            curve: curve("cpu", "sobol", 1.0).curve,
            samples: 16,
            seeds: 24,
            predicted_rmse: 0.011,
            actual_rmse: 0.01,
            ratio: 1.1,
            deviation: 0.02,
        };
        text.clear();
        calibration(&mut text, &[row.clone(), Calibration { ratio: 0.96, ..row }]);
        assert!(
            text.contains("1 of 2 ratios are within 1 ± 0.05; the largest deviation is 0.100."),
            "{text}"
        );
        assert!(text.contains("| predicted | actual | predicted / actual |"), "{text}");
        assert!(text.contains("| s | cpu | sobol | 16 | 24 | 0.0110 | 0.0100 | 1.100 ± 0.020 |\n"), "{text}");
    }

    #[test]
    fn a_floor_that_is_too_low_to_tell_has_a_limit() {
        let row = |floor| Rounding {
            scene: "s".to_owned(),
            backend: "cpu".to_owned(),
            samples: 64,
            bias: -2e-6,
            rms: 3e-5,
            floor,
            floor_limit: 5e-6,
        };
        let settings = Settings {
            software: String::new(),
            size: (1, 1),
            seeds: 1,
            time_limit: 1.0,
            max_samples: 64,
            estimate_error: true,
            reference_samples: 64,
            reference: String::new(),
        };
        let rounded = vec![row(Some(4e-6)), row(None)];
        let data = Data { schema: 1, settings, references: Vec::new(), runs: Vec::new(), rounding: rounded };
        let mut half = curve("cpu", "sobol", 1.0);
        half.points.push(CurvePoint { samples: 64, rmse: 0.01, ..half.points[0].clone() });
        let mut text = String::new();
        rounding(&mut text, &data, &[half]);
        assert!(text.contains("| s | cpu | 64 | -2.0e-6 | 3.0e-5 | 4.0e-6 | ~4e8 |\n"), "{text}");
        assert!(text.ends_with("| s | cpu | 64 | -2.0e-6 | 3.0e-5 | < 5.0e-6 | ~> 3e8 |\n"), "{text}");
    }
}
