//! Decides whether a picture of a stage is right, or which mistake explains it best.

use super::hypothesis::{Effort, Expected, Hypothesis, Studio};
use super::mistake::Mistake;
use super::picture::Mine;
use crate::recipe::Recipe;
use crate::render::RenderError;
use crate::render_cpu::CpuError;
use crate::stages::Stage;
use crate::statistics::blocks::{BlockTest, Differences, Noise};
use thiserror::Error;

/// Effort for the right picture and for those that are decided between.
const FINE: Effort = Effort { fast: 24_000_000, plain: 1_500_000 };

/// Effort for each mistake at first.
const COARSE: Effort = Effort { fast: 3_000_000, plain: 400_000 };

/// Effort for each stage when the stage is not known.
const SMALL: Effort = Effort { fast: 200_000, plain: 40_000 };

/// Mistakes that are rendered again with more samples.
const REFINED: usize = 4;

/// By how many deviations the sum of squares of a right picture may differ. Noise alone stays below 4; the rest is for
/// random numbers that are not quite independent and noise that is far from normal.
const EXCESS_LIMIT: f64 = 10.0;

/// By what factor a block of a right picture may exceed the limit for normal noise.
const LARGEST_FACTOR: f64 = 1.6;

/// A mistake explains a picture if it leaves less than this part of the squared error of the right picture.
const EXPLAINED: f64 = 0.3;

/// A picture that was compared with a hypothesis.
#[derive(Clone, Debug)]
pub struct Compared {
    /// The hypothesis.
    pub hypothesis: Hypothesis,
    /// Mean squared error beyond noise, of blocks as they are displayed.
    pub misfit: f64,
    /// Whether the rest is noise.
    pub is_noise: bool,
    /// The rendered picture.
    pub expected: Expected,
}

/// The finding about a picture.
#[derive(Clone, Debug)]
pub struct Finding {
    /// The stage that it shows.
    pub stage: &'static Stage,
    /// The right picture.
    pub right: Compared,
    /// The likeliest mistake, if it is not right.
    pub mistake: Option<Compared>,
}

impl Finding {
    /// Whether the picture differs by noise only.
    pub fn is_right(&self) -> bool {
        self.mistake.is_none() && self.right.is_noise
    }

    /// How far the picture is from what was found, for the choice among stages.
    fn rank(&self) -> (u8, f64) {
        match &self.mistake {
            None if self.right.is_noise => (0, self.right.misfit),
            Some(found) if found.is_noise => (1, found.misfit),
            Some(found) => (2, found.misfit),
            None => (2, self.right.misfit),
        }
    }
}

/// Why a picture cannot be judged.
#[derive(Debug, Error)]
pub enum JudgeError {
    /// No thread can be started.
    #[error(transparent)]
    Threads(#[from] CpuError),
    /// A picture cannot be rendered.
    #[error(transparent)]
    Render(#[from] RenderError),
}

/// The stages that can be checked. The small balls of the final picture are placed at random, so every program's picture
/// of it is another.
pub fn stages() -> impl Iterator<Item = &'static Stage> {
    Stage::ALL.iter().filter(|stage| stage.id != "book")
}

/// Judges a picture; `stage` is the one that it shows, if known.
///
/// # Errors
/// [`JudgeError`].
pub fn judge(mine: &Mine, stage: Option<&'static Stage>) -> Result<Finding, JudgeError> {
    let stages = match stage {
        Some(stage) => vec![stage],
        None => candidates(mine)?,
    };
    let mut trials = Vec::new();
    for stage in stages {
        let trial = Trial::new(mine, stage)?;
        if trial.right.is_noise {
            return trial.of_right();
        }
        trials.push(trial);
    }
    let mut best: Option<Finding> = None;
    for trial in trials {
        let finding = trial.of_wrong()?;
        let explains_all = finding.mistake.as_ref().is_some_and(|found| found.is_noise);
        if best.as_ref().is_none_or(|best| finding.rank() < best.rank()) {
            best = Some(finding);
        }
        if explains_all {
            break;
        }
    }
    match best {
        Some(best) => Ok(best),
        None => Trial::new(mine, &Stage::ALL[0])?.of_wrong(),
    }
}

/// Cutting off paths of more rays than this shows nowhere.
const LONG_PATH: u32 = 20;

/// The stages whose pictures differ: of two that show the same, the first.
fn distinct() -> Vec<&'static Stage> {
    let mut distinct: Vec<(&'static Stage, Recipe)> = Vec::new();
    for stage in stages() {
        let recipe = stage.recipe();
        let shows_same = |(_, other): &(&Stage, Recipe)| {
            let depth = |recipe: &Recipe| recipe.settings.max_depth.min(LONG_PATH);
            other.scene == recipe.scene
                && other.camera == recipe.camera
                && other.rules == recipe.rules
                && depth(other) == depth(&recipe)
        };
        if !distinct.iter().any(shows_same) {
            distinct.push((stage, recipe));
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
fn candidates(mine: &Mine) -> Result<Vec<&'static Stage>, JudgeError> {
    let factor = (mine.width / SMALL_WIDTH).max(1);
    let mut ranked = Vec::new();
    for is_thorough in [false, true] {
        ranked.clear();
        for stage in distinct() {
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
        for channel in 0..3 {
            let mut mean = 0.0;
            for dy in 0..factor as usize {
                for dx in 0..factor as usize {
                    let at = (y * factor as usize + dy) * mine.width as usize + x * factor as usize + dx;
                    mean += f64::from(mine.bytes[at][channel]);
                }
            }
            mean /= f64::from(factor * factor);
            let shown = f64::from(hypothesis.byte_of(pixel[channel], y, height));
            sum += ((mean - shown) / 256.0).powi(2);
        }
    }
    (sum / (3.0 * expected.pixels.len() as f64)).sqrt()
}

fn recipe_of(stage: &Stage, width: u32, height: u32) -> Recipe {
    let mut recipe = stage.recipe();
    (recipe.settings.width, recipe.settings.height) = (width.max(1), height.max(1));
    recipe
}

/// A picture next to the right one of a stage.
struct Trial<'a> {
    mine: &'a Mine,
    stage: &'static Stage,
    studio: Studio,
    right: Compared,
}

impl<'a> Trial<'a> {
    fn new(mine: &'a Mine, stage: &'static Stage) -> Result<Self, JudgeError> {
        let mut studio = Studio::new(&recipe_of(stage, mine.width, mine.height))?;
        let hypothesis = Hypothesis::right(studio.recipe());
        let expected = studio.render(&hypothesis, FINE)?;
        let right = compare(mine, hypothesis, expected);
        Ok(Trial { mine, stage, studio, right })
    }

    fn finding(&self, mistake: Option<Compared>) -> Finding {
        Finding { stage: self.stage, right: self.right.clone(), mistake }
    }

    /// The finding if blocks differ by noise only: what blocks cannot show is looked for.
    fn of_right(mut self) -> Result<Finding, JudgeError> {
        let mistake = by_pixels(self.mine, &mut self.studio, &self.right)?;
        let mistake = mistake.or_else(|| times_integer(self.mine, &self.right));
        Ok(self.finding(mistake))
    }

    /// The finding if blocks differ by more than noise.
    fn of_wrong(mut self) -> Result<Finding, JudgeError> {
        let (mine, studio, right) = (self.mine, &mut self.studio, &self.right);
        if is_truncated(mine, right) {
            let hypothesis = right.hypothesis.blamed_on(Mistake::Truncated);
            let found = Compared { hypothesis, is_noise: true, ..right.clone() };
            return Ok(self.finding(Some(found)));
        }
        let mut compared = Vec::new();
        for hypothesis in Hypothesis::mistakes(studio.recipe()) {
            let expected = studio.render(&hypothesis, COARSE)?;
            compared.push(compare(mine, hypothesis, expected));
        }
        compared.sort_by(|a, b| a.misfit.total_cmp(&b.misfit));
        compared.truncate(REFINED);
        for found in &mut compared {
            let expected = studio.render(&found.hypothesis, FINE)?;
            *found = compare(mine, found.hypothesis.clone(), expected);
        }
        compared.sort_by(|a, b| a.misfit.total_cmp(&b.misfit));
        let Some(best) = compared.into_iter().next() else { return Ok(self.finding(None)) };
        if best.hypothesis.mistake.is_some_and(Mistake::is_of_pixels)
            && let Some(mistake) = by_pixels(mine, studio, right)?
        {
            return Ok(self.finding(Some(mistake)));
        }
        let explains = best.is_noise || best.misfit < EXPLAINED * right.misfit;
        Ok(self.finding(explains.then_some(best)))
    }
}

/// Compares a picture with a hypothesis.
fn compare(mine: &Mine, hypothesis: Hypothesis, expected: Expected) -> Compared {
    let (width, height) = (mine.width as usize, mine.height as usize);
    let mut values = Vec::with_capacity(mine.bytes.len());
    let mut steps = Vec::with_capacity(mine.bytes.len());
    for (index, (bytes, expected)) in mine.bytes.iter().zip(&expected.pixels).enumerate() {
        let row = index / width;
        let [least, most] = [0, 255].map(|byte| hypothesis.linear(byte, row, height)[0]);
        let (mut value, mut step) = ([0.0; 3], [0.0; 3]);
        for channel in 0..3 {
            let [linear, half_step] = hypothesis.linear(bytes[channel], row, height);
            value[channel] = linear - expected[channel].clamp(least, most);
            step[channel] = half_step;
        }
        values.push(value);
        steps.push(step);
    }
    let test = BlockTest::of(&Differences {
        width: mine.width,
        values: &values,
        noise: Noise::Spread,
        steps: Some(&steps),
        tolerance: 1e-4,
        rare: 0.0,
    });
    let is_noise =
        test.largest_excess() <= EXCESS_LIMIT && test.largest <= LARGEST_FACTOR * test.largest_limit;
    let misfit = misfit(&test, &values, &expected, width);
    Compared { hypothesis, misfit, is_noise, expected }
}

/// Mean over blocks and channels of the squared error beyond noise, as displayed.
fn misfit(test: &BlockTest, values: &[[f64; 3]], expected: &Expected, width: usize) -> f64 {
    let mut sum = 0.0;
    for block in &test.blocks {
        let pixels =
            || block.y.clone().flat_map(|y| block.x.clone().map(move |x| y as usize * width + x as usize));
        let count = pixels().count() as f64;
        for channel in 0..3 {
            let bright = pixels().map(|pixel| expected.pixels[pixel][channel]).sum::<f64>() / count;
            let mean = block.means[channel];
            let spread: f64 = pixels().map(|pixel| (values[pixel][channel] - mean).powi(2)).sum();
            let noise = spread / (count * (count - 1.0).max(1.0));
            // The derivative of the square root takes linear errors to displayed ones.
            sum += (mean * mean - noise) / (4.0 * bright.max(0.02));
        }
    }
    sum / (3 * test.blocks.len().max(1)) as f64
}

/// Least difference of a pixel's neighbours at an edge, linear radiance.
const EDGE: f64 = 0.1;

/// Decides among hypotheses that differ at edges only, pixel by pixel: the right picture, all samples at the centre of
/// the pixel, or pixels that are shifted.
fn by_pixels(mine: &Mine, studio: &mut Studio, right: &Compared) -> Result<Option<Compared>, JudgeError> {
    let recipe = studio.recipe().clone();
    let mut rivals = Vec::new();
    for mistake in Mistake::ALL.into_iter().filter(|mistake| mistake.is_of_pixels()) {
        if mistake.applies_to(&recipe) {
            for hypothesis in Hypothesis::of(mistake, &recipe) {
                let expected = studio.render(&hypothesis, FINE)?;
                rivals.push((hypothesis, expected));
            }
        }
    }
    let (width, height) = (mine.width as usize, mine.height as usize);
    let (mut own, mut pixels) = (0.0, 0);
    let mut errors = vec![0.0; rivals.len()];
    for (index, bytes) in mine.bytes.iter().enumerate() {
        let (column, row) = (index % width, index / width);
        if column == 0 || row == 0 || column + 1 == width || row + 1 == height {
            continue;
        }
        for channel in 0..3 {
            let at = |pixel: usize| right.expected.pixels[pixel][channel];
            let across = (at(index + 1) - at(index - 1)).abs();
            if across.max((at(index + width) - at(index - width)).abs()) < EDGE {
                continue;
            }
            pixels += 1;
            let [linear, _] = right.hypothesis.linear(bytes[channel], row, height);
            own += (linear - at(index)).powi(2);
            for (error, (_, rival)) in errors.iter_mut().zip(&rivals) {
                *error += (linear - rival.pixels[index][channel]).powi(2);
            }
        }
    }
    let least = errors.iter().copied().enumerate().min_by(|a, b| a.1.total_cmp(&b.1));
    Ok(match least {
        Some((index, error)) if pixels > 0 && error < BETTER * own => {
            let (hypothesis, expected) = rivals.swap_remove(index);
            Some(compare(mine, hypothesis, expected))
        }
        _ => None,
    })
}

/// A rival must leave less than this part of the squared error at edges.
const BETTER: f64 = 0.8;

/// Whether nearly all bytes are 0 or 255, though the picture should have values between.
fn is_truncated(mine: &Mine, right: &Compared) -> bool {
    let (width, height) = (mine.width as usize, mine.height as usize);
    let is_end = |byte: &u8| *byte <= 1 || *byte >= 254;
    let all = 3 * mine.bytes.len();
    let ends = mine.bytes.iter().flatten().filter(|byte| is_end(byte)).count();
    let expected = right.expected.pixels.iter().enumerate();
    let expected_ends = expected
        .flat_map(|(index, pixel)| pixel.map(|x| right.hypothesis.byte_of(x, index / width, height)))
        .filter(|byte| is_end(byte))
        .count();
    100 * ends >= 99 * all && 2 * expected_ends < all
}

/// Bytes of 255 times the value instead of 256 times, cut off: values are then smaller by 1/256 everywhere.
fn times_integer(mine: &Mine, right: &Compared) -> Option<Compared> {
    let (width, height) = (mine.width as usize, mine.height as usize);
    // Noise is without bias in linear values, so the loss is fitted there.
    let (mut product, mut square, mut scaled, mut count) = (0.0, 0.0, 0.0, 0.0);
    for (index, (bytes, expected)) in mine.bytes.iter().zip(&right.expected.pixels).enumerate() {
        let row = index / width;
        for channel in 0..3 {
            let [linear, _] = right.hypothesis.linear(bytes[channel], row, height);
            let x = expected[channel];
            if bytes[channel] >= 254 || x > 0.98 || x < 0.05 {
                continue;
            }
            let loss = x - right.hypothesis.times_255(x, row, height);
            product += (linear - x) * loss;
            square += loss * loss;
            scaled += (linear - x).powi(2) * loss * loss;
            count += 1.0;
        }
    }
    if count < 1000.0 {
        return None;
    }
    let (slope, deviation) = (-product / square, scaled.sqrt() / square);
    ((slope - 1.0).abs() < 0.4 && slope > 6.0 * deviation).then(|| {
        let hypothesis = right.hypothesis.blamed_on(Mistake::TimesInteger);
        Compared { hypothesis, ..right.clone() }
    })
}
