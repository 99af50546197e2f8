//! The numbers of slots.

use serde::{Deserialize, Serialize};
use std::fmt;

/// The number of a slot, 1 to 9.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "u8", into = "u8")]
pub struct SlotNumber(u8);

impl TryFrom<u8> for SlotNumber {
    type Error = String;

    fn try_from(number: u8) -> Result<Self, String> {
        let found = SlotNumber::ALL.into_iter().find(|known| known.0 == number);
        found.ok_or_else(|| format!("there is no slot {number}, only 1 to 9"))
    }
}

impl From<SlotNumber> for u8 {
    fn from(number: SlotNumber) -> u8 {
        number.0
    }
}

impl SlotNumber {
    /// All numbers.
    pub const ALL: [SlotNumber; 9] = [
        SlotNumber(1),
        SlotNumber(2),
        SlotNumber(3),
        SlotNumber(4),
        SlotNumber(5),
        SlotNumber(6),
        SlotNumber(7),
        SlotNumber(8),
        SlotNumber(9),
    ];

    /// Its place in [`SlotNumber::ALL`].
    pub fn index(self) -> usize {
        usize::from(self.0) - 1
    }
}

impl fmt::Display for SlotNumber {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(formatter)
    }
}
