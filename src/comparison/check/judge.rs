//! Finds the section, the edition and the writing that a picture shows, and decides whether it is right, or which mistake or
//! number explains it.

use super::Mine;
use super::fit::{Compared, Fit};
use super::hypothesis::{Added, Hypothesis, Mistake, Rendered, Studio, What};
use super::mask::{enlarged, grown};
use super::mistakes::applying_to;
use super::noise::{altered, is_shared};
use super::numbers::{candidates, finished};
use super::random::{common, complete, fixed};
use super::screen::{Screen, small};
use super::written::{Seen, Written, reduced};
use crate::stages::Stage;
use anyhow::{Context, Result, ensure};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Samples per pixel of a picture in full size, by the program's own tracer and by the plain one.
const FINE: [u64; 2] = [256, 64];

/// Width of the small pictures, pixels, and their samples per pixel by each tracer.
const SMALL_WIDTH: u32 = 80;
const SMALL: [u64; 2] = [16, 4];

/// Hypotheses that are compared in full size: written otherwise, and with mistakes.
const COMPARED: [usize; 2] = [6, 8];

/// Mean square of the blocks' means, in bytes, below which a mistake may only show in single pixels.
const FINE_MOST: f64 = 4.0;

/// Bases on which mistakes are tried, where one is near; and those on which the plain tracer renders them, too.
const BASES: usize = 2;
const PLAIN: usize = 3;

/// Root mean square difference below which a base is near, displayed values, and how much farther another may be.
const FOUND: f64 = 0.03;
const NEAR: f64 = 0.02;

/// Mean square of the blocks' means, in bytes, above which the levels of bytes do not matter, and nothing is explained.
const FAR: f64 = 100.0;

/// A guess must leave less than this share of what differs.
const EXPLAINED: f64 = 0.5;

#[derive(Clone, Debug)]
pub struct Finding {
    pub stage: &'static Stage,
    /// The right picture that is closest: of an edition, written in some way.
    pub right: Compared,
    /// What explains the picture, or most of it; `None` if it is right, or nothing does.
    pub found: Option<Compared>,
    /// Whether the right picture, or what was found, leaves only noise.
    pub is_sure: bool,
    /// Others that explain it as well.
    pub alike: Vec<Hypothesis>,
    /// What seems to have changed the file since it was written.
    pub altered: Option<&'static str>,
    /// Pixels that were not compared, because they depend on where small spheres are placed.
    pub ignored: Option<Arc<[bool]>>,
}

impl Finding {
    /// Whether the picture is right, perhaps for another edition.
    pub fn is_right(&self) -> bool {
        self.found.is_none() && self.is_sure
    }

    /// The mistake, or what the reader does otherwise and is right.
    pub fn named(&self) -> Option<&'static Mistake> {
        self.found.as_ref().unwrap_or(&self.right).hypothesis.named()
    }

    /// The reader's samples per pixel, if the noise tells.
    pub fn samples(&self) -> Option<f64> {
        self.found.as_ref().unwrap_or(&self.right).fit.samples
    }

    fn is_settled(&self) -> bool {
        self.is_sure || self.found.is_some()
    }
}

/// Judges a picture, of `stage` if that is known. Reports each attempt to `say`.
///
/// # Errors
/// If memory does not suffice, or after `stop` is set.
pub fn judge(
    mine: &Mine,
    stage: Option<&'static Stage>,
    stop: &AtomicBool,
    mut say: impl FnMut(String),
) -> Result<Finding> {
    let say: &mut dyn FnMut(String) = &mut say;
    if let Some(stage) = stage.filter(|stage| stage.setup.has_random_spheres) {
        return judge_random(mine, stage, stop, say, true);
    }
    let stages: Vec<&Stage> = match stage {
        Some(stage) => vec![stage],
        None => Stage::walk().filter(|stage| !stage.setup.has_random_spheres).collect(),
    };
    let found = Search { mine, studio: Studio::new(stop)?, known: Vec::new(), say }.judged(&stages, true)?;
    if found.is_settled() || stage.is_some() {
        return Ok(found);
    }
    for stage in Stage::walk().filter(|stage| stage.setup.has_random_spheres) {
        let last = judge_random(mine, stage, stop, say, false)?;
        if last.is_sure {
            return Ok(last);
        }
    }
    Ok(found)
}

/// Judges a picture of a stage whose small spheres each program places elsewhere.
fn judge_random(
    mine: &Mine,
    stage: &'static Stage,
    stop: &AtomicBool,
    say: &mut dyn FnMut(String),
    is_thorough: bool,
) -> Result<Finding> {
    say(format!("looking for what all pictures of {} {} have in common", stage.section, stage.title));
    let mut studio = Studio::new(stop)?;
    let fixed = fixed(mine, stage, &mut studio, factor([mine.width, mine.height]))?;
    let mut search = Search { mine: &fixed, studio, known: Vec::new(), say };
    let mut found = search.judged(&[stage], is_thorough)?;
    complete(&mut found.right, &fixed, &mut search.studio)?;
    found.ignored.clone_from(&fixed.ignored);
    Ok(found)
}

struct Search<'a> {
    mine: &'a Mine,
    studio: Studio<'a>,
    /// Pictures in full size.
    known: Vec<(Hypothesis, Rendered)>,
    say: &'a mut dyn FnMut(String),
}

impl Search<'_> {
    /// Judges a picture of one of these stages; mistakes are only tried if `is_thorough`.
    fn judged(&mut self, stages: &[&'static Stage], is_thorough: bool) -> Result<Finding> {
        let ranked = self.ranked(stages)?;
        let distance = |misfit: f64| misfit.max(0.0).sqrt();
        let least = ranked.first().map_or(f64::INFINITY, |(misfit, _)| distance(*misfit));
        let is_near = least < FOUND;
        let limit = if is_near { 1.5 * least + NEAR } else { least };
        let near = || ranked.iter().filter(|(misfit, _)| distance(*misfit) <= limit).map(|(_, it)| it);
        let mut rights: Vec<(Compared, &Hypothesis)> = Vec::new();
        for hypothesis in near().filter(|it| it.is_right()).take(COMPARED[0]) {
            let stage = hypothesis.stage;
            (self.say)(format!("comparing with {} {}", stage.section, stage.title));
            let found = self.with_levels(hypothesis)?;
            if found.fit.is_enough() {
                return Ok(self.finding(found, None, Vec::new()));
            }
            rights.push((found, hypothesis));
        }
        // An edition must be nearer than the book.
        let key = |it: &Compared| it.fit.excess * if it.hypothesis.rows.is_empty() { 1.0 } else { 1.5 };
        rights.sort_by(|(a, _), (b, _)| key(a).total_cmp(&key(b)));
        // Mistakes are made on the way to the book's picture, and not on that of an exercise.
        let mut others: Vec<Hypothesis> = Vec::new();
        for (_, hypothesis) in &rights {
            let book = ranked.iter().find(|(_, it)| it.stage.id == hypothesis.stage.id && it.rows.is_empty());
            others.extend(book.filter(|_| !is_simple(hypothesis)).map(|(_, book)| book.clone()));
            others.push((*hypothesis).clone());
        }
        others.dedup_by(|a, b| a.stage.id == b.stage.id && a.is_traced_as(b));
        let right = match rights.into_iter().next() {
            Some((right, _)) => right,
            None => {
                let nearest = ranked.iter().find(|(_, it)| it.is_right());
                self.with_levels(&nearest.context("there is no stage to compare with")?.1)?
            }
        };
        let mut enough = Vec::new();
        for hypothesis in near().filter(|it| !it.is_right()).take(COMPARED[0]) {
            if hypothesis.written.wraps && !self.has_wrapped(&right) {
                continue;
            }
            let found = self.with_levels(hypothesis)?;
            if found.fit.is_enough() {
                enough.push(found);
            }
        }
        if let Some(finding) = self.explained(&right, enough) {
            return Ok(finding);
        }
        if !is_thorough {
            return Ok(self.finding(right, None, Vec::new()));
        }
        if is_near {
            others.truncate(BASES);
            return self.wrong(right, &others);
        }
        let bases = bases(&ranked, stages.len());
        let right = self.compared(&bases[0])?;
        self.wrong(right, &bases)
    }

    /// Whether the reader's picture is black where ours is white.
    fn has_wrapped(&self, right: &Compared) -> bool {
        let seen = self.seen(&right.hypothesis.written, None);
        let pixels = seen.values.iter().zip(&right.rendered.halves[0]);
        pixels.filter(|(seen, ours)| (0..3).any(|c| seen[c] < 0.01 && ours[c] > 0.9)).count() > 5
    }

    /// The finding if some of these explain the picture.
    fn explained(&self, right: &Compared, mut enough: Vec<Compared>) -> Option<Finding> {
        if enough.is_empty() {
            return None;
        }
        let first = enough.remove(0);
        let mut alike: Vec<Hypothesis> = Vec::new();
        for other in enough {
            if alike.iter().chain([&first.hypothesis]).all(|known| !is_same(known, &other.hypothesis)) {
                alike.push(other.hypothesis);
            }
        }
        Some(self.finding(right.clone(), Some(first), alike))
    }

    fn finding(&self, right: Compared, found: Option<Compared>, alike: Vec<Hypothesis>) -> Finding {
        let explains = found.as_ref().unwrap_or(&right);
        Finding {
            stage: explains.hypothesis.stage,
            is_sure: explains.fit.is_enough(),
            altered: altered(self.mine),
            right,
            found,
            alike,
            ignored: None,
        }
    }

    /// Tries mistakes and numbers on these bases, of which `right` is the first.
    fn wrong(&mut self, right: Compared, bases: &[Hypothesis]) -> Result<Finding> {
        let factor = factor(right.hypothesis.size());
        let (mut screened, mut fine) = (Vec::new(), Vec::new());
        for (rank, base) in bases.iter().enumerate() {
            let stage = base.stage;
            (self.say)(format!("trying the mistakes of {} {}", stage.section, stage.title));
            let seen = self.seen(&base.written, None);
            let mut screen = Screen::new(&mut self.studio, base, &seen, factor, right.fit.samples)?;
            let nothing = screen.excess(base)?;
            for mistake in applying_to(&base.recipe).filter(|it| !it.is_right && it.id != SHARED) {
                for hypothesis in mistake.pictures(base) {
                    let is_on_right = rank == 0 && right.fit.excess < FINE_MOST;
                    if hypothesis.added.is_some() || hypothesis.is_fine {
                        if rank == 0 && (is_on_right || hypothesis.added.is_some()) {
                            fine.push(hypothesis);
                        }
                        continue;
                    }
                    let is_plain = hypothesis.steps.is_some() && base.steps.is_none();
                    if hypothesis.is_traced_as(base)
                        || hypothesis.written.order.exchanges_sides()
                        || is_plain && rank >= PLAIN
                    {
                        continue;
                    }
                    let excess = screen.excess(&hypothesis)?;
                    if excess < EXPLAINED * nothing.max(0.0) + FINE_MOST {
                        screened.push((excess, hypothesis));
                    }
                }
            }
        }
        // Of those that are as near, what differs less from the book comes first.
        let key = |(excess, it): &(f64, Hypothesis)| ((excess.max(0.0) / FINE_MOST) as u64, it.rows.len());
        screened.sort_by(|a, b| key(a).cmp(&key(b)).then(a.0.total_cmp(&b.0)));
        let limit = 1.5 * screened.first().map_or(0.0, |(excess, _)| excess.max(0.0)) + FINE_MOST;
        screened.retain(|(excess, _)| *excess < limit);
        screened.truncate(COMPARED[1]);
        let mut compared = Vec::new();
        for hypothesis in screened.into_iter().map(|(_, hypothesis)| hypothesis).chain(fine) {
            let named = hypothesis.named().map_or("a mistake", |named| named.title);
            (self.say)(format!("comparing: {named}"));
            compared.push(self.with_levels(&hypothesis)?);
        }
        let enough =
            |compared: &[Compared]| compared.iter().filter(|it| it.fit.is_enough()).cloned().collect();
        if let Some(finding) = self.explained(&right, enough(&compared)) {
            return Ok(finding);
        }
        let tried = if right.fit.excess < 10.0 * FAR { BASES } else { 1 };
        for base in bases.iter().take(tried) {
            self.numbers(base, factor, right.fit.samples, &mut compared)?;
            if let Some(finding) = self.explained(&right, enough(&compared)) {
                return Ok(finding);
            }
        }
        let mut finding = self.finding(right, None, Vec::new());
        let shared = applying_to(&finding.right.hypothesis.recipe).find(|mistake| mistake.id == SHARED);
        let shared = shared.and_then(|shared| shared.pictures(&finding.right.hypothesis).pop());
        let seen = self.seen(&finding.right.hypothesis.written, None);
        let guess = match shared.filter(|shared| is_shared(&seen, &finding.right, shared, self.studio.stop)) {
            Some(hypothesis) => Some(Compared { hypothesis, ..finding.right.clone() }),
            None => {
                let wrong = compared.into_iter().filter(|it| !it.hypothesis.is_right());
                let nearest = wrong.min_by(|a, b| a.fit.excess.total_cmp(&b.fit.excess));
                nearest.filter(|it| it.fit.excess < FAR.min(EXPLAINED * finding.right.fit.excess))
            }
        };
        ensure!(!self.studio.stop.load(Ordering::Relaxed), "the check was stopped");
        if let Some(guess) = guess {
            (finding.stage, finding.found) = (guess.hypothesis.stage, Some(guess));
        }
        Ok(finding)
    }

    /// Tries other numbers on a base: single ones, and if none is enough, those that are typed together.
    fn numbers(
        &mut self,
        base: &Hypothesis,
        factor: u32,
        samples: Option<f64>,
        compared: &mut Vec<Compared>,
    ) -> Result<()> {
        let stage = base.stage;
        (self.say)(format!("trying the numbers of {} {}", stage.section, stage.title));
        let seen = self.seen(&base.written, None);
        let mut screen = Screen::new(&mut self.studio, base, &seen, factor, samples)?;
        let kinds = candidates(&mut screen)?;
        for kind in kinds {
            for (group, start) in kind {
                let words = group.iter().map(|what| what.words(what.of(&start), base)).collect::<Vec<_>>();
                (self.say)(format!("comparing: {}", words.join(", ")));
                compared.push(self.with_numbers(&seen, base, &group, start)?);
            }
            if compared.iter().any(|it| it.fit.is_enough()) {
                break;
            }
        }
        Ok(())
    }

    fn with_numbers(
        &mut self,
        seen: &Seen,
        base: &Hypothesis,
        group: &[What],
        start: Hypothesis,
    ) -> Result<Compared> {
        let render = &mut |of: &Hypothesis, is_full: bool| {
            if is_full {
                return self.rendered(of);
            }
            self.studio.render(&of.fast(), 1, FINE[0] / 8, None)
        };
        let (hypothesis, rendered, fit) = finished(render, seen, base, group, start)?;
        Ok(Compared { hypothesis, rendered, fit })
    }

    /// The reader's picture, written in this way; `expected` tells which zeros are whites that wrapped around.
    fn seen(&self, written: &Written, expected: Option<&[[f64; 3]]>) -> Seen {
        Seen::of(self.mine, written, |pixel, channel| expected.map_or(0.0, |pixels| pixels[pixel][channel]))
    }

    /// A hypothesis in full size.
    fn compared(&mut self, hypothesis: &Hypothesis) -> Result<Compared> {
        let mut hypothesis = hypothesis.clone();
        let mut rendered = self.rendered(&hypothesis)?;
        let mean = hypothesis.written.wraps.then(|| rendered.mean());
        let mut seen = self.seen(&hypothesis.written, mean.as_deref());
        seen.tolerance = seen.tolerance.max(hypothesis.tolerance());
        if let Some(added) = hypothesis.added {
            (rendered, hypothesis.note) = with_added(&seen, &hypothesis.written, rendered, added);
        }
        let fit = Fit::new(&seen, &hypothesis.written, &rendered);
        Ok(Compared { hypothesis, rendered, fit })
    }

    fn rendered(&mut self, of: &Hypothesis) -> Result<Rendered> {
        let is_same =
            |(known, _): &&(Hypothesis, Rendered)| known.stage.id == of.stage.id && known.is_traced_as(of);
        if let Some((_, rendered)) = self.known.iter().find(is_same) {
            return Ok(rendered.clone());
        }
        let rendered = self.traced(of)?;
        if of.numbers.is_empty() && of.rows.iter().all(|row| row.is_right) {
            self.known.push((of.clone(), rendered.clone()));
        }
        Ok(rendered)
    }

    fn traced(&mut self, of: &Hypothesis) -> Result<Rendered> {
        if of.steps.is_none() || of.is_exact() {
            return self.studio.render(of, 1, FINE[0], None);
        }
        let mut fast = of.fast();
        let whole = self.studio.render(&fast, 1, FINE[0], None)?;
        // The plain tracer is slow: it renders only what its steps change.
        let factor = factor(of.size());
        fast.plain();
        let [own, book] =
            [of, &fast].map(|it| self.studio.render(it, factor, 4 * SMALL[1], None).map(|it| it.halves));
        let (own, book) = (own?, book?);
        let size = of.size().map(|side| side as usize);
        let is_changed = |pixel: usize| (0..2).any(|half| own[half][pixel] != book[half][pixel]);
        let changed: Vec<bool> = (0..own[0].len()).map(is_changed).collect();
        let small = size.map(|side| side / factor as usize);
        let mut mask = enlarged(&grown(&changed, small), size, factor as usize);
        if let Some(ignored) = &self.mine.ignored {
            mask.iter_mut().zip(ignored.iter()).for_each(|(is_traced, is_ignored)| *is_traced &= !is_ignored);
        }
        Ok(whole.under(&self.studio.render(of, 1, FINE[1], Some(&mask))?))
    }

    /// A hypothesis in full size, with the levels of bytes that fit best.
    fn with_levels(&mut self, hypothesis: &Hypothesis) -> Result<Compared> {
        let mut best = self.compared(hypothesis)?;
        if best.fit.excess > FAR || hypothesis.written.wraps {
            return Ok(best);
        }
        // As in the book's first sections.
        let mut early = hypothesis.clone();
        early.written.levels = 255.999;
        let rows = applying_to(&hypothesis.recipe).filter(|it| it.is_right);
        for other in [early].into_iter().chain(rows.flat_map(|it| it.pictures(hypothesis))) {
            let is_level =
                is_written_otherwise(&other, hypothesis) && other.written.curve == hypothesis.written.curve;
            if !is_level || best.fit.is_enough() {
                continue;
            }
            let mut seen = self.seen(&other.written, None);
            seen.tolerance = seen.tolerance.max(hypothesis.tolerance());
            let fit = Fit::new(&seen, &other.written, &best.rendered);
            if fit.score < best.fit.score {
                best = Compared { hypothesis: other, rendered: best.rendered, fit };
            }
        }
        Ok(best)
    }

    /// Right pictures of these stages, and pictures that are only written otherwise, the most similar first.
    fn ranked(&mut self, stages: &[&'static Stage]) -> Result<Vec<(f64, Hypothesis)>> {
        (self.say)("comparing with all sections and editions".to_owned());
        let size = [self.mine.width, self.mine.height];
        let factor = factor(size);
        let mut known: Vec<(Written, Vec<[f64; 3]>)> = Vec::new();
        let mut ranked = Vec::new();
        for stage in stages {
            let right = Hypothesis::right(stage, common(stage), size);
            let editions =
                applying_to(&right.recipe).filter(|it| it.is_right).flat_map(|it| it.pictures(&right));
            let editions: Vec<Hypothesis> = editions.filter(|it| !it.is_traced_as(&right)).collect();
            for base in [right].into_iter().chain(editions) {
                let mut tiny = |of: &Hypothesis| {
                    small(&mut self.studio, of, factor, SMALL[usize::from(of.steps.is_some())])
                };
                let others = applying_to(&base.recipe).flat_map(|it| it.pictures(&base));
                let is_other = |it: &Hypothesis| {
                    it.written.levels == base.written.levels
                        && it.added.is_none()
                        && (it.is_traced_as(&base) || it.written.order.exchanges_sides())
                };
                let others: Vec<Hypothesis> = others.filter(is_other).collect();
                let rendered = tiny(&base)?;
                let exchanged = match others.iter().find(|it| it.written.order.exchanges_sides()) {
                    Some(other) if size[0] != size[1] && base.rows.is_empty() => Some(tiny(other)?),
                    _ => None,
                };
                for hypothesis in [base].into_iter().chain(others) {
                    let written = hypothesis.written;
                    let of =
                        if written.order.exchanges_sides() { exchanged.as_ref() } else { Some(&rendered) };
                    let Some(rendered) = of else { continue };
                    if written.wraps {
                        let mean =
                            enlarged(&rendered.mean(), size.map(|side| side as usize), factor as usize);
                        let seen = self.seen(&written, Some(&mean));
                        let values = reduced(&seen.values, seen.size[0] as usize, factor as usize);
                        ranked.push((rough(&values, rendered, written.linear(255, 0, 1)[0]), hypothesis));
                        continue;
                    }
                    let place = known.iter().position(|(known, _)| *known == written).unwrap_or_else(|| {
                        let seen = self.seen(&written, None);
                        known.push((written, reduced(&seen.values, seen.size[0] as usize, factor as usize)));
                        known.len() - 1
                    });
                    // What holds the same values is not written otherwise.
                    let is_same = |(other, values): &(Written, Vec<[f64; 3]>)| {
                        *other != written
                            && other.curve == written.curve
                            && !written.wraps
                            && is_equal(values, &known[place].1)
                    };
                    if hypothesis.is_right() || !known[..place].iter().any(is_same) {
                        ranked.push((
                            rough(&known[place].1, rendered, written.linear(255, 0, 1)[0]),
                            hypothesis,
                        ));
                    }
                }
            }
        }
        // If stages have equal pictures, prefer what differs less from the book, and then the closer width.
        let bin = |misfit: &f64| (misfit.max(0.0).sqrt() * 500.0) as u64;
        let key = |it: &Hypothesis| (it.rows.len(), it.stage.setup.width.abs_diff(size[0]));
        ranked.sort_by(|(a, it), (b, other)| bin(a).cmp(&bin(b)).then(key(it).cmp(&key(other))));
        Ok(ranked)
    }
}

/// The mistake whose picture depends on the random numbers.
const SHARED: &str = "same-seed";

/// Whether both say the same to the reader.
fn is_same(a: &Hypothesis, b: &Hypothesis) -> bool {
    let id = |it: &Hypothesis| it.named().map(|named| named.id);
    let numbers = |it: &Hypothesis| it.numbers.iter().map(|number| number.what).collect::<Vec<_>>();
    id(a) == id(b) && numbers(a) == numbers(b)
}

/// The right pictures on which mistakes are tried: of the nearest sections that of the book, and that of an edition if it is
/// nearer.
fn bases(ranked: &[(f64, Hypothesis)], sections: usize) -> Vec<Hypothesis> {
    /// How much nearer a picture must be that differs more from the book.
    const NEARER: f64 = 0.6;
    let rights: Vec<&(f64, Hypothesis)> = ranked.iter().filter(|(_, it)| it.is_right()).collect();
    let mut bases: Vec<Hypothesis> = Vec::new();
    let mut stages: Vec<&str> = Vec::new();
    for (_, nearest) in &rights {
        let id = nearest.stage.id;
        if stages.contains(&id) || stages.len() >= sections {
            continue;
        }
        stages.push(id);
        let of_stage = || rights.iter().filter(|(_, it)| it.stage.id == id);
        let book = of_stage().find(|(_, it)| it.rows.is_empty());
        let edition = of_stage().find(|(_, it)| !it.rows.is_empty() && is_simple(it));
        let other = of_stage().find(|(_, it)| !is_simple(it));
        let mut limit = f64::INFINITY;
        let mut own = Vec::new();
        for (misfit, it) in [book, edition, other].into_iter().flatten() {
            if *misfit < NEARER * limit || own.len() < 2 && is_simple(it) && stages.len() == 1 {
                own.insert(if *misfit < NEARER * limit { 0 } else { own.len() }, it.clone());
                limit = limit.min(*misfit);
            }
        }
        bases.extend(own);
    }
    bases
}

/// Whether a picture differs from the book's only by its edition and its bytes.
fn is_simple(it: &Hypothesis) -> bool {
    it.rows.iter().all(|row| {
        row.id.starts_with("edition") || matches!(row.section, "8.2" | "9.5") && row.id != "reflectance"
    })
}

/// Whether two small pictures are equal.
fn is_equal(a: &[[f64; 3]], b: &[[f64; 3]]) -> bool {
    let is_same = |(a, b): (&f64, &f64)| a == b || a.is_nan() && b.is_nan();
    a.len() == b.len() && a.as_flattened().iter().zip(b.as_flattened()).all(is_same)
}

/// Whether only the bytes of two pictures differ.
fn is_written_otherwise(it: &Hypothesis, base: &Hypothesis) -> bool {
    it.is_traced_as(base) && it.added.is_none()
}

/// Mean squared difference of small pictures in displayed values, without the noise of ours.
fn rough(seen: &[[f64; 3]], rendered: &Rendered, most: f64) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    let halves = rendered.halves.each_ref().map(|half| half.as_flattened());
    for (index, value) in seen.as_flattened().iter().enumerate() {
        let square = (value - halves[0][index].clamp(0.0, most))
            * (value - halves[1][index].clamp(0.0, most))
            / (4.0 * value.max(0.02));
        if square.is_finite() {
            sum += square;
            count += 1.0;
        }
    }
    if 4.0 * count > seen.len() as f64 { sum / count } else { f64::INFINITY }
}

/// The picture with what fits best added, and a remark.
pub fn with_added(
    seen: &Seen,
    written: &Written,
    rendered: Rendered,
    added: Added,
) -> (Rendered, Option<String>) {
    const STEPS: usize = 5;
    let from = |index: usize| match added {
        Added::Gain => index,
        Added::Carry => index.saturating_sub(1),
    };
    let (right, mut times, mut at) = (rendered.mean(), 0.0, rendered.clone());
    for _ in 0..STEPS {
        let fit = Fit::new(seen, written, &at);
        let (mut product, mut square) = (0.0, 1e-9);
        for (index, left) in fit.left.iter().enumerate() {
            for channel in (0..3).filter(|channel| left[*channel].is_finite()) {
                // A value at the top of its range is only a lower bound.
                if seen.values[index][channel] < 0.98 {
                    let direction = right[from(index)][channel] / fit.steps[index][channel];
                    product += direction * left[channel] / fit.variance[index][channel];
                    square += direction * direction / fit.variance[index][channel];
                }
            }
        }
        let least = if added == Added::Gain { -0.99 } else { 0.0 };
        times = (times + product / square).max(least);
        at = rendered.plus(times, from);
    }
    let note = match added {
        Added::Gain => {
            format!("your picture is {:.3} times as bright as ours, in linear values", 1.0 + times)
        }
        Added::Carry => format!("each pixel holds about 1/{:.0} of the one before", 1.0 / times),
    };
    (at, Some(note))
}

/// The factor by which the first pictures are smaller: a common divisor of both sides, if a suitable one exists.
fn factor([width, height]: [u32; 2]) -> u32 {
    let wanted = (width / SMALL_WIDTH).max(1);
    let divides = |factor: &u32| width.is_multiple_of(*factor) && height.is_multiple_of(*factor);
    (wanted.div_ceil(2)..=2 * wanted)
        .filter(divides)
        .min_by_key(|factor| factor.abs_diff(wanted))
        .unwrap_or(wanted)
}
