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

#[cfg(test)]
mod tests {
    use super::super::figures::{Row, SCHEMA};
    use super::super::machine::Machine;
    use super::*;

    fn figures(scenes: Vec<SceneFigures>, scale: Vec<ScaleFigures>) -> BenchFigures {
        let machine = Machine {
            version: "1.2.3",
            processor: "a processor".to_owned(),
            cores: 8,
            levels: vec!["portable", "avx2"],
            load_at_start: None,
        };
        let (features, warnings) = (Vec::new(), Vec::new());
        BenchFigures { schema: SCHEMA, machine, scenes, scale, features, warnings, interrupted: false }
    }

    fn spread(median: f64) -> Option<Spread> {
        Some(Spread { median, min: 0.5 * median, max: 2.0 * median })
    }

    fn row(name: &str, kind: Kind, speed: Option<f64>) -> Row {
        Row {
            name: name.to_owned(),
            kind,
            lanes: 1,
            threads: 1,
            samples_per_pixel: 4,
            runs: Vec::new(),
            paths_per_second: speed.and_then(spread),
            rays_per_second: None,
            lanes_in_use: None,
            ratio_to_baseline: speed.map(|speed| speed / 4e6),
            efficiency: None,
            skipped: None,
        }
    }

    fn scene(name: &str, rows: Vec<Row>) -> SceneFigures {
        let scene = name.to_owned();
        SceneFigures { scene, width: 200, height: 113, max_depth: 50, sampler: "sobol", spheres: 5, rows }
    }

    #[test]
    fn a_scene_has_a_bar_for_each_row_that_was_measured() {
        let rows = vec![
            row("C89", Kind::Baseline, Some(4e6)),
            row("avx2", Kind::Packets, Some(128e6)),
            row("GPU", Kind::Gpu, None),
        ];
        let panel = |title: &str, bars: Vec<Bar>| {
            let label = "million paths per second: median, minimum and maximum".to_owned();
            Panel::Bars(BarChart { title: title.to_owned(), label, bars })
        };
        let bar = |name: &str, value: f64, note: &str, kind| Bar {
            name: name.to_owned(),
            value,
            spread: Some([0.5 * value, 2.0 * value]),
            note: note.to_owned(),
            kind,
        };
        let scenes = vec![scene("book", rows), scene("sky", vec![row("avx2", Kind::Packets, Some(8e6))])];
        let expected = Figure {
            title: "Paths per second".to_owned(),
            about: "Weekender 1.2.3, a processor, 8 threads, avx2".to_owned(),
            // Both charts are as high as the one with two bars.
            size: [1000, 64 + 2 * (100 + 2 * 36)],
            columns: 1,
            panels: vec![
                panel(
                    "book, 200 × 113, depth 50",
                    vec![bar("C89", 4.0, "4.0", 0), bar("avx2", 128.0, "128   32.0 × C89", 2)],
                ),
                panel("sky, 200 × 113, depth 50", vec![bar("avx2", 8.0, "8.0   2.0 × C89", 2)]),
            ],
        };
        assert_eq!(figure(&figures(scenes, Vec::new())), expected);
        assert_eq!(figure(&figures(Vec::new(), Vec::new())).size, [1000, 164], "nothing was measured");
    }

    #[test]
    fn fields_have_curves_of_time_memory_and_speed() {
        let field = |spheres: u64, peak_memory_bytes, speed| ScaleFigures {
            spheres,
            generate_seconds: 0.25,
            build_seconds: 0.5,
            hierarchy_seconds: 0.125,
            scene_bytes_per_sphere: 40.0,
            table_bytes_per_sphere: 128.0,
            peak_memory_bytes,
            samples_per_pixel: 4,
            paths_per_second: spread(speed),
            rays_per_second: None,
        };
        let scale = vec![field(4096, Some(64 << 20), 4e6), field(8192, None, 2e6)];
        let figure = figure(&figures(Vec::new(), scale));
        assert_eq!((figure.size, figure.columns), ([1350, 480], 3));
        let lines: Vec<(String, Vec<String>)> = figure
            .panels
            .iter()
            .map(|panel| {
                let Panel::Lines(chart) = panel else { panic!("{panel:?}") };
                assert_eq!(
                    (chart.x.label.as_str(), [chart.x.scale, chart.y.scale]),
                    ("spheres", [Scale::Log; 2])
                );
                let of_series = |series: &Series| {
                    let points: Vec<String> = series
                        .points
                        .iter()
                        .map(|point| match point.spread {
                            None => format!("{} {}", point.x, point.y),
                            Some([low, high]) => format!("{} {} ({low} to {high})", point.x, point.y),
                        })
                        .collect();
                    format!("{}: {}", series.name, points.join(", "))
                };
                (format!("{}, {}", chart.title, chart.y.label), chart.series.iter().map(of_series).collect())
            })
            .collect();
        let lines: Vec<(&str, Vec<&str>)> = lines
            .iter()
            .map(|(title, series)| (title.as_str(), series.iter().map(String::as_str).collect()))
            .collect();
        assert_eq!(
            lines,
            [
                (
                    "Time to build, seconds",
                    vec![
                        "in proportion: 4096 1.5, 8192 3",
                        "prepared scene: 4096 0.5, 8192 0.5",
                        "hierarchy: 4096 0.125, 8192 0.125",
                        "scene generation: 4096 0.25, 8192 0.25",
                    ]
                ),
                (
                    "Memory, MiB",
                    vec![
                        "2 GiB: 4096 2048, 8192 2048",
                        "process peak: 4096 64",
                        "prepared scene: 4096 0.5, 8192 1",
                    ]
                ),
                ("Speed, million paths per second", vec![": 4096 4 (2 to 8), 8192 2 (1 to 4)"]),
            ]
        );
    }
}
