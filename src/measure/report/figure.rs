//! The plot of error against time.

use super::data::Data;
use super::summary::{CurvePoint, CurveSummary, distinct};
use crate::chart::{Axis, Corner, Figure, LineChart, Look, Panel, Point, Scale, Series};

/// One chart per scene, with the times to `target` marked.
pub fn figure(data: &Data, curves: &[CurveSummary], target: f64) -> Figure {
    let scenes = distinct(curves.iter().map(|curve| curve.curve.scene.as_str()));
    let columns = if scenes.len() > 1 { 2 } else { 1 };
    let rows = scenes.len().div_ceil(columns).max(1) as u32;
    let settings = &data.settings;
    let about = format!(
        "lower left is better; each mark doubles the samples: 1, 2, 4 ...; {}{}",
        if settings.seeds > 1 { format!("bands span {} pictures; ", settings.seeds) } else { String::new() },
        settings.software
    );
    Figure {
        title: "Error against time".to_owned(),
        about,
        size: [560 * columns as u32, 90 + 470 * rows],
        columns,
        panels: scenes.into_iter().map(|scene| Panel::Lines(chart(scene, data, curves, target))).collect(),
    }
}

fn chart(scene: &str, data: &Data, curves: &[CurveSummary], target: f64) -> LineChart {
    let of_scene: Vec<&CurveSummary> = curves.iter().filter(|c| c.curve.scene == scene).collect();
    let points = || of_scene.iter().flat_map(|c| &c.points).filter(|p| p.rmse > 0.0);
    let least = |of: fn(&CurvePoint) -> f64| points().map(of).fold(f64::INFINITY, f64::min);
    let most = |of: fn(&CurvePoint) -> f64| points().map(of).fold(0.0, f64::max);
    let times = [least(|p| p.wall_seconds), most(|p| p.wall_seconds)];
    let errors = [least(|p| p.rmse), most(|p| p.rmse)];
    let bottom = 0.7 * errors[0];
    let mut series = guides(times, errors, bottom, &of_scene, target);
    series.extend(floor(scene, data, times, bottom));
    series.extend(of_scene.iter().map(|curve| measured(curve, bottom)));
    let axis = |label: &str, limits: [f64; 2]| {
        // A chart without points has no limits of its own.
        let limits = (limits[0] > 0.0 && limits[0] < limits[1]).then_some(limits);
        Axis { limits, ..Axis::new(label, Scale::Log) }
    };
    LineChart {
        title: scene.to_owned(),
        x: axis("seconds of rendering", [0.8 * times[0], 1.25 * times[1]]),
        y: axis("error (RMSE, white is 1)", [bottom, 1.4 * errors[1]]),
        series,
        legend: Some(Corner::LowerLeft),
    }
}

fn measured(curve: &CurveSummary, bottom: f64) -> Series {
    let points = curve.points.iter().map(|p| Point {
        x: p.wall_seconds,
        y: p.rmse,
        spread: Some(p.range.map(|end| end.max(bottom))),
    });
    Series {
        name: format!("{}, {}", curve.curve.backend, curve.curve.sampler),
        points: points.collect(),
        look: Look::Measured,
    }
}

fn line(name: String, points: &[[f64; 2]]) -> Series {
    let points = points.iter().map(|[x, y]| Point { x: *x, y: *y, spread: None }).collect();
    Series { name, points, look: Look::Guide }
}

/// Guides: the slope of independent samples, the target, and when each curve reaches it.
fn guides(
    times: [f64; 2],
    errors: [f64; 2],
    bottom: f64,
    curves: &[&CurveSummary],
    target: f64,
) -> Vec<Series> {
    let mut guides = Vec::new();
    // From the upper left corner down to the edge of the chart.
    let end = times[1].min(times[0] * (errors[1] / bottom).powi(2));
    let at = |time: f64| errors[1] * (times[0] / time).sqrt();
    guides.push(line("4x the time, half the error".to_owned(), &[[times[0], at(times[0])], [end, at(end)]]));
    if target > bottom && target < errors[1] {
        guides.push(line(format!("target: {target}"), &[[times[0], target], [times[1], target]]));
        for crossing in
            curves.iter().filter_map(|c| c.times.first().copied().flatten()).filter(|c| !c.is_extrapolated)
        {
            guides.push(line(String::new(), &[[crossing.time, target], [crossing.time, bottom]]));
        }
    }
    guides
}

/// Where rounding would stop the error from falling, if the chart reaches that low.
fn floor(scene: &str, data: &Data, times: [f64; 2], bottom: f64) -> Option<Series> {
    let of_scene = data.rounding.iter().filter(|row| row.scene == scene);
    let floor = of_scene.filter_map(|row| row.floor).fold(0.0, f64::max);
    (floor > bottom).then(|| line("rounding".to_owned(), &[[times[0], floor], [times[1], floor]]))
}

#[cfg(test)]
mod tests {
    use super::super::data::Rounding;
    use super::super::tests::data as no_data;
    use super::*;
    use crate::measure::report::Curve;
    use crate::statistics::fit::Crossing;

    fn data(floor: Option<f64>) -> Data {
        let (scene, backend) = ("book".to_owned(), "cpu".to_owned());
        let rounding =
            Rounding { scene, backend, samples: 64, bias: 0.0, rms: 0.125, floor, floor_limit: 0.5 };
        Data { rounding: vec![rounding], ..no_data() }
    }

    fn point(wall_seconds: f64, rmse: f64) -> CurvePoint {
        CurvePoint {
            samples: 16,
            trace_seconds: wall_seconds,
            wall_seconds,
            device_seconds: None,
            rmse,
            range: [0.5 * rmse, 2.0 * rmse],
            rel_mse: 0.0,
            flip: 0.0,
            estimate_ratio: None,
        }
    }

    fn curve(scene: &str) -> CurveSummary {
        let [scene, backend, sampler] = [scene, "cpu", "sobol"].map(str::to_owned);
        CurveSummary {
            curve: Curve { scene, backend, sampler },
            about: String::new(),
            points: vec![point(1.0, 1.0), point(4.0, 0.25)],
            slope: None,
            efficiency: 1.0,
            times: vec![Some(Crossing { time: 2.0, is_extrapolated: false })],
        }
    }

    #[test]
    fn a_target_or_floor_outside_the_chart_is_not_drawn() {
        let names = |floor: Option<f64>, curves: &[CurveSummary], target: f64| -> Vec<String> {
            let chart = chart("book", &data(floor), curves, target);
            chart.series.into_iter().map(|series| series.name).collect()
        };
        let curves = [curve("book")];
        let all = ["4x the time, half the error", "target: 0.5", "", "rounding", "cpu, sobol"];
        assert_eq!(names(Some(0.25), &curves, 0.5), all);
        // The chart goes from 0.175 to 1.4.
        for target in [0.17, 1.0, 2.0] {
            assert_eq!(names(Some(0.25), &curves, target), [all[0], all[3], all[4]], "{target}");
        }
        assert_eq!(names(Some(0.17), &curves, 0.5), [all[0], all[1], all[2], all[4]]);
        // A time that is only expected is not marked.
        let mut expected = curve("book");
        expected.times[0] = Some(Crossing { time: 9.0, is_extrapolated: true });
        assert_eq!(names(None, &[expected], 0.5), [all[0], all[1], all[4]]);
    }
}
