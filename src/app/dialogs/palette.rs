//! Finds a command by what it does: type a few words, then press Enter.

use super::outcome::Outcome;
use crate::app::commands::{Command, PanelContext, ROWS, Snapshot};
use crate::app::toolkit::menu::entry;
use crate::app::toolkit::widgets::{caption, hint};
use crate::app::toolkit::{Finder, rank};
use crate::measure::stress::shown_cases;
use crate::stages::Stage;
use eframe::egui::{Ui, vec2};

/// Suggestions for an empty box.
const USUAL: [Command; 5] =
    [Command::ShowMe, Command::Save, Command::Present, Command::Stages, Command::Help];

/// Fields of the left panel that are found by other words, too.
const FIELDS: [(&str, &str); 4] = [
    ("Sky", "scene colours background light gradient"),
    ("Field of view", "fov angle zoom lens"),
    ("Lens", "defocus angle focus distance blur sharp depth of field dof aperture bokeh"),
    ("Render", "size samples noise grain quality spp resolution pixels stop sampler seed depth"),
];

/// A line of the palette.
struct Found {
    command: Command,
    name: String,
    is_place: bool,
}

/// The matches of a text: commands, then places; best first, unavailable last.
fn found(text: &str, snapshot: &Snapshot) -> Vec<Found> {
    let is_on = |command: &Command| snapshot.disabled_reason(*command).is_none();
    let name = |command| match command {
        Command::Theme(_) => format!("Theme: {}", snapshot.name(command)),
        _ => snapshot.name(command),
    };
    let of = |command, is_place| Found { name: name(command), command, is_place };
    if text.trim().is_empty() {
        return USUAL.into_iter().filter(is_on).map(|command| of(command, false)).collect();
    }
    let has_rays = snapshot.no_rays().is_none();
    let fields = FIELDS.into_iter().filter(|_| has_rays);
    let listed = ROWS.iter().filter(|row| row.is_listed && row.command != Command::Palette);
    let commands = listed
        .map(|row| (row.command, row.synonyms, false))
        .chain(fields.map(|(name, synonyms)| (Command::Field(name), synonyms, false)));
    let stages = Stage::ALL.iter().map(Command::Stage);
    let places = stages
        .chain(shown_cases().iter().map(Command::Extreme))
        .chain(snapshot.recent())
        .chain(snapshot.bookmarks())
        .map(|command| (command, "", true));
    let mut ranked: Vec<_> = commands
        .chain(places)
        .filter_map(|(command, synonyms, is_place)| {
            let found = of(command, is_place);
            let rank = rank(text, &found.name, synonyms, command.help())?;
            let length = if is_place { 0 } else { found.name.len() };
            Some(((is_place, !is_on(&command), rank, length), found))
        })
        .collect();
    ranked.sort_by_key(|(key, _)| *key);
    ranked.into_iter().map(|(_, found)| found).collect()
}

/// Draws the dialog, whose list has at most this height.
pub(super) fn ui(finder: &mut Finder, ui: &mut Ui, height: f32, cx: &PanelContext) -> Outcome {
    ui.set_width(ui.available_width());
    let words = (
        "Command",
        "What do you want to do?",
        "No command is called that. Keys and mouse (F1) lists them all.",
    );
    let (mut was_place, mut hovered) = (false, None);
    let draw = |ui: &mut Ui, Found { command, name, is_place }: &Found, is_chosen| {
        if *is_place && !std::mem::replace(&mut was_place, true) {
            caption(ui, "Stages, scenes, files and bookmarks");
        }
        let response = entry(ui, cx, *command, name, is_chosen);
        if response.hovered() {
            hovered = Some(*command);
        }
        response
    };
    let (found, run) = finder.ui(ui, words, height, |text| found(text, cx), draw);
    about(ui, cx, hovered.or(finder.chosen(&found).map(|found| found.command)));
    match run {
        Some(run) => {
            cx.send(found[run].command);
            Outcome::Close
        }
        None => Outcome::Stay,
    }
}

/// The help of a command, or why it is disabled. It has two lines, so that nothing moves.
fn about(ui: &mut Ui, snapshot: &Snapshot, command: Option<Command>) {
    let text = command.map_or_else(String::new, |command| {
        snapshot.disabled_reason(command).unwrap_or_else(|| command.help().to_owned())
    });
    ui.allocate_ui(vec2(ui.available_width(), 40.0), |ui| {
        ui.set_min_height(40.0);
        hint(ui, &text);
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::Theme;
    use crate::app::tests::snapshot_of;

    #[test]
    fn the_best_match_comes_first() {
        let snapshot = snapshot_of("--stage glass-schlick --size 32x18");
        let first = |text: &str| found(text, &snapshot).first().map(|found| found.command);
        for (text, expected) in [
            ("dark", Command::Theme(Theme::Dark)),
            ("night", Command::Theme(Theme::Dark)),
            ("save", Command::Save),
            ("png", Command::Save),
            ("save as", Command::Save),
            ("new", Command::NewScene),
            ("sky colours", Command::Field("Sky")),
            ("animation", Command::SaveAnimation),
            ("video", Command::SaveAnimation),
            ("turntable", Command::SaveAnimation),
            ("speed", Command::CompareDevices),
            ("blur", Command::Field("Lens")),
            ("dof", Command::Field("Lens")),
            ("fov", Command::Field("Field of view")),
            ("beamer", Command::Present),
            ("homework", Command::CheckPicture),
            ("resolution", Command::Field("Render")),
            ("11.4", Command::Stage(Stage::find("glass-schlick").unwrap())),
        ] {
            assert_eq!(first(text), Some(expected), "{text}");
        }
        assert_eq!(first("xyzzy"), None);
        for text in ["compare", "gpu", "cpu", "factor"] {
            let found = found(text, &snapshot);
            assert!(found.iter().any(|found| found.command == Command::CompareDevices), "{text}");
        }
        for row in ROWS.iter().filter(|row| row.is_listed && row.command != Command::Palette) {
            let found = found(row.name, &snapshot);
            let is_off = snapshot.disabled_reason(row.command).is_some();
            let place = found.iter().position(|found| found.command == row.command);
            assert!(place.is_some_and(|place| is_off || place == 0), "{}: {place:?}", row.name);
        }
        assert!(!found("", &snapshot).is_empty());
    }
}
