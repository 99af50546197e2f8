//! The plot of error against time.

use super::curves::{CurvePoint, CurveSummary, distinct};
use super::data::Data;
use crate::numbers::chart::{Axis, Figure, LineChart, Point, Series};

/// One chart per scene, with the times to `target` marked.
pub fn figure(data: &Data, curves: &[CurveSummary], target: f64) -> Figure {
    let scenes = distinct(curves.iter().map(|curve| curve.curve.scene.as_str()));
    let columns = if scenes.len() > 1 { 2 } else { 1 };
    let rows = scenes.len().div_ceil(columns).max(1) as u32;
    let settings = &data.settings;
    let about = format!(
        "lower left is better; each mark doubles the samples: 1, 2, 4 ...; the dashed slope halves the error in 4x the time; {}{}",
        if settings.seeds > 1 { format!("bands span {} pictures; ", settings.seeds) } else { String::new() },
        settings.software
    );
    Figure {
        title: "Error against time".to_owned(),
        about,
        size: [560 * columns as u32, 90 + 470 * rows],
        columns,
        panels: scenes.into_iter().map(|scene| chart(scene, curves, target)).collect(),
    }
}

fn chart(scene: &str, curves: &[CurveSummary], target: f64) -> LineChart {
    let of_scene: Vec<&CurveSummary> = curves.iter().filter(|c| c.curve.scene == scene).collect();
    let points = || of_scene.iter().flat_map(|c| &c.points).filter(|p| p.rmse > 0.0);
    let least = |of: fn(&CurvePoint) -> f64| points().map(of).fold(f64::INFINITY, f64::min);
    let most = |of: fn(&CurvePoint) -> f64| points().map(of).fold(0.0, f64::max);
    let times = [least(|p| p.wall_seconds), most(|p| p.wall_seconds)];
    let errors = [least(|p| p.rmse), most(|p| p.rmse)];
    let bottom = 0.7 * errors[0];
    // The slope of independent samples, from the upper left corner down to the edge of the chart.
    let end = times[1].min(times[0] * (errors[1] / bottom).powi(2));
    let at = |time: f64| errors[1] * (times[0] / time).sqrt();
    let guide = |name: &str, ends: [(f64, f64); 2]| {
        let points = ends.map(|(x, y)| Point { x, y, spread: None }).to_vec();
        Series { name: name.to_owned(), points, is_guide: true }
    };
    let mut series = vec![guide("", [(times[0], at(times[0])), (end, at(end))])];
    if target > bottom && target < errors[1] {
        series.push(guide(&format!("target: {target}"), [(times[0], target), (times[1], target)]));
        let reached = of_scene.iter().filter_map(|c| c.times.first().copied().flatten());
        let reached = reached.filter(|crossing| !crossing.is_extrapolated);
        series.extend(reached.map(|at| guide("", [(at.time, target), (at.time, bottom)])));
    }
    series.extend(of_scene.iter().map(|curve| measured(curve, bottom)));
    let axis = |label: &str, limits: [f64; 2]| Axis { label: label.to_owned(), limits };
    LineChart {
        title: scene.to_owned(),
        x: axis("seconds of rendering", [0.8 * times[0], 1.25 * times[1]]),
        y: axis("error (RMSE, white is 1)", [bottom, 1.4 * errors[1]]),
        series,
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
        is_guide: false,
    }
}
