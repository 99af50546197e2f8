//! The cases' pictures, by Weekender and by the book's arithmetic.

use super::super::Candidate;
use super::case::Case;
use super::families::build::sized;
use super::suite::{by_the_book, trace};
use crate::film::Description;
use crate::job::output::write_image;
use crate::job::recipe::{Recipe, file, plain_name};
use crate::stages::Transfer;
use anyhow::Result;
use std::path::Path;
use std::sync::atomic::AtomicBool;

/// Size of a picture, pixels.
const SIZE: [u32; 2] = [120, 80];

/// Samples per pixel of a picture.
const SAMPLES: u64 = 32;

/// Larger scenes are not rendered with the book's arithmetic, which has no hierarchy.
const BOOK_SPHERES: usize = 5000;

/// A case's two pictures, as named in the files.
const KINDS: [&str; 2] = ["ours", "book"];

/// Renders a case's pictures into `directory`, leaving out any that cannot be rendered. Fails if a file cannot be
/// written.
pub fn write(directory: &Path, case: &Case, painter: &mut Candidate, interrupt: &AtomicBool) -> Result<()> {
    for (kind, recipe) in KINDS.into_iter().zip(recipes(&case.recipe)) {
        let Some(recipe) = recipe else { continue };
        if let Ok(traced) = trace(painter, &recipe, interrupt) {
            let description = Description::new(&file::to_picture_toml(&recipe));
            let path = directory.join(file_name(&case.id, kind));
            write_image(&path, &traced.film, Transfer::Gamma2, &description)?;
        }
    }
    Ok(())
}

/// The recipes of both pictures.
fn recipes(recipe: &Recipe) -> [Option<Recipe>; 2] {
    let [width, height] = SIZE;
    let is_square = recipe.settings.width == recipe.settings.height;
    let ours = sized(recipe.clone(), [if is_square { height } else { width }, height], SAMPLES);
    let book = (ours.scene.spheres.len() <= BOOK_SPHERES).then(|| by_the_book(&ours));
    [Some(ours), book]
}

fn file_name(id: &str, kind: &str) -> String {
    format!("{} {kind}.png", plain_name(id)).replace(' ', "-")
}
