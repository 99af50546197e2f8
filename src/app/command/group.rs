//! The menus, and which command each of them lists.

use super::Command;

/// The menu that lists a command.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Group {
    /// Opening, saving and copying.
    File,
    /// Undo, reset and bookmarks.
    Edit,
    /// Selecting and editing the spheres of the scene.
    Spheres,
    /// What the window shows.
    View,
    /// Pause, restart and devices.
    Render,
    /// The stages of the book.
    Stage,
    /// Scenes that are numerically difficult.
    Extreme,
    /// The book, the palette and the list of keys.
    Help,
}

impl Group {
    /// The menus, in order.
    pub const ALL: [Group; 8] = [
        Group::File,
        Group::Edit,
        Group::Spheres,
        Group::View,
        Group::Render,
        Group::Stage,
        Group::Extreme,
        Group::Help,
    ];

    /// The title of the menu.
    pub fn name(self) -> &'static str {
        match self {
            Group::File => "File",
            Group::Edit => "Edit",
            Group::Spheres => "Spheres",
            Group::View => "View",
            Group::Render => "Render",
            Group::Stage => "Stage",
            Group::Extreme => "Extreme scenes",
            Group::Help => "Help",
        }
    }
}

impl Command {
    /// The menu that contains the command.
    pub fn group(self) -> Group {
        match self {
            Command::Open
            | Command::Recent(_)
            | Command::Save(_)
            | Command::SaveScene
            | Command::CopyPicture
            | Command::CopyCommand
            | Command::LoadReference
            | Command::CopyPlot
            | Command::SavePlot
            | Command::Quit => Group::File,
            Command::Undo | Command::Redo | Command::Home | Command::ResetAll | Command::AddBookmark => {
                Group::Edit
            }
            Command::AddSphere
            | Command::DuplicateSphere
            | Command::DeleteSphere
            | Command::NextSphere
            | Command::PreviousSphere
            | Command::Deselect
            | Command::FocusSphere
            | Command::LookAtSphere
            | Command::ResetSpheres => Group::Spheres,
            Command::Pause
            | Command::GoOn
            | Command::Restart
            | Command::SwitchDevice
            | Command::Device(_) => Group::Render,
            Command::PreviousStage
            | Command::NextStage
            | Command::Stage(_)
            | Command::Code
            | Command::Book
            | Command::Companion => Group::Stage,
            Command::BookArithmetic | Command::Extreme(_) => Group::Extreme,
            Command::Palette | Command::Help | Command::FirstSteps => Group::Help,
            _ => Group::View,
        }
    }
}
