//! Which stages a picture looks like.

use super::hypothesis::{Effort, Expected, Hypothesis, Studio, StudioError};
use super::mistake::Mistake;
use super::picture::Mine;
use crate::recipe::Recipe;
use crate::stages::Stage;

/// Effort for each stage when the stage is not known.
const SMALL: Effort = Effort { fast: 64, plain: 16 };

/// The stages that can be checked. The small balls of the final picture are placed at random, so every program's picture
/// of it is another.
pub fn stages() -> impl Iterator<Item = &'static Stage> {
    Stage::ALL.iter().filter(|stage| stage.id != "book")
}

/// Cutting off paths of more rays than this shows nowhere.
const LONG_PATH: u32 = 20;

/// The stages whose pictures differ: of two that show the same, the one whose width is nearer, else the first.
fn distinct(width: u32) -> Vec<&'static Stage> {
    let mut distinct: Vec<(&'static Stage, Recipe)> = Vec::new();
    for stage in stages() {
        let recipe = stage.recipe();
        let shows_same = |(_, other): &&mut (&Stage, Recipe)| {
            let depth = |recipe: &Recipe| recipe.settings.max_depth.min(LONG_PATH);
            other.scene == recipe.scene
                && other.camera == recipe.camera
                && other.rules == recipe.rules
                && depth(other) == depth(&recipe)
        };
        let distance = |recipe: &Recipe| recipe.settings.width.abs_diff(width);
        match distinct.iter_mut().find(shows_same) {
            None => distinct.push((stage, recipe)),
            Some(same) if distance(&recipe) < distance(&same.1) => *same = (stage, recipe),
            Some(_) => {}
        }
    }
    distinct.into_iter().map(|(stage, _)| stage).collect()
}

/// How many stages are judged if the stage is not known.
const CANDIDATES: usize = 4;

/// The width of the small pictures that are compared with all stages, pixels.
const SMALL_WIDTH: u32 = 64;

/// A root mean square difference below which a stage is taken for found, display values.
const FOUND: f64 = 0.03;

/// The stages that the picture looks like most.
pub fn candidates(mine: &Mine) -> Result<Vec<&'static Stage>, StudioError> {
    let factor = (mine.width / SMALL_WIDTH).max(1);
    let mut ranked = Vec::new();
    for is_thorough in [false, true] {
        ranked.clear();
        for stage in distinct(mine.width) {
            let mut studio = Studio::new(&recipe_of(stage, mine.width / factor, mine.height / factor))?;
            let mut hypotheses = vec![Hypothesis::right(studio.recipe())];
            hypotheses.extend(
                Hypothesis::mistakes(studio.recipe()).into_iter().filter(|hypothesis| {
                    is_thorough || hypothesis.mistake.is_some_and(Mistake::is_of_output)
                }),
            );
            let mut least = f64::INFINITY;
            for hypothesis in &hypotheses {
                let expected = studio.render(hypothesis, SMALL)?;
                least = least.min(rough_difference(mine, factor, hypothesis, &expected));
            }
            ranked.push((least, stage));
        }
        ranked.sort_by(|a, b| a.0.total_cmp(&b.0));
        if ranked.first().is_some_and(|(least, _)| *least < FOUND) {
            break;
        }
    }
    Ok(ranked.into_iter().map(|(_, stage)| stage).take(CANDIDATES).collect())
}

/// Root mean square difference of reduced pictures, display values.
fn rough_difference(mine: &Mine, factor: u32, hypothesis: &Hypothesis, expected: &Expected) -> f64 {
    let (width, height) = ((mine.width / factor) as usize, (mine.height / factor) as usize);
    let mut sum = 0.0;
    for (index, pixel) in expected.pixels.iter().enumerate() {
        let (x, y) = (index % width, index / width);
        for (channel, linear) in pixel.iter().enumerate() {
            let mut mean = 0.0;
            for dy in 0..factor as usize {
                for dx in 0..factor as usize {
                    let at = (y * factor as usize + dy) * mine.width as usize + x * factor as usize + dx;
                    mean += f64::from(mine.bytes[at][channel]);
                }
            }
            mean /= f64::from(factor * factor);
            let shown = f64::from(hypothesis.byte_of(*linear, y, height));
            sum += ((mean - shown) / 256.0).powi(2);
        }
    }
    (sum / (3.0 * expected.pixels.len() as f64)).sqrt()
}

pub fn recipe_of(stage: &Stage, width: u32, height: u32) -> Recipe {
    let mut recipe = stage.recipe();
    (recipe.settings.width, recipe.settings.height) = (width.max(1), height.max(1));
    recipe
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rough_difference_is_that_of_means_over_squares() {
        let hypothesis = Hypothesis::of(Mistake::GammaEarly, &Stage::find("sky").unwrap().recipe()).remove(0);
        // Three columns and two rows of squares of two pixels; each square is 48 levels off in one channel.
        let linear = |place: usize| 0.1 * (place + 1) as f64;
        let byte = |place: usize| hypothesis.byte_of(linear(place), 0, 2);
        let expected = Expected { pixels: (0..6).map(|place| [linear(place); 3]).collect() };
        let bytes = (0..6 * 4)
            .map(|index| {
                let (x, y) = (index % 6, index / 6);
                let near = byte(y / 2 * 3 + x / 2);
                // Four values with the mean of their square.
                let own = if (x + y) % 2 == 0 { near - 5 } else { near + 5 };
                [own, own - 48, own]
            })
            .collect();
        let mine = Mine { width: 6, height: 4, bytes, format: "P3", damages: Vec::new() };
        let found = rough_difference(&mine, 2, &hypothesis, &expected);
        assert!((found - 48.0 / 256.0 / 3.0_f64.sqrt()).abs() < 1e-12, "{found}");
    }

    #[test]
    fn of_stages_that_show_the_same_the_one_whose_width_is_nearer_is_tried() {
        let ids = |width| distinct(width).into_iter().map(|stage| stage.id).collect::<Vec<_>>();
        for (one, other) in [("diffuse", "diffuse-limited"), ("ppm-tiny", "ppm-gradient")] {
            for width in [1, 16, 300, 4000] {
                let is_tried = |id: &str| ids(width).contains(&id);
                let distance = |id: &str| Stage::find(id).unwrap().recipe().settings.width.abs_diff(width);
                let [a, b] = [one, other].map(is_tried);
                if a != b {
                    let (tried, left_out) = if a { (one, other) } else { (other, one) };
                    assert!(distance(tried) <= distance(left_out), "{tried} at {width}");
                }
                assert!(a || b, "{one} {other} at {width}");
            }
        }
        assert_eq!((ids(16).contains(&"ppm-tiny"), ids(4000).contains(&"ppm-tiny")), (true, false));
        assert!(!ids(400).contains(&"book"));
    }

    #[test]
    fn a_picture_that_no_hypothesis_explains_has_different_candidates() {
        let stage = Stage::find("metal-fuzzy").unwrap();
        let mut studio = Studio::new(&recipe_of(stage, 16, 9)).unwrap();
        let right = Hypothesis::right(studio.recipe());
        let expected = studio.render(&right, SMALL).unwrap();
        let mine = |amplitude: u8| {
            let byte = |index: usize, linear: f64| {
                let (x, y) = (index % 16, index / 16);
                let byte = right.byte_of(linear, y, 9);
                match (x + y).is_multiple_of(2) {
                    true => byte.saturating_add(amplitude),
                    false => byte.saturating_sub(amplitude),
                }
            };
            let pixels = expected.pixels.iter().enumerate();
            let bytes = pixels.map(|(index, pixel)| pixel.map(|linear| byte(index, linear))).collect();
            Mine { width: 16, height: 9, bytes, format: "P3", damages: Vec::new() }
        };
        let found = |amplitude: u8| -> Vec<&str> {
            candidates(&mine(amplitude)).unwrap().into_iter().map(|stage| stage.id).collect()
        };
        assert_eq!(found(0)[0], "metal-fuzzy");
        let mut ids = found(24);
        assert!(ids.contains(&"metal-fuzzy"), "{ids:?}");
        ids.sort_unstable();
        ids.dedup();
        assert_eq!(ids.len(), 4, "{ids:?}");
    }

    #[test]
    fn a_picture_has_at_least_a_pixel() {
        let stage = Stage::find("sky").unwrap();
        let size = |width, height| {
            let settings = recipe_of(stage, width, height).settings;
            [settings.width, settings.height]
        };
        assert_eq!((size(0, 3), size(7, 0)), ([1, 3], [7, 1]));
    }
}
