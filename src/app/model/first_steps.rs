//! What a new user has tried of the first steps.

use serde::{Deserialize, Serialize};

/// Something to try.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// Dragging the picture.
    Orbit,
    /// Changing a sphere.
    Change,
    /// Going to the next stage or back.
    Leaf,
}

impl Step {
    /// All steps, in order.
    pub const ALL: [Step; 3] = [Step::Orbit, Step::Change, Step::Leaf];
}

/// What the user has tried.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct FirstSteps {
    /// The card was closed or everything was tried: it does not come back by itself.
    pub is_over: bool,
    done: [bool; 3],
}

impl FirstSteps {
    /// Whether the user has done this.
    pub fn has(&self, step: Step) -> bool {
        self.done[step as usize]
    }

    /// Whether the user has done everything.
    pub fn has_all(&self) -> bool {
        self.done == [true; 3]
    }

    /// Notes that the user did this.
    pub fn note(&mut self, step: Step) {
        self.done[step as usize] = true;
        self.is_over |= self.has_all();
    }

    /// Forgets what was done, to show the steps again.
    pub fn forget(&mut self) {
        self.done = [false; 3];
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_steps_are_over_once_all_were_tried() {
        let mut steps = FirstSteps::default();
        for (tried, step) in [Step::Leaf, Step::Orbit, Step::Change].into_iter().enumerate() {
            assert!(!steps.has(step) && !steps.has_all() && !steps.is_over);
            steps.note(step);
            assert_eq!(Step::ALL.iter().filter(|step| steps.has(**step)).count(), tried + 1);
            assert!(steps.has(step));
        }
        assert!(steps.has_all() && steps.is_over);
        steps.forget();
        assert!(!Step::ALL.iter().any(|step| steps.has(*step)), "they are shown again");
        assert!(steps.is_over, "but not by themselves");
    }
}
