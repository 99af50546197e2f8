//! A presentation: full screen, the picture with large captions, no panels.

/// The state of a presentation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Presentation {
    /// The window was in full-screen mode before, and stays in it.
    pub was_full_screen: bool,
    /// Whether titles and texts are shown.
    pub has_captions: bool,
    /// Whether the screen is black.
    pub is_blank: bool,
}
