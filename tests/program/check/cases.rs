//! Pictures of a plain tracer that shares no code with Weekender, and what must be said about them.

use crate::check::book::Book;
use crate::common::program::ends;
use std::fs::File;
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;
use tempfile::TempDir;
use weekender::comparison::check::{AnswerKind, Finding, Mine, judge};
use weekender::stages::Stage;

fn checked(name: &str, stage: Option<&str>) -> (Mine, Finding) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/program/check/cases").join(name);
    let mine = Mine::read(&path).unwrap();
    let finding = judge(&mine, stage.map(|stage| Stage::find(stage).unwrap()), |_| {}).unwrap();
    (mine, finding)
}

#[test]
fn right_pictures_are_not_accused() {
    for (name, stage, known) in [
        ("right-11.5-listing79-fuzz0.png", None, Some("listing-79")),
        ("right-9.1-with-acne.png", Some("diffuse"), Some("acne-early")),
        ("right-4-samples.png", None, None),
        ("v3-metal.png", None, Some("edition-scene")),
    ] {
        let (mine, finding) = checked(name, stage);
        assert_eq!(finding.answer(&mine).kind, AnswerKind::Right, "{name}: {:?}", finding.named());
        assert_eq!(finding.named().map(|named| named.id), known, "{name}");
    }
    // Section 9.3 shows on purpose what is right in 9.1.
    let (mine, finding) = checked("right-9.1-with-acne.png", None);
    assert!(!finding.is_sure || finding.answer(&mine).kind == AnswerKind::Right, "{:?}", finding.named());
}

#[test]
fn lossy_pictures_get_only_guesses() {
    for (name, part) in [("right-jpeg75.png", "JPEG"), ("right-blurred.png", "smoothed")] {
        let (mine, finding) = checked(name, None);
        let answer = finding.answer(&mine);
        assert!(answer.kind == AnswerKind::CannotCheck && answer.title.contains(part), "{name}: {answer:?}");
    }
    // A palette of 99 greys and blues.
    let bytes = Book::new("lambertian-gamma", "").render(240, 135, 60, 4);
    let few = bytes.into_iter().map(|pixel| pixel.map(|byte| byte / 8 * 8 + 4)).collect();
    let mine = Mine::of_bytes(few, [240, 135]);
    let finding = judge(&mine, Some(Stage::find("lambertian-gamma").unwrap()), |_| {}).unwrap();
    let answer = finding.answer(&mine);
    assert!(answer.kind == AnswerKind::CannotCheck && answer.title.contains("palette"), "{answer:?}");
}

#[test]
fn mistakes_are_named() {
    let mut wrong = Vec::new();
    for (name, stage, known) in [
        ("polar-naive.png", Some("lambertian-gamma"), "vector-polar"),
        ("hemisphere-inverted.png", None, "hemisphere-inverted"),
        ("carry.png", None, "sum-kept"),
        ("small-blur.png", Some("defocus"), "lens-radius"),
        ("half-bright.png", Some("lambertian-gamma"), "brightness"),
        ("far-root.png", Some("lambertian-gamma"), "far-root"),
    ] {
        let (_, finding) = checked(name, stage);
        let named = crate::check::ids(&finding);
        if !finding.is_sure || !named.contains(&known) {
            wrong.push(format!("{name}: {}, {named:?}, {}", finding.stage.id, finding.is_sure));
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
    // Half a step of a byte allows only a guess.
    let (_, finding) = checked("gradient-over-width.png", None);
    assert!(crate::check::ids(&finding).contains(&"gradient-over-width"), "{:?}", finding.named());
    let (mine, finding) = checked("half-bright.png", Some("lambertian-gamma"));
    let evidence = finding.answer(&mine).evidence.join("; ");
    assert!(evidence.contains("0.5"), "{evidence}");
}

/// The numbers of a right picture in this form, with this header.
fn shaped(header: &str, size: [u32; 2], pixel: impl Fn([u8; 3]) -> String) -> String {
    let bytes = Book::new("lambertian-gamma", "").render(size[0], size[1], 40, 5);
    header.to_owned() + &bytes.into_iter().map(pixel).collect::<String>()
}

#[test]
fn shapes_of_numbers_are_understood() {
    let directory = TempDir::new().unwrap();
    let path = directory.path().join("mine.ppm");
    let size = [96, 54];
    let plain = |[r, g, b]: [u8; 3]| format!("{r} {g} {b}\n");
    for (file, part) in [
        (shaped("P3\n96 54\n255\n", size, |[r, g, b]| format!("{r} {g} {b} 255\n")), "four numbers"),
        (shaped("P3\n96 54\n255\n", size, |[r, g, b]| format!("({r}, {g}, {b})\n")), "brackets"),
        (shaped("P6\n96 54\n255\n", size, plain), "numbers follow as text"),
        (shaped("P2\n96 54\n255\n", size, plain), "three numbers per pixel"),
        (shaped("P3\n255\n96 54\n", size, plain), "before width and height"),
    ] {
        std::fs::write(&path, file).unwrap();
        let mine = Mine::read(&path).unwrap();
        let finding = judge(&mine, Some(Stage::find("lambertian-gamma").unwrap()), |_| {}).unwrap();
        assert!(finding.is_right(), "{part}: {:?}", finding.named());
        let answer = finding.answer(&mine);
        assert!(answer.title.contains(part), "{part}: {}", answer.title);
        assert_eq!(answer.kind, AnswerKind::Mistake, "other programs cannot read it");
    }
    // A largest value of 256 is unusual, but every program reads it.
    std::fs::write(&path, shaped("P3\n96 54\n256\n", size, plain)).unwrap();
    let mine = Mine::read(&path).unwrap();
    assert!(
        mine.damages.is_empty() && mine.notes.iter().any(|note| note.contains("256")),
        "{:?}",
        mine.notes
    );
    let finding = judge(&mine, Some(Stage::find("lambertian-gamma").unwrap()), |_| {}).unwrap();
    assert_eq!(finding.answer(&mine).kind, AnswerKind::Right);
    std::fs::write(&path, "").unwrap();
    let reason = Mine::read(&path).unwrap_err().to_string();
    assert!(reason.contains("empty") && reason.contains("early"), "{reason}");
}

/// Writes a picture row by row, as a ray tracer does.
fn write_rows(path: &Path, mistake: &'static str) {
    let [width, height] = [160, 90];
    let bytes = Book::new("lambertian-gamma", mistake).render(width, height, 30, 5);
    let mut file = File::create(path).unwrap();
    write!(file, "P3\n{width} {height}\n255\n").unwrap();
    for rows in bytes.chunks(15 * width as usize) {
        for [r, g, b] in rows {
            writeln!(file, "{r} {g} {b}").unwrap();
        }
        file.flush().unwrap();
        std::thread::sleep(Duration::from_millis(150));
    }
}

#[test]
fn a_watched_picture_is_judged_after_each_change() {
    let directory = TempDir::new().unwrap();
    let path = directory.path().join("mine.ppm");
    write_rows(&path, "gamma-twice");
    let mut child = Command::new(env!("CARGO_BIN_EXE_weekender"))
        .args(["check", "--watch", "mine.ppm", "--stage", "lambertian-gamma", "--json", "-"])
        .current_dir(directory.path())
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let mut lines = BufReader::new(child.stdout.take().unwrap()).lines();
    let mut found =
        || -> serde_json::Value { serde_json::from_str(&lines.next().unwrap().unwrap()).unwrap() };
    let first = found();
    assert_eq!((&first["mistake"]["id"], &first["rows"]), (&"gamma-twice".into(), &90.into()));
    let writer = std::thread::spawn(move || write_rows(&path, ""));
    // Rows that are there already may be judged, but none as truncated or torn.
    let last = loop {
        let line = found();
        assert!(line["error"].is_null() && line["mistake"].is_null(), "{line}");
        if line["rows"] == 90 {
            break line;
        }
        assert!(line["rows"].as_u64().unwrap() >= 36, "{line}");
    };
    assert_eq!(last["is_right"], true, "{last}");
    writer.join().unwrap();
    child.kill().unwrap();
    child.wait().unwrap();
}

#[test]
fn several_pictures_have_one_exit_code() {
    let cases = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/program/check/cases");
    let check = |code: i32, files: &[&str]| {
        let stage = ["check", "--stage", "lambertian-gamma"];
        ends(&cases, code, &[&stage[..], files].concat()).0
    };
    let text = check(1, &["half-bright.png", "empty.ppm"]);
    assert_eq!(text.lines().count(), 2, "{text}");
    assert!(text.contains("half-bright.png: section 9.5: ") && text.contains("empty.ppm: "), "{text}");
    check(2, &["empty.ppm", "empty.ppm"]);
}
