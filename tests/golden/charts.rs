//! Charts of made-up numbers, as SVG.

use crate::common::check;
use weekender::chart::{
    Axis, Bar, BarChart, Corner, Figure, LineChart, Look, Panel, Point, Scale, Series, page_svg, save,
};

/// A series over 2^`from` to 2^`to`.
fn series(name: &str, look: Look, [from, to]: [i32; 2], law: impl Fn(f64) -> f64) -> Series {
    let point = |power: i32| {
        let x = 2_f64.powi(power);
        let spread = (power % 2 == 0).then(|| [0.8 * law(x), 1.3 * law(x)]);
        Point { x, y: law(x), spread }
    };
    Series { name: name.to_owned(), points: (from..=to).map(point).collect(), look }
}

fn errors(scale: Scale, legend: Option<Corner>) -> Panel {
    let measured = ["independent", "sobol", "third", "fourth", "fifth", "sixth", "seventh"];
    let guide = series("slope -1/2", Look::Guide, [-4, 9], |x| 0.3 / x.sqrt());
    let lines = measured.iter().enumerate().map(|(index, name)| {
        let share = 0.1 / (index + 1) as f64;
        series(name, Look::Measured, [index as i32, 8], move |x| share / x.powf(0.5 + share))
    });
    Panel::Lines(LineChart {
        title: "Error".to_owned(),
        x: Axis::new("seconds", scale),
        y: Axis::new("RMSE", Scale::Log),
        series: std::iter::once(guide).chain(lines).collect(),
        legend,
    })
}

fn straight() -> Panel {
    let axis = |label: &str, limits| Axis { limits, ..Axis::new(label, Scale::Linear) };
    let alone = Series {
        name: "alone".to_owned(),
        points: vec![Point { x: 1.5, y: 2.5, spread: Some([2.0, 3.0]) }],
        look: Look::Measured,
    };
    Panel::Lines(LineChart {
        title: String::new(),
        x: axis("spheres", Some([0.0, 4.0])),
        y: axis("seconds", None),
        series: vec![series("", Look::Measured, [-3, 2], |x| 3.0 * x + 1.0), alone],
        legend: Some(Corner::LowerRight),
    })
}

fn speeds() -> Panel {
    let bar = |(index, name): (usize, &&str)| Bar {
        name: (*name).to_owned(),
        value: 3.7 * 1.6_f64.powi(index as i32),
        spread: (index != 1).then(|| [3.3 * 1.6_f64.powi(index as i32), 4.1 * 1.6_f64.powi(index as i32)]),
        note: format!("{index} of 5"),
        kind: index / 2,
    };
    let names = ["C89", "one lane", "4 lanes", "8 lanes", "16 lanes on all threads of the machine"];
    Panel::Bars(BarChart {
        title: "Speed".to_owned(),
        label: "million paths per second".to_owned(),
        bars: names.iter().enumerate().map(bar).collect(),
    })
}

fn saved(figure: &Figure) -> String {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("chart.svg");
    save(&path, figure).unwrap();
    std::fs::read_to_string(path).unwrap()
}

#[test]
fn charts_are_as_kept() {
    let (upper, lower) = (Some(Corner::UpperRight), Some(Corner::LowerLeft));
    let grid = Figure {
        title: "Weekender".to_owned(),
        about: "made-up numbers".to_owned(),
        size: [960, 720],
        columns: 2,
        panels: vec![errors(Scale::Log, lower), speeds(), errors(Scale::Linear, upper)],
    };
    check("charts_grid", &saved(&grid));
    let (columns, size) = (1, [480, 360]);
    let untitled = Figure {
        title: String::new(),
        about: String::new(),
        size,
        columns,
        panels: vec![straight(), errors(Scale::Log, Some(Corner::UpperLeft))],
    };
    check("charts_untitled", &saved(&untitled));
    let page = Figure { panels: vec![errors(Scale::Log, None)], size: [640, 320], ..untitled };
    check("charts_page", &page_svg(&page, "Error against time").unwrap());
}
