//! Pictures that other programs write: what `compare`, `check` and `info` make of them.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a helper of a test may fail like the test")]

mod pipes;

use std::path::{Path, PathBuf};
use weekender::film::{CheckpointError, checkpoint};
use weekender::job::output::{Encoding, Values, decode_picture, read_picture};
use weekender::job::saved::{self, OpenError};
use weekender::pictures::Picture;
use weekender::pictures::compare::{Comparison, compare_sides};
use weekender::stages::Transfer;

fn file(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/pictures/files").join(name)
}

fn picture(name: &str) -> Picture {
    let encoding = Encoding::Book(Transfer::Linear);
    Picture::read(&file(name), encoding).unwrap_or_else(|error| panic!("{name}: {error}"))
}

fn compared(a: &str, b: &str) -> Comparison {
    compare_sides(&[picture(a), picture(b)]).unwrap()
}

fn refusal(name: &str) -> String {
    Picture::read(&file(name), Encoding::Srgb).unwrap_err().to_string()
}

#[test]
fn the_same_picture_is_equal_in_every_form() {
    for name in [
        "half.exr",
        "blender.exr",
        "dot.exr",
        "lower.exr",
        "parts.exr:beauty",
        "alpha.exr",
        "aces.exr",
        "stale.exr",
        "bytes.png",
        "deep.ppm",
        "p3-100.ppm",
        "p3-254.ppm",
        "p3-1023.ppm",
        "p3-65535.ppm",
        "netpbm.pfm",
        "netpbm-big.pfm",
    ] {
        let Comparison { reasons, unclear, .. } = compared("float.exr", name);
        // Some blocks of the picture exceed 1, the most that integers hold.
        let reasons: Vec<_> = reasons.into_iter().filter(|reason| !reason.contains("the mean is")).collect();
        assert!(reasons.is_empty() && unclear.is_none(), "{name}: {reasons:?} {unclear:?}");
    }
    for name in ["parts.exr:albedo", "shifted.exr"] {
        assert!(!compared("float.exr", name).is_equal(), "{name}");
    }
}

#[test]
fn the_step_of_a_half_float_is_no_difference_but_two_are() {
    let [float, half] = ["float.exr", "half.exr"].map(picture);
    assert!(half.steps.is_some() && half.limit.is_infinite() && float.steps.is_none());
    assert!(compare_sides(&[half.clone(), half.clone()]).unwrap().is_same);
    let mut off = half.clone();
    off.pixels.iter_mut().flatten().for_each(|x| *x *= 1.0 + 4.0 / 2048.0);
    assert!(!compare_sides(&[float, off]).unwrap().is_equal());
    // NaN and infinity in half floats are no limit of an integer.
    let mut hole = half.clone();
    hole.pixels[3][1] = f64::NAN;
    assert!(!compare_sides(&[half, hole]).unwrap().is_equal());
}

#[test]
fn layers_are_chosen_or_listed() {
    assert_eq!(
        picture("grey.exr").pixels,
        picture("float.exr").pixels.iter().map(|p| [p[0]; 3]).collect::<Vec<_>>()
    );
    let message = refusal("parts.exr");
    assert!(message.contains("several layers") && message.contains("albedo, beauty"), "{message}");
    assert!(refusal("parts.exr:gloss").contains("no layer \"gloss\""));
    assert!(refusal("depth.exr").contains("no channels R, G and B, nor Y, but Z"));
    let message = refusal("htj2k.exr");
    assert!(message.contains("compression") && message.contains("save it with another"), "{message}");
}

#[test]
fn the_display_window_is_the_picture() {
    let whole = picture("float.exr");
    let found = picture("crop.exr");
    assert_eq!((found.width, found.height), (24, 16));
    assert!(found.notes[0].contains("12x8 pixels at 6,4 of 24x16"), "{:?}", found.notes);
    assert_eq!((found.pixels[0], found.pixels[5 * 24 + 7]), ([0.0; 3], whole.pixels[5 * 24 + 7]));
    assert_eq!(picture("overscan.exr").pixels, whole.pixels);
    let shifted = picture("shifted.exr");
    assert_eq!((shifted.pixels[7], shifted.pixels[8]), ([0.0; 3], whole.pixels[0]));
}

#[test]
fn what_is_ignored_is_noted() {
    for (name, part) in [
        ("alpha.exr", "64 of its pixels have an alpha other than 1"),
        ("alpha.png", "48 of its pixels have an alpha other than 1"),
        ("aces.exr", "colours are not those of sRGB"),
        ("dwa.exr", "its dwaa compression may change the values"),
        ("netpbm-scale-2.pfm", "multiplied by its scale, 2"),
    ] {
        let notes = compared("float.exr", name).notes.join("; ");
        assert!(notes.contains(part) && notes.contains(name), "{name}: {notes}");
    }
    assert!(picture("float.exr").notes.is_empty() && picture("bytes.png").notes.is_empty());
}

#[test]
fn a_film_that_was_saved_again_is_a_picture() {
    let film = checkpoint::load(&file("film.exr")).unwrap().film;
    for name in ["film-same.exr", "film-rgb.exr", "film-half.exr"] {
        assert!(matches!(checkpoint::load(&file(name)), Err(CheckpointError::Resaved { .. })), "{name}");
        let found = compared("film.exr", name);
        assert!(found.is_equal(), "{name}: {:?} {:?}", found.reasons, found.unclear);
        let found = picture(name);
        assert!(found.film.is_none() && (found.width, found.height) == (film.width(), film.height()));
        let refused = saved::open_film(&file(name)).unwrap_err();
        assert!(matches!(refused, OpenError::Film(CheckpointError::Resaved { .. })), "{refused}");
        assert!(refused.to_string().contains("another program has saved it again"), "{refused}");
    }
}

#[test]
fn other_formats_are_named() {
    for (ending, name) in [("bmp", "BMP"), ("gif", "GIF"), ("jpg", "JP"), ("tga", "TGA"), ("tif", "TIF")] {
        let message = read_picture(&file(&format!("bytes.{ending}")), None).unwrap_err().to_string();
        assert!(
            message.contains(&format!("it is a {name}")) && message.contains("save it as PNG"),
            "{message}"
        );
    }
}

fn decoded(bytes: &[u8]) -> (Vec<[u16; 3]>, String) {
    let read = decode_picture(std::io::Cursor::new(bytes), bytes.len() as u64, None)
        .unwrap_or_else(|error| panic!("{error}: {}", String::from_utf8_lossy(bytes)));
    let Values::Integers { rgb, .. } = read.values else { panic!("floats") };
    let titles = read.damages.into_iter().map(|damage| damage.title).chain(read.notes);
    (rgb, titles.collect::<Vec<_>>().join("; "))
}

#[test]
fn faults_of_text_pictures_are_named() {
    let right = vec![[204, 226, 255], [1, 2, 3]];
    for (text, said) in [
        ("P3 2 1 255 204 226 255 1 2 3", ""),
        ("P3\n#a\n2 # b\n1\n# c\n255 # d\n204 # e 7\n226 255\n#f\n1 2 3#g", ""),
        ("P3\n2 1\n255\n204, 226, 255\n1, 2, 3,\n", "commas between"),
        ("P3\n2 1\n255\n204,226,255\n1,2,3\n", "commas between"),
        ("P3\n2 1\n255\n204,5 226,0 255,0\n1,2 2,9 3,0\n", "decimal commas"),
        ("P3 2 1 255 9 9 9 9 9 9\nP3 2 1 255 204 226 255 1 2 3", "several pictures"),
        ("P3 2 1 255 9 9 9\nP3 2 1 255 204 226 255 1 2 3", "several pictures"),
    ] {
        let (found, notes) = decoded(text.as_bytes());
        assert!(
            found == right && notes.contains(said) && notes.is_empty() == said.is_empty(),
            "{text}: {notes}"
        );
    }
}

#[test]
fn faults_of_binary_pictures_are_named() {
    let right = vec![[10, 13, 10], [32, 9, 10]];
    let pixels = b"\n\r\n \t\n";
    let file = |header: &[u8], pixels: &[u8], more: &[u8]| [header, pixels, more].concat();
    let with_returns = b"\r\n\r\r\n \t\r\n";
    for (bytes, said) in [
        (file(b"P6 2 1 255\n", pixels, b""), ""),
        (file(b"P6\r\n2 1\r\n255\r\n", pixels, b""), ""),
        (file(b"P6 2 1 255 \n", pixels, b""), ""),
        (file(b"P6 2 1 255#x\n", pixels, b""), ""),
        (file(b"P6\r\n2 1\r\n255\r\n", with_returns, b""), "text mode"),
        (file(b"P6 2 1 255\n", pixels, b"more"), "4 bytes after"),
        (file(b"P6 2 1 255\n", b"123456", &file(b"P6 2 1 255\n", pixels, b"")), "several pictures"),
        (file(b"P6 2 1 255\n", b"123456", b"\nP3 2 1 255 10 13 10 32 9 10"), "several pictures"),
        (file(b"Scanlines: 3\nDone.\nP6 2 1 255\n", pixels, b""), "other text before"),
    ] {
        let (found, notes) = decoded(&bytes);
        assert!(
            found == right && notes.contains(said) && notes.is_empty() == said.is_empty(),
            "{notes}: {found:?}"
        );
    }
}

#[test]
fn a_pfm_may_have_any_line_end_scale_and_order() {
    let values = [0.5_f32, 10.0, 0.25];
    let little: Vec<u8> = values.iter().flat_map(|x| x.to_le_bytes()).collect();
    let read = |header: &str, data: &[u8]| {
        let bytes = [header.as_bytes(), data].concat();
        let read = decode_picture(std::io::Cursor::new(&bytes), bytes.len() as u64, None)
            .map_err(|e| e.to_string())?;
        let Values::Floats { rgb, .. } = read.values else { panic!("integers") };
        Ok::<_, String>((rgb[0], read.notes.join("; ")))
    };
    for header in ["PF\n1 1\n-1.0\n", "PF\r\n1 1\r\n-1.0\r\n", "PF 1 1 -1 \t\n", "PF 1 1 -1 "] {
        assert_eq!(read(header, &little), Ok((values, String::new())), "{header:?}");
    }
    let (found, notes) = read("PF 1 1 -2\n", &little).unwrap();
    assert!(found == [1.0, 20.0, 0.5] && notes.contains("its scale, 2"), "{notes}");
    let (found, notes) = read("PF 1 1 1\n", &little).unwrap();
    assert!(found == values && notes.contains("the other byte order"), "{notes}");
    for scale in ["0", "0.0", "nan", "-1,0", "x"] {
        let message = read(&format!("PF 1 1 {scale}\n"), &little).unwrap_err();
        assert!(message.contains("its scale is") && message.contains("-1.0"), "{message}");
    }
}
