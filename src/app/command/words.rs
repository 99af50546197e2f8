//! The commands in words.

use super::Command;
use crate::app::model::sizing::Sizing;
use crate::job::output::OutputFormat;

impl Command {
    /// The name in menus and in the palette.
    pub fn name(self) -> String {
        match self {
            Command::Fresh => "Start fresh".into(),
            Command::Open => "Open…".into(),
            Command::Recent(place) => format!("Open recent {}", place + 1),
            Command::Reload => "Reload the scene file".into(),
            Command::Save(OutputFormat::Png) => "Save as PNG…".into(),
            Command::Save(OutputFormat::P6) => "Save as PPM (P6)…".into(),
            Command::Save(OutputFormat::Exr) => "Save film (EXR checkpoint)…".into(),
            Command::SaveScene => "Save scene file…".into(),
            Command::CopyPicture => "Copy picture".into(),
            Command::Crop => "Crop…".into(),
            Command::CopyCrop => "Copy the crop".into(),
            Command::SaveCrop => "Save the crop as PNG…".into(),
            Command::CopyCommand => "Copy as command".into(),
            Command::LoadReference => "Load reference film…".into(),
            Command::ReferenceSize => "Set the picture to the reference's size".into(),
            Command::CopyPlot => "Copy error against time".into(),
            Command::SavePlot => "Save error against time (CSV)…".into(),
            Command::Quit => "Quit".into(),
            Command::Undo => "Undo".into(),
            Command::Redo => "Redo".into(),
            Command::Home => "Camera of the stage".into(),
            Command::ResetAll => "Reset everything".into(),
            Command::ViewFrom(side) => side.name().into(),
            Command::AddBookmark => "Bookmark this camera".into(),
            Command::Bookmark(place) => format!("Go to bookmark {}", place + 1),
            Command::FlyBookmarks => "Fly the bookmarks".into(),
            Command::SaveFlight => "Save the bookmarks as keyframes…".into(),
            Command::Flights => "Smooth flights".into(),
            Command::AddSphere => "Add a sphere".into(),
            Command::DuplicateSphere => "Duplicate the sphere".into(),
            Command::DeleteSphere => "Delete the sphere".into(),
            Command::NextSphere => "Select the next sphere".into(),
            Command::PreviousSphere => "Select the previous sphere".into(),
            Command::Deselect => "Deselect the sphere".into(),
            Command::FocusSphere => "Focus on the sphere".into(),
            Command::LookAtSphere => "Look at the sphere".into(),
            Command::ResetSpheres => "Spheres of the stage".into(),
            Command::Show(show) => format!("Show {}", show.name()),
            Command::Wipe => "Wipe against the other stage".into(),
            Command::WipeDifference => "Difference from the other stage".into(),
            Command::BookArithmetic => "The book's arithmetic".into(),
            Command::Brighter => "Brighter".into(),
            Command::Darker => "Darker".into(),
            Command::NoExposure => "No exposure".into(),
            Command::Fit => "Fit in the window".into(),
            Command::ActualSize => "Actual size (100 %)".into(),
            Command::ZoomIn => "Zoom in".into(),
            Command::ZoomOut => "Zoom out".into(),
            Command::Panels => "Hide or show all panels".into(),
            Command::Controls => "Controls panel".into(),
            Command::Info => "Stage and pixel panel".into(),
            Command::Plot => "Error plot".into(),
            Command::Packet => "Lanes of a packet".into(),
            Command::Gizmo => "Axes in the corner".into(),
            Command::NextPanel => "Next panel".into(),
            Command::ListPaths => "List the paths of this pixel".into(),
            Command::FullScreen => "Full screen".into(),
            Command::NextRay => "Next ray of the path".into(),
            Command::PreviousRay => "Previous ray of the path".into(),
            Command::ClearPaths => "Clear the paths".into(),
            Command::Slot(command) => command.name(),
            Command::Theme(theme) => format!("{} theme", theme.name()),
            Command::Pause => "Pause or go on".into(),
            Command::GoOn => "Go on after the end".into(),
            Command::Restart => "Start again".into(),
            Command::SwitchDevice => "Switch between CPU and GPU".into(),
            Command::Device(device) => format!("Trace on {}", device.label()),
            Command::Size(Sizing::Viewport) => "Size of the viewport".into(),
            Command::Size(Sizing::Book) => "Size in the book".into(),
            Command::PreviousStage => "Previous stage".into(),
            Command::NextStage => "Next stage".into(),
            Command::Stage(stage) => format!("{} {}", stage.section, stage.title),
            Command::Extreme(case) => case.title().to_owned(),
            Command::Stages => "List of stages".into(),
            Command::ShowMe => "Show me what to look for".into(),
            Command::Present => "Present".into(),
            Command::Blank => "Blank the screen".into(),
            Command::Code => "Code of this stage".into(),
            Command::Book => "Read this section of the book".into(),
            Command::Companion => "Read this in the companion".into(),
            Command::Palette => "Command palette".into(),
            Command::Help => "Keyboard and mouse".into(),
            Command::FirstSteps => "First steps".into(),
        }
    }

    /// What the command does, in one sentence.
    pub fn help(self) -> &'static str {
        match self {
            Command::Fresh => "The scene of section 11.5, which is the usual picture, in the usual view",
            Command::Open => {
                "Open a scene file (.toml), or restore the view of a .png, .ppm or .exr that Weekender wrote"
            }
            Command::Save(OutputFormat::Png) => {
                "The picture with 8 bits per channel and a description of how it was made"
            }
            Command::Save(OutputFormat::P6) => "The book's picture format, in its binary form",
            Command::Save(OutputFormat::Exr) => {
                "Linear picture with the exact sums, which can be resumed and merged"
            }
            Command::Recent(_) => "Open a file that was opened or saved before",
            Command::Reload => {
                "After another program has changed it; what you have changed stays, except for spheres"
            }
            Command::SaveScene => "Scene, camera and settings as text",
            Command::CopyPicture => "To the clipboard at full size, with 8 bits per channel as it is saved",
            Command::Crop => {
                "Mark a part of the picture, to copy or save it at the film's pixels; the film stays whole"
            }
            Command::CopyCrop => "The marked part of the picture, to the clipboard with 8 bits per channel",
            Command::SaveCrop => "The marked part of the picture with 8 bits per channel and a description",
            Command::CopyCommand => {
                "The command line that renders this picture; on the CPU it is the same to the bit"
            }
            Command::LoadReference => "Choose a film (.exr) for the difference view",
            Command::ReferenceSize => {
                "Render the picture at the size of the reference film, so that they can be subtracted"
            }
            Command::CopyPlot => "The plot's points as CSV, on the clipboard",
            Command::SavePlot => "The plot's points as CSV: backend, samples, seconds, errors",
            Command::Quit => "Close the window",
            Command::Undo => "Take back the last change",
            Command::Redo => "Make the change again",
            Command::Home => "Reset camera and lens to the stage's values",
            Command::ResetAll => {
                "Reset spheres, camera, lens, settings and stop conditions to the stage's values"
            }
            Command::ViewFrom(_) => "Fly to that side of what the camera looks at; with Shift, jump there",
            Command::AddBookmark => "Save camera and lens to return to later",
            Command::Bookmark(_) => "Fly to a saved camera; with Shift, jump there",
            Command::FlyBookmarks => "From the first one to the last in their order, two seconds each",
            Command::SaveFlight => "A scene file whose animation, with --frames, takes the same path",
            Command::Flights => "Fly to views and bookmarks instead of jumping there",
            Command::AddSphere => "On what is under the pointer, or else in the foreground",
            Command::DuplicateSphere => "A copy beside it, of the same material",
            Command::DeleteSphere => "Remove the selected one from the scene; Undo brings it back",
            Command::NextSphere => "In the order of the scene; after the last one comes the first",
            Command::PreviousSphere => "In the order of the scene; before the first one comes the last",
            Command::Deselect => "Escape does this too, and so does a click on the sky",
            Command::FocusSphere => "Set the focus distance to the nearest point of the selected one",
            Command::LookAtSphere => "Turn the camera, so that the selected one is in the middle",
            Command::ResetSpheres => "Take back all changes to the scene; camera and settings stay",
            Command::Show(show) => show.help(),
            Command::Wipe => "Drag a divider between this stage and its pair or the next stage; same camera",
            Command::WipeDifference => "Where this stage and its pair differ, and by how much",
            Command::BookArithmetic => {
                "Drag a divider between this picture and one made with the book's own quadratic and its smallest \
                 distance of .001"
            }
            Command::Brighter => "Show the picture with half a stop more light; files are saved without it",
            Command::Darker => "Show the picture with half a stop less light; files are saved without it",
            Command::NoExposure => "Show the picture as bright as it is saved",
            Command::Fit => "The whole picture, as large as possible",
            Command::ActualSize => "One pixel of the picture per pixel of the screen",
            Command::ZoomIn => "Make the picture larger; Ctrl and the wheel zoom at the pointer",
            Command::ZoomOut => "Make the picture smaller; Ctrl and the wheel zoom at the pointer",
            Command::Panels => "Nothing but the picture",
            Command::Controls => "Camera, lens, render, stop and output",
            Command::Info => "What the stage shows, and the pixel under the pointer",
            Command::Plot => "Estimated error against seconds",
            Command::Packet => "What each lane does step by step, with and without refill",
            Command::Gizmo => "They turn with the camera; a click on an end looks from that side",
            Command::NextPanel => "Give the keyboard to the controls of another part of the window",
            Command::ListPaths => "What the samples of the pixel under the pointer do, ray by ray",
            Command::FullScreen => "Fill the whole screen with the window",
            Command::NextRay => "Go on along the highlighted path, with the reason for the next direction",
            Command::PreviousRay => "Go back along the highlighted path, towards the camera",
            Command::ClearPaths => "Remove their rays from the picture and their list from the panel",
            Command::Slot(command) => command.help(),
            Command::Theme(_) => "Colours of the window",
            Command::Pause => "Pause or resume tracing; no samples are lost",
            Command::GoOn => "To about half the error, or to twice the samples or seconds; no sample is lost",
            Command::Restart => "Discard all samples and render from the beginning",
            Command::SwitchDevice => "The same picture continues on the other device",
            Command::Device(device) => device.help(),
            Command::Size(Sizing::Viewport) => {
                "Render the largest picture that fits, one of its pixels per pixel of the screen; it has the \
                 aspect ratio of the book's picture, so that both show the same"
            }
            Command::Size(Sizing::Book) => {
                "Render as many pixels as the book does, such as 400x225; a scene that is not in the book has the \
                 size that it defines"
            }
            Command::PreviousStage => "One step back in the book",
            Command::NextStage => "One step forward in the book",
            Command::Stage(stage) => stage.what_is_new,
            Command::Extreme(case) => case.watch.map_or("An extreme scene", |watch| watch.look_for),
            Command::Stages => "Every picture of the book to choose from, with arrow keys and Enter",
            Command::ShowMe => {
                "Sets the zoom, the view or the wipe in which it is seen; again, or Escape, returns"
            }
            Command::Present => "Full screen with large captions, for a lecture; Escape ends it",
            Command::Blank => "Black in a presentation until a key is pressed; the period key does this too",
            Command::Code => "The lines of the tracer that are new in this stage, in Rust and WGSL",
            Command::Book => "Opens the web browser",
            Command::Companion => "Opens the page that \"weekender companion --out companion\" has written",
            Command::Palette => "Find any command by its name",
            Command::Help => "All keys, and what the mouse does",
            Command::FirstSteps => "A card over the picture with three things to try",
        }
    }
}
