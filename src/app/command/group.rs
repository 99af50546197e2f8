//! The menus, and which one lists which command.

use super::Command;

/// The menu that lists a command.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Group {
    /// Opening, saving and copying.
    File,
    /// Undo and reset.
    Edit,
    /// Views, bookmarks and flights.
    Camera,
    /// Selecting and editing the spheres of the scene.
    Spheres,
    /// What the window shows.
    View,
    /// Pictures that are kept.
    Slots,
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
    pub const ALL: [Group; 10] = [
        Group::File,
        Group::Edit,
        Group::Camera,
        Group::Spheres,
        Group::View,
        Group::Slots,
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
            Group::Camera => "Camera",
            Group::Spheres => "Spheres",
            Group::View => "View",
            Group::Slots => "Slots",
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
            Command::Fresh
            | Command::Open
            | Command::Recent(_)
            | Command::Save(_)
            | Command::SaveScene
            | Command::CopyPicture
            | Command::Crop
            | Command::CopyCrop
            | Command::SaveCrop
            | Command::CopyCommand
            | Command::LoadReference
            | Command::CopyPlot
            | Command::SavePlot
            | Command::Quit => Group::File,
            Command::Undo | Command::Redo | Command::ResetAll => Group::Edit,
            Command::Home
            | Command::ViewFrom(_)
            | Command::AddBookmark
            | Command::Bookmark(_)
            | Command::FlyBookmarks
            | Command::SaveFlight
            | Command::Flights => Group::Camera,
            Command::AddSphere
            | Command::DuplicateSphere
            | Command::DeleteSphere
            | Command::NextSphere
            | Command::PreviousSphere
            | Command::Deselect
            | Command::FocusSphere
            | Command::LookAtSphere
            | Command::ResetSpheres => Group::Spheres,
            Command::Slot(_) => Group::Slots,
            Command::Pause
            | Command::GoOn
            | Command::Restart
            | Command::SwitchDevice
            | Command::Device(_)
            | Command::Size(_) => Group::Render,
            Command::PreviousStage
            | Command::NextStage
            | Command::Stage(_)
            | Command::Stages
            | Command::ShowMe
            | Command::Code
            | Command::Book
            | Command::Companion => Group::Stage,
            Command::BookArithmetic | Command::Extreme(_) => Group::Extreme,
            Command::Palette | Command::Help | Command::FirstSteps => Group::Help,
            _ => Group::View,
        }
    }
}
