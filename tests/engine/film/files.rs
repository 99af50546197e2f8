//! Film files: what is read back, and what is refused.

use super::common::{description, noisy_film};
use proptest::prelude::*;
use std::ops::Range;
use std::path::Path;
use weekender::film::{CheckpointError, Film, FilmFile, checkpoint, key};
use weekender::job::output::read_description;

proptest! {
    #[test]
    fn film_files_round_trip(
        width in 1_u32..9,
        height in 1_u32..9,
        words in prop::collection::vec(0..u64::MAX / 4, 1..40),
        rejected in 0_u64..5,
    ) {
        let mut film = Film::new(width, height);
        let mut next = words.iter().cycle();
        for half in film.halves_mut() {
            for sum in half {
                sum.0 = [0; 3].map(|_| *next.next().unwrap());
            }
        }
        film.record(5..1 << 32, rejected).unwrap();
        film.record(0..2, 0).unwrap();
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("film.exr");
        checkpoint::save(&path, &film, &description()).unwrap();
        let file = checkpoint::load(&path).unwrap();
        prop_assert!(file.film == film && file.description == description());
        let head = checkpoint::read_head(&path).unwrap();
        prop_assert_eq!((head.width, head.height, head.rejected), (width, height, rejected));
        prop_assert_eq!((&head.samples, head.description), (film.samples(), description()));
        // The same film always gives the same bytes.
        let again = directory.path().join("again.exr");
        checkpoint::save(&again, &film, &description()).unwrap();
        prop_assert!(std::fs::read(&path).unwrap() == std::fs::read(&again).unwrap());
    }
}

fn load_error(path: &Path) -> CheckpointError {
    let error = checkpoint::load(path).unwrap_err();
    assert!(error.to_string().contains(&path.display().to_string()), "{error}");
    error
}

/// Changes the byte at `offset` after the position of `needle` in the file.
fn spoil(path: &Path, needle: &[u8], offset: usize, byte: u8) {
    let mut bytes = std::fs::read(path).unwrap();
    let place = bytes.windows(needle.len()).position(|window| window == needle).unwrap();
    bytes[place + offset] = byte;
    std::fs::write(path, bytes).unwrap();
}

#[test]
fn another_version_is_refused() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("x.exr");
    checkpoint::save(&path, &noisy_film(9, 4, &[0..10]), &description()).unwrap();
    let whole = std::fs::read(&path).unwrap();
    let writer = concat!("Weekender ", env!("CARGO_PKG_VERSION")).to_owned();
    for (needle, offset, digit, layout, samples) in [
        (&b"\nsample_version = 6"[..], 18, b'2', 4, 2),
        (b"version = 4", 10, b'9', 9, 6),
        (b"version = 4", 10, b'3', 3, 6),
    ] {
        std::fs::write(&path, &whole).unwrap();
        spoil(&path, needle, offset, digit);
        let error = load_error(&path);
        let message = error.to_string();
        for part in
            [&format!("layout {layout} with samples of version {samples}"), &writer, "render it again"]
        {
            assert!(message.contains(part), "{part} is not in {message}");
        }
        let (path, writer) = (path.clone(), writer.clone());
        assert_eq!(error, CheckpointError::Version { path, layout, samples, writer });
    }
}

/// A film of layout 4 with samples of version 6, as they were first written, with two bands and both halves.
#[test]
fn old_film_file_is_read() {
    let path = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/engine/film/data/layout-4.exr"));
    let FilmFile { film, description } = checkpoint::load(path).unwrap();
    assert_eq!((film.width(), film.height(), film.samples().to_string()), (20, 18, "0..4".to_owned()));
    assert_eq!(description.get(key::SCENE), Some("three-spheres"));
    let sum = |half: usize| film.halves()[half].iter().flat_map(|sum| sum.0).sum::<u64>();
    assert_eq!([sum(0), sum(1)], [15_647_608_029, 15_527_426_791]);
    assert_eq!(checkpoint::read_head(path).unwrap().description, description);
}

/// The bytes of an attribute in a file: name, type, length and value.
fn attribute(bytes: &[u8], name_and_type: &str) -> Range<usize> {
    let name_and_type = (name_and_type.replace(' ', "\0") + "\0").into_bytes();
    let start = bytes.windows(name_and_type.len()).position(|window| window == name_and_type).unwrap();
    let length = start + name_and_type.len();
    let value = u32::from_le_bytes(bytes[length..length + 4].try_into().unwrap());
    start..length + 4 + value as usize
}

#[test]
fn no_flipped_bit_changes_a_film_unnoticed() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("x.exr");
    let film = noisy_film(3, 2, &[0..4, 9..12]);
    checkpoint::save(&path, &film, &description()).unwrap();
    let whole = std::fs::read(&path).unwrap();
    let original = checkpoint::load(&path).unwrap();
    // Attributes that other programs may read and this one does not.
    let harmless = "displayWindow box2i,dataWindow box2i,pixelAspectRatio float,screenWindowCenter v2f,\
                    screenWindowWidth float,name string,type string,software string,lineOrder lineOrder,\
                    chunkCount int,channels chlist";
    let harmless = harmless.split(',').map(|name| attribute(&whole, name));
    // The version field of OpenEXR, too.
    let harmless: Vec<Range<usize>> = harmless.chain(std::iter::once(4..8)).collect();
    let (mut bytes, mut accepted) = (whole.clone(), Vec::new());
    // The lowest bit of each byte, and the one that changes the case of a letter.
    for bit in (0..whole.len()).flat_map(|byte| [8 * byte, 8 * byte + 5]) {
        bytes[bit / 8] ^= 1 << (bit % 8);
        std::fs::write(&path, &bytes).unwrap();
        if let Ok(read) = checkpoint::load(&path) {
            assert_eq!(read, original, "bit {} of byte {}", bit % 8, bit / 8);
            accepted.push(bit / 8);
        }
        if let Ok(description) = read_description(&path) {
            assert_eq!(description, original.description, "bit {} of byte {}", bit % 8, bit / 8);
        }
        bytes[bit / 8] ^= 1 << (bit % 8);
    }
    accepted.dedup();
    let surprising: Vec<String> = accepted
        .iter()
        .filter(|place| !harmless.iter().any(|range| range.contains(place)))
        .map(|place| {
            format!("{place}: {:?}", String::from_utf8_lossy(&whole[place.saturating_sub(30)..=*place]))
        })
        .collect();
    assert!(surprising.is_empty(), "{surprising:#?}");
    for length in 0..whole.len() {
        std::fs::write(&path, &whole[..length]).unwrap();
        assert!(checkpoint::load(&path).is_err(), "{length}");
    }
}

#[test]
fn damage_is_located() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("x.exr");
    let film = noisy_film(40, 70, &[0..4]);
    checkpoint::save(&path, &film, &description()).unwrap();
    let whole = std::fs::read(&path).unwrap();
    // Each row is a chunk: its number, its length in bytes, and the bytes.
    for row in [0_u32, 17, 47, 69] {
        let chunks = (8..whole.len() - 8).filter(|place| whole[*place..place + 4] == row.to_le_bytes());
        let chunk = chunks.max().unwrap();
        let length = u32::from_le_bytes(whole[chunk + 4..chunk + 8].try_into().unwrap());
        assert!(length > 500, "no chunk was found");
        let mut bytes = whole.clone();
        bytes[chunk + 8 + length as usize / 2] ^= 1;
        std::fs::write(&path, bytes).unwrap();
        let first = row / 16 * 16;
        let rows = format!("the rows {first} to {}", (first + 15).min(69));
        let message = checkpoint::load(&path).unwrap_err().to_string();
        assert!(message.contains("is damaged") && message.contains(&rows), "{row}: {message}");
    }
}
