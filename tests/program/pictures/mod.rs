//! Pictures that other programs write: what `compare`, `check` and `info` make of them.

mod pipes;

use std::path::{Path, PathBuf};
use weekender::comparison::Picture;
use weekender::comparison::check::Mine;
use weekender::comparison::compare::{Comparison, compare_sides};
use weekender::film::{CheckpointError, checkpoint};
use weekender::job::output::{Encoding, Values, decode_picture, read_picture};
use weekender::job::saved::{self, OpenError};
use weekender::stages::Transfer;

fn file(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/program/pictures/files").join(name)
}

fn picture(name: &str) -> Picture {
    let encoding = Encoding::Book(Transfer::Linear);
    Picture::read(&file(name), Some(encoding)).unwrap_or_else(|error| panic!("{name}: {error}"))
}

fn compared(a: &str, b: &str) -> Comparison {
    compare_sides(&[picture(a), picture(b)]).unwrap()
}

fn refusal(name: &str) -> String {
    Picture::read(&file(name), Some(Encoding::Srgb)).unwrap_err().to_string()
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
fn one_half_float_step_is_equal_but_two_differ() {
    let [float, half] = ["float.exr", "half.exr"].map(picture);
    assert!(half.steps.is_some() && half.limit.is_infinite() && float.steps.is_none());
    assert!(compare_sides(&[half.clone(), half.clone()]).unwrap().is_same);
    let mut off = half.clone();
    off.pixels.iter_mut().flatten().for_each(|x| *x *= 1.0 + 4.0 / 2048.0);
    assert!(!compare_sides(&[float, off]).unwrap().is_equal());
    // NaN and infinity in half floats are not the limit of an integer format.
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
fn ignored_properties_are_noted() {
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
fn resaved_film_is_a_picture() {
    let film = checkpoint::load(&file("film.exr")).unwrap().film;
    for name in ["film-same.exr", "film-rgb.exr", "film-half.exr"] {
        assert!(matches!(checkpoint::load(&file(name)), Err(CheckpointError::Resaved { .. })), "{name}");
        let found = compared("film.exr", name);
        assert!(found.is_equal(), "{name}: {:?} {:?}", found.reasons, found.unclear);
        let found = picture(name);
        assert!(found.film.is_none() && (found.width, found.height) == (film.width(), film.height()));
        let refused = saved::open(&file(name)).and_then(|saved| saved.film()).unwrap_err();
        assert!(matches!(refused, OpenError::Film(CheckpointError::Resaved { .. })), "{refused}");
        assert!(refused.to_string().contains("another program re-saved it"), "{refused}");
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

/// The pixels of a file, and what is said about it.
fn decoded(bytes: &[u8]) -> Result<(Vec<[u16; 3]>, String), String> {
    let read = decode_picture(std::io::Cursor::new(bytes), bytes.len() as u64, None);
    let read = read.map_err(|error| error.to_string())?;
    let Values::Integers { rgb, .. } = read.values else { panic!("floats") };
    let titles = read.damages.into_iter().map(|damage| damage.title).chain(read.notes);
    Ok((rgb, titles.collect::<Vec<_>>().join("; ")))
}

/// Files with the pixels `right`, and a word of what is said about each, if anything is.
fn assert_decoded(right: [[u16; 3]; 2], files: &[(Vec<u8>, &str)]) {
    for (file, said) in files {
        let shown = String::from_utf8_lossy(file);
        let (found, notes) = decoded(file).unwrap_or_else(|error| panic!("{error}: {shown}"));
        assert_eq!(found, right, "{shown}");
        assert!(notes.contains(said) && notes.is_empty() == said.is_empty(), "{shown}: {notes}");
    }
}

#[test]
fn text_pictures_are_read_and_their_faults_named() {
    const P3: &str = "P3\n# tiny\n2 1\n255\n204 226 255\n1 2 3\n";
    let files = [
        (P3, ""),
        ("P32 1\n255\n204 226 255\n1 2 3\n", ""),
        ("P3 2 1 255 204 226 255 1 2 3\nP3", "1 lines"),
        ("P3\r2 1\r255\r204 226 255\r1 2 3", ""),
        ("P3\r\n2\t1 255 # c 9 9\r\n204 226 255\r\n1 2 3\r\n", ""),
        ("P3\n#a\n2 # b\n1\n# c\n255 # d\n204 # e 7\n226 255\n#f\n1 2 3#g", ""),
        ("\u{FEFF}P3 2 1 255 204 226 255 1 2 3", "byte order mark"),
        ("P3\n2 1\n255\n204, 226, 255\n1, 2, 3,\n", "commas between"),
        ("P3\n2 1\n255\n204,226,255\n1,2,3\n", "commas between"),
        ("P3\n2 1\n255\n204,5 226,0 255,0\n1,2 2,9 3,0\n", "decimal commas"),
        ("P3\n2 1\n255\n204 226.4 255\n1 2 3\n", "1 values are not whole"),
        ("P3\n2 1\n255\n204 226 256\n1 2 3\n", "1 numbers"),
        ("P3 2 1 255 204 226 255 1 2 3 7", "7 numbers"),
        ("P3\n2 1\n255\nScanlines remaining: 1\n204 226 255 1 2 3", "1 lines"),
        ("starting\nP3\n2 1\n255\n204 226 255\n1 2 3\n", "other text before"),
        ("P3 2 1 255 9 9 9 9 9 9\nP3 2 1 255 204 226 255 1 2 3", "several pictures"),
        ("P3 2 1 255 9 9 9\nP3 2 1 255 204 226 255 1 2 3", "several pictures"),
    ]
    .map(|(file, said)| (file.as_bytes().to_vec(), said));
    assert_decoded([[204, 226, 255], [1, 2, 3]], &files);
    let utf_16 = ["", "\u{FEFF}"].into_iter().flat_map(|mark| {
        let words = move || mark.encode_utf16().chain(P3.encode_utf16());
        [words().flat_map(u16::to_le_bytes).collect(), words().flat_map(u16::to_be_bytes).collect()]
    });
    let utf_16: Vec<(Vec<u8>, &str)> = utf_16.map(|file| (file, "UTF-16")).collect();
    assert_decoded([[204, 226, 255], [1, 2, 3]], &utf_16);
}

#[test]
fn binary_pictures_are_read_and_their_faults_named() {
    let pixels = b"\n\r\n \t\n";
    let file = |header: &[u8], pixels: &[u8], more: &[u8]| [header, pixels, more].concat();
    let files = [
        (file(b"P6 2 1 255\n", pixels, b""), ""),
        (file(b"P6\r\n2 1\r\n255\r\n", pixels, b""), ""),
        (file(b"P6 2 1 255 \n", pixels, b""), ""),
        (file(b"P6 # a\n2\n#b\n# c\n1 255#x\n", pixels, b""), ""),
        (file(b"P6\r\n2 1\r\n255\r\n", b"\r\n\r\r\n \t\r\n", b""), "text mode"),
        (file(b"P6 2 1 255\n", pixels, b"more"), "4 bytes after"),
        (file(b"P6 2 1 255\n", b"123456", &file(b"P6 2 1 255\n", pixels, b"")), "several pictures"),
        (file(b"P6 2 1 255\n", b"123456", b"\nP3 2 1 255 10 13 10 32 9 10"), "several pictures"),
        (file(b"Scanlines: 3\nDone.\nP6 2 1 255\n", pixels, b""), "other text before"),
    ];
    assert_decoded([[10, 13, 10], [32, 9, 10]], &files);
}

#[test]
fn non_pictures_are_refused() {
    for (file, word) in [
        (&b"P3 2 2 255 0 0 0 0 0 0 0"[..], "1 of 2 rows"),
        (b"P3 2 2 255 0 0 0", "12 numbers"),
        (b"P6 2 1 255\n12", "binary mode"),
        (b"P3", "header"),
        (b"P3 0 5 255", "0 x 5"),
        (b"P3 -32 5 255", "0 x 5"),
        (b"P3 99999 99999 255", "99999x99999"),
        (b"P6 99999 99999 255\n", "99999x99999"),
        (b"GIF89a", "it is a GIF file"),
        (b"", "it is empty"),
    ] {
        let reason = Mine::decode(file).unwrap_err();
        assert!(reason.contains(word), "{reason} should say {word}");
    }
}

/// Values are scaled by the largest one; alpha is ignored.
#[test]
fn values_are_scaled_to_255() {
    for (file, byte) in [
        ("P3 1 1 1 0 1 1", [0, 255, 255]),
        ("P3 1 1 65535 0 32768 65535", [0, 128, 255]),
        ("P3 1 1 100 50 99 -7", [128, 252, 0]),
    ] {
        assert_eq!(Mine::decode(file.as_bytes()).unwrap().bytes, [byte], "{file}");
    }
    let image = image::RgbaImage::from_fn(16, 9, |x, y| image::Rgba([7, x as u8, y as u8, x as u8]));
    let mut file = std::io::Cursor::new(Vec::new());
    image.write_to(&mut file, image::ImageFormat::Png).unwrap();
    let png = Mine::decode(file.get_ref()).unwrap();
    assert_eq!((png.bytes[5 * 16 + 3], png.format), ([7, 3, 5], "PNG"));
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

/// Names and contents of chunks.
type Chunks<'a> = &'a [(png::chunk::ChunkType, &'a [u8])];

/// Bytes of a grey ramp in a PNG with these chunks before its pixels.
fn png_with(chunks: Chunks<'_>, stored: impl Fn(f64) -> f64) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, 64, 48);
    encoder.set_color(png::ColorType::Rgb);
    let mut writer = encoder.write_header().unwrap();
    chunks.iter().for_each(|(name, data)| writer.write_chunk(*name, data).unwrap());
    let pixel = |index: u32| [(255.0 * stored(ramp(index))).round() as u8; 3];
    writer.write_image_data((0..64 * 48).map(pixel).collect::<Vec<_>>().as_flattened()).unwrap();
    drop(writer);
    bytes
}

fn ramp(index: u32) -> f64 {
    0.05 + 0.9 * f64::from(index % 64) / 64.0
}

#[test]
fn png_colour_chunks_are_used_or_noted() {
    use png::chunk::{cHRM, cICP, gAMA, sRGB};
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("a.png");
    let read = |chunks: Chunks<'_>, stored: &dyn Fn(f64) -> f64, encoding: Option<Encoding>| {
        std::fs::write(&path, png_with(chunks, stored)).unwrap();
        Picture::read(&path, encoding).unwrap()
    };
    let is_right = |picture: &Picture| {
        let values = (0..64 * 48).map(|index| (picture.pixels[index as usize][0], ramp(index)));
        values.filter(|(found, _)| found.is_finite()).all(|(found, wanted)| (found - wanted).abs() < 0.02)
    };
    let gamma = |gamma: f64| ((100_000.0 * gamma).round() as u32).to_be_bytes();
    let srgb = |x: f64| Encoding::Srgb.displayed(x, 0, 1);
    let (linear, square, other) = (|x: f64| x, f64::sqrt, |x: f64| x.powf(1.0 / 1.8));
    let stated: [(Chunks<'_>, &dyn Fn(f64) -> f64); 7] = [
        (&[(sRGB, &[0])], &srgb),
        (&[(gAMA, &gamma(1.0 / 2.2))], &srgb),
        (&[(gAMA, &gamma(1.0))], &linear),
        (&[(gAMA, &gamma(0.5))], &square),
        (&[(gAMA, &gamma(1.0 / 1.8))], &other),
        (&[(cICP, &[1, 13, 0, 1]), (gAMA, &gamma(1.0))], &srgb),
        (&[(cICP, &[1, 8, 0, 1])], &linear),
    ];
    for (chunks, stored) in stated {
        let picture = read(chunks, stored, None);
        assert!(is_right(&picture), "{chunks:?}");
        assert!(
            picture.notes.iter().any(|note| note.contains("it says that its values are")),
            "{:?}",
            picture.notes
        );
        // A flag says more than the file.
        let picture = read(chunks, &square, Some(Encoding::Book(Transfer::Gamma2)));
        assert!(is_right(&picture) && picture.notes.is_empty(), "{chunks:?}: {:?}", picture.notes);
    }
    let primaries: Vec<u8> = [31_270_u32, 32_900, 70_800, 29_200, 17_000, 79_700, 13_100, 4600]
        .into_iter()
        .flat_map(u32::to_be_bytes)
        .collect();
    let noted: [(Chunks<'_>, &str); 3] = [
        (&[(cICP, &[9, 16, 0, 1])], "PQ"),
        (&[(cICP, &[12, 13, 0, 1])], "Display P3"),
        (&[(cHRM, &primaries)], "its colours are not those of sRGB"),
    ];
    for (chunks, part) in noted {
        let notes = read(chunks, &square, None).notes;
        assert!(notes.iter().any(|note| note.contains(part)), "{part}: {notes:?}");
    }
    assert!(is_right(&read(&[], &square, None)), "without such a chunk, values are the book's");
}
