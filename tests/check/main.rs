//! `weekender check`: right pictures pass, planted mistakes are named, damaged files are understood.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a helper of a test may fail like the test")]

mod book;

use book::Book;
use std::fmt::Write;
use std::path::Path;
use std::process::{Command, Output};
use tempfile::TempDir;
use weekender::pictures::check::{Mine, judge};
use weekender::stages::Stage;

fn mine(stage: &'static str, mistake: &'static str, samples: u32, seed: u64) -> Mine {
    let (width, height) = (200, 112);
    let bytes = Book::new(stage, mistake).render(width, height, samples, seed);
    Mine::of_bytes(bytes, [width, height])
}

/// The id of the mistake found, or "right".
fn found(mine: &Mine, stage: Option<&str>) -> &'static str {
    let stage = stage.map(|id| Stage::find(id).unwrap());
    let finding = judge(mine, stage, |_| {}).unwrap();
    match finding.named() {
        Some(mistake) => mistake.id,
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
        ("lambertian-gamma", "gamma-2.2"),
        ("hollow-glass", "gamma-srgb"),
        ("lambertian-gamma", "wraps-to-0"),
        ("hollow-glass", "glass-black"),
        ("hollow-glass", "glass-swapped"),
        ("defocus", "lens-origin"),
        ("defocus", "lens-aim"),
        ("lambertian-gamma", "same-seed"),
    ];
    for (stage, mistake) in planted {
        assert_eq!(found(&mine(stage, mistake, 60, 3), Some(stage)), mistake, "{stage}");
    }
}

/// With the rules of an earlier section, black glass looks like glass whose normals are not turned.
#[test]
fn mistakes_with_the_same_picture_are_both_named() {
    let finding = judge(&mine("hollow-glass", "glass-black", 60, 3), None, |_| {}).unwrap();
    let named = [finding.named(), finding.alike].map(|mistake| mistake.unwrap().id);
    assert!(named.contains(&"glass-black"), "{named:?}");
}

/// Some mistake always fits slightly better than none, but no mistake turns one scene into another.
#[test]
fn other_scene_matches_no_mistake() {
    for (shown, stage) in [("lambertian-gamma", "hollow-glass"), ("metal-fuzzy", "lambertian-gamma")] {
        assert_eq!(found(&mine(shown, "", 30, 7), Some(stage)), "unknown", "{shown} as {stage}");
    }
}

#[test]
fn mistakes_are_named_without_a_stage() {
    for (stage, mistake) in [
        ("lambertian-gamma", "zero-t-min"),
        ("lambertian-gamma", "hemisphere"),
        ("lambertian-gamma", "same-seed"),
    ] {
        assert_eq!(found(&mine(stage, mistake, 60, 3), None), mistake, "{stage}");
    }
    assert_eq!(found(&mine("normals-world", "", 10, 3), None), "right");
}

#[test]
fn the_stage_is_found() {
    for (stage, mistake) in [("metal-fuzzy", "right"), ("lambertian-gamma", "flipped-rows")] {
        let mine = mine(stage, mistake, 30, 5);
        let finding = judge(&mine, None, |_| {}).unwrap();
        assert_eq!((finding.stage.id, found(&mine, None)), (stage, mistake));
    }
}

/// A tiny P3 file.
const P3: &str = "P3\n# tiny\n2 1\n255\n0 1 2\n253 254 255\n";

#[test]
fn every_format_is_read() {
    let bytes = vec![[0, 1, 2], [253, 254, 255]];
    let read = |file: &[u8]| Mine::decode(file).unwrap_or_else(|reason| panic!("{reason}"));
    for file in [
        P3.as_bytes(),
        b"P6 2 1 255\n\x00\x01\x02\xFD\xFE\xFF",
        b"P6 # a\n2\n#b\n# c\n1 255\n\x00\x01\x02\xFD\xFE\xFFand more",
        b"P6 2 1 65535\n\x00\xFF\x01\x00\x02\x00\xFD\x00\xFE\xFF\xFF\xFF",
        b"P3\r2 1\r255\r0 1 2\r253 254 255",
        b"P3\r\n2\t1 255 # c 9 9\r\n0 1 2\r\n253 254 255\r\n",
    ] {
        let mine = read(file);
        assert_eq!((mine.width, mine.height, &mine.bytes), (2, 1, &bytes), "{}", text(file));
        assert!(mine.damages.is_empty(), "{:?}", mine.damages);
    }
    // Only one byte of white space follows the header; more of it belongs to the pixels.
    assert_eq!(read(b"P6 1 1 255\n\n\r\n").bytes, [*b"\n\r\n"]);
    // Values are scaled by the largest one.
    assert_eq!(read(b"P3 1 1 1 0 1 1").bytes, [[0, 255, 255]]);
    assert_eq!(read(b"P3 1 1 65535 0 32768 65535").bytes, [[0, 128, 255]]);
    assert_eq!(read(b"P3 1 1 100 50 99 -7").bytes, [[128, 252, 0]]);
    let image =
        image::RgbaImage::from_fn(16, 9, |x, y| image::Rgba([7, x as u8, 250 + y as u8 % 6, x as u8]));
    let mut file = std::io::Cursor::new(Vec::new());
    image.write_to(&mut file, image::ImageFormat::Png).unwrap();
    let png = read(file.get_ref());
    assert_eq!((png.bytes[5 * 16 + 3], png.format), ([7, 3, 255], "PNG"), "alpha is ignored");
}

#[test]
fn damage_is_repaired_and_reported() {
    let utf_16: Vec<u8> = [0xFEFF].into_iter().chain(P3.encode_utf16()).flat_map(u16::to_le_bytes).collect();
    let utf_16_be: Vec<u8> =
        [0xFEFF].into_iter().chain(P3.encode_utf16()).flat_map(u16::to_be_bytes).collect();
    let of_words = |bytes: fn(u16) -> [u8; 2]| P3.encode_utf16().flat_map(bytes).collect::<Vec<u8>>();
    let marked = [b"\xEF\xBB\xBF", P3.as_bytes()].concat();
    let with_messages = P3.replace("255\n0", "255\nScanlines remaining: 1\n0");
    let too_large = P3.replace("255\n0 1 2", "255\n-5 1 2").replace("253", "256");
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
        (b"P6 2 1 255\n12", "binary mode"),
        (b"P6\r\n2 1\r\n255\r\n\x00", "binary mode"),
        (b"P3 0 5 255", "0 x 5"),
        (b"P3 99999 99999 255", "99999x99999"),
        (b"P6 99999 99999 255\n", "99999x99999"),
        (b"GIF89a", "it is a GIF file"),
        (b"", "it is not a PNG"),
    ] {
        let reason = Mine::decode(file).unwrap_err();
        assert!(reason.contains(word), "{reason} should say {word}");
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
fn finding_sets_exit_code_files_and_json() {
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
    // Our own picture in the same place is right.
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
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {message}");
        assert!(message.contains(part), "{arguments:?} should say {part}: {message}");
        assert_eq!(text(&output.stdout), "", "{arguments:?}");
    }
}

#[test]
fn blank_or_tiny_picture_is_refused() {
    let directory = TempDir::new().unwrap();
    let path = directory.path().join("tiny.ppm");
    let read = |width: usize, height: usize, pixels: String| {
        std::fs::write(&path, format!("P3\n{width} {height}\n255\n{pixels}")).unwrap();
        Mine::read(&path).map_err(|error| error.to_string())
    };
    for [width, height] in [[1, 1], [15, 9], [16, 8]] {
        let refused = read(width, height, "0 0 0\n".repeat(width * height)).unwrap_err();
        assert!(refused.contains(&format!("{width} x {height} pixels, fewer than 16 x 9")), "{refused}");
    }
    for value in ["0 0 0", "255 255 255", "9 8 7"] {
        let refused = read(16, 9, format!("{value}\n").repeat(16 * 9)).unwrap_err();
        assert!(refused.contains(&format!("all its pixels are {value}, so")), "{refused}");
        assert!(refused.contains("number of samples") && refused.contains("int(x) * 256"), "{refused}");
    }
    assert!(read(16, 9, "1 0 0\n".to_owned() + &"0 0 0\n".repeat(16 * 9 - 1)).is_ok());
}
