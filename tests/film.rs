//! The film: exact sums, sample ranges, the resolved picture, the error estimate, film files and merging.

#![allow(clippy::unwrap_used, clippy::panic, clippy::single_range_in_vec_init)]

use proptest::prelude::*;
use std::collections::HashSet;
use std::io::Cursor;
use std::ops::Range;
use std::path::Path;
use weekender::files::InputError;
use weekender::film::{
    CheckpointError, Description, ErrorEstimate, FIXED_POINT_MAX, FIXED_POINT_SCALE, Film, FilmError,
    MergeError, PixelSum, RADIANCE_LIMIT, SAMPLE_LIMIT, SampleRanges, checkpoint, fixed_point, key,
    merge_files, same_recipe_text, to_byte,
};
use weekender::output::decode_description;
use weekender::stages::Transfer;

const RECIPE: &str = "[render]\nwidth = 7\nsamples_per_pixel = 10\n";

/// A pseudo-random number that depends only on its arguments.
fn noise(pixel: usize, sample: u64, channel: usize) -> f64 {
    let mut x = (pixel as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ (sample << 20) ^ channel as u64;
    for _ in 0..3 {
        x = (x ^ (x >> 31)).wrapping_mul(0xd6e8_feb8_6659_fd93);
    }
    (x >> 40) as f64 / 16_777_216.0
}

fn add(film: &mut Film, pixel: usize, sample: u64, radiance: [f64; 3]) -> bool {
    let half = (sample % film.halves().len() as u64) as usize;
    match fixed_point(radiance) {
        Some(sum) => film.halves_mut()[half][pixel].add(sum),
        None => return false,
    }
    true
}

/// A film of noise, filled as a renderer would fill it.
fn noisy_film(width: u32, height: u32, halves: usize, ranges: &[Range<u64>]) -> Film {
    let mut film = Film::new(width, height, halves);
    for range in ranges {
        for sample in range.clone() {
            for pixel in 0..(width * height) as usize {
                add(&mut film, pixel, sample, [0, 1, 2].map(|c| noise(pixel, sample, c)));
            }
        }
        film.record(range.clone(), 0).unwrap();
    }
    film
}

fn description() -> Description {
    let mut description = Description::new(RECIPE);
    description.set(key::SCENE, "three-spheres");
    description.set(key::SAMPLES, 10);
    description.set(key::SECONDS, 1.5);
    description
}

#[test]
fn ten_million_samples_of_a_constant_have_its_mean() {
    let samples = 10_000_000;
    let mut film = Film::new(1, 1, 2);
    for sample in 0..samples {
        add(&mut film, 0, sample, [0.7; 3]);
    }
    film.record(0..samples, 0).unwrap();
    for mean in film.mean(0) {
        assert!((mean / 0.7 - 1.0).abs() <= 1e-7, "{mean}");
    }
}

#[test]
fn the_order_of_samples_does_not_matter() {
    let forward = noisy_film(5, 3, 2, &[0..100, 100..128]);
    let backward = noisy_film(5, 3, 2, &[100..128, 7..100, 0..7]);
    assert_eq!(forward, backward);
    let mut merged = noisy_film(5, 3, 2, &[3..90]);
    merged.merge(&noisy_film(5, 3, 2, &[90..128, 0..3])).unwrap();
    assert_eq!(forward, merged);
}

#[test]
fn merged_films_have_rejected_the_samples_of_both() {
    let mut film = Film::new(1, 1, 2);
    film.record(0..4, 3).unwrap();
    let mut other = Film::new(1, 1, 2);
    other.record(4..6, 2).unwrap();
    let directory = tempfile::tempdir().unwrap();
    let paths = ["a.exr", "b.exr"].map(|name| directory.path().join(name));
    for (path, film) in paths.iter().zip([&film, &other]) {
        checkpoint::save(path, film, &description()).unwrap();
    }
    assert_eq!(merge_files(&paths, same_recipe_text).unwrap().film.rejected(), 5);
    film.merge(&other).unwrap();
    assert_eq!((film.rejected(), film.sample_count()), (5, 6));
}

#[test]
fn what_is_no_radiance_is_rejected_and_the_picture_stays_finite() {
    let mut film = Film::new(1, 1, 1);
    let bad = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -1e-30];
    let mut rejected = 0;
    for (sample, x) in bad.into_iter().enumerate() {
        for channel in 0..3 {
            let mut radiance = [0.5; 3];
            radiance[channel] = x;
            rejected += u64::from(!add(&mut film, 0, sample as u64, radiance));
        }
    }
    assert!(add(&mut film, 0, 12, [1.0, 0.0, -0.0]));
    film.record(0..13, rejected).unwrap();
    assert_eq!(film.rejected(), 12);
    assert_eq!(film.pixel_sum(0), PixelSum([1 << 24, 0, 0]));
    assert!(film.mean(0).iter().all(|x| x.is_finite()));
}

#[test]
fn fixed_point_rounds_and_saturates() {
    let k = |x: f64| fixed_point([x; 3]).unwrap().0[0];
    assert_eq!(k(1.0), 1 << 24);
    assert_eq!(k(0.6 / FIXED_POINT_SCALE), 1);
    assert_eq!(k(0.4 / FIXED_POINT_SCALE), 0);
    assert_eq!(k(RADIANCE_LIMIT), u64::from(FIXED_POINT_MAX));
    assert_eq!(k(f64::MAX), u64::from(FIXED_POINT_MAX));
    let largest = f32::from_bits((RADIANCE_LIMIT as f32).to_bits() - 1);
    assert_eq!(k(f64::from(largest)), u64::from(FIXED_POINT_MAX));
}

/// A film of one sample in which one channel takes all of `values`.
fn film_of(values: &[f64]) -> Film {
    let mut film = Film::new(values.len() as u32, 1, 1);
    for (pixel, x) in values.iter().enumerate() {
        add(&mut film, pixel, 0, [*x; 3]);
    }
    film.record(0..1, 0).unwrap();
    film
}

#[test]
fn bytes_step_where_the_book_has_them_step() {
    // (b / 256)^2 is exact in fixed point for every byte b.
    for byte in 0..=255_u8 {
        let edge = (f64::from(byte) / 256.0).powi(2);
        let below = edge - 1.0 / FIXED_POINT_SCALE;
        let film = film_of(&[edge, below.max(0.0)]);
        let bytes = film.to_rgb8(Transfer::Gamma2);
        assert_eq!(bytes[..3], [byte; 3], "at the edge of {byte}");
        assert_eq!(bytes[3..], [byte.saturating_sub(1); 3], "below the edge of {byte}");
        let bytes = film_of(&[f64::from(byte) / 256.0]).to_rgb8(Transfer::Linear);
        assert_eq!(bytes, [byte; 3]);
    }
    assert_eq!(film_of(&[1.0, 100.0]).to_rgb8(Transfer::Gamma2), [255; 6]);
    assert_eq!(Film::new(2, 2, 1).to_rgb8(Transfer::Gamma2), [0; 12]);
}

#[test]
fn the_upper_half_can_stay_linear() {
    let mut film = Film::new(1, 3, 1);
    for pixel in 0..3 {
        add(&mut film, pixel, 0, [0.25; 3]);
    }
    film.record(0..1, 0).unwrap();
    let bytes = film.to_rgb8(Transfer::LinearAboveGamma2);
    assert_eq!(bytes, [64, 64, 64, 128, 128, 128, 128, 128, 128]);
}

#[test]
fn rows_are_the_picture_s_rows() {
    for halves in [1, 2] {
        let film = noisy_film(7, 5, halves, &[0..6]);
        for transfer in [Transfer::Linear, Transfer::Gamma2, Transfer::LinearAboveGamma2] {
            let whole = film.to_rgb8(transfer);
            let mut expected = Vec::new();
            for pixel in 0..35 {
                expected.extend(film.mean(pixel).map(|x| to_byte(x, transfer, pixel / 7, 5)));
            }
            assert_eq!(whole, expected);
            let mut part = vec![0; 3 * 7 * 2];
            film.resolve_rows(2..4, transfer, &mut part);
            assert_eq!(part, whole[2 * 21..4 * 21]);
        }
        let means = film.means();
        assert!((0..35).all(|i| means[i] == film.mean(i).map(|x| x as f32)));
    }
}

#[test]
fn the_error_is_that_of_the_mean() {
    // The halves differ by 0.2 everywhere: MSE = 0.04 / 4.
    let mut film = Film::new(4, 1, 2);
    for pixel in 0..4 {
        add(&mut film, pixel, 0, [0.6; 3]);
        add(&mut film, pixel, 1, [0.4; 3]);
    }
    assert_eq!(film.error(), None);
    film.record(0..1, 0).unwrap();
    assert_eq!(film.error(), None);
    film.record(1..2, 0).unwrap();
    let error = film.error().unwrap();
    assert!((error.rmse - 0.1).abs() < 1e-6, "{error:?}");
    assert!((error.rel_mse - 0.01 / 0.26).abs() < 1e-6, "{error:?}");
    assert_eq!(noisy_film(2, 2, 1, &[0..4]).error(), None);
}

#[test]
fn the_error_is_right_for_halves_of_different_counts() {
    // Noise is uniform in [0, 1) with variance 1/12 per sample. Of three samples, two are in half A.
    for samples in [3, 8, 9] {
        let error = noisy_film(200, 100, 2, &[0..samples]).error().unwrap();
        let expected = (1.0 / 12.0 / samples as f64).sqrt();
        assert!((error.rmse / expected - 1.0).abs() < 0.02, "{samples}: {error:?}, expected {expected}");
    }
}

#[test]
fn the_estimate_knows_how_far_off_it_may_be() {
    // 400 small films with different samples: compares the spread of their estimates with the stated uncertainty.
    let errors: Vec<_> =
        (0..400).map(|k| noisy_film(16, 12, 2, &[8 * k..8 * k + 8]).error().unwrap()).collect();
    let mean = |of: &dyn Fn(usize) -> f64| (0..errors.len()).map(of).sum::<f64>() / errors.len() as f64;
    let middle = mean(&|k| errors[k].rmse);
    let spread = mean(&|k| (errors[k].rmse - middle).powi(2)).sqrt();
    let said = mean(&|k| errors[k].rmse_deviation);
    assert!((said / spread - 1.0).abs() < 0.15, "said {said}, was {spread}");
    assert_eq!(Film::new(4, 3, 2).error(), None);
    let mut same = Film::new(4, 3, 2);
    same.record(0..2, 0).unwrap();
    assert_eq!(same.error().unwrap().rmse_deviation, 0.0);
}

#[test]
fn an_uncertainty_is_a_share_of_the_error() {
    let estimate = ErrorEstimate { rmse: 0.1, rmse_deviation: 0.002, rel_mse: 0.0 };
    assert_eq!(estimate.uncertainty(), "± 2.0 %");
    assert!((estimate.pixels_in_effect() - 625.0).abs() < 1e-6, "{}", estimate.pixels_in_effect());
    let none = ErrorEstimate { rmse: 0.0, rmse_deviation: 0.0, rel_mse: 0.0 };
    assert_eq!(none.uncertainty(), "± 0.1 %");
}

/// A film of two samples with noise only in its first `noisy` pixels.
fn film_with_noise_in(pixels: u32, noisy: usize) -> Film {
    let mut film = Film::new(pixels, 1, 2);
    for pixel in 0..pixels as usize {
        let by = if pixel < noisy { 0.5 } else { 0.0 };
        add(&mut film, pixel, 0, [0.5 + by; 3]);
        add(&mut film, pixel, 1, [0.5 - by; 3]);
    }
    film.record(0..2, 0).unwrap();
    film
}

#[test]
fn an_estimate_of_few_pixels_among_many_is_in_doubt() {
    for (pixels, noisy, is_doubted) in
        [(1000, 50, true), (1000, 1000, false), (1000, 300, false), (150, 50, false), (150, 5, true)]
    {
        let film = film_with_noise_in(pixels, noisy);
        let doubt = film.doubt(&film.error().unwrap());
        assert_eq!(doubt.is_some(), is_doubted, "{noisy} of {pixels}: {doubt:?}");
    }
}

#[test]
fn films_that_do_not_go_together_are_left_as_they_were() {
    let mut film = noisy_film(4, 3, 2, &[0..10]);
    let before = film.clone();
    let error = film.merge(&noisy_film(4, 3, 2, &[20..30, 8..12])).unwrap_err();
    assert_eq!(error, FilmError::Overlap { range: 8..10 });
    for (width, height, halves) in [(3, 4, 2), (4, 3, 1)] {
        assert!(matches!(film.merge(&Film::new(width, height, halves)), Err(FilmError::Size { .. })));
    }
    assert!(film.record(9..11, 5).is_err());
    assert_eq!(film, before);
}

#[test]
fn only_what_can_be_a_film_becomes_one() {
    let film = noisy_film(4, 3, 2, &[0..10]);
    let build = |width, halves: Vec<Vec<PixelSum>>, rejected| {
        Film::from_parts(width, 3, halves, film.samples().clone(), rejected)
    };
    assert_eq!(build(4, film.halves().to_vec(), 0).unwrap(), film);
    assert!(build(5, film.halves().to_vec(), 0).is_err());
    assert!(build(4, film.halves()[..1].to_vec(), 0).is_ok());
    assert!(build(4, Vec::new(), 0).is_err());
    assert!(build(4, film.halves().to_vec(), 4 * 3 * 10 + 1).is_err());
    let mut beyond = film.halves().to_vec();
    beyond[1][11].0[2] = 5 * u64::from(FIXED_POINT_MAX) + 1;
    let message = build(4, beyond, 0).unwrap_err().to_string();
    assert!(message.contains("pixel 11"), "{message}");
}

proptest! {
    #[test]
    fn ranges_are_a_set(
        ranges in prop::collection::vec((0_u64..60, 0_u64..12), 0..12),
        within in (0_u64..70, 0_u64..70),
        limit in 0_u64..20,
    ) {
        let mut set = HashSet::new();
        let mut samples = SampleRanges::default();
        for (start, length) in ranges {
            let range = start..start + length;
            let common: Vec<u64> = range.clone().filter(|i| set.contains(i)).collect();
            match samples.overlap(&range) {
                None => prop_assert!(common.is_empty()),
                Some(both) => {
                    // It is a contiguous range that starts at the first common sample and is as long as possible.
                    prop_assert!(both.clone().all(|i| set.contains(&i) && range.contains(&i)));
                    prop_assert_eq!(Some(&both.start), common.first());
                    prop_assert!(!(set.contains(&both.end) && range.contains(&both.end)));
                }
            }
            let before = samples.clone();
            if common.is_empty() {
                prop_assert_eq!(samples.insert(range.clone()), Ok(()));
                set.extend(range);
            } else {
                prop_assert!(samples.insert(range).is_err());
                prop_assert_eq!(&samples, &before);
            }
        }
        prop_assert_eq!(&SampleRanges::from_ranges(samples.iter().collect::<Vec<_>>().into_iter().rev()).unwrap(), &samples);
        let (mut first, mut second) = (SampleRanges::default(), SampleRanges::default());
        for (index, range) in samples.iter().enumerate() {
            if index % 2 == 0 { &mut first } else { &mut second }.insert(range).unwrap();
        }
        prop_assert_eq!(first.first_common(&second), None);
        prop_assert_eq!(&first.union(&second).unwrap(), &samples);
        if first.count() > 0 {
            prop_assert!(samples.first_common(&first).is_some() && samples.union(&first).is_err());
        }
        let held: HashSet<u64> = samples.iter().flatten().collect();
        prop_assert_eq!(&held, &set);
        let pieces: Vec<_> = samples.iter().collect();
        prop_assert!(pieces.windows(2).all(|pair| pair[0].end < pair[1].start));
        prop_assert_eq!(samples.count(), set.len() as u64);
        prop_assert_eq!(samples.end(), set.iter().max().map_or(0, |i| i + 1));
        for half_count in 1..=3 {
            for half in 0..half_count {
                let expected = set.iter().filter(|i| (**i as usize) % half_count == half).count();
                prop_assert_eq!(samples.count_in_half(half, half_count), expected as u64);
            }
        }
        let within = within.0..within.1;
        let start = within.clone().find(|i| !set.contains(i));
        let gap = start.filter(|_| limit > 0).map(|start| {
            let end = (start..within.end).take(limit as usize).find(|i| set.contains(i));
            start..end.unwrap_or(within.end.min(start + limit))
        });
        prop_assert_eq!(samples.first_gap(within, limit), gap);
    }

    #[test]
    fn a_film_file_gives_back_the_film(
        width in 1_u32..9,
        height in 1_u32..9,
        halves in 1_usize..=2,
        words in prop::collection::vec(0..u64::MAX / 4, 1..40),
        rejected in 0_u64..5,
    ) {
        let mut film = Film::new(width, height, halves);
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
        prop_assert_eq!(file.film, film);
        prop_assert_eq!(file.description, description());
    }
}

#[test]
fn a_set_of_samples_may_reach_the_last_number_and_no_further() {
    let mut samples = SampleRanges::default();
    samples.insert(1..SAMPLE_LIMIT).unwrap();
    assert_eq!(samples.count_in_half(0, 2) + samples.count_in_half(1, 2), samples.count());
    assert_eq!(samples.to_string(), format!("1..{SAMPLE_LIMIT}"));
    for end in [SAMPLE_LIMIT + 1, 1 << 63, u64::MAX] {
        let range = SAMPLE_LIMIT..end;
        let refused = Err(FilmError::Range { range: range.clone() });
        assert_eq!(samples.insert(range.clone()), refused);
        assert_eq!(SampleRanges::from_ranges([range.clone()]).map(|_| ()), refused);
        let mut film = Film::new(1, 1, 1);
        assert_eq!(film.record(range, 0), refused);
        assert_eq!(film, Film::new(1, 1, 1));
    }
}

#[test]
fn more_rejected_samples_than_can_be_counted_are_an_error() {
    let mut film = Film::new(1, 1, 1);
    film.record(0..1, u64::MAX).unwrap();
    let before = film.clone();
    assert!(matches!(film.record(1..2, 1), Err(FilmError::Parts { .. })));
    let mut other = Film::new(1, 1, 1);
    other.record(1..2, 1).unwrap();
    assert!(matches!(film.merge(&other), Err(FilmError::Parts { .. })));
    assert_eq!(film, before);
}

#[test]
fn a_film_may_have_very_many_ranges() {
    // Anything quadratic in the number of ranges would take most of a minute here.
    let even = || (0..200_000).map(|k| 2 * k..2 * k + 1);
    let mut film = Film::new(1, 1, 1);
    for range in even() {
        film.record(range, 0).unwrap();
    }
    assert_eq!(film.samples(), &SampleRanges::from_ranges(even().rev()).unwrap());
    let directory = tempfile::tempdir().unwrap();
    let [path, odd] = ["even.exr", "odd.exr"].map(|name| directory.path().join(name));
    checkpoint::save(&path, &film, &description()).unwrap();
    assert_eq!(checkpoint::load(&path).unwrap().film, film);
    let mut gaps = 0;
    let mut other = Film::new(1, 1, 1);
    while let Some(gap) = film.samples().first_gap(other.samples().end()..400_000, 10) {
        other.record(gap.clone(), 0).unwrap();
        other = if gap.end < 400_000 { other } else { break };
        gaps += 1;
    }
    assert_eq!(gaps, 199_999);
    checkpoint::save(&odd, &other, &description()).unwrap();
    let merged = merge_files(&[path, odd], same_recipe_text).unwrap();
    assert_eq!(merged.film.samples().to_string(), "0..400000");
}

#[test]
fn a_film_always_becomes_the_same_bytes() {
    let directory = tempfile::tempdir().unwrap();
    let film = noisy_film(9, 4, 2, &[0..10]);
    let bytes: Vec<Vec<u8>> = (0..8)
        .map(|i| {
            let path = directory.path().join(format!("{i}.exr"));
            checkpoint::save(&path, &film, &description()).unwrap();
            std::fs::read(path).unwrap()
        })
        .collect();
    assert!(bytes.iter().all(|other| *other == bytes[0]));
}

fn load_error(path: &Path) -> CheckpointError {
    let error = checkpoint::load(path).unwrap_err();
    assert!(error.to_string().contains(&path.display().to_string()), "{error}");
    error
}

#[test]
fn what_is_no_film_file_is_refused_with_the_reason() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("x.exr");
    let input = |error| match error {
        CheckpointError::Input(error) => error,
        other => panic!("{other}"),
    };
    assert!(matches!(input(load_error(&path)), InputError::Unreadable { .. }));
    assert!(matches!(input(load_error(directory.path())), InputError::NotFile { .. }));
    for bytes in [&b""[..], b"v/1", b"P6\n1 1\n255\nabc"] {
        std::fs::write(&path, bytes).unwrap();
        assert!(matches!(load_error(&path), CheckpointError::NotExr { .. }));
    }
    exr::prelude::write_rgb_file(&path, 3, 2, |_, _| (0.1_f32, 0.2_f32, 0.3_f32)).unwrap();
    assert!(matches!(load_error(&path), CheckpointError::NotFilm { .. }));
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
    checkpoint::save(&path, &noisy_film(9, 4, 2, &[0..10]), &description()).unwrap();
    spoil(&path, b"version = 3", 10, b'2');
    let error = load_error(&path);
    let told = error.to_string();
    assert!(told.contains("version 2, but this program reads version 3; go on with the program"), "{told}");
    assert_eq!(error, CheckpointError::Version { path, version: 2 });
}

/// The bytes of an attribute in a file: name, type, length and value.
fn attribute(bytes: &[u8], name_and_type: &[u8]) -> Range<usize> {
    let start = bytes.windows(name_and_type.len()).position(|window| window == name_and_type).unwrap();
    let length = start + name_and_type.len();
    let value = u32::from_le_bytes(bytes[length..length + 4].try_into().unwrap());
    start..length + 4 + value as usize
}

#[test]
fn no_flipped_bit_changes_a_film_unnoticed() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("x.exr");
    let film = noisy_film(3, 2, 2, &[0..4, 9..12]);
    checkpoint::save(&path, &film, &description()).unwrap();
    let whole = std::fs::read(&path).unwrap();
    let original = checkpoint::load(&path).unwrap();
    // Attributes that other programs may read and this one does not.
    let harmless: Vec<Range<usize>> = [
        &b"displayWindow\0box2i\0"[..],
        b"dataWindow\0box2i\0",
        b"pixelAspectRatio\0float\0",
        b"screenWindowCenter\0v2f\0",
        b"screenWindowWidth\0float\0",
        b"name\0string\0",
        b"type\0string\0",
        b"software\0string\0",
        b"lineOrder\0lineOrder\0",
        b"chunkCount\0int\0",
        b"channels\0chlist\0",
    ]
    .into_iter()
    .map(|name| attribute(&whole, name))
    // The version field of OpenEXR.
    .chain([4..8])
    .collect();
    let (mut bytes, mut accepted) = (whole.clone(), Vec::new());
    for bit in 0..8 * whole.len() {
        bytes[bit / 8] ^= 1 << (bit % 8);
        if let Ok(read) = checkpoint::read(Cursor::new(&bytes), bytes.len() as u64, &path) {
            assert_eq!(read, original, "bit {} of byte {}", bit % 8, bit / 8);
            accepted.push(bit / 8);
        }
        if let Ok(description) = decode_description(Cursor::new(&bytes), &path) {
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
        assert!(checkpoint::read(Cursor::new(&whole[..length]), length as u64, &path).is_err(), "{length}");
    }
}

#[test]
fn a_missing_channel_is_named() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("x.exr");
    checkpoint::save(&path, &noisy_film(9, 4, 1, &[0..10]), &description()).unwrap();
    spoil(&path, b"sum.a.R.lo", 9, b'p');
    let message = load_error(&path).to_string();
    assert!(message.contains("sum.a.R.lo is missing"), "{message}");
}

#[test]
fn merged_files_are_the_film_of_one_run() {
    let directory = tempfile::tempdir().unwrap();
    let paths: Vec<_> = [0..4, 9..12, 4..9]
        .into_iter()
        .map(|range: Range<u64>| {
            let path = directory.path().join(format!("{}.exr", range.start));
            let mut description = description();
            description.set(key::BACKEND, if range.start == 9 { "gpu" } else { "cpu" });
            checkpoint::save(&path, &noisy_film(5, 3, 2, &[range]), &description).unwrap();
            path
        })
        .collect();
    let merged = merge_files(&paths, same_recipe_text).unwrap();
    assert_eq!(merged.film, noisy_film(5, 3, 2, &[0..12]));
    assert_eq!(merged.description.get(key::SAMPLES), Some("12"));
    assert_eq!(merged.description.get(key::SECONDS), Some("4.5"));
    assert_eq!(merged.description.get(key::BACKEND), Some("cpu; gpu"));
    assert_eq!(merged.description.recipe(), RECIPE);

    // Overlap: the message names both files and the samples.
    let overlapping = directory.path().join("overlapping.exr");
    checkpoint::save(&overlapping, &noisy_film(5, 3, 2, &[100..101, 10..20]), &description()).unwrap();
    let error = merge_files(&[&paths[0], &paths[1], &overlapping], same_recipe_text).unwrap_err();
    let (first, other) = (paths[1].clone(), overlapping);
    assert_eq!(error, MergeError::Overlap { first, other, range: 10..12 });

    // Different jobs, different sizes, no files.
    let stranger = directory.path().join("stranger.exr");
    let recipe = RECIPE.replace("width = 7", "width = 8");
    checkpoint::save(&stranger, &noisy_film(5, 3, 2, &[50..51]), &Description::new(&recipe)).unwrap();
    let error = merge_files(&[&paths[0], &stranger], same_recipe_text).unwrap_err().to_string();
    assert!(error.contains("stranger.exr") && error.contains("`width = 7`") && error.contains("`width = 8`"));
    let trusting = merge_files(&[&paths[0], &stranger], |_, _| Ok(())).unwrap();
    assert_eq!(trusting.film.sample_count(), 5);
    assert_eq!(trusting.description.get(key::SAMPLES), Some("5"), "with a gap");
    checkpoint::save(&stranger, &noisy_film(3, 5, 2, &[50..51]), &description()).unwrap();
    let error = merge_files(&[&paths[0], &stranger], same_recipe_text).unwrap_err();
    assert!(matches!(error, MergeError::Film { reason: FilmError::Size { .. }, .. }));
    assert_eq!(merge_files::<&Path>(&[], same_recipe_text), Err(MergeError::NoFiles));
}

#[test]
fn recipes_may_ask_for_different_numbers_of_samples() {
    let more = RECIPE.replace("samples_per_pixel = 10", "samples_per_pixel = 500");
    assert_eq!(same_recipe_text(RECIPE, &more), Ok(()));
    assert!(same_recipe_text(RECIPE, "[render]\n").is_err());
    assert!(same_recipe_text("samples_per_pixel_other = 1", "samples_per_pixel_other = 2").is_err());
}
