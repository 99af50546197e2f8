//! The dialog about the program.

use super::outcome::Outcome;
use crate::app::commands::Snapshot;
use crate::app::model::adapter;
use crate::app::toolkit::widgets::{fold, hint, tip};
use crate::system::journal::kept_text;
use eframe::egui::{RichText, ScrollArea, Ui};

const LICENCES: &str = concat!(
    "Weekender is free under the MIT or the Apache 2.0 licence, as you choose. Those of the libraries are in the file \
     LICENSES-OF-LIBRARIES.txt beside the program.\n\n",
    include_str!("../../../LICENSE-MIT")
);

pub(super) fn ui(ui: &mut Ui, snapshot: &Snapshot) -> Outcome {
    ui.heading(version());
    hint(
        ui,
        "The path tracer of Ray Tracing in One Weekend by Peter Shirley, Trevor David Black and Steve Hollasch, as a \
         viewer",
    );
    fold(ui, ["Licences", ""], false, |ui| {
        ScrollArea::vertical().max_height(200.0).show(ui, |ui| ui.label(RichText::new(LICENCES).small()));
    });
    let mut is_closed = false;
    ui.horizontal_wrapped(|ui| {
        let copy = ui.button("Copy for a report");
        let help = "Version, processor, graphics card and log, without names of your files";
        if tip(ui, copy, help, None).clicked() {
            ui.ctx().copy_text(report(snapshot));
        }
        is_closed = ui.button("Close").clicked();
    });
    if is_closed { Outcome::Close } else { Outcome::Stay }
}

fn version() -> String {
    format!("Weekender {}", env!("CARGO_PKG_VERSION"))
}

fn report(snapshot: &Snapshot) -> String {
    let backend = snapshot.status.backend.as_ref();
    let processor =
        backend.map_or_else(|| "unknown".to_owned(), |info| format!("{} {}", info.name, info.device));
    let graphics = adapter().map_or_else(|reason| reason, |adapter| adapter.name.clone());
    // Lines with a path may name the user's files.
    let log: Vec<_> =
        kept_text().lines().filter(|line| !line.contains(['/', '\\'])).map(str::to_owned).collect();
    format!(
        "{}\nsystem     {} {}\ntracer     {processor}\ngraphics   {graphics}\n\nLog:\n{}\n",
        version(),
        std::env::consts::OS,
        std::env::consts::ARCH,
        log.join("\n")
    )
}
