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
