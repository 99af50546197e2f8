//! All commands that the user can give. Menus, buttons, shortcuts, the palette and the help are generated from this.

mod group;
mod keys;
mod menus;
mod shortcut;
mod slots;
mod words;

pub use group::Group;
pub use slots::SlotCommand;

use super::model::device::Device;
use super::model::remembered::Theme;
use super::model::show::Show;
use super::model::sizing::Sizing;
use super::model::viewpoint::Viewpoint;
use crate::job::output::OutputFormat;
use crate::measure::stress::{Case, shown_cases};
use crate::stages::Stage;

/// A command that the user can give.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Command {
    /// Show the usual first picture.
    Fresh,
    /// Open a picture, film or scene.
    Open,
    /// Open this file of those opened or saved last, counted from 0.
    Recent(usize),
    /// Read the scene file again.
    Reload,
    /// Save the picture, in this format.
    Save(OutputFormat),
    /// Save the scene file.
    SaveScene,
    /// Copy the picture to the clipboard.
    CopyPicture,
    /// Mark a part of the picture to copy or save, or stop that.
    Crop,
    /// Copy the marked part of the picture.
    CopyCrop,
    /// Save the marked part of the picture.
    SaveCrop,
    /// Copy the command line to the clipboard.
    CopyCommand,
    /// Load a film to compare with.
    LoadReference,
    /// Give the picture the size of the film to compare with.
    ReferenceSize,
    /// Copy the plot's points to the clipboard.
    CopyPlot,
    /// Save the plot's points.
    SavePlot,
    /// Close the window.
    Quit,
    /// Undo a change.
    Undo,
    /// Redo the change that was undone last.
    Redo,
    /// Reset the camera to that of the stage.
    Home,
    /// Reset everything to the values of the stage.
    ResetAll,
    /// Look at the same point from this side.
    ViewFrom(Viewpoint),
    /// Add a bookmark of the camera.
    AddBookmark,
    /// Go to this bookmark, counted from 0.
    Bookmark(usize),
    /// Fly from the first bookmark to the last.
    FlyBookmarks,
    /// Save the scene with the bookmarks as keyframes of an animation.
    SaveFlight,
    /// Fly to views and bookmarks, or jump there.
    Flights,
    /// Add a sphere where the pointer is.
    AddSphere,
    /// Add a copy of the selected sphere.
    DuplicateSphere,
    /// Delete the selected sphere.
    DeleteSphere,
    /// Select the next sphere of the scene.
    NextSphere,
    /// Select the previous sphere of the scene.
    PreviousSphere,
    /// Select no sphere.
    Deselect,
    /// Focus the lens on the selected sphere.
    FocusSphere,
    /// Turn the camera to the selected sphere.
    LookAtSphere,
    /// Reset the spheres to those of the stage.
    ResetSpheres,
    /// Show a view of the picture.
    Show(Show),
    /// Compare this stage with another one on both sides of a divider.
    Wipe,
    /// Show a heat map of the difference from the other stage.
    WipeDifference,
    /// Compare the picture with the same picture by the book's own arithmetic.
    BookArithmetic,
    /// Show the picture brighter.
    Brighter,
    /// Show the picture darker.
    Darker,
    /// Show the picture as bright as it is saved.
    NoExposure,
    /// Zoom so that the whole picture fits.
    Fit,
    /// Zoom so that one pixel of the picture is one pixel of the screen.
    ActualSize,
    /// Zoom in around the middle.
    ZoomIn,
    /// Zoom out around the middle.
    ZoomOut,
    /// Give the keyboard focus to the next panel.
    NextPanel,
    /// List the paths of the pixel under the pointer.
    ListPaths,
    /// Remove the listed paths from the picture.
    ClearPaths,
    /// Show or hide all panels.
    Panels,
    /// Show or hide the left panel.
    Controls,
    /// Show or hide the right panel.
    Info,
    /// Show or hide the plot.
    Plot,
    /// Show or hide the steps of a packet's lanes.
    Packet,
    /// Show or hide the axes in the corner.
    Gizmo,
    /// Full screen.
    FullScreen,
    /// Explain the next ray of the highlighted path.
    NextRay,
    /// Explain the previous ray of the highlighted path.
    PreviousRay,
    /// A command for slots.
    Slot(SlotCommand),
    /// Use this colour theme.
    Theme(Theme),
    /// Pause or continue.
    Pause,
    /// Go on after the end, to a lower error or more samples.
    GoOn,
    /// Render again from the beginning.
    Restart,
    /// Switch between CPU and GPU.
    SwitchDevice,
    /// Render with this device.
    Device(Device),
    /// Render at the size of the viewport or the book.
    Size(Sizing),
    /// Go to the previous stage.
    PreviousStage,
    /// Go to the next stage.
    NextStage,
    /// Go to this stage.
    Stage(&'static Stage),
    /// Open this extreme scene.
    Extreme(&'static Case),
    /// Show or hide the code that is new in the stage.
    Code,
    /// Open the book's web page.
    Book,
    /// Open the page that accompanies the book.
    Companion,
    /// Open the palette, which lists all commands.
    Palette,
    /// Show the list of stages.
    Stages,
    /// Show what there is to look for in the stage, or return from it.
    ShowMe,
    /// Begin or end a presentation.
    Present,
    /// Blank the screen of a presentation, or show it again.
    Blank,
    /// Show the keys and mouse actions.
    Help,
    /// Show or close the card with the first steps.
    FirstSteps,
}

impl Command {
    /// All commands, in the order of the menus, except those for bookmarks and for the files opened or saved last.
    pub fn all() -> Vec<Command> {
        use Command::*;
        let mut all = vec![
            Fresh,
            Open,
            Reload,
            Save(OutputFormat::Png),
            Save(OutputFormat::P6),
            Save(OutputFormat::Exr),
        ];
        all.extend([
            SaveScene,
            CopyPicture,
            Crop,
            CopyCrop,
            SaveCrop,
            CopyCommand,
            LoadReference,
            ReferenceSize,
            CopyPlot,
            SavePlot,
            Quit,
        ]);
        all.extend([Undo, Redo, ResetAll, Home]);
        all.extend(self::Viewpoint::ALL.map(ViewFrom));
        all.extend([AddBookmark, FlyBookmarks, SaveFlight, Flights]);
        all.extend([AddSphere, DuplicateSphere, DeleteSphere, NextSphere, PreviousSphere, Deselect]);
        all.extend([FocusSphere, LookAtSphere, ResetSpheres]);
        all.extend(self::Show::ALL.map(Show));
        all.extend([Wipe, WipeDifference, Brighter, Darker, NoExposure, Fit, ActualSize, ZoomIn, ZoomOut]);
        all.extend([
            ListPaths,
            NextRay,
            PreviousRay,
            ClearPaths,
            Panels,
            Controls,
            Info,
            Plot,
            Packet,
            Gizmo,
            NextPanel,
            FullScreen,
            Present,
            Blank,
        ]);
        all.extend(self::Theme::ALL.map(Theme));
        all.extend(SlotCommand::all().into_iter().map(Slot));
        all.extend([Pause, GoOn, Restart, SwitchDevice]);
        all.extend(self::Device::ALL.map(Device));
        all.extend(self::Sizing::ALL.map(Size));
        all.extend([PreviousStage, NextStage, Stages, ShowMe, Code, Book, Companion]);
        all.extend(crate::stages::Stage::ALL.iter().map(Stage));
        all.push(BookArithmetic);
        all.extend(shown_cases().iter().map(Extreme));
        all.extend([Palette, Help, FirstSteps]);
        all
    }

    /// Whether the command opens a dialog first.
    pub fn opens_dialog(self) -> bool {
        use Command::{Help, LoadReference, Open, Palette, Save, SaveCrop, SaveFlight, SavePlot, SaveScene};
        matches!(
            self,
            Open | Save(_) | SaveCrop | SaveScene | SaveFlight | SavePlot | LoadReference | Palette | Help
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use eframe::egui::{Key, Modifiers};
    use std::collections::HashSet;

    #[test]
    fn shortcuts_and_names_are_unique() {
        let all = Command::all();
        let names: HashSet<String> = all.iter().map(|command| command.name()).collect();
        assert_eq!(names.len(), all.len());
        let shortcuts: Vec<_> = all.iter().filter_map(|command| command.shortcut()).collect();
        for (index, shortcut) in shortcuts.iter().enumerate() {
            assert!(!shortcuts[..index].contains(shortcut), "{shortcut:?}");
        }
    }

    #[test]
    fn no_shortcut_is_a_flying_key() {
        let flying = [Key::W, Key::A, Key::S, Key::D, Key::Q, Key::E].map(|key| (Modifiers::NONE, key));
        for shortcut in Command::all().into_iter().filter_map(Command::shortcut) {
            assert!(!flying.contains(&(shortcut.modifiers, shortcut.logical_key)));
        }
    }

    #[test]
    fn help_says_more_than_the_name() {
        let words = |text: &str| -> HashSet<String> {
            text.split(|c: char| !c.is_alphanumeric())
                .filter(|word| !word.is_empty())
                .map(str::to_lowercase)
                .collect()
        };
        for command in Command::all() {
            let (name, help) = (command.name(), command.help());
            let new = words(help).difference(&words(&name)).count();
            assert!(new >= 2, "{name:?} is explained by {help:?}");
            assert!(help.starts_with(char::is_uppercase) || help.starts_with(char::is_numeric), "{help:?}");
            // Commands of the same kind, such as themes, may share a help text.
            let is_other = |other: &Command| {
                std::mem::discriminant(other) != std::mem::discriminant(&command) && other.help() == help
            };
            let other = Command::all().into_iter().find(is_other).map(|other| other.name());
            assert_eq!(other, None, "explained as {name:?} is");
        }
    }
}
