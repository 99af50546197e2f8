//! How the window shows what to look for.

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sight {
    pub means: Means,
    /// The part of the picture that fills the window: left, top, right and bottom as shares of width and height, from
    /// the upper left. `None` is the whole picture.
    pub part: Option<[f64; 4]>,
    /// What to see there, in one or two short sentences.
    pub caption: &'static str,
}

/// The tool that makes it visible.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Means {
    Picture,
    Albedo,
    RaysPerPath,
    StandardError,
    /// Luminance in false colours, between these powers of two.
    Luminance([f64; 2]),
    /// A wipe against the stage's pair or, without one, the next stage. The divider stands at this share of the width.
    Wipe(f32),
}
