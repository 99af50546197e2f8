//! Decides which stage a picture shows, and whether it is right or which mistake explains it best.

use super::Mine;
use super::hypothesis::{Compared, Hypothesis, Mistake, Shows, Studio, compare};
use super::mistakes::{MISTAKES, applying_to};
use crate::job::recipe::Recipe;
use crate::stages::Stage;
use anyhow::{Context, Result, bail};

/// Samples per pixel of the right picture.
const FINE: u64 = 256;

/// Samples per pixel of the first comparison with each mistake, and of the final candidates.
const COARSE: [u64; 2] = [16, 128];

/// Samples per pixel when the stage is unknown.
const SMALL: u64 = 32;

/// Mistakes rendered again with more samples.
const REFINED: usize = 4;

/// None are if the first comparison leaves more than this share of the squared error.
const HOPELESS: f64 = 0.7;

/// A mistake explains a picture if it leaves less than this share of the right picture's squared error.
const EXPLAINED: f64 = 0.3;

/// Stages judged when the stage is unknown.
const CANDIDATES: usize = 3;

/// Width of the thumbnails compared with all stages, pixels.
const SMALL_WIDTH: u32 = 64;

/// Root mean square difference below which a stage counts as recognised, display values.
const FOUND: f64 = 0.03;

/// Least difference between a pixel's neighbours at an edge, linear radiance.
const EDGE: f64 = 0.1;

/// A mistake must leave less than this share of the squared error at edges.
const BETTER: f64 = 0.8;

#[derive(Clone, Debug)]
pub struct Finding {
    pub stage: &'static Stage,
    pub right: Compared,
    /// The likeliest mistake; `None` if the picture is right.
    pub mistake: Option<Compared>,
    /// Another mistake that gives the same picture.
    pub alike: Option<&'static Mistake>,
}

impl Finding {
    /// Whether the picture differs only by noise.
    pub fn is_right(&self) -> bool {
        self.mistake.is_none() && self.right.is_noise
    }

    pub fn named(&self) -> Option<&'static Mistake> {
        self.mistake.as_ref()?.hypothesis.mistake
    }

    /// Ranks findings of different stages: lower is closer.
    fn rank(&self) -> (u8, f64) {
        let found = self.mistake.as_ref().unwrap_or(&self.right);
        let class = match found.is_noise {
            true if self.mistake.is_none() => 0,
            true if self.explains_all() => 1,
            true => 2,
            false => 3,
        };
        (class, found.misfit)
    }

    /// Whether a mistake, rather than a step of a later section, explains all differences.
    fn explains_all(&self) -> bool {
        self.mistake.as_ref().is_some_and(|found| found.is_noise)
            && self.named().is_some_and(|mistake| !mistake.is_early())
    }
}

/// Judges a picture, of `stage` if it is known. `say` is told what is being tried.
pub fn judge(mine: &Mine, stage: Option<&'static Stage>, mut say: impl FnMut(String)) -> Result<Finding> {
    let stages = match stage {
        Some(stage) if !stages().any(|known| known == stage) => bail!(
            "{} cannot be checked: its small spheres are placed at random, so every program's picture of it is another; \
             check an earlier section, such as --stage defocus",
            stage.id
        ),
        Some(stage) => vec![stage],
        None => candidates(mine, &mut say)?,
    };
    let (mut trials, mut best) = (Vec::new(), None);
    for stage in stages {
        say(format!("comparing with {}", stage.id));
        let trial = Trial::new(mine, stage)?;
        if !trial.right.is_noise {
            trials.push(trial);
            continue;
        }
        let finding = trial.finding()?;
        if finding.is_right() {
            return Ok(finding);
        }
        keep_closer(&mut best, finding);
    }
    for trial in trials {
        if best.as_ref().is_some_and(Finding::explains_all) {
            break;
        }
        say(format!("trying the mistakes of {}", trial.stage.id));
        keep_closer(&mut best, trial.finding()?);
    }
    best.context("there is no stage to compare with")
}

fn keep_closer(best: &mut Option<Finding>, finding: Finding) {
    if best.as_ref().is_none_or(|best| finding.rank() < best.rank()) {
        *best = Some(finding);
    }
}

/// A picture compared with the right one of a stage.
struct Trial<'a> {
    mine: &'a Mine,
    stage: &'static Stage,
    studio: Studio,
    right: Compared,
}

impl<'a> Trial<'a> {
    fn new(mine: &'a Mine, stage: &'static Stage) -> Result<Self> {
        let mut studio = Studio::new(stage.recipe(), [mine.width, mine.height])?;
        let hypothesis = Hypothesis::right(studio.recipe());
        let expected = studio.render(&hypothesis, FINE)?;
        let right = compare(mine, hypothesis, expected);
        Ok(Trial { mine, stage, studio, right })
    }

    fn finding(mut self) -> Result<Finding> {
        let (mut mistake, mut alike) = (None, None);
        if self.right.is_noise {
            mistake = self.at_edges()?;
        }
        if mistake.is_none() {
            mistake = self.in_bytes();
        }
        if mistake.is_none() && !self.right.is_noise {
            (mistake, alike) = self.in_blocks()?;
            if mistake.is_none() {
                mistake = self.in_noise()?;
            }
        }
        Ok(Finding { stage: self.stage, right: self.right, mistake, alike })
    }

    fn at_edges(&mut self) -> Result<Option<Compared>> {
        at_edges(self.mine, &mut self.studio, &self.right, FINE)
    }

    /// The mistake whose picture is closest, and another that gives the same picture; `None` if none explains the
    /// difference.
    fn in_blocks(&mut self) -> Result<(Option<Compared>, Option<&'static Mistake>)> {
        let (mut pictures, mut ranked) = (all_mistakes(self.studio.recipe()), Vec::new());
        for samples in COARSE {
            ranked.clear();
            for hypothesis in pictures {
                let expected = self.studio.render(&hypothesis, samples)?;
                ranked.push(compare(self.mine, hypothesis, expected));
            }
            ranked.sort_by(|a, b| a.misfit.total_cmp(&b.misfit));
            ranked.retain(|found| found.is_noise || found.misfit < HOPELESS * self.right.misfit);
            ranked.truncate(REFINED);
            pictures = ranked.iter().map(|found| found.hypothesis.clone()).collect();
        }
        let mut ranked = ranked.into_iter();
        let Some(best) = ranked.next() else { return Ok((None, None)) };
        let named = best.hypothesis.mistake;
        if named.is_some_and(Mistake::is_at_edges)
            && let Some(found) = self.at_edges()?
        {
            return Ok((Some(found), None));
        }
        if !best.is_noise && best.misfit >= EXPLAINED * self.right.misfit {
            return Ok((None, None));
        }
        let others = ranked.filter(|found| best.is_noise && found.is_noise);
        let mut others = others.filter_map(|found| found.hypothesis.mistake);
        let alike = others.find(|other| named.is_none_or(|named| named.id != other.id));
        Ok((Some(best), alike))
    }

    fn in_noise(&mut self) -> Result<Option<Compared>> {
        let mut plain = self.right.hypothesis.clone();
        plain.plain();
        for mistake in applying_to(&plain.recipe) {
            if let Shows::InNoise(test) = mistake.shows
                && test(self.mine, &self.right, &self.studio.render(&plain, 1)?)
            {
                return Ok(Some(self.right.blamed_on(mistake)));
            }
        }
        Ok(None)
    }

    fn in_bytes(&self) -> Option<Compared> {
        let shows = |mistake: &&Mistake| match mistake.shows {
            Shows::InBytes(test) => test(self.mine, &self.right),
            _ => false,
        };
        Some(self.right.blamed_on(MISTAKES.iter().find(shows)?))
    }
}

/// Decides, pixel by pixel, between the right picture and mistakes that only show at edges.
pub(super) fn at_edges(
    mine: &Mine,
    studio: &mut Studio,
    right: &Compared,
    samples: u64,
) -> Result<Option<Compared>> {
    let recipe = studio.recipe().clone();
    let mistakes = applying_to(&recipe).filter(|mistake| mistake.is_at_edges());
    let edges = edges(&right.expected, [mine.width as usize, mine.height as usize]);
    let error = |expected: &[[f64; 3]]| -> f64 {
        let square = |(index, channel): &(usize, usize)| {
            let row = index / mine.width as usize;
            let byte = mine.bytes[*index][*channel];
            let [linear, _] = right.hypothesis.written.linear(byte, row, mine.height as usize);
            (linear - expected[*index][*channel]).powi(2)
        };
        edges.iter().map(square).sum()
    };
    let mut best = (BETTER * error(&right.expected), None);
    for hypothesis in mistakes.flat_map(|mistake| mistake.pictures(&recipe)) {
        let expected = studio.render(&hypothesis, samples)?;
        let error = error(&expected);
        if error < best.0 {
            best = (error, Some((hypothesis, expected)));
        }
    }
    Ok(best.1.map(|(hypothesis, expected)| compare(mine, hypothesis, expected)))
}

/// Pixels and channels at an edge.
fn edges(expected: &[[f64; 3]], [width, height]: [usize; 2]) -> Vec<(usize, usize)> {
    let inside = |index: &usize| {
        let (column, row) = (index % width, index / width);
        column > 0 && row > 0 && column + 1 < width && row + 1 < height
    };
    let is_edge = |(index, channel): &(usize, usize)| {
        let step = |by: usize| (expected[index + by][*channel] - expected[index - by][*channel]).abs();
        step(1).max(step(width)) >= EDGE
    };
    let places = (0..expected.len()).filter(inside).flat_map(|index| (0..3).map(move |c| (index, c)));
    places.filter(is_edge).collect()
}

fn all_mistakes(recipe: &Recipe) -> Vec<Hypothesis> {
    let is_compared = |mistake: &&Mistake| !matches!(mistake.shows, Shows::InNoise(_));
    applying_to(recipe).filter(is_compared).flat_map(|mistake| mistake.pictures(recipe)).collect()
}

/// The stages that can be checked. The final picture places its small balls at random, so every program's differs.
pub fn stages() -> impl Iterator<Item = &'static Stage> {
    Stage::ALL.iter().filter(|stage| stage.id != "book")
}

/// The stages that the picture resembles most: first as rendered right or written wrongly and, if none match, with any
/// mistake.
fn candidates(mine: &Mine, mut say: impl FnMut(String)) -> Result<Vec<&'static Stage>> {
    let factor = (mine.width / SMALL_WIDTH).clamp(1, mine.height.max(1));
    let mut ranked = Vec::new();
    for is_thorough in [false, true] {
        ranked.clear();
        let what = if is_thorough { "the mistakes of all stages" } else { "all stages" };
        say(format!("comparing with {what}"));
        for stage in stages() {
            let mut studio = Studio::new(stage.recipe(), [mine.width / factor, mine.height / factor])?;
            let right = Hypothesis::right(studio.recipe());
            let recipe = &right.recipe.clone();
            let is_tried = |picture: &Hypothesis| is_thorough || picture.is_right_before_writing(recipe);
            let mistakes = all_mistakes(recipe).into_iter().filter(is_tried);
            let mut least = f64::INFINITY;
            for hypothesis in std::iter::once(right).chain(mistakes) {
                let expected = studio.render(&hypothesis, SMALL)?;
                let mut difference = rough_difference(mine, factor, &hypothesis, &expected);
                if hypothesis.mistake.is_some_and(Mistake::is_early) {
                    // A later stage that looks like the picture is likelier.
                    difference += FOUND;
                }
                least = least.min(difference);
            }
            ranked.push((least, stage));
        }
        // Of stages with equal pictures, prefer the one with the closer width.
        let distance = |stage: &Stage| stage.setup.width.abs_diff(mine.width);
        ranked.sort_by(|(a, stage_a), (b, stage_b)| {
            a.total_cmp(b).then(distance(stage_a).cmp(&distance(stage_b)))
        });
        if ranked.first().is_some_and(|(least, _)| *least < FOUND) {
            return Ok(ranked.into_iter().map(|(_, stage)| stage).take(CANDIDATES).collect());
        }
    }
    // No mistake of any stage looks like the picture: one stage is enough to say where it differs.
    Ok(ranked.into_iter().map(|(_, stage)| stage).take(1).collect())
}

/// Root mean square difference of the thumbnails, display values.
fn rough_difference(mine: &Mine, factor: u32, hypothesis: &Hypothesis, expected: &[[f64; 3]]) -> f64 {
    let [width, height] = [mine.width, mine.height].map(|side| side / factor);
    let shown = hypothesis.written.bytes_of(expected, [width, height]);
    let mut sum = 0.0;
    for (place, shown) in (0..).zip(&shown) {
        let [x, y] = [place % width, place / width].map(|at| at * factor);
        let square =
            (y..y + factor).flat_map(|y| (x..x + factor).map(move |x| (y * mine.width + x) as usize));
        for (channel, shown) in shown.iter().enumerate() {
            let seen = |at: usize| {
                hypothesis.written.unwrapped(mine.bytes[at][channel], expected[place as usize][channel])
            };
            let bytes: f64 = square.clone().map(|at| f64::from(seen(at))).sum();
            sum += ((bytes / f64::from(factor * factor) - f64::from(*shown)) / 256.0).powi(2);
        }
    }
    (sum / (3.0 * expected.len() as f64)).sqrt()
}
