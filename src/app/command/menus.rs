//! Which menu lists which command.

use super::{Command, Group};

impl Command {
    /// The menu that contains the command.
    pub fn group(self) -> Group {
        match self {
            Command::Fresh
            | Command::Open
            | Command::Recent(_)
            | Command::Reload
            | Command::Save(_)
            | Command::SaveScene
            | Command::CopyPicture
            | Command::Crop
            | Command::CopyCrop
            | Command::SaveCrop
            | Command::CopyCommand
            | Command::LoadReference
            | Command::ReferenceSize
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
