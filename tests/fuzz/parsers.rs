//! The parsers under test. What a parser accepts, it must be able to write and read again.

use crate::seeds;
use std::ffi::OsString;
use std::io::Cursor;
use std::path::Path;
use weekender::film::{Checksum, FilmFile, checkpoint};
use weekender::measure::report;
use weekender::output::{Encoding, decode_description, decode_picture};
use weekender::recipe::file;
use weekender::stages::Transfer;

/// The result of parsing an input.
pub struct Outcome {
    pub is_taken: bool,
    /// The reason, if it was refused.
    pub told: String,
    /// Memory that may be used beyond what the length of the input explains, bytes.
    pub allowance: usize,
}

impl Outcome {
    fn refused(reason: impl ToString) -> Self {
        Outcome { is_taken: false, told: reason.to_string(), allowance: 0 }
    }

    fn taken(told: impl ToString, allowance: usize) -> Self {
        Outcome { is_taken: true, told: told.to_string(), allowance }
    }
}

/// A parser under test.
pub struct Parser {
    pub name: &'static str,
    pub seeds: Vec<Vec<u8>>,
    /// Words of the parser's language.
    pub words: &'static [&'static str],
    pub parse: fn(&[u8]) -> Outcome,
    /// Bytes of memory allowed per byte of input.
    pub bytes_per_byte: usize,
    /// Corrects checksums, so that the code after them is reached.
    pub seal: Option<fn(&mut [u8])>,
}

pub fn all() -> Vec<Parser> {
    let exr = &["sum.a.R.lo", "weekenderFilm", "chlist", "box2i", "tiledesc", "\0\0\0\0", "deepscanline"][..];
    let parser = |name, seeds, words, parse, bytes_per_byte| Parser {
        name,
        seeds,
        words,
        parse,
        bytes_per_byte,
        seal: None,
    };
    vec![
        parser("scene", seeds::scenes(), SCENE_WORDS, scene, 600),
        Parser { seal: Some(seal), ..parser("film", seeds::films(), exr, film, 3000) },
        parser("exr", seeds::exrs(), exr, picture, 100_000),
        parser(
            "png",
            seeds::pngs(),
            &["IHDR", "PLTE", "IDAT", "tRNS", "iTXt", "zTXt", "IEND"],
            picture,
            10_000,
        ),
        parser(
            "ppm",
            seeds::ppms(),
            &["P1", "P2", "P3", "P4", "P5", "P6", "P7", "255", "65535", "# ", "\n"],
            picture,
            700,
        ),
        parser("pfm", seeds::pfms(), &["PF", "Pf", "-1", "1e39", "\n"], picture, 100),
        Parser {
            seal: Some(seal),
            ..parser(
                "description",
                seeds::descriptions(),
                &["Weekender recipe", "# ", "iTXt", "zTXt"],
                description,
                3000,
            )
        },
        parser(
            "report",
            seeds::reports(),
            &["null", "true", "{", "}", "[", "]", ",", "\"schema\"", "1e400"],
            report_json,
            600,
        ),
        parser("flags", seeds::flags(), FLAG_WORDS, flags, 1 << 20),
    ]
}

const SCENE_WORDS: &[&str] = &[
    "[camera]",
    "[render]",
    "[sky]",
    "[rules]",
    "[[spheres]]",
    "[materials.a]",
    "look_from",
    "look_at",
    "vup",
    "vfov_degrees",
    "defocus_angle_degrees",
    "focus_distance",
    "center",
    "radius",
    "material",
    "kind",
    "albedo",
    "fuzz",
    "refraction_index",
    "\"lambertian\"",
    "\"metal\"",
    "\"dielectric\"",
    "scene = \"field:100\"",
    "scene_mark",
    "samples_per_pixel",
    "estimate_error",
    "[[",
    "]]",
    "{",
    "}",
    "\"\"\"",
    "'''",
    "#",
    "=",
    ".",
    ",",
    "\n",
    "true",
    "1979-05-27T07:32:00Z",
    "\\u0000",
    "\\U0010ffff",
];

const FLAG_WORDS: &[&str] = &[
    "\n--batch",
    "\n--scene\n",
    "\n--stage\n",
    "\n--size\n",
    "\n--samples\n",
    "\n--depth\n",
    "\n--seed\n",
    "\n--look-from\n",
    "\n--vfov\n",
    "\n--simd\n",
    "\n--isa\n",
    "\n--threads\n",
    "\n--out\n",
    "\n--resume\n",
    "\n--json\n",
    "\n--time-limit\n",
    "\n--noise-target\n",
    "\n--sample-range\n",
    "\ncompare",
    "\nmerge",
    "\nbench",
    "\ndiff",
    "\nreport",
    "\n--help",
    "\n--version",
    "\n--",
    "=",
    ",",
    "..",
    "x",
];

/// Fields may have ten million spheres, which take time and memory of their own.
fn names_large_field(text: &str) -> bool {
    text.split("field:").skip(1).any(|count| count.bytes().take_while(u8::is_ascii_digit).count() > 4)
}

fn scene(input: &[u8]) -> Outcome {
    let Ok(text) = std::str::from_utf8(input) else { return Outcome::refused("not UTF-8") };
    if names_large_field(text) {
        return Outcome::refused("a large field");
    }
    match file::parse(text, "a.toml") {
        Ok(recipe) => {
            let again = file::parse(&file::to_toml(&recipe), "a.toml").unwrap();
            assert_eq!(
                again.job().unwrap(),
                recipe.job().unwrap(),
                "a scene is another when it is read back"
            );
            let allowance = 2000 * recipe.scene.spheres.len();
            Outcome::taken("", allowance)
        }
        Err(error) => Outcome::refused(error),
    }
}

fn film(input: &[u8]) -> Outcome {
    let path = Path::new("a.exr");
    match checkpoint::read(Cursor::new(input), input.len() as u64, path) {
        Ok(FilmFile { film, description }) => {
            assert!(
                film.to_rgb8(Transfer::Gamma2).len() == 3 * film.width() as usize * film.height() as usize
            );
            assert!(film.error().is_none_or(|error| error.rmse.is_finite()));
            let directory = tempfile::tempdir().unwrap();
            let copy = directory.path().join("a.exr");
            checkpoint::save(&copy, &film, &description).unwrap();
            assert_eq!(checkpoint::load(&copy).unwrap(), FilmFile { film, description });
            Outcome::taken("", 1 << 20)
        }
        Err(error) => Outcome::refused(error),
    }
}

fn picture(input: &[u8]) -> Outcome {
    let encoding = Encoding::Book(Transfer::Gamma2);
    match decode_picture(Cursor::new(input), input.len() as u64, encoding) {
        Ok(picture) => {
            let count = picture.width as usize * picture.height as usize;
            assert_eq!(picture.pixels.len(), count);
            assert!(picture.steps.is_none_or(|steps| steps.len() == count));
            Outcome::taken("", (16 << 20) + 100 * count)
        }
        // A chunk is read completely before it is checked.
        Err(error) => Outcome { allowance: 16 << 20, ..Outcome::refused(error) },
    }
}

fn description(input: &[u8]) -> Outcome {
    match decode_description(Cursor::new(input), Path::new("a")) {
        Ok(description) => {
            let told = match file::parse(description.recipe(), "a") {
                Ok(recipe) => recipe.job().map_or_else(|error| error.to_string(), |_| String::new()),
                Err(error) => error.to_string(),
            };
            Outcome::taken(told, 1000 * description.recipe().len())
        }
        Err(error) => Outcome::refused(error),
    }
}

fn report_json(input: &[u8]) -> Outcome {
    match report::parse(input) {
        Ok(data) => {
            let text = serde_json::to_string(&data).unwrap();
            assert_eq!(report::parse(text.as_bytes()).unwrap(), data);
            Outcome::taken("", 0)
        }
        Err(error) => Outcome::refused(error),
    }
}

/// Parses one argument per line.
fn flags(input: &[u8]) -> Outcome {
    let text = String::from_utf8_lossy(input);
    if names_large_field(&text) {
        return Outcome::refused("a large field");
    }
    let words = ["weekender"].into_iter().chain(text.split('\n')).map(OsString::from);
    match weekender::cli::parse(words) {
        Ok(request) => Outcome::taken(format!("{request:?}").len().ilog2(), 1 << 30),
        Err(failure) => Outcome { allowance: 1 << 30, ..Outcome::refused(failure) },
    }
}

/// Corrects the checksum of a film's header, if there is one.
fn seal(input: &mut [u8]) {
    let _ = try_seal(input);
}

fn try_seal(input: &mut [u8]) -> Option<()> {
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
    if number("version")? > 3 {
        sum.word(number("sample_version")?);
        let bands = table.get("bands")?.as_array()?;
        bands.iter().try_for_each(|band| band.as_str().map(|band| sum.text(band.as_bytes())))?;
    }
    let place = start + head.find("head_checksum = \"")? + "head_checksum = \"".len();
    input.get_mut(place..place + 16)?.copy_from_slice(sum.finish().as_bytes());
    Some(())
}
