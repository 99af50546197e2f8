//! The parts of a plan: what is there of each, and their sum.

use super::Lacking;
use crate::console;
use crate::describe::{counted, describe};
use crate::files::ShownPath;
use crate::film::{CheckpointError, Description, Film, FilmSum, MergeError, SampleRanges, checkpoint, key};
use crate::plan::{Commands, Plan, Samples, Work};
use crate::progressive::Status;
use crate::saved::same_job;
use crate::shell;
use std::path::Path;

/// What is there of a part.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum State {
    Whole,
    /// A checkpoint that lacks this many samples per pixel.
    Unfinished {
        missing: u64,
    },
    Missing,
    /// A film that is damaged, of another picture or of other samples, in words.
    Wrong(String),
}

/// The sum of the parts of a plan.
pub(super) struct PlanSum<'a> {
    plan: &'a Plan<Samples>,
    sum: FilmSum,
    states: Vec<State>,
}

impl<'a> PlanSum<'a> {
    /// An empty sum.
    pub fn new(plan: &'a Plan<Samples>) -> Result<Self, MergeError> {
        let settings = plan.job.settings();
        let halves = settings.half_count();
        let mut description =
            describe(&plan.recipe, plan.stage(), &Film::new(1, 1, 1), &Status::default(), None);
        description.set(key::COMMAND, &plan.manifest.command);
        let sum = FilmSum::new(settings.width, settings.height, halves, description, &plan.path)?;
        Ok(PlanSum { plan, sum, states: vec![State::Missing; plan.manifest.work.parts.len()] })
    }

    /// A copy, from which [`PlanSum::take_back`] takes away only what is added to it.
    ///
    /// # Errors
    /// [`MergeError::Film`] if there is not enough memory.
    pub fn try_copy(&self) -> Result<Self, MergeError> {
        Ok(PlanSum { plan: self.plan, sum: self.sum.try_copy()?, states: self.states.clone() })
    }

    /// Empties the sum.
    pub fn clear(&mut self) {
        self.sum.clear();
        self.states.fill(State::Missing);
    }

    /// Adds what is there of a part: only a whole one, or also a checkpoint, which [`PlanSum::take_back`] takes away
    /// again. What cannot be added is left out.
    ///
    /// # Errors
    /// [`MergeError::Lost`]: the sum is then worthless.
    pub fn add(&mut self, index: usize, also_unfinished: bool) -> Result<&State, MergeError> {
        let part = &self.plan.manifest.work.parts[index];
        let path = self.plan.part_path(part);
        let state = match head_state(self.plan, index) {
            State::Unfinished { missing } if !also_unfinished => State::Unfinished { missing },
            State::Whole | State::Unfinished { .. } => {
                match self.sum.add(&path, same_job, |samples| part.missing(samples) > 0) {
                    Ok(share) => match part.missing(share.samples()) {
                        0 => State::Whole,
                        missing => State::Unfinished { missing },
                    },
                    Err(error @ MergeError::Lost { .. }) => return Err(error),
                    Err(error) => State::Wrong(words(&error)),
                }
            }
            state => state,
        };
        self.states[index] = state;
        Ok(&self.states[index])
    }

    /// Takes the unfinished parts away again.
    ///
    /// # Errors
    /// [`MergeError::Lost`]: the sum is then worthless.
    pub fn take_back(&mut self) -> Result<(), MergeError> {
        self.sum.take_back()
    }

    pub fn film(&self) -> &Film {
        self.sum.film()
    }

    pub fn description(&self) -> Description {
        self.sum.description()
    }

    /// Whether a part is whole and in the sum for good.
    pub fn is_whole(&self, index: usize) -> bool {
        self.states[index] == State::Whole
    }

    /// How many parts are whole.
    pub fn whole(&self) -> usize {
        self.states.iter().filter(|state| **state == State::Whole).count()
    }

    /// The parts that are not whole.
    pub fn lacking(&self) -> Lacking {
        let parts = self.states.iter().cloned().enumerate();
        parts.filter(|(_, state)| *state != State::Whole).collect()
    }

    /// How much of the picture is there.
    pub fn words(&self) -> String {
        let [start, end] = self.plan.manifest.work.samples;
        let samples: &SampleRanges = self.film().samples();
        format!(
            "{} of {} samples per pixel ({samples}); {} of {} parts are whole",
            samples.count(),
            end - start,
            self.whole(),
            self.states.len()
        )
    }
}

/// What the head of a part's file says about it.
pub(super) fn head_state(plan: &Plan<Samples>, index: usize) -> State {
    let part = &plan.manifest.work.parts[index];
    let path = plan.part_path(part);
    if path.symlink_metadata().is_err() {
        return State::Missing;
    }
    match checkpoint::read_head(&path) {
        Ok(head) => state_of(plan, index, &head.samples),
        Err(error) => State::Wrong(error.to_string()),
    }
}

/// What is there of a part whose file holds `samples`.
pub(super) fn state_of(plan: &Plan<Samples>, index: usize, samples: &SampleRanges) -> State {
    let part = &plan.manifest.work.parts[index];
    if part.is_exceeded_by(samples) {
        let [start, end] = part.samples;
        return State::Wrong(format!(
            "{} holds the samples {samples}, but this part has {start}..{end}; move the file away",
            plan.part_path(part).shown()
        ));
    }
    match part.missing(samples) {
        0 => State::Whole,
        missing => State::Unfinished { missing },
    }
}

/// Reads the whole film of a part, and tells what is there of it.
pub(super) fn checked_state(plan: &Plan<Samples>, index: usize, recipe: &str) -> State {
    let path = plan.part_path(&plan.manifest.work.parts[index]);
    match head_state(plan, index) {
        State::Whole | State::Unfinished { .. } => match checkpoint::check(&path) {
            Ok(head) => match same_job(recipe, head.description.recipe()) {
                Ok(()) => state_of(plan, index, &head.samples),
                Err(difference) => State::Wrong(other_picture(&path, &difference)),
            },
            Err(error) => State::Wrong(error.to_string()),
        },
        state => state,
    }
}

fn other_picture(path: &Path, difference: &str) -> String {
    format!("{} is the film of another picture: {difference}; move it away", path.shown())
}

fn words(error: &MergeError) -> String {
    match error {
        MergeError::OtherJob { other, difference, .. } => other_picture(other, difference),
        MergeError::File(CheckpointError::Input(reason)) => reason.to_string(),
        error => error.to_string(),
    }
}

/// A line on a part that is not whole.
pub(super) fn line(plan: &Plan<Samples>, index: usize, state: &State) -> String {
    let part = &plan.manifest.work.parts[index];
    let ([start, end], file) = (part.samples, &part.file);
    match state {
        State::Whole => format!("part {index}: {file} is whole"),
        State::Unfinished { missing } => {
            let count = end - start;
            format!("part {index}: {file} has {} of {count} samples per pixel", count - missing)
        }
        State::Missing => format!("part {index}: {file} is missing (samples {start}..{end})"),
        State::Wrong(words) => format!("part {index}: {words}"),
    }
}

/// Most commands that are told beside a result.
const COMMANDS_TOLD: usize = 50;

/// How to render what these parts lack: a heading, and the commands, one a line.
pub(super) fn remedy<W: Work>(plan: &Plan<W>, parts: &[usize], program: &str) -> String {
    remedy_lines(plan, parts, program, parts.len())
}

/// Tells the same on standard error; of many commands, only the first and how to see the others.
pub(super) fn note_remedy<W: Work>(plan: &Plan<W>, parts: &[usize], program: &str) {
    console::note(&remedy_lines(plan, parts, program, COMMANDS_TOLD));
}

/// The remedy with `most` commands.
fn remedy_lines<W: Work>(plan: &Plan<W>, parts: &[usize], program: &str, most: usize) -> String {
    let manifest = plan.path.to_string_lossy();
    let commands = Commands::new(program, &manifest, plan);
    let mut lines = vec![format!("for what is missing (--array={} in Slurm):", ranges(parts))];
    lines.extend(parts.iter().take(most).map(|index| commands.part_line(*index)));
    if parts.len() > most {
        let check = shell::line([program, "merge", &commands.manifest, "--check"]);
        let more = counted((parts.len() - most) as u64, "more command");
        lines.push(format!("... and {more}; all of them: {check}"));
    }
    lines.join("\n")
}

/// Ascending numbers as Slurm takes them: `0,3-7,9`.
fn ranges(numbers: &[usize]) -> String {
    let runs = numbers.chunk_by(|number, next| number + 1 == *next);
    let words = |run: &[usize]| match run {
        [first, _, .., last] => format!("{first}-{last}"),
        few => few.iter().map(usize::to_string).collect::<Vec<_>>().join(","),
    };
    runs.map(words).collect::<Vec<_>>().join(",")
}

/// The numbers of the parts.
pub(super) fn numbers(lacking: &Lacking) -> Vec<usize> {
    lacking.iter().map(|(index, _)| *index).collect()
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::plan::{Manifest, Part};
    use crate::recipe::Recipe;
    use std::ops::Range;
    use tempfile::TempDir;

    /// A plan of the samples 7 to 49 in parts of 23 and 20.
    pub fn planned() -> (TempDir, Plan<Samples>) {
        let directory = tempfile::tempdir().unwrap();
        let mut recipe = Recipe::find("three-spheres").unwrap();
        (recipe.settings.width, recipe.settings.height) = (4, 3);
        let part = |file: &str, samples| Part { file: file.to_owned(), samples };
        let parts = vec![part("part-0.exr", [7, 30]), part("part-1.exr", [30, 50])];
        let work = Samples { samples: [7, 50], block: 1, parts };
        let plan = Plan::write(directory.path(), &recipe, &recipe.job().unwrap(), Manifest::new(work));
        (directory, plan.unwrap())
    }

    /// A film of the plan in which sample `i` is `i + 1` in every pixel.
    pub fn film(plan: &Plan<Samples>, samples: Range<u64>) -> Film {
        let mut film = plan.job.new_film();
        let halves = film.halves().len() as u64;
        for (half, sums) in (0..).zip(film.halves_mut()) {
            let own = samples.clone().filter(|sample| sample % halves == half);
            let sum: u64 = own.map(|sample| sample + 1).sum();
            sums.iter_mut().for_each(|pixel| pixel.0 = [sum; 3]);
        }
        film.record(samples, 0).unwrap();
        film
    }

    /// Writes a film of the plan, as a renderer does: a new file takes the place of the old one.
    pub fn save(plan: &Plan<Samples>, name: &str, samples: Range<u64>) {
        let film = film(plan, samples);
        let description = describe(&plan.recipe, None, &film, &Status::default(), None);
        checkpoint::save(&plan.beside(name), &film, &description).unwrap();
    }

    #[test]
    fn a_part_has_as_many_samples_as_its_range_wherever_that_begins() {
        let (_directory, plan) = planned();
        let state = |index: usize, start: u64, end: u64| {
            state_of(&plan, index, &SampleRanges::from_ranges(std::iter::once(start..end)).unwrap())
        };
        assert_eq!((state(0, 7, 30), state(1, 30, 50)), (State::Whole, State::Whole));
        assert_eq!(state(1, 30, 41), State::Unfinished { missing: 9 });
        let State::Wrong(words) = state(1, 29, 50) else { panic!("a sample of the part before") };
        assert!(words.contains("part-1.exr holds the samples 29..50, but this part has 30..50"), "{words}");
        assert_eq!(
            line(&plan, 1, &State::Unfinished { missing: 9 }),
            "part 1: part-1.exr has 11 of 20 samples per pixel"
        );
        assert_eq!(line(&plan, 0, &State::Missing), "part 0: part-0.exr is missing (samples 7..30)");
    }

    #[test]
    fn a_sum_tells_how_many_samples_of_the_plan_it_has() {
        let (_directory, plan) = planned();
        let mut sum = PlanSum::new(&plan).unwrap();
        assert_eq!(sum.words(), "0 of 43 samples per pixel (); 0 of 2 parts are whole");
        save(&plan, "part-1.exr", 30..50);
        assert_eq!(sum.add(1, false).unwrap(), &State::Whole);
        assert_eq!(sum.words(), "20 of 43 samples per pixel (30..50); 1 of 2 parts are whole");
        assert_eq!((sum.is_whole(0), sum.is_whole(1)), (false, true));
        assert_eq!(numbers(&sum.lacking()), [0]);
    }

    #[test]
    fn three_numbers_in_a_row_are_a_range() {
        for (numbers, words) in [
            (&[][..], ""),
            (&[4], "4"),
            (&[0, 2, 4], "0,2,4"),
            (&[1, 2], "1,2"),
            (&[0, 1, 2, 4, 6, 8, 9, 10], "0-2,4,6,8-10"),
            (&[3, 4, 6, 7, 8], "3,4,6-8"),
        ] {
            assert_eq!(ranges(numbers), words);
        }
        let most: Vec<usize> = (8..1000).collect();
        assert_eq!(ranges(&most), "8-999");
    }

    #[test]
    fn the_commands_that_are_not_told_are_counted() {
        let (_directory, plan) = planned();
        assert_eq!(remedy(&plan, &[0, 1], "w"), remedy_lines(&plan, &[0, 1], "w", 2));
        let told = remedy_lines(&plan, &[0, 1], "w", 1);
        let lines: Vec<&str> = told.lines().collect();
        assert!(lines.len() == 3 && lines[1].ends_with("--part 0"), "{told}");
        assert!(lines[2].starts_with("... and 1 more command; all of them: w merge "), "{told}");
        assert!(lines[2].ends_with("plan.json --check"), "{told}");
    }

    #[test]
    fn a_sum_says_how_its_plan_was_made() {
        let (_directory, mut plan) = planned();
        (plan.manifest.command, plan.manifest.stage) = ("w plan".to_owned(), Some("metal".to_owned()));
        save(&plan, "part-0.exr", 7..17);
        let mut sum = PlanSum::new(&plan).unwrap();
        assert_eq!(sum.add(0, false).unwrap(), &State::Unfinished { missing: 13 });
        assert_eq!(sum.film().sample_count(), 0, "only what is whole");
        assert_eq!(sum.add(0, true).unwrap(), &State::Unfinished { missing: 13 });
        let description = sum.description();
        for (name, value) in [
            (key::COMMAND, "w plan"),
            (key::STAGE, "metal"),
            (key::SCENE, "three-spheres"),
            (key::SAMPLES, "10"),
        ] {
            assert_eq!(description.get(name), Some(value));
        }
    }
}
