//! A picture on the window's graphics device.

use eframe::egui::{ColorImage, Context, TextureHandle, TextureId, TextureOptions};
use std::sync::Arc;

/// A picture, and its texture once it has been drawn.
pub struct Texture {
    image: Arc<ColorImage>,
    handle: Option<(TextureHandle, TextureOptions)>,
}

impl Texture {
    /// From three bytes a pixel, top row first. An `earlier` texture is used again.
    pub fn new([width, height]: [u32; 2], rgb8: &[u8], earlier: Option<Texture>) -> Self {
        let image = Arc::new(ColorImage::from_rgb([width as usize, height as usize], rgb8));
        let handle = earlier.and_then(|earlier| earlier.handle).map(|(mut handle, options)| {
            handle.set(Arc::clone(&image), options);
            (handle, options)
        });
        Texture { image, handle }
    }

    /// To be drawn, with pixels as squares or smoothed.
    pub fn id(&mut self, context: &Context, options: TextureOptions) -> TextureId {
        match &mut self.handle {
            Some((handle, old)) => {
                if *old != options {
                    handle.set(Arc::clone(&self.image), options);
                    *old = options;
                }
                handle.id()
            }
            empty => {
                let handle = context.load_texture("picture", Arc::clone(&self.image), options);
                let id = handle.id();
                *empty = Some((handle, options));
                id
            }
        }
    }
}
