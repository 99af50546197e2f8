//! Pictures of the cases, by Weekender and by the book's arithmetic, and a page that shows them side by side.

use super::backend::Backend;
use super::case::Case;
use super::families::build::sized;
use super::report::{CaseReport, StressReport};
use super::suite::by_the_book;
use super::table;
use crate::files::{GENERATOR, write_text};
use crate::film::Description;
use crate::output::write_image;
use crate::recipe::{Recipe, file, plain_name};
use crate::stages::Transfer;
use anyhow::{Context, Result};
use std::fmt::Write;
use std::path::Path;
use std::sync::atomic::AtomicBool;

/// Size of a picture on the page, pixels.
const SIZE: [u32; 2] = [120, 80];

/// Samples per pixel of a picture on the page.
const SAMPLES: u64 = 32;

/// Larger scenes are not rendered with the book's arithmetic, which has no hierarchy.
const BOOK_SPHERES: usize = 5000;

/// The two pictures of a case, as in the file names.
const KINDS: [&str; 2] = ["ours", "book"];

/// Renders the pictures of a case and writes them to `directory`.
///
/// # Errors
/// If a file cannot be written. A picture that cannot be rendered is left out.
pub fn write_pictures(
    directory: &Path,
    case: &Case,
    backend: &mut Backend,
    interrupt: &AtomicBool,
) -> Result<()> {
    for (kind, recipe) in KINDS.into_iter().zip(recipes(&case.recipe)) {
        let Some(recipe) = recipe else { continue };
        if let Ok(traced) = backend.trace(&recipe, interrupt) {
            let path = directory.join(file_name(&case.id, kind));
            write_image(&path, &traced.film, Transfer::Gamma2, &description(&recipe))?;
        }
    }
    Ok(())
}

/// A recipe as both pictures of the page show it.
fn recipes(recipe: &Recipe) -> [Option<Recipe>; 2] {
    let [width, height] = SIZE;
    let is_square = recipe.settings.width == recipe.settings.height;
    let ours = sized(recipe.clone(), [if is_square { height } else { width }, height], SAMPLES);
    let many = ours.scene.spheres.len() > BOOK_SPHERES;
    let book = (!many).then(|| by_the_book(&ours));
    [Some(ours), book]
}

fn description(recipe: &Recipe) -> Description {
    Description::new(&file::to_picture_toml(recipe))
}

fn file_name(id: &str, kind: &str) -> String {
    format!("{} {kind}.png", plain_name(id)).replace(' ', "-")
}

/// Writes the table and the page to `directory`.
///
/// # Errors
/// If a file cannot be written.
pub fn write_pages(directory: &Path, report: &StressReport) -> Result<()> {
    write_text(&directory.join("table.md"), &table::markdown(report)).context("cannot write the table")?;
    write_text(&directory.join("index.html"), &page(directory, report)).context("cannot write the page")
}

const PAGE_HEAD: &str = "<title>weekender stress</title>\n<style>\n\
body { font: 15px sans-serif; margin: 2em; max-width: 72em }\n\
td { vertical-align: top; padding: .4em .8em .4em 0 }\n\
img { width: 240px; image-rendering: pixelated; background: #ddd }\n\
.wrong { color: #b00020; font-weight: bold }\n</style>\n<h1>weekender stress</h1>\n";

fn page(directory: &Path, report: &StressReport) -> String {
    let mut text = format!("<!doctype html>\n<meta charset=\"utf-8\">\n{GENERATOR}\n{PAGE_HEAD}");
    // Writing to a string cannot fail.
    let _ = writeln!(text, "<p>{}</p>", escaped(table::summary(report).trim()));
    let _ = writeln!(text, "<table>\n<tr><th>case</th><th>Weekender</th><th>the book's arithmetic</th></tr>");
    for case in &report.cases {
        let _ = writeln!(text, "<tr><td>{}</td>", about(case));
        for kind in KINDS {
            let name = file_name(&case.id, kind);
            if directory.join(&name).exists() {
                let _ = writeln!(text, "<td><img src=\"{name}\" alt=\"{} {kind}\"></td>", escaped(&case.id));
            } else {
                let _ = writeln!(text, "<td>no picture</td>");
            }
        }
        text.push_str("</tr>\n");
    }
    text.push_str("</table>\n");
    text
}

fn about(case: &CaseReport) -> String {
    let mut text = format!("<b>{}</b><br>{}<br>", escaped(&case.id), escaped(&case.stiff));
    let _ = write!(text, "expected: {}, because {}<br>", escaped(&case.expected), escaped(case.why));
    for measured in &case.measured {
        let verdict = &measured.verdict;
        let class = if verdict.is_right() { "right" } else { "wrong" };
        let name = verdict.name().to_lowercase();
        let reason =
            if verdict.is_right() { String::new() } else { format!(": {}", escaped(verdict.reason())) };
        let who = format!("{}, {}", escaped(&measured.backend), measured.form);
        let _ = write!(text, "{who}: <span class=\"{class}\">{name}</span>{reason}<br>");
    }
    text
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::backends::BackendChoice;
    use crate::stages::SurfaceRule;
    use crate::stress::families::build::one_ball;
    use crate::stress::families::cases;

    #[test]
    fn the_page_shows_what_was_rendered() {
        let directory = tempfile::tempdir().unwrap();
        let case = cases().iter().find(|case| case.id == "scaled/1e-3").unwrap();
        let mut backend = Backend::new("cpu", BackendChoice::Cpu(crate::render_cpu::CpuOptions::default()));
        write_pictures(directory.path(), case, &mut backend, &AtomicBool::new(false)).unwrap();
        let report = StressReport {
            schema: 1,
            version: "",
            backends: vec!["cpu".into()],
            seconds: 1.0,
            chosen: 1,
            interrupted: false,
            cases: vec![CaseReport {
                id: case.id.clone(),
                family: case.family.title,
                stiff: "a < b".into(),
                expected: "1".into(),
                why: "so",
                tolerance: 0.0,
                spheres: 1,
                first_hits: None,
                measured: Vec::new(),
                book: Vec::new(),
            }],
        };
        write_pages(directory.path(), &report).unwrap();
        let page = std::fs::read_to_string(directory.path().join("index.html")).unwrap();
        assert!(page.contains("a &lt; b") && !page.contains("no picture"), "{page}");
        for kind in KINDS {
            let path = directory.path().join(file_name("scaled/1e-3", kind));
            assert!(page.contains(path.file_name().unwrap().to_str().unwrap()));
            let read =
                crate::output::read_picture(&path, crate::output::Encoding::Book(Transfer::Gamma2)).unwrap();
            assert_eq!([read.width, read.height], SIZE);
        }
        assert!(directory.path().join("table.md").exists());
    }

    #[test]
    fn a_square_picture_stays_square() {
        let directory = tempfile::tempdir().unwrap();
        let mut case = cases().iter().find(|case| case.id == "shells/1").unwrap().clone();
        case.recipe = sized(case.recipe, [16, 16], 4);
        let options = crate::render_cpu::CpuOptions::default();
        let mut backend = Backend::new("cpu", BackendChoice::Cpu(options));
        write_pictures(directory.path(), &case, &mut backend, &AtomicBool::new(false)).unwrap();
        let path = directory.path().join("shells-1-ours.png");
        let read =
            crate::output::read_picture(&path, crate::output::Encoding::Book(Transfer::Gamma2)).unwrap();
        assert_eq!([read.width, read.height], [80, 80]);
        // A ball of albedo .5 under a white sky, after the square root.
        assert!(read.pixels.iter().flatten().all(|x| (x - 0.5).abs() < 0.005), "{:?}", read.pixels[0]);
    }

    #[test]
    fn the_page_shows_both_arithmetics_unless_the_book_would_take_too_long() {
        let mut recipe = one_ball();
        for (size, expected) in [([24, 16], SIZE), ([8, 6], SIZE), ([8, 8], [80, 80])] {
            let [ours, book] = recipes(&sized(recipe.clone(), size, 4)).map(Option::unwrap);
            assert_eq!((ours.scene.clone(), ours.camera), (recipe.scene.clone(), recipe.camera));
            assert_eq!(([ours.settings.width, ours.settings.height], ours.samples_per_pixel), (expected, 32));
            assert_eq!((ours.rules, book.rules.surface), (recipe.rules, SurfaceRule::Book));
            assert_eq!(Recipe { rules: ours.rules, ..book }, ours);
        }
        for (count, has_book) in [(5000, true), (5001, false)] {
            let scene = std::sync::Arc::make_mut(&mut recipe.scene);
            scene.spheres = vec![scene.spheres[0]; count];
            assert_eq!(recipes(&recipe).map(|recipe| recipe.is_some()), [true, has_book], "{count}");
        }
    }

    #[test]
    fn a_picture_that_is_missing_has_its_cell() {
        let directory = tempfile::tempdir().unwrap();
        let [first, second] = [("a/1", "book"), ("b/2", "ours")];
        for (id, kind) in [first, second] {
            std::fs::write(directory.path().join(file_name(id, kind)), "").unwrap();
        }
        let case = |(id, _): (&str, &str)| CaseReport {
            id: id.to_owned(),
            family: "",
            stiff: "stiff".to_owned(),
            expected: "1".to_owned(),
            why: "so",
            tolerance: 0.0,
            spheres: 1,
            measured: Vec::new(),
            first_hits: None,
            book: Vec::new(),
        };
        let report = StressReport {
            schema: 1,
            version: "",
            backends: Vec::new(),
            seconds: 1.0,
            chosen: 2,
            interrupted: false,
            cases: [first, second].map(case).into(),
        };
        let page = page(directory.path(), &report);
        let none = "<td>no picture</td>\n";
        let of = |name: &str, alt: &str| format!("<td><img src=\"{name}\" alt=\"{alt}\"></td>\n");
        for cells in [
            format!("{none}{}</tr>\n", of("a-1-book.png", "a/1 book")),
            format!("{}{none}</tr>\n", of("b-2-ours.png", "b/2 ours")),
        ] {
            assert!(page.contains(&cells), "{cells}: {page}");
        }
        assert_eq!(page.matches(none).count(), 2);
    }

    #[test]
    fn the_page_says_why_a_backend_is_wrong() {
        use crate::stress::report::Measured;
        use crate::stress::verdict::Verdict;
        let measured = |verdict: Verdict| Measured {
            backend: "a<b".to_owned(),
            form: "+40",
            mean: None,
            offset: None,
            deviation: None,
            rounding: None,
            seconds: None,
            tame_seconds: None,
            verdict,
        };
        let verdicts =
            [Verdict::Right, Verdict::Warned("thin".into()), Verdict::Wrong("off & \"on\"".into())];
        let case = CaseReport {
            id: "i>d".to_owned(),
            family: "",
            stiff: "stiff".to_owned(),
            expected: "1".to_owned(),
            why: "so",
            tolerance: 0.0,
            spheres: 1,
            measured: verdicts.map(measured).into_iter().collect(),
            first_hits: None,
            book: Vec::new(),
        };
        assert_eq!(
            about(&case),
            "<b>i&gt;d</b><br>stiff<br>expected: 1, because so<br>\
             a&lt;b, +40: <span class=\"right\">right</span><br>\
             a&lt;b, +40: <span class=\"right\">warned</span><br>\
             a&lt;b, +40: <span class=\"wrong\">wrong</span>: off &amp; &quot;on&quot;<br>"
        );
    }
}
