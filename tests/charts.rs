//! Charts written to files.

#![allow(clippy::unwrap_used)]

use std::path::Path;
use weekender::numbers::chart::{
    Axis, Bar, BarChart, ChartError, Figure, LineChart, Look, Panel, Point, Series, save,
};

const SIZE: [u32; 2] = [480, 360];

fn series(name: &str, look: Look, law: impl Fn(f64) -> f64) -> Series {
    let point = |power: i32| {
        let x = 2_f64.powi(power);
        Point { x, y: law(x), spread: Some([0.8 * law(x), 1.3 * law(x)]) }
    };
    Series { name: name.to_owned(), points: (0..8).map(point).collect(), look }
}

fn lines() -> Panel {
    Panel::Lines(LineChart {
        title: "Error".to_owned(),
        x: Axis::new("seconds"),
        y: Axis::new("RMSE"),
        series: vec![
            series("slope -1/2", Look::Guide, |x| 0.3 / x.sqrt()),
            series("independent", Look::Measured, |x| 0.1 / x.sqrt()),
            series("sobol", Look::Measured, |x| 0.05 / x.powf(0.7)),
        ],
    })
}

fn bars() -> Panel {
    let bar = |name: &str, value: f64, kind| Bar {
        name: name.to_owned(),
        value,
        spread: Some([0.9 * value, 1.1 * value]),
        note: format!("{value:.1}"),
        kind,
    };
    Panel::Bars(BarChart {
        title: "Speed".to_owned(),
        label: "million paths per second".to_owned(),
        bars: vec![bar("scalar", 3.0, 0), bar("8 lanes", 25.0, 1)],
    })
}

fn figure(panels: Vec<Panel>) -> Figure {
    let columns = panels.len();
    Figure { title: "A title".to_owned(), about: "and a line".to_owned(), size: SIZE, columns, panels }
}

/// Pixels of a PNG, RGB.
fn pixels(path: &Path) -> image::RgbImage {
    image::open(path).unwrap().to_rgb8()
}

#[test]
fn a_png_shows_every_series_in_its_colour() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("chart.png");
    save(&path, &figure(vec![lines(), bars()])).unwrap();
    let picture = pixels(&path);
    assert_eq!([picture.width(), picture.height()], SIZE.map(|points| 2 * points));
    for color in [[0x00, 0x72, 0xB2], [0xD5, 0x5E, 0x00]] {
        for half in [0, 1] {
            let wide = picture.width() / 2;
            let count =
                picture.enumerate_pixels().filter(|(x, _, p)| x / wide == half && p.0 == color).count();
            assert!(count > 200, "{color:?} has {count} pixels in half {half}");
        }
    }
}

#[test]
fn an_svg_has_its_texts_as_texts() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("chart.SVG");
    save(&path, &figure(vec![lines(), bars()])).unwrap();
    let text = std::fs::read_to_string(path).unwrap();
    assert!(text.starts_with("<svg") && text.trim_end().ends_with("</svg>"));
    for word in ["A title", "and a line", "seconds", "RMSE", "independent", "sobol", "8 lanes", "25.0"] {
        assert!(text.lines().any(|line| line.trim() == word), "{word}");
    }
}

#[test]
fn what_cannot_be_shown_is_left_out() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("chart.png");
    let values = [0.0, -1.0, f64::NAN, f64::INFINITY, 1e-300, 1e300];
    let points = values.map(|y| Point { x: y, y, spread: Some([-y, y]) }).to_vec();
    let series = vec![
        Series { name: "odd".to_owned(), points, look: Look::Measured },
        Series { name: "none".to_owned(), points: Vec::new(), look: Look::Guide },
    ];
    let axis = Axis::new("x");
    let chart = LineChart { title: String::new(), x: axis.clone(), y: axis, series };
    save(&path, &figure(vec![Panel::Lines(chart)])).unwrap();
    let none = BarChart { title: String::new(), label: String::new(), bars: Vec::new() };
    save(&path, &figure(vec![Panel::Bars(none)])).unwrap();
    save(&path, &figure(Vec::new())).unwrap();
}

#[test]
fn other_endings_are_refused_before_anything_is_written() {
    let directory = tempfile::tempdir().unwrap();
    for name in ["chart", "chart.jpg", "png"] {
        let path = directory.path().join(name);
        let error = save(&path, &figure(vec![bars()])).unwrap_err();
        assert!(matches!(error, ChartError::UnknownEnding { .. }));
        assert!(error.to_string().contains(".png or .svg"), "{error}");
        assert!(!path.exists());
    }
    let nowhere = directory.path().join("no").join("chart.png");
    assert!(matches!(save(&nowhere, &figure(vec![bars()])), Err(ChartError::Write(_))));
}
