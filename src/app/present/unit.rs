//! The unit of all sizes.

use eframe::egui::Context;

/// A hundredth of the window's height; less if the window is narrower than a 4:3 screen.
pub fn unit(context: &Context) -> f32 {
    let size = context.content_rect().size();
    (size.y / 100.0).min(size.x / 133.0).max(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::tests::part;
    use std::cell::Cell;

    #[test]
    fn a_unit_is_a_hundredth_of_the_height_unless_the_window_is_narrow_or_tiny() {
        for (size, expected) in
            [([1280.0, 720.0], 7.2), ([960.0, 720.0], 7.2), ([665.0, 720.0], 5.0), ([133.0, 90.0], 1.0)]
        {
            let found = Cell::new(0.0);
            drop(part(size, |ui| found.set(unit(ui.ctx()))));
            assert!((found.get() - expected).abs() < 1e-4, "{size:?}: {}", found.get());
        }
    }
}
