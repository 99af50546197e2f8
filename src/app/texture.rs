//! A picture as a texture of the window.

use eframe::egui::{ColorImage, Context, TextureHandle, TextureId, TextureOptions};
use std::sync::Arc;

/// A picture, and its texture once it was drawn.
pub struct Texture {
    image: Arc<ColorImage>,
    handle: Option<(TextureHandle, TextureOptions)>,
}

impl Texture {
    /// Makes it from three bytes per pixel, top row first. The texture of `earlier` is reused.
    pub fn new([width, height]: [u32; 2], rgb8: &[u8], earlier: Option<Texture>) -> Self {
        let image = Arc::new(ColorImage::from_rgb([width as usize, height as usize], rgb8));
        let handle = earlier.and_then(|earlier| earlier.handle).map(|(mut handle, options)| {
            handle.set(Arc::clone(&image), options);
            (handle, options)
        });
        Texture { image, handle }
    }

    /// The colour of a pixel, column and row from the upper left.
    pub fn colour(&self, [x, y]: [u32; 2]) -> Option<[u8; 3]> {
        let [width, height] = self.image.size;
        let (x, y) = (x as usize, y as usize);
        (x < width && y < height).then(|| {
            let [red, green, blue, _] = self.image[(x, y)].to_array();
            [red, green, blue]
        })
    }

    /// The texture for drawing, with square or smoothed pixels.
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
