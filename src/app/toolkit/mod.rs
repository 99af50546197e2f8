//! What every part of the window is built of: theme, widgets, menus, messages, textures, and answers from background
//! threads.

mod answers;
mod finder;
pub mod menu;
pub mod number;
pub mod overlay;
mod texture;
pub mod theme;
mod toasts;
pub mod widgets;

pub use answers::{Answers, Query, caught};
pub use finder::{Finder, rank};
pub use texture::Texture;
pub use toasts::Toasts;
