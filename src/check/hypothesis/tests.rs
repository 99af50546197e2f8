//! Bytes, layouts and hypotheses of all mistakes.

use super::*;
use crate::stages::{Shading, Stage, SurfaceRule};
use crate::statistics::blocks::{BlockTest, Differences, Noise};

/// Acne depends on the precision, and the gradient has no rays.
fn is_traced(stage: &&Stage) -> bool {
    let rules = stage.setup.rules;
    stage.id != "book" && rules.shading != Shading::ImageGradient && rules.surface != SurfaceRule::Acne
}

#[test]
fn without_a_mistake_the_plain_tracer_makes_the_right_picture() {
    for stage in Stage::ALL.iter().filter(is_traced) {
        let mut recipe = stage.recipe();
        (recipe.settings.width, recipe.settings.height) = (96, 54);
        let mut studio = Studio::new(&recipe).unwrap();
        let effort = Effort { fast: 256, plain: 32 };
        let right = studio.render(&Hypothesis::right(&recipe), effort).unwrap().pixels;
        let plain = Tracer::new(&recipe, None).means(32);
        // The grid of one sample per pixel meets edges where the precisions may differ.
        let values: Vec<[f64; 3]> =
            right.iter().zip(&plain).map(|(a, b)| [0, 1, 2].map(|i| b[i] - a[i])).collect();
        let test = BlockTest::of(&Differences {
            width: 96,
            values: &values,
            noise: Noise::Spread,
            steps: None,
            tolerance: 2e-3,
            rare: 0.0,
        });
        assert!(test.largest_excess() < 6.0 && test.largest < 7.0, "{}: {:?}", stage.id, test.excess);
    }
}

#[test]
fn every_mistake_shows_in_some_stage() {
    for mistake in Mistake::ALL {
        let shows = |stage: &Stage| {
            let recipe = stage.recipe();
            let is_direct = mistake == Mistake::Truncated;
            mistake.applies_to(&recipe) && (is_direct || !Hypothesis::of(mistake, &recipe).is_empty())
        };
        assert!(Stage::ALL.iter().any(shows), "{mistake:?}");
    }
}

#[test]
fn bytes_and_linear_values_belong_together() {
    for id in ["sky", "metal", "gamut"] {
        let recipe = Stage::find(id).unwrap().recipe();
        let right = Hypothesis::right(&recipe);
        let others = [Mistake::NoGamma, Mistake::GammaEarly, Mistake::GammaTwice, Mistake::TimesInteger];
        let others = others.into_iter().flat_map(|mistake| Hypothesis::of(mistake, &recipe));
        for hypothesis in others.chain([right]) {
            for byte in 0..254 {
                let [linear, half_step] = hypothesis.linear(byte, 3, 9);
                assert_eq!(hypothesis.byte_of(linear, 3, 9), byte, "{id}, {:?}", hypothesis.mistake);
                assert!(half_step > 0.0);
                // Of a value times 255, cut off, the upper half of all bytes is one less.
                let less = hypothesis.byte_of(hypothesis.times_255(linear, 3, 9), 3, 9);
                assert_eq!(less, byte - u8::from(byte >= 128), "{id}, {:?}", hypothesis.mistake);
            }
        }
    }
}

#[test]
fn a_picture_is_laid_out_as_it_was_written() {
    let recipe = Stage::find("metal").unwrap().recipe();
    // Three columns and two rows; each pixel has the number of its place.
    let linear: Vec<[f64; 3]> = (0..6).map(|place| [0.0, 0.1, 0.2].map(|c| f64::from(place) + c)).collect();
    let laid_out =
        |mistake| -> Vec<[f64; 3]> { Hypothesis::of(mistake, &recipe)[0].shown.laid_out(&linear, 3) };
    let places = |of: Vec<[f64; 3]>| of.iter().map(|pixel| pixel[0] as u32).collect::<Vec<_>>();
    assert_eq!(places(laid_out(Mistake::NoGamma)), [0, 1, 2, 3, 4, 5]);
    assert_eq!(places(laid_out(Mistake::FlippedRows)), [3, 4, 5, 0, 1, 2]);
    assert_eq!(places(laid_out(Mistake::MirroredColumns)), [2, 1, 0, 5, 4, 3]);
    assert_eq!(laid_out(Mistake::SwappedChannels)[4], [4.2, 4.1, 4.0]);
}

#[test]
fn small_pictures_get_all_samples_and_large_ones_as_many_paths() {
    let count = |id: &str, width: u32, height: u32| {
        let mut recipe = Stage::find(id).unwrap().recipe();
        (recipe.settings.width, recipe.settings.height) = (width, height);
        let mut studio = Studio::new(&recipe).unwrap();
        let right = Hypothesis::right(studio.recipe());
        let expected = studio.render(&right, Effort { fast: 4, plain: 4 }).unwrap();
        assert_eq!(expected.pixels.len(), (width * height) as usize);
        studio.last.as_ref().map(|(_, count, _)| *count)
    };
    assert_eq!(count("antialiased", 16, 9), Some(4));
    assert_eq!(count("antialiased", 600, 300), Some(2));
    assert_eq!(count("antialiased", 1200, 301), Some(1));
    // Without antialiasing, all samples of a pixel are the same.
    assert_eq!(count("sky", 16, 9), Some(1));
}
