//! What the user does to the viewport in a frame.

use crate::app::model::edit::Edit;
use eframe::egui::Rect;
use glam::DVec3;

/// The input of a frame.
#[derive(Default)]
pub struct Touch {
    /// The user moved the camera.
    pub is_move: bool,
    /// The user would have moved the camera or asked for what is there, but the stage traces no rays.
    pub is_refused: bool,
    /// The user dragged the camera around a point.
    pub is_orbit: bool,
    /// The point of the scene that the move keeps where it is in the picture.
    pub pivot: Option<DVec3>,
    /// The pixel under the pointer.
    pub hovered: Option<[u32; 2]>,
    /// The pixel whose paths the user asked for.
    pub listed: Option<[u32; 2]>,
    /// The sphere that the user selected; the inner `None` stands for no sphere.
    pub select: Option<Option<usize>>,
    /// The divider of a wipe was dragged.
    pub is_divider_moved: bool,
    /// A change to the spheres.
    pub edit: Option<Edit>,
    /// The area of the viewport.
    pub room: Option<Rect>,
}
