//! The films or frames of a plan: what exists of each, and the commands for what is missing.

use crate::film::{SampleRanges, checkpoint};
use crate::job::plan::{Commands, Part, Plan, Work};
use crate::job::saved::FrameState;
use crate::progressive::describe::SOFTWARE;
use crate::system::files::ShownPath;
use crate::system::shell::Shell;
use std::path::PathBuf;

/// What exists of a film or frame.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum State {
    Whole,
    /// A checkpoint with this many of the part's samples per pixel.
    Unfinished {
        held: u64,
        of: u64,
    },
    Missing,
    /// A file that is damaged, of another picture or of other samples, with reason and remedy.
    Wrong(String),
}

/// The film of a part, or a frame of one.
pub(super) struct Piece {
    /// The part that renders it.
    part: usize,
    kind: Kind,
    pub path: PathBuf,
    pub state: State,
    /// Whether its final version is in the sum.
    pub is_merged: bool,
}

#[derive(Clone)]
enum Kind {
    Film(Part),
    Frame(u32),
}

/// All films or frames of a plan.
pub(super) struct Pieces<'a> {
    pub plan: &'a Plan,
    pub all: Vec<Piece>,
}

impl<'a> Pieces<'a> {
    /// The films or frames, not checked yet.
    pub fn of(plan: &'a Plan) -> Self {
        let piece = |part, kind, path| Piece { part, kind, path, state: State::Missing, is_merged: false };
        let all = match &plan.manifest.work {
            Work::Samples(work) => {
                let film =
                    |(part, it): (usize, &Part)| piece(part, Kind::Film(it.clone()), plan.beside(&it.file));
                work.parts.iter().enumerate().map(film).collect()
            }
            Work::Frames(work) => {
                let names = plan.frame_names();
                let frames = work.parts.iter().enumerate();
                let frames = frames.flat_map(|(part, frames)| frames.range().map(move |frame| (part, frame)));
                frames.map(|(part, frame)| piece(part, Kind::Frame(frame), names.path(frame))).collect()
            }
        };
        Pieces { plan, all }
    }

    /// Checks the files that were not whole. Only the head of a film is read.
    pub fn look(&mut self) {
        for piece in self.all.iter_mut().filter(|piece| piece.state != State::Whole) {
            piece.state = piece.look(self.plan);
        }
    }

    /// A line for each file that is damaged, of another picture or of other samples.
    pub fn wrong(&self) -> impl Iterator<Item = String> {
        self.all.iter().filter(|piece| matches!(piece.state, State::Wrong(_))).map(Piece::line)
    }

    fn lacking(&self) -> impl Iterator<Item = &Piece> {
        self.all.iter().filter(|piece| piece.state != State::Whole)
    }

    pub fn is_complete(&self) -> bool {
        self.lacking().next().is_none()
    }

    /// How many are complete.
    pub fn words(&self) -> String {
        let count = self.all.len();
        let noun = if matches!(self.plan.manifest.work, Work::Samples(_)) { "parts" } else { "frames" };
        format!("{} of {count} {noun} are whole", count - self.lacking().count())
    }

    /// A line for each that is incomplete.
    pub fn lines(&self) -> impl Iterator<Item = String> {
        self.lacking().map(Piece::line)
    }

    /// How to render what is missing: a heading, then one command per line.
    pub fn remedy(&self, program: &str) -> String {
        let mut parts: Vec<usize> = self.lacking().map(|piece| piece.part).collect();
        parts.dedup();
        let commands = Commands::new(program, &self.plan.path.to_string_lossy(), &self.plan.manifest);
        let heading = format!("for what is missing (--array={} in Slurm):", ranges(&parts));
        let lines = parts.iter().map(|part| commands.part_line(Shell::HERE, &part.to_string()));
        std::iter::once(heading).chain(lines).collect::<Vec<_>>().join("\n")
    }
}

impl Piece {
    fn look(&self, plan: &Plan) -> State {
        match (&self.kind, &plan.manifest.work) {
            _ if self.path.symlink_metadata().is_err() => State::Missing,
            (Kind::Frame(frame), Work::Frames(work)) => {
                let recipe = plan.recipe.at_frame(&work.camera_path(&plan.recipe), *frame);
                match FrameState::of(&self.path, &recipe, SOFTWARE) {
                    FrameState::Whole => State::Whole,
                    FrameState::Missing => State::Missing,
                    FrameState::Wrong(reason) => State::Wrong(reason),
                }
            }
            (Kind::Film(part), _) => match checkpoint::read_head(&self.path) {
                Ok(head) => self.of_samples(part, &head.samples),
                Err(error) => State::Wrong(error.to_string()),
            },
            _ => State::Missing,
        }
    }

    /// The state of a part whose film holds `samples`.
    fn of_samples(&self, part: &Part, samples: &SampleRanges) -> State {
        if part.is_exceeded_by(samples) {
            let ([start, end], path) = (part.samples, self.path.shown());
            return State::Wrong(format!(
                "{path} holds the samples {samples}, but this part has {start}..{end}; move the file away"
            ));
        }
        match part.missing(samples) {
            0 => State::Whole,
            missing => {
                let of = part.samples[1] - part.samples[0];
                State::Unfinished { held: of - missing, of }
            }
        }
    }

    /// Its state in one line.
    pub fn line(&self) -> String {
        let Piece { part, path, state, .. } = self;
        let name = path.file_name().unwrap_or_default().shown();
        match state {
            State::Whole => format!("part {part}: {name} is whole"),
            State::Unfinished { held, of } => {
                format!("part {part}: {name} has {held} of {of} samples per pixel")
            }
            State::Missing => format!("part {part}: {name} is missing"),
            State::Wrong(reason) => format!("part {part}: {reason}"),
        }
    }
}

/// Ascending numbers as Slurm writes them: `0,3-7,9`.
fn ranges(numbers: &[usize]) -> String {
    let runs = numbers.chunk_by(|number, next| number + 1 == *next);
    let text = |run: &[usize]| match run {
        [first, _, .., last] => format!("{first}-{last}"),
        few => few.iter().map(usize::to_string).collect::<Vec<_>>().join(","),
    };
    runs.map(text).collect::<Vec<_>>().join(",")
}

#[cfg(test)]
mod tests {
    use super::ranges;

    #[test]
    fn three_numbers_in_a_row_are_a_range() {
        for (numbers, expected) in [
            (&[][..], ""),
            (&[4], "4"),
            (&[1, 2], "1,2"),
            (&[0, 1, 2, 4, 6, 8, 9, 10], "0-2,4,6,8-10"),
            (&[3, 4, 6, 7, 8], "3,4,6-8"),
        ] {
            assert_eq!(ranges(numbers), expected);
        }
    }
}
