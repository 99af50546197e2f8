//! The model of the window: the document, the view, the device, and the remembered settings. It does not depend on
//! widgets or drawing.

pub mod animation;
pub mod changes;
mod checked;
pub mod companion;
pub mod device;
mod document;
mod edit;
mod kept;
pub mod navigation;
mod origin;
mod partner;
mod remembered;
mod show;
mod sizing;
pub mod spheres;
mod state;
mod view;
mod wish;

pub use checked::CheckedScene;
pub use device::{Device, adapter, best_isa};
pub use document::Document;
pub use edit::{Body, Edit, kind_word};
pub use kept::{Kept, KeptList};
pub use origin::{Origin, Source};
pub use partner::Partner;
pub use remembered::{Dock, Remembered, Stored, Tab};
pub use show::{Show, Tone};
pub use sizing::{Sizing, at_other, laid_over, middle_of};
pub use state::{Model, Presentation};
pub use view::{Found, Mode, ViewState};
pub use wish::Wish;
