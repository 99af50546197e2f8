//! The shortcuts of the commands.

use super::super::model::show::Show;
use super::Command;
use super::shortcut::{DIGITS, ctrl, ctrl_shift, key};
use crate::job::output::OutputFormat;
use eframe::egui::{Context, Key, KeyboardShortcut};

impl Command {
    /// The shortcut as it is printed on a keyboard.
    pub fn keys(self, context: &Context) -> Option<String> {
        let named = context.format_shortcut(&self.shortcut()?);
        Some(
            named
                .replace("OpenBracket", "[")
                .replace("CloseBracket", "]")
                .replace("Plus", "+")
                .replace("Minus", "-")
                .replace("PageUp", "Page Up")
                .replace("PageDown", "Page Down"),
        )
    }

    /// The command's shortcut.
    pub fn shortcut(self) -> Option<KeyboardShortcut> {
        match self {
            Command::Open => ctrl(Key::O),
            Command::Reload => ctrl(Key::R),
            Command::Save(OutputFormat::Png) => ctrl(Key::S),
            Command::Save(OutputFormat::P6) => ctrl_shift(Key::S),
            Command::Save(OutputFormat::Exr) => ctrl(Key::E),
            Command::CopyPicture => ctrl(Key::C),
            Command::CopyCommand => ctrl_shift(Key::C),
            Command::Quit => ctrl(Key::Q),
            Command::Undo => ctrl(Key::Z),
            Command::Redo => ctrl_shift(Key::Z),
            Command::Home => key(Key::Home),
            Command::AddBookmark => ctrl(Key::B),
            Command::AddSphere => key(Key::Insert),
            Command::DuplicateSphere => ctrl(Key::D),
            Command::DeleteSphere => key(Key::Delete),
            Command::NextSphere => key(Key::Period),
            Command::PreviousSphere => key(Key::Comma),
            Command::Show(show) => {
                let place = Show::ALL.iter().position(|other| *other == show)?;
                ctrl(*DIGITS.get(place)?)
            }
            Command::Wipe => key(Key::C),
            Command::WipeDifference => key(Key::X),
            Command::Slot(command) => command.shortcut(),
            Command::Brighter => key(Key::Plus),
            Command::Darker => key(Key::Minus),
            Command::NoExposure => key(Key::Num0),
            Command::Fit => key(Key::F),
            Command::ActualSize => key(Key::Num1),
            Command::ZoomIn => key(Key::CloseBracket),
            Command::ZoomOut => key(Key::OpenBracket),
            Command::Panels => key(Key::Tab),
            Command::Controls => key(Key::L),
            Command::Info => key(Key::I),
            Command::Plot => key(Key::P),
            Command::Packet => key(Key::N),
            Command::NextPanel => key(Key::F6),
            Command::ListPaths => key(Key::T),
            Command::FullScreen => key(Key::F11),
            Command::NextRay => key(Key::ArrowRight),
            Command::PreviousRay => key(Key::ArrowLeft),
            Command::Pause => key(Key::Space),
            Command::Restart => key(Key::R),
            Command::SwitchDevice => key(Key::G),
            Command::PreviousStage => key(Key::PageUp),
            Command::NextStage => key(Key::PageDown),
            Command::Stages => key(Key::O),
            Command::ShowMe => key(Key::H),
            Command::Present => key(Key::F5),
            Command::Blank => key(Key::B),
            Command::Code => key(Key::K),
            Command::Palette => ctrl(Key::P),
            Command::Help => key(Key::F1),
            _ => None,
        }
    }
}
