//! `weekender check`: right pictures are right, planted mistakes are named, damaged files are understood.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a helper of a test may fail like the test")]

mod book;

use book::Book;
use std::fmt::Write;
use std::path::Path;
use std::process::{Command, Output};
use tempfile::TempDir;
use weekender::check::{Mine, Mistake, judge};
use weekender::stages::Stage;

fn mine(stage: &'static str, mistake: &'static str, samples: u32, seed: u64) -> Mine {
    let (width, height) = (200, 112);
    let bytes = Book::new(stage, mistake).render(width, height, samples, seed);
    Mine { width, height, bytes, format: "P3", damages: Vec::new() }
}

/// The id of the mistake that is found, or "right".
fn found(mine: &Mine, stage: Option<&str>) -> &'static str {
    let stage = stage.map(|id| Stage::find(id).unwrap());
    let finding = judge(mine, stage).unwrap();
    match finding.mistake.as_ref().and_then(|found| found.hypothesis.mistake) {
        Some(mistake) => mistake.about().id,
        None if finding.is_right() => "right",
        None => "unknown",
    }
}

#[test]
fn noise_is_no_mistake() {
    for stage in book::STAGES {
        for samples in [10, 60] {
            let mine = mine(stage, "", samples, u64::from(samples));
            assert_eq!(found(&mine, Some(stage)), "right", "{stage}, {samples} samples");
        }
    }
}

#[test]
fn planted_mistakes_are_named() {
    let planted = [
        ("normals-world", "normal-not-unit"),
        ("antialiased", "no-antialiasing"),
        ("antialiased", "half-pixel-up"),
        ("lambertian-gamma", "gamma-twice"),
        ("lambertian-gamma", "scale-255"),
        ("lambertian-gamma", "truncated"),
        ("lambertian-gamma", "zero-t-min"),
        ("lambertian-gamma", "point-in-sphere"),
        ("metal-fuzzy", "fuzz-missing"),
        ("metal-fuzzy", "fuzz-unnormalised"),
        ("hollow-glass", "index-inverted"),
        ("hollow-glass", "always-refract"),
        ("hollow-glass", "last-hit-wins"),
        ("hollow-glass", "vfov-radians"),
        ("defocus", "focus-distance-one"),
    ];
    for (stage, mistake) in planted {
        assert_eq!(found(&mine(stage, mistake, 60, 3), Some(stage)), mistake, "{stage}");
    }
}

/// Some mistake is always a little nearer than none, but no mistake turns one scene into another.
#[test]
fn another_scene_is_blamed_on_no_mistake() {
    for (shown, stage) in [("lambertian-gamma", "hollow-glass"), ("metal-fuzzy", "lambertian-gamma")] {
        assert_eq!(found(&mine(shown, "", 30, 7), Some(stage)), "unknown", "{shown} as {stage}");
    }
}

#[test]
fn the_stage_is_found() {
    for (stage, mistake) in [("metal-fuzzy", "right"), ("lambertian-gamma", "flipped-rows")] {
        let mine = mine(stage, mistake, 30, 5);
        let finding = judge(&mine, None).unwrap();
        assert_eq!((finding.stage.id, found(&mine, None)), (stage, mistake));
    }
}

#[test]
fn ids_are_unique() {
    let mut ids: Vec<&str> = Mistake::ALL.iter().map(|mistake| mistake.about().id).collect();
    ids.sort_unstable();
    ids.dedup();
    assert_eq!(ids.len(), Mistake::ALL.len());
}

/// A tiny P3 file.
const P3: &str = "P3\n# tiny\n2 1\n255\n0 1 2\n253 254 255\n";

#[test]
fn every_form_of_a_picture_is_read() {
    let bytes = vec![[0, 1, 2], [253, 254, 255]];
    let read = |file: &[u8]| Mine::decode(file).unwrap_or_else(|reason| panic!("{reason}"));
    let of_p6 = read(b"P6 2 1 255\n\x00\x01\x02\xFD\xFE\xFF");
    for mine in [read(P3.as_bytes()), of_p6] {
        assert_eq!((mine.width, mine.height, &mine.bytes), (2, 1, &bytes));
        assert!(mine.damages.is_empty(), "{:?}", mine.damages);
    }
}

#[test]
fn damages_are_repaired_and_told() {
    let utf_16: Vec<u8> = [0xFEFF].into_iter().chain(P3.encode_utf16()).flat_map(u16::to_le_bytes).collect();
    let utf_16_be: Vec<u8> =
        [0xFEFF].into_iter().chain(P3.encode_utf16()).flat_map(u16::to_be_bytes).collect();
    let of_words = |bytes: fn(u16) -> [u8; 2]| P3.encode_utf16().flat_map(bytes).collect::<Vec<u8>>();
    let marked = [b"\xEF\xBB\xBF", P3.as_bytes()].concat();
    let with_messages = P3.replace("255\n0", "255\nScanlines remaining: 1\n0");
    let too_large = P3.replace("255\n0 1 2", "255\n-5 1 2").replace("253", "256");
    let cr_lf = b"P6\r\n2 1\r\n255\r\n\x00\x01\r\n\xFD\xFE\xFF".to_vec();
    for (file, word) in [
        (utf_16, "UTF-16"),
        (utf_16_be, "UTF-16"),
        (of_words(u16::to_be_bytes), "UTF-16"),
        (of_words(u16::to_le_bytes), "UTF-16"),
        (marked, "byte order mark"),
        (with_messages.into_bytes(), "1 lines"),
        (format!("starting\n{P3}").into_bytes(), "other text before"),
        (P3.replace("0 1 2", "0 1.5 2").into_bytes(), "1 values are not whole"),
        (too_large.into_bytes(), "2 numbers"),
        (format!("{P3} 7").into_bytes(), "7 numbers"),
        (cr_lf, "byte 10"),
    ] {
        let mine = Mine::decode(&file).unwrap();
        let [damage] = mine.damages.as_slice() else { panic!("{word}: {:?}", mine.damages) };
        assert!(damage.title.contains(word), "{damage:?}");
        assert_eq!((mine.bytes.len(), mine.bytes[0][1]), (2, 1), "{word}");
    }
    for (file, word) in [
        (&b"P3 2 2 255 0 0 0 0 0 0 0"[..], "1 of 2 rows"),
        (b"P3 2 2 255 0 0 0", "12 numbers"),
        (b"P3", "header"),
        (b"P6 2 1 255\n12", "6 bytes"),
        (b"P3 0 5 255", "0 x 5"),
        (b"P3 99999 99999 255", "4000000"),
        (b"GIF89a", "neither"),
        (b"", "neither"),
    ] {
        let reason = Mine::decode(file).unwrap_err();
        assert!(reason.contains(word), "{reason} should say {word}");
    }
}

#[test]
fn what_is_not_a_number_is_neither_whole_nor_between_0_and_the_largest_value() {
    for value in ["nan", "-nan", "-nan(ind)"] {
        let mine = Mine::decode(P3.replace("253", value).as_bytes()).unwrap();
        let titles: Vec<&str> = mine.damages.iter().map(|damage| damage.title.as_str()).collect();
        assert_eq!(
            titles,
            ["1 values are not whole numbers", "1 numbers are below 0 or above 255"],
            "{value}"
        );
        assert_eq!(mine.bytes, [[0, 1, 2], [0, 254, 255]], "{value}");
    }
}

fn check(at: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_weekender"))
        .current_dir(at)
        .arg("check")
        .args(arguments)
        .output()
        .unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

#[test]
fn exit_codes_files_and_json_tell_the_finding() {
    let at = TempDir::new().unwrap();
    let at = at.path();
    for (name, mistake) in [("right.ppm", ""), ("wrong.ppm", "gamma-twice")] {
        let mine = mine("lambertian-gamma", mistake, 20, 2);
        let mut file = format!("P3\n{} {}\n255\n", mine.width, mine.height);
        for [r, g, b] in mine.bytes {
            writeln!(file, "{r} {g} {b}").unwrap();
        }
        std::fs::write(at.join(name), file).unwrap();
    }
    let stage = ["--stage", "lambertian-gamma"];
    let output = check(at, &[&["right.ppm"], &stage[..]].concat());
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    assert!(text(&output.stdout).contains("noise only"), "{}", text(&output.stdout));

    let output = check(at, &[&["wrong.ppm", "--out", "d", "--json", "-"], &stage[..]].concat());
    assert_eq!(output.status.code(), Some(1), "{}", text(&output.stderr));
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!((&json["mistake"]["id"], &json["stage"]), (&"gamma-twice".into(), &"lambertian-gamma".into()));
    assert_eq!(json["is_right"], false);
    for name in ["mine.png", "ours.png", "difference.png"] {
        let read = Mine::read(&at.join("d").join(name)).unwrap();
        assert_eq!((read.width, read.height), (200, 112), "{name}");
    }
    // Our own picture of the same place is right.
    let output = check(at, &[&["d/ours.png"], &stage[..]].concat());
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stdout));

    for (arguments, part) in [
        (&["nothing.ppm"][..], "nothing.ppm"),
        (&["right.ppm", "--stage", "book"], "random"),
        (&["right.ppm", "--stage", "metall"], "did you mean metal?"),
        (&["right.ppm", "--out", "right.ppm"], "right.ppm"),
        (&["right.ppm", "--json", "nowhere/found.json"], "nowhere"),
        (&["d/mine.png", "--out", "d"], "would replace"),
    ] {
        let output = check(at, arguments);
        let told = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {told}");
        assert!(told.contains(part), "{arguments:?} should say {part}: {told}");
        assert_eq!(text(&output.stdout), "", "{arguments:?}");
    }
}

#[test]
fn a_render_as_text_is_the_same_picture() {
    let at = TempDir::new().unwrap();
    let at = at.path();
    let render = |name: &str, more: &[&str]| {
        let fixed = ["--batch", "--stage", "metal", "--size", "31x17", "--samples", "4", "--progress", "off"];
        let output = Command::new(env!("CARGO_BIN_EXE_weekender"))
            .current_dir(at)
            .args(fixed)
            .args(["--out", name])
            .args(more)
            .output()
            .unwrap();
        assert!(output.status.success(), "{}", text(&output.stderr));
        Mine::read(&at.join(name)).unwrap()
    };
    let (binary, ascii) = (render("b.ppm", &[]), render("a.ppm", &["--ppm", "ascii"]));
    assert_eq!((binary.format, ascii.format), ("P6", "P3"));
    assert_eq!(binary.bytes, ascii.bytes);
    assert!(weekender::output::read_description(&at.join("a.ppm")).unwrap().get("Stage") == Some("metal"));
}

/// Almost any picture of a few pixels could be right, so none is called right.
#[test]
fn a_picture_of_few_pixels_is_refused() {
    let directory = tempfile::tempdir().unwrap();
    for [width, height] in [[1, 1], [3, 2], [15, 9], [16, 8]] {
        let path = directory.path().join("tiny.ppm");
        let pixels = "0 0 0\n".repeat(width * height);
        std::fs::write(&path, format!("P3\n{width} {height}\n255\n{pixels}")).unwrap();
        let refused = Mine::read(&path).unwrap_err().to_string();
        assert!(refused.contains(&format!("{width} x {height} pixels, fewer than 16 x 9")), "{refused}");
    }
}
