//! The final picture of 14.1, in which the small spheres are placed at random: what every program's picture has in common.

use super::Mine;
use super::fit::Compared;
use super::hypothesis::{Hypothesis, Studio};
use super::mask::{enlarged, grown};
use super::screen::small;
use super::written::EQUAL;
use crate::job::recipe::Recipe;
use crate::scene::Scene;
use crate::scene::builtin::book_of;
use crate::stages::Stage;
use anyhow::Result;
use std::sync::Arc;

/// Number of scenes compared: each with different random numbers, and one without small spheres.
const SCENES: u64 = 7;

/// Samples per pixel of their small pictures.
const SAMPLES: u64 = 32;

/// The recipe of a stage, with the spheres that are the same in every program.
pub fn common(stage: &Stage) -> Recipe {
    let mut recipe = stage.recipe();
    if stage.setup.has_random_spheres {
        recipe.scene = Arc::new(large(&recipe.scene));
    }
    recipe
}

fn large(scene: &Scene) -> Scene {
    let mut scene = scene.clone();
    scene.spheres.retain(|sphere| sphere.radius >= 1.0);
    scene
}

/// The picture, without the pixels that depend on where the small spheres of `stage` are; judged in squares of `factor` x
/// `factor` pixels.
pub fn fixed(mine: &Mine, stage: &'static Stage, studio: &mut Studio, factor: u32) -> Result<Mine> {
    let size = [mine.width, mine.height];
    let mut pictures = Vec::new();
    for seed in 1..=SCENES {
        let mut hypothesis = Hypothesis::right(stage, common(stage), size);
        if seed < SCENES {
            hypothesis.recipe.scene = Arc::new(book_of(100 + seed));
        }
        // All have the same random numbers, so paths that meet no small sphere are equal.
        pictures.push(small(studio, &hypothesis, factor, SAMPLES)?.mean());
    }
    let spread = |cell: usize, channel: usize| {
        let values = pictures.iter().map(|picture| picture[cell][channel].sqrt());
        let range = values.fold([f64::INFINITY, 0.0], |[low, high], x| [low.min(x), high.max(x)]);
        range[1] - range[0]
    };
    let depends: Vec<bool> =
        (0..pictures[0].len()).map(|cell| (0..3).any(|channel| spread(cell, channel) > EQUAL)).collect();
    // The neighbours of a dependent cell may depend in yet another scene.
    let [width, height] = size.map(|side| side as usize);
    let cells = [width, height].map(|side| side / factor as usize);
    let ignored = enlarged(&grown(&depends, cells), [width, height], factor as usize);
    Ok(Mine { ignored: Some(ignored.into()), ..mine.clone() })
}

/// Fills the pixels of our picture that are not compared, from a scene with small spheres.
pub fn complete(ours: &mut Compared, mine: &Mine, studio: &mut Studio) -> Result<()> {
    const SAMPLES: u64 = 64;
    let Some(ignored) = &mine.ignored else { return Ok(()) };
    let stage = ours.hypothesis.stage;
    let whole = Hypothesis::right(stage, stage.recipe(), ours.hypothesis.size());
    let whole = studio.render(&whole, 1, SAMPLES, None)?;
    for (ours, whole) in ours.rendered.halves.iter_mut().zip(&whole.halves) {
        let pixels = ours.iter_mut().zip(whole).zip(ignored.iter());
        pixels.filter(|(_, is_ignored)| **is_ignored).for_each(|((pixel, whole), _)| *pixel = *whole);
    }
    Ok(())
}
