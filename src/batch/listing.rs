//! `--list`: scenes, stages, devices.

use crate::backends;
use crate::failure::Failure;
use crate::scene::builtin::BuiltinScene;
use crate::stages::Stage;
use crate::terminal::print;
use std::fmt::Write;
use std::process::ExitCode;

/// Prints the scenes, stages and devices to choose from.
///
/// # Errors
/// [`Failure::Run`] if standard output cannot be written.
pub fn list() -> Result<ExitCode, Failure> {
    print(&text()).map_err(Failure::Run)?;
    Ok(ExitCode::SUCCESS)
}

fn text() -> String {
    let stages = Stage::ALL.iter().map(|stage| stage.id.len());
    let width = stages.chain(BuiltinScene::ALL.iter().map(|scene| scene.name.len())).max().unwrap_or(0);
    let mut lines = vec!["Scenes (--scene)".to_owned()];
    lines.extend(BuiltinScene::ALL.iter().map(|scene| format!("  {:<width$} {}", scene.name, scene.about)));
    lines.extend([String::new(), "Stages (--stage)".to_owned()]);
    lines.extend(
        Stage::ALL
            .iter()
            .map(|stage| format!("  {:<width$} {:>5}  {}", stage.id, stage.section, stage.title)),
    );
    lines.extend([String::new(), "Devices (--device)".to_owned()]);
    for backend in backends::list() {
        let note = if backend.is_auto { " (auto)" } else { "" };
        lines.push(format!("  {:<width$} {}{note}", backend.device, backend.about));
    }
    lines.iter().fold(String::new(), |mut text, line| {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{line}");
        text
    })
}
