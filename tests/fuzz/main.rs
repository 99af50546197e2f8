//! Fuzz tests of all parsers. An input may be refused, but there must be no panic, and no memory use that the length of the
//! input does not explain. What a parser accepts must be written and read again.
//!
//! A short run is part of the tests. For a long run: `PROPTEST_CASES=1000000 cargo test --release --test fuzz`.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a helper of a test may fail like the test")]

mod seeds;

use peak_alloc::PeakAlloc;
use proptest::prelude::*;
use proptest::sample::{Index, select};
use proptest::test_runner::TestRunner;
use std::ffi::OsString;
use std::io::Cursor;
use weekender::film::{Checksum, FilmFile, checkpoint};
use weekender::job::output::{Encoding, decode_picture, read_description};
use weekender::job::recipe::file;
use weekender::stages::Transfer;

#[global_allocator]
static MEMORY: PeakAlloc = PeakAlloc;

/// Number of inputs for each parser in a short run.
const SHORT_RUN: u32 = 2000;

/// A parser under test.
struct Parser {
    name: &'static str,
    seeds: Vec<Vec<u8>>,
    /// Words of the parser's language.
    words: &'static str,
    /// Returns the memory that may be used beyond what the length of the input explains, bytes.
    parse: fn(&[u8]) -> usize,
    /// Bytes of memory allowed per byte of input.
    bytes_per_byte: usize,
}

fn parsers() -> Vec<Parser> {
    let exr = "sum.a.R.lo weekenderFilm chlist box2i tiledesc deepscanline";
    let exrs = seeds::exrs().into_iter().chain(seeds::kept("tests/fuzz/finds/exr")).collect();
    let parser =
        |name, seeds, words, parse, bytes_per_byte| Parser { name, seeds, words, parse, bytes_per_byte };
    vec![
        parser("scene", seeds::scenes(), SCENE_WORDS, scene, 600),
        parser("film", seeds::films(), exr, film, 3000),
        parser("exr", exrs, exr, picture, 100_000),
        parser("png", seeds::pngs(), "IHDR PLTE IDAT tRNS iTXt zTXt IEND", picture, 10_000),
        parser("ppm", seeds::ppms(), "P1 P2 P3 P4 P5 P6 P7 255 65535 #", picture, 700),
        parser("pfm", seeds::pfms(), "PF Pf -1 1e39", picture, 100),
        parser("description", seeds::descriptions(), "Weekender recipe # iTXt zTXt", description, 3000),
        parser("flags", seeds::flags(), FLAG_WORDS, flags, 1 << 20),
    ]
}

const SCENE_WORDS: &str = "[camera] [render] [sky] [rules] [[spheres]] [[keyframes]] [materials.a] look_from vup \
    vfov_degrees focus_distance center radius material kind albedo fuzz refraction_index \"lambertian\" \"metal\" \
    \"dielectric\" scene scene_mark samples_per_pixel estimate_error [[ ]] { } \"\"\" ''' # = . , true \
    1979-05-27T07:32:00Z \\u0000 \\U0010ffff";

const FLAG_WORDS: &str = "--batch --scene --stage --size --samples --depth --seed --look-from --vfov --simd --isa --threads \
    --out --resume --json --time-limit --noise-target --sample-range compare merge bench report --help -- = , .. x";

/// Numbers that often cause errors.
const NUMBERS: &str = "0 -0 -1 1 1e308 -1e308 1e-320 1e400 nan inf -inf 0.5 4294967296 4294967295 9223372036854775807 \
    18446744073709551615 99999999999999999999999999 0x7f 1e 16384 16385 20000";

/// A place in the input, how many bytes are replaced there, and the new bytes.
type Change = (Index, Option<usize>, Vec<u8>);

fn change(words: &'static str) -> impl Strategy<Value = Change> {
    let text = |list: Vec<&'static str>| select(list).prop_map(|word| word.as_bytes().to_vec());
    let words = words.split_whitespace().flat_map(|word| [word, "\n"]).collect();
    let binary =
        (any::<u64>(), 0..64_u32, 1..=8_usize, any::<bool>()).prop_map(|(number, shift, size, is_little)| {
            let number = number >> shift;
            let bytes = if is_little { number.to_le_bytes() } else { number.swap_bytes().to_le_bytes() };
            if is_little { bytes[..size].to_vec() } else { bytes[8 - size..].to_vec() }
        });
    let inserted = prop_oneof![
        3 => prop::collection::vec(any::<u8>(), 0..4),
        3 => text(words),
        2 => text(NUMBERS.split(' ').collect()),
        2 => binary,
        1 => (any::<u8>(), 1..300_usize).prop_map(|(byte, count)| vec![byte; count]),
    ];
    // `None` overwrites.
    let removed = prop_oneof![2 => Just(None), 1 => Just(Some(0)), 1 => (0..64_usize).prop_map(Some)];
    (any::<Index>(), removed, inserted)
}

fn changed(seed: &[u8], changes: &[Change]) -> Vec<u8> {
    let mut input = seed.to_vec();
    for (at, removed, inserted) in changes {
        let start = at.index(input.len() + 1);
        let end = (start + removed.unwrap_or(inserted.len())).min(input.len());
        input.splice(start..end, inserted.iter().copied());
    }
    input
}

/// There is one test, because the memory of all threads counts.
#[test]
fn no_input_breaks_a_parser() {
    let mut config = ProptestConfig { failure_persistence: None, ..ProptestConfig::default() };
    if std::env::var_os("PROPTEST_CASES").is_none() {
        config.cases = SHORT_RUN;
    }
    for parser in parsers() {
        parser.seeds.iter().for_each(|seed| check(&parser, seed));
        let changes = prop::collection::vec(change(parser.words), 1..6);
        let inputs = (select(parser.seeds.clone()), changes, any::<bool>());
        let mut runner = TestRunner::new(config.clone());
        let result = runner.run(&inputs, |(seed, changes, is_sealed)| {
            let mut input = changed(&seed, &changes);
            if is_sealed {
                let _ = seal(&mut input);
            }
            check(&parser, &input);
            Ok(())
        });
        result.unwrap_or_else(|error| panic!("{}: {error}", parser.name));
    }
}

fn check(parser: &Parser, input: &[u8]) {
    let before = MEMORY.current_usage();
    MEMORY.reset_peak_usage();
    let allowance = (parser.parse)(input);
    let peak = MEMORY.peak_usage().saturating_sub(before);
    let limit = (4 << 20) + parser.bytes_per_byte * input.len() + allowance;
    assert!(peak <= limit, "{} takes {peak} bytes, more than {limit}", parser.name);
}

/// Fields may have ten million spheres, which take time and memory of their own.
fn names_large_field(text: &str) -> bool {
    text.split("field:").skip(1).any(|count| count.bytes().take_while(u8::is_ascii_digit).count() > 4)
}

fn scene(input: &[u8]) -> usize {
    let Ok(text) = std::str::from_utf8(input) else { return 0 };
    if names_large_field(text) {
        return 0;
    }
    let Ok(recipe) = file::parse(text, "a.toml") else { return 0 };
    let again = file::parse(&file::to_toml(&recipe), "a.toml").unwrap();
    assert_eq!(again.job().unwrap(), recipe.job().unwrap(), "a scene changes when it is read back");
    2000 * recipe.scene.spheres.len()
}

fn film(input: &[u8]) -> usize {
    let directory = tempfile::tempdir().unwrap();
    let [path, copy] = ["a.exr", "b.exr"].map(|name| directory.path().join(name));
    std::fs::write(&path, input).unwrap();
    let Ok(FilmFile { film, description }) = checkpoint::load(&path) else { return 0 };
    assert!(film.error().is_none_or(|error| error.rmse.is_finite()));
    checkpoint::save(&copy, &film, &description).unwrap();
    assert_eq!(checkpoint::load(&copy).unwrap(), FilmFile { film, description });
    1 << 20
}

fn picture(input: &[u8]) -> usize {
    // A chunk is read completely before it is checked.
    let chunk = 16 << 20;
    let Ok(read) = decode_picture(Cursor::new(input), input.len() as u64, None) else { return chunk };
    let count = read.width as usize * read.height as usize;
    let picture = read.linear(Encoding::Book(Transfer::Gamma2));
    assert_eq!(picture.pixels.len(), count);
    assert!(picture.steps.is_none_or(|steps| steps.len() == count));
    chunk + 100 * count
}

fn description(input: &[u8]) -> usize {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("a");
    std::fs::write(&path, input).unwrap();
    let Ok(description) = read_description(&path) else { return 0 };
    if names_large_field(description.recipe()) {
        return 0;
    }
    let _ = file::parse(description.recipe(), "a").map(|recipe| recipe.job());
    1000 * description.recipe().len()
}

/// Parses one argument per line.
fn flags(input: &[u8]) -> usize {
    let text = String::from_utf8_lossy(input);
    if !names_large_field(&text) {
        let words = ["weekender"].into_iter().chain(text.split('\n')).map(OsString::from);
        let _ = weekender::cli::parse(words);
    }
    1 << 30
}

/// Corrects the checksum of a film's header, so that the code after it is reached. `None` for other files.
fn seal(input: &mut [u8]) -> Option<()> {
    let text_at = |name: &[u8]| {
        let start = input.windows(name.len()).position(|window| window == name)? + name.len();
        let length = u32::from_le_bytes(input.get(start..start + 4)?.try_into().ok()?) as usize;
        Some((start + 4, input.get(start + 4..start + 4 + length)?))
    };
    let (start, head) = text_at(b"weekenderFilm\0string\0")?;
    let (_, recipe) = text_at(b"weekenderRecipe\0string\0")?;
    let (_, comments) = text_at(b"comments\0string\0")?;
    let head = std::str::from_utf8(head).ok()?;
    let table: toml::Table = head.parse().ok()?;
    let whole = |value: &toml::Value| u64::try_from(value.as_integer()?).ok();
    let number = |name: &str| whole(table.get(name)?);
    let mut sum = Checksum::default();
    for name in ["version", "width", "height", "halves", "rejected"] {
        sum.word(number(name)?);
    }
    let ranges = table.get("samples")?.as_array()?;
    sum.word(ranges.len() as u64);
    for range in ranges {
        range.as_array()?.iter().try_for_each(|end| whole(end).map(|end| sum.word(end)))?;
    }
    sum.text(recipe);
    sum.text(comments);
    sum.word(number("sample_version")?);
    let bands = table.get("bands")?.as_array()?;
    bands.iter().try_for_each(|band| band.as_str().map(|band| sum.text(band.as_bytes())))?;
    let place = start + head.find("head_checksum = \"")? + "head_checksum = \"".len();
    input.get_mut(place..place + 16)?.copy_from_slice(sum.finish().as_bytes());
    Some(())
}
