//! The final picture of 14.1, in which the small spheres are placed at random: what every program's picture has in common.

use super::Mine;
use super::hypothesis::{Compared, Hypothesis, Studio};
use super::mask::{enlarged, grown};
use super::written::{EQUAL, reduced};
use crate::job::recipe::Recipe;
use crate::scene::Scene;
use crate::scene::builtin::book_of;
use crate::stages::Stage;
use anyhow::Result;
use std::borrow::Cow;
use std::sync::Arc;

/// Number of scenes compared: each with different random numbers, and one without small spheres.
const SCENES: u64 = 7;

/// Samples per pixel of their pictures.
const SAMPLES: u64 = 32;

/// Width and height of the cells that are compared, pixels.
const CELL: usize = 4;

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

/// The picture, without the pixels that depend on where the small spheres of `stage` are.
pub fn fixed<'a>(mine: &'a Mine, stage: &Stage) -> Result<Cow<'a, Mine>> {
    if !stage.setup.has_random_spheres {
        return Ok(Cow::Borrowed(mine));
    }
    let [width, height] = [mine.width as usize, mine.height as usize];
    let mut studio = Studio::new(common(stage), [mine.width, mine.height])?;
    let mut pictures = Vec::new();
    for seed in 1..=SCENES {
        let mut hypothesis = Hypothesis::right(studio.recipe());
        if seed < SCENES {
            hypothesis.recipe.scene = Arc::new(book_of(100 + seed));
        }
        // All have the same random numbers, so paths that meet no small sphere are equal.
        let linear = studio.halves(&hypothesis, 1, SAMPLES, None)?.mean();
        pictures.push(reduced(&linear, width, CELL));
    }
    let (columns, rows) = (width / CELL, height / CELL);
    let spread = |cell: usize, channel: usize| {
        let values = pictures.iter().map(|picture| picture[cell][channel].sqrt());
        let range = values.fold([f64::INFINITY, 0.0], |[low, high], x| [low.min(x), high.max(x)]);
        range[1] - range[0]
    };
    let depends: Vec<bool> =
        (0..columns * rows).map(|cell| (0..3).any(|channel| spread(cell, channel) > EQUAL)).collect();
    // The neighbours of a dependent cell may depend in yet another scene.
    let ignored = enlarged(&grown(&depends, [columns, rows]), [width, height], CELL);
    Ok(Cow::Owned(Mine { ignored: Some(ignored.into()), ..mine.clone() }))
}

/// Fills the pixels of our picture that are not compared, from a scene with small spheres.
pub fn complete(ours: &mut Compared, ignored: Option<&[bool]>, stage: &Stage) -> Result<()> {
    let Some(ignored) = ignored else { return Ok(()) };
    let mut studio = Studio::new(stage.recipe(), ours.hypothesis.size())?;
    let whole = studio.halves(&Hypothesis::right(studio.recipe()), 1, ours.rendered.samples, None)?;
    for (half, whole) in ours.rendered.halves.iter_mut().zip(whole.halves) {
        let pixels = half.iter_mut().zip(whole).zip(ignored);
        pixels.filter(|(_, is_ignored)| **is_ignored).for_each(|((pixel, whole), _)| *pixel = whole);
    }
    Ok(())
}
