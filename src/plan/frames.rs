//! Plans that divide the frames of an animation.

use super::error::PlanError;
use super::manifest::{Plan, Work};
use crate::animation::{CameraPath, FRAME_LIMIT, FrameNames, Turn};
use crate::output::FrameRate;
use crate::recipe::Recipe;
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// Frames of an animation, in parts.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Frames {
    /// First frame, and one past the last.
    pub frames: [u32; 2],
    /// How the camera circles; if it does not, it follows the keyframes of the scene file.
    pub turntable: Option<Turn>,
    /// The rate of the animated PNG.
    pub rate: FrameRate,
    /// The parts.
    pub parts: Vec<FramePart>,
}

/// A part of a plan: some frames.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FramePart {
    /// First frame, and one past the last.
    pub frames: [u32; 2],
}

impl FramePart {
    /// The part's frames.
    pub fn range(&self) -> Range<u32> {
        self.frames[0]..self.frames[1]
    }
}

impl Frames {
    /// Frames in `parts` parts of about the same length; `None` if there are fewer frames than parts, or no parts.
    pub fn new(frames: &Range<u32>, turntable: Option<Turn>, rate: FrameRate, parts: u64) -> Option<Self> {
        let count = u64::from(frames.end.checked_sub(frames.start)?);
        if parts == 0 || count < parts {
            return None;
        }
        let border = |part: u64| frames.start + (count * part / parts) as u32;
        let parts = (0..parts).map(|part| FramePart { frames: [border(part), border(part + 1)] }).collect();
        Some(Frames { frames: [frames.start, frames.end], turntable, rate, parts })
    }

    /// All frames.
    pub fn range(&self) -> Range<u32> {
        self.frames[0]..self.frames[1]
    }
}

impl Work for Frames {
    const VERSION: u32 = 2;
    const RESULT: &str = "animation.png";

    fn count(&self) -> usize {
        self.parts.len()
    }

    fn files(&self) -> Vec<&str> {
        Vec::new()
    }

    fn check(&self) -> Result<(), String> {
        let mut next = self.frames[0];
        for (index, FramePart { frames: [start, end] }) in self.parts.iter().enumerate() {
            if *start != next || end <= start {
                return Err(format!("part {index} has the frames {start}..{end}, but {next} comes next"));
            }
            next = *end;
        }
        if next != self.frames[1] || self.parts.is_empty() {
            return Err(format!("its parts end at frame {next}, but it has {}", self.frames[1]));
        }
        if next > FRAME_LIMIT {
            return Err(format!(
                "its parts end at frame {next}, but an animation ends at {FRAME_LIMIT} at most"
            ));
        }
        let is_turning = match self.turntable {
            Some(Turn::FramesPerTurn(frames)) => frames > 0,
            Some(Turn::DegreesPerFrame(degrees)) => degrees.is_finite(),
            None => true,
        };
        if !is_turning || self.rate.frames == 0 || self.rate.seconds == 0 {
            return Err("its turntable or its rate cannot be".to_owned());
        }
        Ok(())
    }
}

impl Plan<Frames> {
    /// A part by its number, from 0.
    ///
    /// # Errors
    /// [`PlanError::NoPart`].
    pub fn part(&self, number: u64) -> Result<&FramePart, PlanError> {
        self.index(number).map(|index| &self.manifest.work.parts[index])
    }

    /// How the camera moves.
    pub fn camera_path(&self) -> CameraPath {
        let Recipe { camera, keyframes, .. } = &self.recipe;
        match self.manifest.work.turntable {
            Some(turn) => CameraPath::Turntable { start: *camera, turn },
            None => CameraPath::Keyframes { still: *camera, keyframes: keyframes.clone() },
        }
    }

    /// The files of the frames, beside the manifest.
    pub fn names(&self) -> FrameNames {
        FrameNames::in_directory(self.directory())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RATE: FrameRate = FrameRate { frames: 30, seconds: 1 };

    #[test]
    fn frames_are_divided_evenly_and_completely() {
        let parts = |frames, parts| {
            let work = Frames::new(&frames, None, RATE, parts)?;
            assert_eq!(work.check(), Ok(()));
            Some(work.parts.iter().map(FramePart::range).collect::<Vec<_>>())
        };
        assert_eq!(parts(0..120, 4), Some(vec![0..30, 30..60, 60..90, 90..120]));
        assert_eq!(parts(7..12, 3), Some(vec![7..8, 8..10, 10..12]));
        assert_eq!(parts(0..FRAME_LIMIT, 100_000).map(|parts| parts.len()), Some(100_000));
        assert_eq!((parts(0..3, 4), parts(0..3, 0)), (None, None));
    }

    #[test]
    fn gaps_and_frames_twice_are_found() {
        let good = Frames::new(&(0..9), None, RATE, 3).unwrap();
        for (part, frames, told) in [
            (0, [0, 4], "part 1 has the frames 3..6, but 4 comes next"),
            (1, [4, 6], "part 1 has the frames 4..6, but 3 comes next"),
            (1, [3, 3], "part 1 has the frames 3..3, but 3 comes next"),
            (2, [6, 8], "its parts end at frame 8, but it has 9"),
            (2, [6, 10], "its parts end at frame 10, but it has 9"),
        ] {
            let mut wrong = good.clone();
            wrong.parts[part] = FramePart { frames };
            assert_eq!(wrong.check(), Err(told.to_owned()));
        }
    }

    #[test]
    fn turntables_and_rates_that_cannot_be_are_refused() {
        let check = |turntable, frames, seconds| {
            Frames::new(&(0..4), turntable, FrameRate { frames, seconds }, 2).unwrap().check()
        };
        for turn in [None, Some(Turn::FramesPerTurn(1)), Some(Turn::DegreesPerFrame(-3.0))] {
            assert_eq!(check(turn, 1, 1), Ok(()), "{turn:?}");
        }
        let refused = Err("its turntable or its rate cannot be".to_owned());
        for turn in
            [Turn::FramesPerTurn(0), Turn::DegreesPerFrame(f64::NAN), Turn::DegreesPerFrame(f64::INFINITY)]
        {
            assert_eq!(check(Some(turn), 1, 1), refused, "{turn:?}");
        }
        assert_eq!((check(None, 0, 1), check(None, 1, 0)), (refused.clone(), refused));
    }

    #[test]
    fn no_frames_and_frames_beyond_the_limit_are_refused() {
        let last = |end: u32| Frames::new(&(end - 2..end), None, RATE, 2).unwrap().check();
        assert_eq!(last(FRAME_LIMIT), Ok(()));
        let told = "its parts end at frame 100001, but an animation ends at 100000 at most";
        assert_eq!(last(FRAME_LIMIT + 1), Err(told.to_owned()));
        let none = Frames { frames: [3, 3], turntable: None, rate: RATE, parts: Vec::new() };
        assert!(none.check().is_err());
    }
}
