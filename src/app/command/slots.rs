//! The commands for slots.

use super::shortcut::{DIGITS, alt, key, shift, shift_alt};
use crate::app::model::slots::SlotNumber;
use eframe::egui::{Key, KeyboardShortcut};

/// A command for slots.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SlotCommand {
    /// Keep the picture in the first free slot.
    Keep,
    /// Keep the picture in this slot.
    KeepIn(SlotNumber),
    /// Show the picture of this slot.
    Look(SlotNumber),
    /// Show the live picture.
    LookLive,
    /// Show what was shown before: the live picture or a slot.
    Swap,
    /// Compare with the chosen slot on both sides of a divider.
    Wipe,
    /// Show a heat map of the difference from the chosen slot.
    Difference,
    /// Say whether the picture and the chosen slot differ only by noise.
    OnlyNoise,
    /// Give the picture the size of the chosen slot's.
    TakeSize,
    /// Go on from the picture of the chosen slot.
    Open,
    /// Empty the chosen slot.
    Delete,
    /// Put back the picture that was deleted or replaced last.
    BringBack,
}

impl SlotCommand {
    /// All commands for slots, in the order of the menu.
    pub fn all() -> Vec<SlotCommand> {
        use SlotCommand::{
            BringBack, Delete, Difference, Keep, KeepIn, Look, LookLive, OnlyNoise, Open, Swap, TakeSize,
            Wipe,
        };
        let mut all = vec![Keep, Swap, LookLive];
        all.extend(SlotNumber::ALL.map(Look));
        all.extend([Wipe, Difference, OnlyNoise, TakeSize, Open]);
        all.extend(SlotNumber::ALL.map(KeepIn));
        all.extend([Delete, BringBack]);
        all
    }

    /// The name, as in menus.
    pub fn name(self) -> String {
        match self {
            SlotCommand::KeepIn(number) => format!("Keep in slot {number}"),
            SlotCommand::Look(number) => format!("Look at slot {number}"),
            SlotCommand::Keep => "Keep this picture".into(),
            SlotCommand::LookLive => "Look at the live picture".into(),
            SlotCommand::Swap => "Flip between two pictures".into(),
            SlotCommand::Wipe => "Wipe against the slot".into(),
            SlotCommand::Difference => "Difference from the slot".into(),
            SlotCommand::OnlyNoise => "Is it only noise?".into(),
            SlotCommand::TakeSize => "Set the picture to the slot's size".into(),
            SlotCommand::Open => "Go on from the slot".into(),
            SlotCommand::Delete => "Delete the slot".into(),
            SlotCommand::BringBack => "Bring back the slot".into(),
        }
    }

    /// What the command does, in one sentence.
    pub fn help(self) -> &'static str {
        match self {
            SlotCommand::Keep => {
                "A copy with all its samples, in the first free slot, to look at and compare with"
            }
            SlotCommand::KeepIn(_) => {
                "A copy of this picture with all its samples; one that is there is replaced"
            }
            SlotCommand::Look(_) => "Show the kept picture instead of the live one; Escape returns",
            SlotCommand::LookLive => "Leave the slot that is shown; Escape does this too",
            SlotCommand::Swap => "Show the live picture and the slot looked at last in turn, or two slots",
            SlotCommand::Wipe => "Drag a divider between the shown picture and the one in the chosen slot",
            SlotCommand::Difference => {
                "Where the shown picture and the chosen slot's differ, with the values"
            }
            SlotCommand::OnlyNoise => {
                "Test whether the shown picture and the chosen slot's differ by more than noise, as \
                 \"weekender compare\" does"
            }
            SlotCommand::TakeSize => {
                "Render the live picture at the size of the chosen slot's, so that they can be subtracted"
            }
            SlotCommand::Open => {
                "Restore the chosen slot's scene, camera, settings and samples; Undo returns"
            }
            SlotCommand::Delete => "Empty the chosen one; its picture can be brought back until the next",
            SlotCommand::BringBack => "The picture that was deleted or replaced last, to its old place",
        }
    }

    /// The command's shortcut.
    pub fn shortcut(self) -> Option<KeyboardShortcut> {
        match self {
            SlotCommand::Keep => key(Key::M),
            SlotCommand::KeepIn(number) => shift_alt(DIGITS[number.index()]),
            SlotCommand::Look(number) => alt(DIGITS[number.index()]),
            SlotCommand::LookLive => alt(Key::Num0),
            SlotCommand::Swap => key(Key::J),
            SlotCommand::Wipe => shift(Key::C),
            SlotCommand::Difference => shift(Key::X),
            SlotCommand::OnlyNoise => shift(Key::N),
            SlotCommand::TakeSize | SlotCommand::Open | SlotCommand::Delete | SlotCommand::BringBack => None,
        }
    }
}
