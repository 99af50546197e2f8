//! `report.md`.

use super::super::table::or_dash;
use super::curves::{CurveSummary, distinct};
use super::data::Data;
use crate::numbers::statistics::fit::Crossing;

/// Backends to compare others with, if measured.
const BASES: [&str; 2] = ["c89", "scalar"];

/// The report as Markdown. `command` made the report.
pub fn markdown(data: &Data, curves: &[CurveSummary], targets: &[f64], command: &str) -> String {
    let settings = &data.settings;
    let mut text = format!(
        "# Error against time\n\nHow the error of a picture falls with time, as measured by\n\n    {command}\n\n\
         with {}. Pictures per curve, with different random numbers: {}. Seconds of tracing for all of them: {}. \
         Samples per pixel: at most {}.\n\n![Error against time](error-vs-time.svg)\n\n{HOW_TO_READ}",
        settings.software, settings.seeds, settings.time_limit, settings.max_samples
    );
    for scene in distinct(curves.iter().map(|curve| curve.curve.scene.as_str())) {
        let of_scene: Vec<&CurveSummary> = curves.iter().filter(|c| c.curve.scene == scene).collect();
        text += &format!("\n## {scene}\n\n");
        if let Some(reference) = data.references.iter().find(|r| r.scene == scene) {
            text += &format!(
                "The reference has {} samples per pixel by {}. Its own RMSE of {:.1e} has been subtracted.\n\n",
                reference.samples,
                reference.about,
                reference.mse.sqrt()
            );
        }
        text += &overview(&of_scene, targets);
    }
    text
}

const HOW_TO_READ: &str = "\
**How to read it.** *RMSE* is the root mean square difference from the reference over pixels and channels, in linear
radiance, where white is 1. At 0.05 a picture is grainy, at 0.01 nearly clean, and at 0.001 no screen shows the
difference. *relMSE* gives more weight to errors in dark areas. The *slope* is the exponent of the seconds in the RMSE:
-0.5 means that halving the error takes four times as long. *Efficiency* is 1/(RMSE^2 seconds): twice the efficiency
gives the same picture in half the time. *Estimate* is the RMSE that the pictures' halves predict without a reference,
divided by the true one. Efficiency, relMSE and estimate are of the last point. Times with ~ are extrapolated. Seconds
are medians over the pictures and include adding to the film; errors are means. `report.json` has every picture at every
number of samples.
";

/// One row per curve of a scene.
fn overview(curves: &[&CurveSummary], targets: &[f64]) -> String {
    let bases: Vec<&str> =
        BASES.into_iter().filter(|base| curves.iter().any(|c| c.curve.backend == *base)).collect();
    let mut heads =
        ["backend", "sampler", "slope", "efficiency", "relMSE", "estimate"].map(str::to_owned).to_vec();
    heads.extend(targets.iter().map(|target| format!("to RMSE {target}")));
    heads.extend(bases.iter().map(|base| format!("times {base}")));
    let rows = curves.iter().map(|curve| {
        let slope = or_dash(curve.slope, |[slope, deviation]| format!("{slope:.2} ± {deviation:.2}"));
        let names = [&curve.curve.backend, &curve.curve.sampler].map(Clone::clone);
        let last = curve.points.last();
        let rel_mse = or_dash(last, |point| number(point.rel_mse));
        let estimate = or_dash(last.and_then(|point| point.estimate_ratio), |ratio| format!("{ratio:.3}"));
        let figures = [slope, number(curve.efficiency), rel_mse, estimate];
        let mut row = [&names[..], &figures].concat();
        row.extend(curve.times.iter().map(|time| {
            or_dash(*time, |c| format!("{}{} s", if c.is_extrapolated { "~" } else { "" }, number(c.time)))
        }));
        row.extend(bases.iter().map(|base| ratio(curve, curves, base)));
        row
    });
    let mut text = markdown_table(&heads, rows);
    if let (false, [target, ..]) = (bases.is_empty(), targets) {
        text += &format!(
            "\n*times X*: how many times as long X takes to reach an RMSE of {target} with its best sampler.\n"
        );
    }
    text
}

/// How many times as long `base` takes to reach the first target.
fn ratio(curve: &CurveSummary, curves: &[&CurveSummary], base: &str) -> String {
    let first = |curve: &CurveSummary| curve.times.first().copied().flatten();
    let of_base = curves.iter().filter(|c| c.curve.backend == base).filter_map(|c| first(c));
    let best: Option<Crossing> = of_base.min_by(|a, b| a.time.total_cmp(&b.time));
    or_dash(best.zip(first(curve)), |(base, mine)| {
        let mark = if base.is_extrapolated || mine.is_extrapolated { "~" } else { "" };
        format!("{mark}{:.2}", base.time / mine.time)
    })
}

/// A Markdown table. Columns after the first two are right-aligned.
fn markdown_table(heads: &[String], rows: impl IntoIterator<Item = Vec<String>>) -> String {
    let rule = (0..heads.len()).map(|column| if column < 2 { "---" } else { "---:" }.to_owned());
    let rows = [heads.to_vec(), rule.collect()].into_iter().chain(rows);
    rows.map(|cells| format!("| {} |\n", cells.join(" | "))).collect()
}

/// Three significant digits.
fn number(x: f64) -> String {
    match x.abs() {
        size if !size.is_finite() => "-".to_owned(),
        size if !(1e-3..1e5).contains(&size) => format!("{x:.2e}"),
        size => format!("{x:.*}", (2 - size.log10().floor() as i32).max(0) as usize),
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::curve as key;
    use super::*;

    #[test]
    fn ratio_uses_best_baseline_sampler() {
        let curve = |backend, sampler, seconds: f64| CurveSummary {
            curve: key(backend, sampler),
            points: Vec::new(),
            slope: None,
            efficiency: 2.0,
            times: vec![Some(Crossing { time: seconds, is_extrapolated: seconds > 30.0 })],
        };
        let curves = [
            curve("c89", "independent", 40.0),
            curve("c89", "sobol", 20.0),
            curve("cpu", "sobol", 5.0),
            curve("cpu", "independent", 50.0),
        ];
        let ratios = curves.each_ref().map(|curve| ratio(curve, &curves.each_ref(), "c89"));
        assert_eq!(ratios, ["~0.50", "1.00", "4.00", "~0.40"]);
        assert_eq!([40.0, 0.0400, 2e5].map(number), ["40.0", "0.0400", "2.00e5"]);
    }
}
