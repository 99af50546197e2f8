//! Small pictures of what common mistakes look like, rendered as `weekender check` renders them.

use super::directive::typographic;
use super::site::Uses;
use crate::page::gallery::fingerprint;
use crate::pictures::check::{Hypothesis, MISTAKES, Mistake, Studio};
use crate::stages::Stage;
use crate::system::files::replace_file;
use anyhow::{Context, Result};
use image::{ImageFormat, RgbImage};
use maud::{Markup, html};
use std::io::{Cursor, Write as _};
use std::path::Path;

/// Width of the pictures, pixels.
const WIDTH: u32 = 180;

/// Samples per pixel; the plain tracer gets an eighth.
const SAMPLES: u64 = 128;

/// A stage with a mistake or, without one, as it should be.
#[derive(Clone, Debug)]
pub struct Thumbnail {
    stage: &'static Stage,
    mistake: Option<&'static Mistake>,
}

impl Thumbnail {
    fn height(&self) -> u32 {
        WIDTH * self.stage.setup.height / self.stage.setup.width
    }

    /// The name holds the recipe's fingerprint, so a file that exists is up to date.
    fn file(&self) -> String {
        let name = self.mistake.map_or("right", |mistake| mistake.id);
        format!("figures/mistakes/{}-{name}-{:.8}.png", self.stage.id, fingerprint(&self.stage.recipe()))
    }

    /// Renders the picture unless it exists.
    pub fn render(&self, out: &Path) -> Result<()> {
        let path = out.join(self.file());
        if path.exists() {
            return Ok(());
        }
        let size = [WIDTH, self.height()];
        let mut studio = Studio::new(self.stage.recipe(), size)?;
        let recipe = studio.recipe().clone();
        let wrong = self.mistake.and_then(|mistake| mistake.pictures(&recipe).into_iter().next());
        let picture = wrong.unwrap_or_else(|| Hypothesis::right(&recipe));
        let linear = studio.render(&picture, SAMPLES)?;
        let bytes = picture.written.bytes_of(&linear, size).concat();
        let image = RgbImage::from_raw(size[0], size[1], bytes).context("a picture of another size")?;
        let mut png = Cursor::new(Vec::new());
        image.write_to(&mut png, ImageFormat::Png)?;
        Ok(replace_file(&path, |writer| writer.write_all(png.get_ref()))?)
    }
}

/// A row of pictures: the stage as it should be, and with each of these mistakes, whose ids are words.
pub fn strip(stage: &str, ids: &str, uses: &mut Uses) -> Result<Markup> {
    let stage = Stage::find(stage)?;
    let find =
        |id| MISTAKES.iter().find(|mistake| mistake.id == id).with_context(|| format!("no mistake {id:?}"));
    let wrong: Result<Vec<&Mistake>> = ids.split_whitespace().map(find).collect();
    let thumbnails = std::iter::once(None).chain(wrong?.into_iter().map(Some));
    let thumbnails: Vec<Thumbnail> = thumbnails.map(|mistake| Thumbnail { stage, mistake }).collect();
    uses.mistakes.extend(thumbnails.iter().cloned());
    let title = |picture: &Thumbnail| {
        let title = typographic(picture.mistake.map_or("as it should be", |mistake| mistake.title));
        title[..1].to_uppercase() + &title[1..]
    };
    Ok(html! {
        ul .mistakes {
            @for picture in &thumbnails {
                li {
                    img src=(picture.file()) width=(WIDTH) height=(picture.height()) loading="lazy"
                        alt={ (stage.title) ": " (title(picture)) };
                    p { strong { (title(picture)) "." } @if let Some(mistake) = picture.mistake { " Remedy: " (typographic(mistake.remedy)) "." } }
                }
            }
        }
    })
}
