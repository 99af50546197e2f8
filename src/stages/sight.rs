//! What shows the thing to look for.

/// How the thing to look for in a stage is shown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sight {
    pub means: Means,
    /// The part of the picture that fills the window: left, top, right and bottom as shares of width and height, from the
    /// upper left. `None` is the whole picture.
    pub part: Option<[f64; 4]>,
    /// What is then to be seen, in one or two short sentences.
    pub caption: &'static str,
}

/// What makes something visible.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Means {
    Picture,
    Albedo,
    RaysPerPath,
    StandardError,
    /// Luminance in false colours, between these two powers of two.
    Luminance([f64; 2]),
    /// A wipe against the stage's pair, or without one against the next stage. The divider stands at this share of the
    /// picture's width.
    Wipe(f32),
}
