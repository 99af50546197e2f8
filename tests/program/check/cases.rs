//! Pictures of a plain tracer that shares no code with Weekender, and what must be said about them.

use crate::check::book::Book;
use crate::common::program::ends;
use std::fs::File;
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::atomic::AtomicBool;
use std::time::Duration;
use tempfile::TempDir;
use weekender::comparison::check::{AnswerKind, Finding, Mine, judge};
use weekender::stages::Stage;

fn checked(name: &str, stage: Option<&str>) -> (Mine, Finding) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/program/check/cases").join(name);
    let mine = Mine::read(&path).unwrap();
    let finding = judged(&mine, stage);
    (mine, finding)
}

fn judged(mine: &Mine, stage: Option<&str>) -> Finding {
    judge(mine, stage.map(|stage| Stage::find(stage).unwrap()), &AtomicBool::new(false), |_| {}).unwrap()
}

/// Pictures that programs of learners made, right and wrong, and what must be said about them: the id of a mistake or a row of
/// what is right all the same, or a number's words; whether it must be certain.
#[test]
fn pictures_of_learners_are_understood() {
    let mut wrong = Vec::new();
    for (name, stage, known, is_sure) in [
        ("root-shadowed-hollow.png", Some("hollow-glass"), "root-shadowed", true),
        ("viewport-width-int.png", Some("metal-fuzzy"), "integer-width", true),
        ("left-fuzz-0.png", Some("metal-fuzzy"), "the fuzz of the left ball is 0", true),
        ("edition3-last-hit-wins.png", None, "last-hit-wins", true),
        ("cube-vectors.png", None, "vector-cube", true),
        ("reflect-plus.png", Some("metal-fuzzy"), "reflect-plus", false),
        ("inner-sphere-only.png", Some("hollow-glass"), "inner-only", true),
        ("viewport-without-focus-distance.png", Some("defocus"), "viewport-without-focus", true),
        ("hemisphere-around-lambertian.png", Some("lambertian-gamma"), "hemisphere-around", true),
        ("off-centre-viewport.png", Some("lambertian-gamma"), "corner-without-aspect", true),
        ("red-sphere-int-viewport.png", None, "integer-width", true),
        ("red-sphere-off-centre.png", None, "corner-without-aspect", false),
        ("edition3-no-gamma.png", None, "no-gamma", true),
        ("center-ball-z-is-minus-1.png", None, "the z of the middle ball is -1,", true),
        ("index-is-1.33.png", Some("hollow-glass"), "index of the left ball is 1.33", true),
        ("left-ball-x-is-minus-1.1.png", None, "the x of the left ball is -1.1,", true),
        ("right-ball-fuzz-is-0.3.png", None, "the fuzz of the right ball is 0.3,", true),
    ] {
        let (mine, finding) = checked(&format!("learners/{name}"), stage);
        let explains = &finding.found.as_ref().unwrap_or(&finding.right).hypothesis;
        let words: Vec<&str> = explains.numbers.iter().map(|number| number.words.as_str()).collect();
        let said = format!("{:?} {words:?}", crate::check::ids(&finding));
        if !said.contains(known) || is_sure && !finding.is_sure {
            wrong.push(format!("{name}: {said}, {}, {}", finding.is_sure, finding.answer(&mine).title));
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn right_pictures_are_not_accused() {
    for (name, stage, known) in [
        ("right-11.5-listing79-fuzz0.png", None, Some("listing-79")),
        ("right-9.1-with-acne.png", Some("diffuse"), Some("acne-early")),
        ("right-4-samples.png", None, None),
        ("learners/edition3-and-255.png", None, Some("edition-scene")),
    ] {
        let (mine, finding) = checked(name, stage);
        assert_eq!(finding.answer(&mine).kind, AnswerKind::Right, "{name}: {:?}", finding.named());
        assert_eq!(finding.named().map(|named| named.id), known, "{name}");
    }
    // Its edges are not quite those of edition 3, but nothing is wrong in it.
    let (mine, finding) = checked("v3-metal.png", None);
    assert_ne!(finding.answer(&mine).kind, AnswerKind::Mistake, "{:?}", finding.named());
    // Section 9.3 shows on purpose what is right in 9.1.
    let (mine, finding) = checked("right-9.1-with-acne.png", None);
    assert!(!finding.is_sure || finding.answer(&mine).kind == AnswerKind::Right, "{:?}", finding.named());
}

/// What has changed a file is a note, and no verdict.
#[test]
fn lossy_pictures_get_only_guesses() {
    let palette = {
        let bytes = Book::new("lambertian-gamma", "").render(240, 135, 60, 4);
        let few = bytes.into_iter().map(|pixel| pixel.map(|byte| byte / 8 * 8 + 4)).collect();
        let mine = Mine::of_bytes(few, [240, 135]);
        let finding = judged(&mine, Some("lambertian-gamma"));
        (mine, finding)
    };
    let pictures = [
        ("JPEG", checked("right-jpeg75.png", None)),
        ("smoothed", checked("right-blurred.png", None)),
        ("palette", palette),
    ];
    for (part, (mine, finding)) in pictures {
        let answer = finding.answer(&mine);
        assert!(!matches!(answer.kind, AnswerKind::Right | AnswerKind::Mistake), "{part}: {answer:?}");
        assert!(!answer.title.contains(part), "{part}: {answer:?}");
        assert!(answer.evidence.iter().any(|line| line.contains(part)), "{part}: {answer:?}");
    }
}

#[test]
fn mistakes_are_named() {
    let mut wrong = Vec::new();
    for (name, stage, known) in [
        ("polar-naive.png", Some("lambertian-gamma"), "vector-polar"),
        ("hemisphere-inverted.png", None, "hemisphere-inverted"),
        ("carry.png", None, "sum-kept"),
        ("gradient-over-width.png", None, "gradient-over-width"),
        ("half-bright.png", Some("lambertian-gamma"), "brightness"),
        ("small-blur.png", Some("defocus"), "lens-radius"),
    ] {
        let (mine, finding) = checked(name, stage);
        let named = crate::check::ids(&finding);
        if known == "brightness" {
            let evidence = finding.answer(&mine).evidence.join("; ");
            assert!(evidence.contains("0.5"), "{evidence}");
        }
        // What is right in 9.1 has acne, whose strength depends on rounding; nor does a sky of half the light fit to a byte.
        let is_guess = ["hemisphere-inverted", "brightness"].contains(&known);
        if !finding.is_sure && !is_guess || !named.contains(&known) {
            wrong.push(format!("{name}: {}, {named:?}, {}", finding.stage.id, finding.is_sure));
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
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
        let finding = judged(&mine, Some("lambertian-gamma"));
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
    let finding = judged(&mine, Some("lambertian-gamma"));
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
    // Other pictures of the same length and time: rewritten, renamed over it, and behind a link.
    let at = |name: &str| directory.path().join(name);
    let time = std::time::SystemTime::UNIX_EPOCH + Duration::from_secs(1_000_000_000);
    let set_time =
        |name: &str| File::options().write(true).open(at(name)).unwrap().set_modified(time).unwrap();
    let bytes = |half: bool| {
        let pixels = std::iter::repeat_n(if half { b"\x40\x60\x80" } else { b"\x80\x60\x40" }, 160 * 90);
        [b"P6\n160 90\n255\n".to_vec(), pixels.flatten().copied().collect()].concat()
    };
    let mut is_half = false;
    for way in ["in place", "renamed", "linked"] {
        is_half = !is_half;
        let name = if way == "in place" { "mine.ppm" } else { way };
        std::fs::write(at(name), bytes(is_half)).unwrap();
        set_time(name);
        match way {
            "renamed" => std::fs::rename(at(name), at("mine.ppm")).unwrap(),
            #[cfg(unix)]
            "linked" => {
                std::os::unix::fs::symlink(way, at("link")).unwrap();
                std::fs::rename(at("link"), at("mine.ppm")).unwrap();
            }
            _ => {}
        }
        let colour = if is_half { "64 96 128" } else { "128 96 64" };
        while !found()["error"].as_str().is_some_and(|error| error.contains(colour)) {}
    }
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
