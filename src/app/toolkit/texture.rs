//! A picture as a texture of the window.

use eframe::egui::{ColorImage, Context, TextureHandle, TextureId, TextureOptions};
use std::cell::{Cell, RefCell};
use std::sync::Arc;

/// A picture, and its texture once it was drawn.
pub struct Texture {
    pub image: Arc<ColorImage>,
    handle: RefCell<Option<(TextureHandle, TextureOptions)>>,
    /// The texture still has an earlier picture.
    is_stale: Cell<bool>,
}

impl Texture {
    /// Makes it from three bytes per pixel, top row first. The texture of `earlier` is reused.
    pub fn new([width, height]: [u32; 2], rgb8: &[u8], earlier: Option<Texture>) -> Self {
        let image = Arc::new(ColorImage::from_rgb([width as usize, height as usize], rgb8));
        let handle = RefCell::new(earlier.and_then(|earlier| earlier.handle.into_inner()));
        Texture { image, handle, is_stale: Cell::new(true) }
    }

    /// Pixels across and down.
    pub fn size(&self) -> [u32; 2] {
        self.image.size.map(|side| side as u32)
    }

    /// The texture for drawing, with square or smoothed pixels.
    pub fn id(&self, context: &Context, options: TextureOptions) -> TextureId {
        let mut slot = self.handle.borrow_mut();
        let is_new = self.is_stale.replace(false);
        let is_stale = slot.as_ref().is_some_and(|(_, old)| is_new || *old != options);
        let fitting = || fitting(&self.image, context.input(|input| input.max_texture_side));
        let (handle, old) =
            slot.get_or_insert_with(|| (context.load_texture("picture", fitting(), options), options));
        if is_stale {
            handle.set(fitting(), options);
            *old = options;
        }
        handle.id()
    }
}

/// The picture with sides of at most `limit` pixels: of larger ones, a device shows every second pixel, or fewer.
fn fitting(image: &Arc<ColorImage>, limit: usize) -> Arc<ColorImage> {
    let [across, down] = image.size.map(|side| side.div_ceil(limit));
    if across <= 1 && down <= 1 {
        return Arc::clone(image);
    }
    let rows = image.pixels.chunks(image.width()).step_by(down);
    let pixels = rows.flat_map(|row| row.iter().step_by(across).copied()).collect();
    Arc::new(ColorImage::new([image.width().div_ceil(across), image.height().div_ceil(down)], pixels))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_that_is_too_wide_for_the_device_is_shown_smaller() {
        let context = Context::default();
        let limit = context.input(|input| input.max_texture_side) as u32;
        let rgb8: Vec<u8> = (0..(3 * limit + 1) * 2).flat_map(|at| [at as u8; 3]).collect();
        let wide = Texture::new([3 * limit + 1, 2], &rgb8, None);
        let id = wide.id(&context, TextureOptions::NEAREST);
        let size = context.tex_manager().read().meta(id).map(|meta| meta.size);
        let [width, height] = size.unwrap();
        assert!(width <= limit as usize && width > limit as usize / 2 && height == 2, "{width}");
        assert_eq!(wide.size(), [3 * limit + 1, 2]);
        context.tex_manager().write().take_delta().clear();
    }
}
