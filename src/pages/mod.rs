//! Pages: the gallery, the companion, and figures that render in the browser.

pub mod companion;
pub mod gallery;
pub mod web;
