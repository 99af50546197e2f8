//! Guarded calls of renderers, which turn panics into errors, and disposal of failed renderers.

use crate::backends::{BackendChoice, close};
use crate::render::{RenderError, Renderer};
use std::panic::{AssertUnwindSafe, catch_unwind};

/// A renderer and what it was made from.
pub(super) type Backend = (BackendChoice, Box<dyn Renderer>);

/// Runs `work`. A panic becomes an error of `backend`. The film is unchanged then, as renderers promise.
pub(super) fn guarded<T>(
    backend: &'static str,
    work: impl FnOnce() -> Result<T, RenderError>,
) -> Result<T, RenderError> {
    catch_unwind(AssertUnwindSafe(work))
        .unwrap_or_else(|payload| Err(RenderError::of_panic(backend, payload.as_ref())))
}

/// Closes a backend that has failed.
pub(super) fn dismiss(backend: Option<Backend>) {
    if backend.is_some() {
        close(backend);
    }
}
