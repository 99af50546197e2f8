//! What a browser needs to run a stage: the shaders, the contents of their buffers, the numbers that a reader can
//! change, and the script that runs them.
//!
//! A page takes part by three elements: [`HOST_STYLE`] in `<style>`, [`HOST_SCRIPT`] in `<script type="module">`, and
//! [`live_data`] in `<script type="application/json" id="live-data">`. The script then adds a switch to each
//! `.panel[data-stage]`. It needs no server: a page opened from disk may use WebGPU, too.

mod data;
mod sliders;

use crate::stages::Stage;
use anyhow::Result;

/// The script: plain JavaScript without dependencies.
pub const HOST_SCRIPT: &str = concat!(
    include_str!("../../../assets/web/scene.js"),
    include_str!("../../../assets/web/film.js"),
    include_str!("../../../assets/web/live.js"),
);

/// The style of what the script adds. The page can set the variables `--fg`, `--bg`, `--accent`, `--muted` and `--line`.
pub const HOST_STYLE: &str = include_str!("../../../assets/web/live.css");

/// The data of these stages as JSON that can stand in a `<script>` element.
///
/// # Errors
/// If a stage cannot be rendered.
pub fn live_data<'a>(stages: impl IntoIterator<Item = &'a Stage>) -> Result<String> {
    let json = data::live_data(stages)?.to_string();
    // Only strings contain these characters, and HTML would end the element there or begin a comment.
    Ok(json.replace("</", "<\\/").replace("<!--", "\\u003c!--"))
}
