//! The check inside the page: the program compiled for browsers, and what the page's script knows of the book.

use anyhow::{Context, Result};
use serde_json::json;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::{env, fs};
use weekender::numbers::heat::{HeatScale, colour_at};
use weekender::stages::Stage;
use weekender::system::files::replace_file;

/// The script that holds the program.
const FILE: &str = "check.js";

/// Most pixels of a picture that a page's memory of 4 GiB can check.
const PIXEL_LIMIT: u32 = 1_300_000;

/// The script in the build folder that this program is in; `assets/package/cross.sh web` makes it.
pub fn find() -> Option<PathBuf> {
    let program = env::current_exe().ok()?;
    program.ancestors().map(|folder| folder.join("cross").join(FILE)).find(|path| path.is_file())
}

/// Copies the script beside the page.
pub fn copy(out: &Path) -> Result<()> {
    let Some(from) = find() else { return Ok(()) };
    let script = fs::read(&from).with_context(|| format!("cannot read {}", from.display()))?;
    Ok(replace_file(&out.join(FILE), |writer| writer.write_all(&script))?)
}

/// Data for the page's script, as JSON that is safe inside a `<script>` element.
pub fn data() -> String {
    let stages: Vec<_> = Stage::ALL.iter().map(|stage| [stage.id, stage.section, stage.title]).collect();
    let scale = HeatScale::DISPLAYED;
    let colours: Vec<[u8; 3]> = (0..=6).map(|step| colour_at(f64::from(step) / 6.0)).collect();
    let labels: Vec<String> = scale.marks().into_iter().map(|(_, label)| label).collect();
    let scale = json!({ "title": scale.title, "colours": colours, "labels": labels });
    let data = json!({ "program": find().map(|_| FILE), "stages": stages, "scale": scale, "pixel_limit": PIXEL_LIMIT });
    data.to_string().replace("</", "<\\/").replace("<!--", "\\u003c!--")
}
