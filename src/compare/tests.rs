//! Films whose noise is unusual: none, or more than their difference. What a backend renders beside a file.

use super::side::Rendering;
use super::{PairedSamples, Side, beside, both, compare, compare_sides, sides};
use crate::backends::BackendChoice;
use crate::cli::{CompareOptions, CompareSide};
use crate::film::{Description, Film, checkpoint, fixed_point};
use crate::output::Encoding;
use crate::recipe::Recipe;
use crate::recipe::file::to_picture_toml;
use crate::render_cpu::CpuOptions;
use crate::stages::{Diffuse, Transfer};
use std::hash::{DefaultHasher, Hash, Hasher};
use std::sync::Arc;

/// A film with one sample in each half, of the radiance that `value` returns for half and pixel.
fn side(value: impl Fn(u32, u32) -> f64) -> Side {
    let mut film = Film::new(80, 48, 2);
    for (half, pixels) in film.halves_mut().iter_mut().enumerate() {
        for (pixel, sum) in pixels.iter_mut().enumerate() {
            *sum = fixed_point([value(half as u32, pixel as u32); 3]).unwrap();
        }
    }
    film.record(0..2, 0).unwrap();
    Side::of_film(String::new(), String::new(), film)
}

#[test]
fn pictures_without_noise_are_equal_or_infinitely_far_apart() {
    let dark = side(|_, _| 0.25);
    assert_eq!(compare(&dark, &dark, None).times_noise(), 0.0);
    assert_eq!(compare(&dark, &side(|_, _| 0.75), None).times_noise(), f64::INFINITY);
    let found = compare(&dark, &side(|_, pixel| 0.25 + f64::from(pixel % 2)), None);
    assert_eq!((found.rms, found.times_noise()), (0.5_f64.sqrt(), f64::INFINITY));
}

/// The halves differ a lot, but both pictures have the same two.
#[test]
fn blocks_that_are_nearer_than_the_halves_allow_are_remarked_on() {
    let random = |half: u32, pixel: u32| {
        let mut hasher = DefaultHasher::new();
        [half, pixel].hash(&mut hasher);
        hasher.finish() as f64 / 2.0_f64.powi(64)
    };
    let [one, swapped, other] = [
        side(random),
        side(|half, pixel| random(1 - half, pixel)),
        side(|half, pixel| random(half + 2, pixel)),
    ];
    let is_remarked_on = |a: &Side, b: &Side, paired: Option<PairedSamples>| {
        compare(a, b, paired).notes.iter().any(|note| note.contains("do the halves belong to one picture?"))
    };
    assert!(is_remarked_on(&one, &swapped, None));
    assert!(!is_remarked_on(&one, &other, None));
    // Pictures of the same samples may be as near as they like.
    assert!(!is_remarked_on(&one, &swapped, Some(PairedSamples::default())));
}

fn one_thread() -> BackendChoice {
    BackendChoice::Cpu(CpuOptions { threads: Some(1), ..CpuOptions::default() })
}

fn backend() -> CompareSide {
    CompareSide::Backend { name: "cpu".to_owned(), choice: one_thread() }
}

/// Three spheres at 8x6 with 5 samples per pixel.
fn small() -> Recipe {
    let mut recipe = Recipe::find("three-spheres").unwrap();
    (recipe.settings.width, recipe.settings.height, recipe.samples_per_pixel) = (8, 6, 5);
    recipe
}

/// A film of `recipe` that holds the samples 4..6 and 8..11.
fn read_film(recipe: &Recipe) -> Side {
    let mut film = recipe.job().unwrap().new_film();
    for range in [4..6, 8..11] {
        film.record(range, 0).unwrap();
    }
    Side::of_rendered("film.exr".to_owned(), recipe.clone(), Arc::new(film)).unwrap()
}

#[test]
fn a_backend_renders_what_was_asked_for_else_what_the_film_holds_else_what_the_recipe_says() {
    let recipe = small();
    let mut seeded = recipe.clone();
    seeded.settings.seed = 7;
    let film = read_film(&recipe);
    let other = read_film(&seeded);
    let picture = Side { film: None, job: None, ..read_film(&recipe) };
    for (read, asked, expected) in [
        (&film, None, "4..6, 8..11"),
        (&film, Some(2), "0..2"),
        (&film, Some(5), "0..5"),
        (&film, Some(9), "0..9"),
        (&other, None, "0..5"),
        (&other, Some(9), "0..9"),
        (&picture, None, "0..3"),
        (&picture, Some(9), "0..9"),
    ] {
        // The recipe's own size and samples are not those of the file.
        let mut recipe = recipe.clone();
        (recipe.settings.width, recipe.settings.height, recipe.samples_per_pixel) = (40, 30, 3);
        let options = CompareOptions { recipe, samples: asked, ..options_of(backend(), backend()) };
        let mut rendering = Rendering::start(&one_thread(), "cpu").unwrap();
        let rendered = beside(&options, read, &mut rendering).unwrap();
        let found = rendered.film.unwrap();
        assert_eq!(found.samples().to_string(), expected, "{asked:?}");
        assert_eq!((found.width(), found.height(), rendered.name.as_str()), (8, 6, "cpu"));
    }
}

/// How `first` and `second` are compared, with the recipe of [`small`].
fn options_of(first: CompareSide, second: CompareSide) -> CompareOptions {
    CompareOptions {
        sides: [first, second],
        recipe: small(),
        samples: None,
        encoding: Encoding::Book(Transfer::Gamma2),
        heat_map: None,
        json: None,
    }
}

#[test]
fn a_backend_and_a_file_keep_their_order() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("film.exr");
    let recipe = small();
    let mut film = recipe.job().unwrap().new_film();
    film.halves_mut()[0].iter_mut().for_each(|sum| sum.add(fixed_point([50.0; 3]).unwrap()));
    film.record(0..2, 0).unwrap();
    checkpoint::save(&path, &film, &Description::new(&to_picture_toml(&recipe))).unwrap();
    let file = || CompareSide::File(path.clone());
    let name = path.display().to_string();
    for (options, names) in [
        (options_of(file(), backend()), [name.as_str(), "cpu"]),
        (options_of(backend(), file()), ["cpu", name.as_str()]),
    ] {
        let (found, paired) = sides(&options).unwrap();
        assert_eq!(found.each_ref().map(|side| side.name.as_str()), names);
        assert!(paired.is_none());
        // The film in the file is far brighter than any picture of the scene.
        let is_file_brighter = (compare(&found[0], &found[1], None).bias < 0.0) == (names[1] == "cpu");
        assert!(is_file_brighter, "{names:?}");
    }
    let (found, paired) = sides(&options_of(file(), file())).unwrap();
    assert!(paired.is_none() && compare(&found[0], &found[1], None).is_same);
}

#[test]
fn a_picture_with_fewer_levels_is_no_difference_unless_it_shows_something_else() {
    let directory = tempfile::tempdir().unwrap();
    // A gradient from the left to the right, in values from 0 to 1.
    let side = |most: u32, is_rounded: bool, brighter: f64| {
        let mut file = format!("P6 64 64 {most} ").into_bytes();
        for pixel in 0..64 * 64 {
            let value = 0.2 + 0.4 * f64::from(pixel % 64) / 64.0 + brighter;
            let most = f64::from(most);
            let stored = if is_rounded { (most * value).round() } else { ((most + 1.0) * value).floor() };
            file.extend([stored as u8; 3]);
        }
        let path = directory.path().join("a.ppm");
        std::fs::write(&path, file).unwrap();
        Side::read(&path, Encoding::Book(Transfer::Gamma2)).unwrap()
    };
    let fine = side(255, false, 0.0);
    for (most, is_rounded) in [(31, false), (31, true), (15, false), (15, true), (100, true)] {
        for found in [
            compare(&fine, &side(most, is_rounded, 0.0), None),
            compare(&side(most, is_rounded, 0.0), &fine, None),
        ] {
            assert!(found.is_equal(), "{most}, {is_rounded}: {:?} {:?}", found.reasons, found.unclear);
        }
        let found = compare(&fine, &side(most, is_rounded, 0.3), None);
        assert!(!found.reasons.is_empty(), "{most}, {is_rounded}: {:?}", found.unclear);
    }
}

#[test]
fn each_of_two_backends_renders_its_own_side() {
    let recipe = small();
    let start = |choice, name| Rendering::start(&choice, name).unwrap();
    let mut reference = start(BackendChoice::Reference { threads: Some(1) }, "reference");
    let mut cpu = start(one_thread(), "cpu");
    let (sides, paired) = both(&recipe, 6, &mut reference, &mut cpu).unwrap();
    assert_eq!(sides.each_ref().map(|side| side.name.as_str()), ["reference", "cpu"]);
    let job = recipe.job().unwrap();
    for (side, rendering) in sides.iter().zip([&mut reference, &mut cpu]) {
        let film = side.film.as_ref().unwrap();
        assert_eq!(film.samples().to_string(), "0..6");
        let alone = rendering.render(&recipe, &job, std::iter::once(0..6)).unwrap();
        assert_eq!(film, alone.film.as_ref().unwrap());
    }
    assert_eq!(paired.count, 6 * 8 * 6);
    // Two of one kind are told apart.
    let (sides, _) = both(&recipe, 1, &mut cpu, &mut start(one_thread(), "cpu")).unwrap();
    assert_eq!(sides.each_ref().map(|side| side.name.as_str()), ["cpu (first)", "cpu (second)"]);
}

#[test]
fn two_backends_render_the_samples_that_were_asked_for_else_those_of_the_recipe() {
    for (asked, count) in [(None, 5), (Some(2), 2), (Some(7), 7)] {
        let options = CompareOptions { samples: asked, ..options_of(backend(), backend()) };
        let (found, paired) = sides(&options).unwrap();
        for side in &found {
            assert_eq!(side.film.as_ref().unwrap().samples().to_string(), format!("0..{count}"));
        }
        assert_eq!(paired.map(|paired| (paired.count, paired.parted)), Some((count * 8 * 6, 0)));
    }
}

#[test]
fn pictures_that_differ_in_width_or_height_are_not_compared() {
    let side = |name: &str, width, height| {
        Side::of_film(name.to_owned(), String::new(), Film::new(width, height, 1))
    };
    for ([width, height], told) in [
        ([8, 7], Some("a.exr has 8x6 pixels and b.exr has 8x7; render both at the same size")),
        ([9, 6], Some("a.exr has 8x6 pixels and b.exr has 9x6; render both at the same size")),
        // As many pixels, but other rows.
        ([6, 8], Some("a.exr has 8x6 pixels and b.exr has 6x8; render both at the same size")),
        ([8, 6], None),
    ] {
        let found = compare_sides(&[side("a.exr", 8, 6), side("b.exr", width, height)], None);
        assert_eq!(found.err().map(|error| error.to_string()).as_deref(), told);
    }
}

#[test]
fn jobs_are_remarked_on_if_they_explain_the_result() {
    let side = |change: fn(&mut Recipe), samples| {
        let mut recipe = small();
        change(&mut recipe);
        let mut film = recipe.job().unwrap().new_film();
        film.record(samples, 0).unwrap();
        Side::of_rendered("a film".to_owned(), recipe, Arc::new(film)).unwrap()
    };
    let (same, other) = ("both hold the same samples", "these should be different pictures");
    let remarks = |second: Side| -> Vec<&'static str> {
        let found = compare_sides(&[side(|_| {}, 0..4), second], None).unwrap();
        let is_noted = |part: &&str| found.notes.iter().any(|note| note.contains(*part));
        [same, other].into_iter().filter(is_noted).collect()
    };
    assert_eq!(remarks(side(|_| {}, 0..4)), [same]);
    assert_eq!(remarks(side(|_| {}, 4..8)), [""; 0]);
    // Only the job counts, not how many samples the recipe asks for.
    assert_eq!(remarks(side(|recipe| recipe.samples_per_pixel = 9, 0..4)), [same]);
    type Change = fn(&mut Recipe);
    let changes: [(Change, &[&str]); 5] = [
        (|recipe| recipe.settings.seed = 1, &[]),
        (|recipe| recipe.settings.max_depth = 3, &[]),
        (|recipe| recipe.camera.vfov_degrees = 40.0, &[other]),
        (|recipe| recipe.rules.diffuse = Diffuse::Hemisphere, &[other]),
        (|recipe| recipe.scene = Recipe::find("metals").unwrap().scene, &[other]),
    ];
    for (change, expected) in changes {
        assert_eq!(remarks(side(change, 0..4)), expected);
    }
    // Nothing is known of a picture without a film or a job.
    for unknown in [
        Side { film: None, ..side(|recipe| recipe.camera.vfov_degrees = 40.0, 0..4) },
        Side { job: None, ..side(|recipe| recipe.camera.vfov_degrees = 40.0, 0..4) },
    ] {
        assert_eq!(remarks(unknown), [""; 0]);
    }
}
