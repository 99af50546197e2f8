//! A thread that reads kept pictures.

use super::folder::Folder;
use crate::app::answers::{Answers, caught};
use crate::app::model::document::Document;
use crate::app::model::kept::Kept;
use crate::render_cpu::give_way;
use eframe::egui::Context;
use std::io;

/// A kept picture that was read.
pub struct Arrival {
    /// [`Kept::id`].
    pub id: String,
    /// The picture, or why it cannot be read.
    pub outcome: Result<Kept, String>,
}

/// Reads kept pictures.
#[derive(Default)]
pub struct SlotReader {
    arrivals: Answers<Arrival>,
}

impl SlotReader {
    /// Reads these pictures in this order. `live` shares its scene with them where they are equal.
    ///
    /// # Errors
    /// If the system cannot start a thread.
    pub fn read(
        &self,
        context: &Context,
        folder: Folder,
        ids: Vec<String>,
        live: Document,
    ) -> io::Result<()> {
        let answers: Vec<_> = ids.into_iter().map(|id| (id, self.arrivals.answer(context))).collect();
        std::thread::Builder::new().name("slot files".to_owned()).spawn(move || {
            give_way();
            let mut known = vec![live];
            for (id, answer) in answers {
                let outcome = caught(|| folder.read(&id, &known)).unwrap_or_else(Err);
                known.extend(outcome.as_ref().ok().map(|kept| kept.document.clone()));
                answer.give(Arrival { id, outcome });
            }
        })?;
        Ok(())
    }

    /// The oldest picture that has not been taken yet.
    pub fn take(&self) -> Option<Arrival> {
        self.arrivals.take()
    }
}
