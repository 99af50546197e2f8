//! The menus.

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
