//! Charts of the measurements.

use super::super::machine::Machine;
use super::figures::{BenchFigures, Kind, ScaleFigures, SceneFigures, Spread};
use crate::numbers::chart::{Axis, Bar, BarChart, Figure, LineChart, Look, Panel, Point, Series};

/// Height of a bar's row, and of everything around the rows, points.
const ROW_HEIGHT: u32 = 36;
const FRAME_HEIGHT: u32 = 100;

/// Charts the rows of all scenes or, if fields were measured, the fields.
pub fn figure(machine: &Machine, figures: &BenchFigures) -> Figure {
    let about = machine.words();
    if figures.scale.is_empty() { bars(&figures.scenes, about) } else { scale(&figures.scale, about) }
}

fn bars(scenes: &[SceneFigures], about: String) -> Figure {
    let rows = |scene: &SceneFigures| scene.rows.iter().filter(|row| row.paths_per_second.is_some()).count();
    let most = scenes.iter().map(rows).max().unwrap_or(0) as u32;
    Figure {
        title: "Paths per second".to_owned(),
        about,
        size: [1000, 64 + scenes.len().max(1) as u32 * (FRAME_HEIGHT + ROW_HEIGHT * most)],
        columns: 1,
        panels: scenes.iter().map(|scene| Panel::Bars(scene_bars(scene))).collect(),
    }
}

fn scene_bars(scene: &SceneFigures) -> BarChart {
    let bars = scene.rows.iter().filter_map(|row| {
        let [median, min, max] = millions(row.paths_per_second?);
        let number = format!("{median:.*}", if median < 100.0 { 1 } else { 0 });
        let note = match row.ratio_to_baseline {
            Some(ratio) if row.kind != Kind::Baseline => format!("{number}   {ratio:.1} × C89"),
            _ => number,
        };
        let (name, spread) = (row.name.clone(), Some([min, max]));
        Some(Bar { name, value: median, spread, note, kind: row.kind as usize })
    });
    BarChart {
        title: format!("{}, {} × {}, depth {}", scene.scene, scene.width, scene.height, scene.max_depth),
        label: "million paths per second: median, minimum and maximum".to_owned(),
        bars: bars.collect(),
    }
}

fn millions(Spread { median, min, max }: Spread) -> [f64; 3] {
    [median, min, max].map(|number| number / 1e6)
}

fn scale(rows: &[ScaleFigures], about: String) -> Figure {
    let series = |name: &str, value: &dyn Fn(&ScaleFigures) -> Option<f64>| {
        let points = rows.iter().filter_map(|row| Some((row.spheres as f64, value(row)?)));
        Series::new(name, Look::Measured, points)
    };
    let chart = |title: &str, unit: &str, series: Vec<Series>| {
        Panel::Lines(LineChart {
            title: title.to_owned(),
            x: Axis::new("spheres"),
            y: Axis::new(unit),
            series,
        })
    };
    let build = series("prepared scene", &|row| Some(row.build_seconds));
    let times = vec![
        in_proportion(&build),
        build,
        series("hierarchy", &|row| Some(row.hierarchy_seconds)),
        series("scene generation", &|row| Some(row.generate_seconds)),
    ];
    let mib = |bytes: f64| bytes / f64::from(1 << 20);
    let memory = vec![
        Series { look: Look::Guide, ..series("2 GiB", &|_| Some(2048.0)) },
        series("process peak", &|row| Some(mib(row.peak_memory_bytes? as f64))),
        series("prepared scene", &|row| Some(mib(row.table_bytes_per_sphere * row.spheres as f64))),
    ];
    let speed = rows.iter().filter_map(|row| {
        let [median, min, max] = millions(row.paths_per_second?);
        Some(Point { x: row.spheres as f64, y: median, spread: Some([min, max]) })
    });
    let speed = Series { name: String::new(), points: speed.collect(), look: Look::Measured };
    Figure {
        title: "Fields of a thousand or more spheres".to_owned(),
        about,
        size: [1350, 480],
        columns: 3,
        panels: vec![
            chart("Time to build", "seconds", times),
            chart("Memory", "MiB", memory),
            chart("Speed", "million paths per second", vec![speed]),
        ],
    }
}

/// A guide proportional to x, through a point just above the series' first.
fn in_proportion(series: &Series) -> Series {
    let law = |point: &Point| (point.x, 3.0 * series.points[0].y * point.x / series.points[0].x);
    Series::new("in proportion", Look::Guide, series.points.iter().map(law))
}
