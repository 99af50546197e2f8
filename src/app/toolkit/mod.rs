//! What every part of the window is built of: theme, widgets, menus, messages, textures, and answers from background
//! threads.

pub mod answers;
pub mod finder;
pub mod menu;
pub mod texture;
pub mod theme;
pub mod toasts;
pub mod widgets;
