//! What a browser needs to run a stage: the shaders, their buffers, the numbers that a reader can change, and the
//! script that runs them.
//!
//! A page opts in with three elements: [`HOST_STYLE`] in `<style>`, [`HOST_SCRIPT`] in `<script type="module">`, and
//! [`live_data`] in `<script type="application/json" id="live-data">`. The script adds a switch to each
//! `.panel[data-stage]`. No server is needed: a page opened from disk may use WebGPU, too.

mod data;
mod sliders;

use crate::stages::Stage;
use anyhow::Result;

/// Plain JavaScript without dependencies.
pub const HOST_SCRIPT: &str = concat!(
    include_str!("../../../assets/web/scene.js"),
    include_str!("../../../assets/web/film.js"),
    include_str!("../../../assets/web/live.js"),
);

/// The style of the script's additions. The page can set the variables `--fg`, `--bg`, `--accent`, `--muted` and
/// `--line`.
pub const HOST_STYLE: &str = include_str!("../../../assets/web/live.css");

/// The stages' data as JSON that is safe inside a `<script>` element. Fails if a stage cannot be rendered.
pub fn live_data<'a>(stages: impl IntoIterator<Item = &'a Stage>) -> Result<String> {
    let json = data::live_data(stages)?.to_string();
    // Only strings contain these characters, and HTML would end the element there or start a comment.
    Ok(json.replace("</", "<\\/").replace("<!--", "\\u003c!--"))
}
