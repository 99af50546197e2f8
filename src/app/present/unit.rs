//! The unit of all sizes.

use eframe::egui::Context;

/// A hundredth of the window's height; less if the window is narrower than a 4:3 screen.
pub fn unit(context: &Context) -> f32 {
    let size = context.content_rect().size();
    (size.y / 100.0).min(size.x / 133.0).max(1.0)
}
