//! A picture as a texture of the window.

use eframe::egui::{ColorImage, Context, TextureHandle, TextureId, TextureOptions};
use std::cell::RefCell;
use std::sync::Arc;

/// A picture, and its texture once it was drawn.
pub struct Texture {
    image: Arc<ColorImage>,
    handle: RefCell<Option<(TextureHandle, TextureOptions)>>,
}

impl Texture {
    /// Makes it from three bytes per pixel, top row first. The texture of `earlier` is reused.
    pub fn new([width, height]: [u32; 2], rgb8: &[u8], earlier: Option<Texture>) -> Self {
        let image = Arc::new(ColorImage::from_rgb([width as usize, height as usize], rgb8));
        let handle = RefCell::new(earlier.and_then(|earlier| earlier.handle.into_inner()));
        if let Some((handle, options)) = &mut *handle.borrow_mut() {
            handle.set(Arc::clone(&image), *options);
        }
        Texture { image, handle }
    }

    /// Pixels across and down.
    pub fn size(&self) -> [u32; 2] {
        self.image.size.map(|side| side as u32)
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
    pub fn id(&self, context: &Context, options: TextureOptions) -> TextureId {
        match &mut *self.handle.borrow_mut() {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pixel_has_its_colour_and_a_new_picture_the_same_texture() {
        let context = Context::default();
        let first = Texture::new([2, 2], &[1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12], None);
        assert_eq!(
            [[0, 0], [1, 0], [0, 1]].map(|at| first.colour(at)),
            [[1, 2, 3], [4, 5, 6], [7, 8, 9]].map(Some)
        );
        assert_eq!([[2, 0], [0, 2]].map(|at| first.colour(at)), [None; 2]);
        let (square, smooth) = (TextureOptions::NEAREST, TextureOptions::LINEAR);
        let id = first.id(&context, square);
        let known = |id| context.tex_manager().read().meta(id).map(|meta| (meta.size, meta.options));
        assert_eq!(known(id), Some(([2, 2], square)));
        context.tex_manager().write().take_delta().clear();
        assert_eq!(first.id(&context, smooth), id);
        let mut uploaded = context.tex_manager().write().take_delta();
        assert!(
            uploaded
                .set
                .iter()
                .any(|(at, delta)| *at == id && delta.iter().any(|delta| delta.options == smooth)),
            "it is smoothed at once"
        );
        uploaded.clear();
        let second = Texture::new([1, 3], &[0; 9], Some(first));
        assert_eq!(known(id).map(|(size, _)| size), Some([1, 3]), "it is uploaded at once");
        assert_eq!(second.id(&context, smooth), id);
        context.tex_manager().write().take_delta().clear();
    }
}
