//! Notices when another program has changed the scene file of the picture, which is opened again then.

use crate::app::model::{Origin, Source};
use crate::app::toolkit::Answers;
use crate::job::recipe::file;
use eframe::egui::Context;
use std::path::PathBuf;
use std::sync::Arc;
use std::thread;
use std::time::{Duration, SystemTime};

const LOOKS_APART: Duration = Duration::from_millis(500);

#[derive(Default)]
pub struct SceneFile {
    /// The origin whose file is watched.
    watched: Option<Arc<Origin>>,
    pub changes: Answers<PathBuf>,
}

impl SceneFile {
    pub fn watch(&mut self, context: &Context, origin: &Arc<Origin>) {
        if self.watched.as_ref().is_some_and(|watched| Arc::ptr_eq(watched, origin)) {
            return;
        }
        // The thread of the file before ends with its slot.
        *self = SceneFile { watched: Some(Arc::clone(origin)), ..SceneFile::default() };
        let Source::File(path) = &origin.source else { return };
        let (path, answer) = (path.clone(), self.changes.answer(context));
        let look = move || {
            let mut inputs = file::inputs(&path);
            let mut known = stamps(&inputs);
            let mut last = known.clone();
            while answer.is_wanted() {
                thread::sleep(LOOKS_APART);
                // A change has settled if it is seen twice.
                let now = stamps(&inputs);
                if now == last && now != known && now[0].is_some() {
                    inputs = file::inputs(&path);
                    known = stamps(&inputs);
                    answer.give(Ok(path.clone()));
                }
                last = now;
            }
        };
        if let Err(error) = thread::Builder::new().name("scene file".to_owned()).spawn(look) {
            log::warn!("changes of the scene file will not be noticed: {error}");
        }
    }
}

/// Lengths and modification times of the file and of the table of spheres that it names. They change with the content;
/// `None` for what is not a regular file.
fn stamps(inputs: &[PathBuf]) -> Vec<Option<(u64, Option<SystemTime>)>> {
    let stamp = |path: &PathBuf| {
        let found = std::fs::metadata(path).ok().filter(std::fs::Metadata::is_file)?;
        Some((found.len(), found.modified().ok()))
    };
    inputs.iter().map(stamp).collect()
}
