//! Charts of the measurements.

use super::figures::{BenchFigures, Kind, ScaleFigures, SceneFigures, Spread};
use crate::chart::{Axis, Bar, BarChart, Corner, Figure, LineChart, Look, Panel, Point, Scale, Series};

/// Height of a bar's row and of everything around the rows, points.
const ROW_HEIGHT: u32 = 36;
const FRAME_HEIGHT: u32 = 100;

/// A chart of the rows of all scenes or, if they were measured, of the fields.
pub fn figure(figures: &BenchFigures) -> Figure {
    if figures.scale.is_empty() { bars(figures) } else { scale(figures) }
}

fn bars(figures: &BenchFigures) -> Figure {
    let rows = |scene: &SceneFigures| scene.rows.iter().filter(|row| row.paths_per_second.is_some()).count();
    let most = figures.scenes.iter().map(rows).max().unwrap_or(0) as u32;
    let panels: Vec<Panel> = figures.scenes.iter().map(|scene| Panel::Bars(scene_bars(scene))).collect();
    Figure {
        title: "Paths per second".to_owned(),
        about: figures.machine.words(),
        size: [1000, 64 + panels.len().max(1) as u32 * (FRAME_HEIGHT + ROW_HEIGHT * most)],
        columns: 1,
        panels,
    }
}

fn scene_bars(scene: &SceneFigures) -> BarChart {
    let millions = |number: f64| number / 1e6;
    let bars = scene.rows.iter().filter_map(|row| {
        let Spread { median, min, max } = row.paths_per_second?;
        let number = format!("{:.*}", if median < 1e8 { 1 } else { 0 }, millions(median));
        let note = match row.ratio_to_baseline {
            Some(ratio) if row.kind != Kind::Baseline => format!("{number}   {ratio:.1} × C89"),
            _ => number,
        };
        Some(Bar {
            name: row.name.clone(),
            value: millions(median),
            spread: Some([millions(min), millions(max)]),
            note,
            kind: row.kind as usize,
        })
    });
    BarChart {
        title: format!("{}, {} × {}, depth {}", scene.scene, scene.width, scene.height, scene.max_depth),
        label: "million paths per second: median, minimum and maximum".to_owned(),
        bars: bars.collect(),
    }
}

fn scale(figures: &BenchFigures) -> Figure {
    let rows = &figures.scale;
    let series = |name: &str, value: &dyn Fn(&ScaleFigures) -> Option<f64>| {
        let point = |row| Some(Point { x: row_count(row), y: value(row)?, spread: None });
        Series {
            name: name.to_owned(),
            points: rows.iter().filter_map(point).collect(),
            look: Look::Measured,
        }
    };
    let chart = |title: &str, unit: &str, series: Vec<Series>, legend| {
        Panel::Lines(LineChart {
            title: title.to_owned(),
            x: Axis::new("spheres", Scale::Log),
            y: Axis::new(unit, Scale::Log),
            series,
            legend,
        })
    };
    let hierarchy = series("hierarchy", &|row| Some(row.hierarchy_seconds));
    let build = series("prepared scene", &|row| Some(row.build_seconds));
    let generate = series("scene generation", &|row| Some(row.generate_seconds));
    let guide = in_proportion(&build);
    let mib = |bytes: f64| bytes / f64::from(1 << 20);
    let tables = series("prepared scene", &|row| Some(mib(row.table_bytes_per_sphere * row_count(row))));
    let peak = series("process peak", &|row| Some(mib(row.peak_memory_bytes? as f64)));
    let limit = Series { look: Look::Guide, ..series("2 GiB", &|_| Some(2048.0)) };
    let speed = Series {
        name: String::new(),
        points: rows
            .iter()
            .filter_map(|row| {
                let Spread { median, min, max } = row.paths_per_second?;
                Some(Point { x: row_count(row), y: median / 1e6, spread: Some([min / 1e6, max / 1e6]) })
            })
            .collect(),
        look: Look::Measured,
    };
    Figure {
        title: "Fields of a thousand or more spheres".to_owned(),
        about: figures.machine.words(),
        size: [1350, 480],
        columns: 3,
        panels: vec![
            chart(
                "Time to build",
                "seconds",
                vec![guide, build, hierarchy, generate],
                Some(Corner::UpperLeft),
            ),
            chart("Memory", "MiB", vec![limit, peak, tables], Some(Corner::LowerRight)),
            chart("Speed", "million paths per second", vec![speed], None),
        ],
    }
}

fn row_count(row: &ScaleFigures) -> f64 {
    row.spheres as f64
}

/// A guide in proportion to x, through the first point of a series and a little above it.
fn in_proportion(series: &Series) -> Series {
    let first = series.points.first().copied();
    let points = first.into_iter().flat_map(|first| {
        let law = move |x: f64| Point { x, y: 3.0 * first.y * x / first.x, spread: None };
        series.points.iter().map(move |point| law(point.x))
    });
    Series { name: "in proportion".to_owned(), points: points.collect(), look: Look::Guide }
}
