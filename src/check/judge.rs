//! Decides whether a picture of a stage is right, or which mistake explains it best.

use super::compared::{Compared, compare};
use super::details::{by_pixels, is_truncated, times_integer};
use super::hypothesis::{Effort, Hypothesis, Studio, StudioError};
use super::likeness::{candidates, recipe_of};
use super::mistake::Mistake;
use super::picture::Mine;
use crate::stages::Stage;

/// Effort for the right picture and for those that are decided between.
const FINE: Effort = Effort { fast: 256, plain: 16 };

/// Effort for each mistake at first.
const COARSE: Effort = Effort { fast: 32, plain: 4 };

/// Mistakes that are rendered again with more samples.
const REFINED: usize = 4;

/// A mistake explains a picture if it leaves less than this part of the squared error of the right picture.
const EXPLAINED: f64 = 0.3;

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

/// Judges a picture; `stage` is the one that it shows, if known.
///
/// # Errors
/// [`StudioError`].
pub fn judge(mine: &Mine, stage: Option<&'static Stage>) -> Result<Finding, StudioError> {
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

/// A picture next to the right one of a stage.
struct Trial<'a> {
    mine: &'a Mine,
    stage: &'static Stage,
    studio: Studio,
    right: Compared,
}

impl<'a> Trial<'a> {
    fn new(mine: &'a Mine, stage: &'static Stage) -> Result<Self, StudioError> {
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
    fn of_right(mut self) -> Result<Finding, StudioError> {
        let mistake = by_pixels(self.mine, &mut self.studio, &self.right, FINE)?;
        let mistake = mistake.or_else(|| times_integer(self.mine, &self.right));
        Ok(self.finding(mistake))
    }

    /// The finding if blocks differ by more than noise.
    fn of_wrong(mut self) -> Result<Finding, StudioError> {
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
            && let Some(mistake) = by_pixels(mine, studio, right, FINE)?
        {
            return Ok(self.finding(Some(mistake)));
        }
        let explains = best.is_noise || best.misfit < EXPLAINED * right.misfit;
        Ok(self.finding(explains.then_some(best)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::check::hypothesis::Expected;

    fn compared(misfit: f64, is_noise: bool) -> Compared {
        let hypothesis = Hypothesis::right(&Stage::ALL[0].recipe());
        Compared { hypothesis, misfit, is_noise, expected: Expected { pixels: Vec::new() } }
    }

    /// A picture of a stage with a mistake in it, as [`Studio`] renders it.
    fn mistaken(stage: &Stage, mistake: Mistake, effort: Effort) -> (Mine, Expected) {
        let (width, height) = (48, 27);
        let mut studio = Studio::new(&recipe_of(stage, width, height)).unwrap();
        let hypothesis = Hypothesis::of(mistake, studio.recipe()).remove(0);
        let expected = studio.render(&hypothesis, effort).unwrap();
        let pixels = expected.pixels.iter().enumerate();
        let row = |index: usize| index / width as usize;
        let bytes = pixels
            .map(|(index, pixel)| pixel.map(|x| hypothesis.byte_of(x, row(index), height as usize)))
            .collect();
        (Mine { width, height, bytes, format: "P3", damages: Vec::new() }, expected)
    }

    #[test]
    fn the_picture_of_a_finding_has_all_samples() {
        let stage = Stage::find("metal-fuzzy").unwrap();
        for mistake in [Mistake::FlippedRows, Mistake::SkyReversed] {
            let (mine, expected) = mistaken(stage, mistake, FINE);
            let finding = judge(&mine, Some(stage)).unwrap();
            assert!(!finding.is_right() && !finding.right.is_noise && finding.stage.id == stage.id);
            let found = finding.mistake.unwrap();
            assert_eq!(found.hypothesis.mistake, Some(mistake));
            assert!(found.is_noise && found.expected.pixels == expected.pixels, "{mistake:?}");
        }
    }

    #[test]
    fn a_right_picture_ranks_first_then_a_whole_explanation_then_the_nearest_stage() {
        let finding = |right, mistake| Finding { stage: &Stage::ALL[0], right, mistake };
        let findings = [
            finding(compared(0.9, true), None),
            finding(compared(2.0, false), Some(compared(0.8, true))),
            finding(compared(2.0, false), Some(compared(0.1, false))),
            finding(compared(0.2, false), None),
            finding(compared(2.0, false), Some(compared(0.3, false))),
        ];
        let ranks: Vec<_> = findings.iter().map(Finding::rank).collect();
        assert!(ranks.is_sorted_by(|a, b| a < b), "{ranks:?}");
    }
}
