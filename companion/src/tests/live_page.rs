//! A page with live figures, in the HTML that the companion has.

use crate::live::live_data;
use std::path::Path;
use std::sync::atomic::AtomicBool;
use weekender::job::render::{RenderJob, Renderer};
use weekender::render_cpu::{CpuOptions, CpuRenderer};
use weekender::stages::{Setup, Stage};

/// The script of live figures.
pub const SCRIPT: &str = concat!(
    include_str!("../../assets/scene.js"),
    include_str!("../../assets/film.js"),
    include_str!("../../assets/live.js"),
);

/// A stage in a smaller picture of fewer samples.
pub fn small(id: &str, [width, height]: [u32; 2], samples_per_pixel: u64) -> Stage {
    let stage = Stage::find(id).unwrap();
    let samples_per_pixel = samples_per_pixel.min(stage.setup.samples_per_pixel);
    Stage { setup: Setup { width, height, samples_per_pixel, ..stage.setup }, ..*stage }
}

/// The job that the page renders of a stage.
pub fn job_of(stage: &Stage) -> RenderJob {
    let recipe = stage.recipe();
    RenderJob::new(recipe.scene, recipe.camera, recipe.settings, recipe.rules).unwrap()
}

/// Writes `index.html` and the stills. Each figure is a caption with one or two stages.
pub fn write(directory: &Path, figures: &[(&str, &[Stage])]) {
    let stages = || figures.iter().flat_map(|(_, stages)| *stages);
    stages().for_each(|stage| write_still(directory, stage));
    let figures: String = figures.iter().map(|(caption, stages)| figure(caption, stages)).collect();
    let (style, script) = (include_str!("../../assets/live.css"), SCRIPT);
    let data = live_data(stages()).unwrap();
    let page = format!(
        r#"<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>Live figures</title>
<link rel="icon" href="data:,">
<style>
:root {{ color-scheme: light dark; }}
.figure {{ margin: 1.5rem 0; }}
.panels {{ display: grid; grid-template-columns: repeat(auto-fit, minmax(min(100%, 20rem), 1fr)); gap: 0.75rem; }}
.panel img {{ width: 100%; height: auto; }}
</style>
<style>
{style}</style>
</head>
<body>
<h1>Live figures</h1>
{figures}<script type="application/json" id="live-data">{data}</script>
<script type="module">
{script}</script>
</body>
</html>
"#
    );
    std::fs::write(directory.join("index.html"), page).unwrap();
}

fn figure(caption: &str, stages: &[Stage]) -> String {
    let panel = |Stage { id, title, setup: Setup { width, height, .. }, .. }: &Stage| {
        format!(
            r#"<div class="panel" data-stage="{id}"><img src="{id}.png" width="{width}" height="{height}" alt="{title}." loading="lazy"></div>"#
        )
    };
    let panels: String = stages.iter().map(panel).collect();
    format!(
        "<figure class=\"figure\"><div class=\"panels\">{panels}</div><figcaption>{caption}</figcaption></figure>\n<p>{}</p>\n",
        "The text continues after the figure. ".repeat(12)
    )
}

fn write_still(directory: &Path, stage: &Stage) {
    let job = job_of(stage);
    let mut film = job.new_film();
    let samples = 0..stage.setup.samples_per_pixel.min(16);
    CpuRenderer::new(CpuOptions::default())
        .unwrap()
        .accumulate(&job, samples, &mut film, &AtomicBool::new(false))
        .unwrap();
    let bytes = film.to_rgb8(job.rules().transfer);
    let file = directory.join(format!("{}.png", stage.id));
    image::save_buffer(file, &bytes, film.width(), film.height(), image::ColorType::Rgb8).unwrap();
}
