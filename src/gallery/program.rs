//! `weekender gallery`: all figures in a directory, with a page that shows them.

use super::page::page;
use super::progress::StillProgress;
use super::rendering::{self, Event, Order, Outcome};
use super::{Figure, Quality, Still};
use crate::cli::GalleryOptions;
use crate::console;
use crate::describe::{counted, seconds};
use crate::failure::Failure;
use crate::files::{check_page, write_text};
use crate::interrupt::Interrupt;
use crate::stages::Stage;
use crate::suggest::similar_names;
use crate::terminal::print;
use std::fs;
use std::process::ExitCode;
use std::time::Instant;
use thiserror::Error;

/// Renders what is missing of the gallery, and writes its page.
///
/// # Errors
/// [`Failure::Input`] if nothing was rendered, [`Failure::BrokeOff`] or [`Failure::Run`] otherwise.
pub fn run(options: &GalleryOptions) -> Result<ExitCode, Failure> {
    let stages = chosen(&options.only).map_err(Failure::input)?;
    let interrupt = Interrupt::install().map_err(Failure::Run)?;
    let begin = Instant::now();
    let order = Order {
        directory: &options.out,
        stages: &stages,
        quality: if options.quick { Quality::Quick } else { Quality::Full },
        backend: &options.backend,
    };
    let index = options.out.join("index.html");
    if options.out.is_dir() {
        check_page(&index).map_err(Failure::input)?;
    }
    let mut progress = StillProgress::new(options.progress);
    let mut printed = Ok(());
    let outcome = rendering::render(&order, &interrupt, |event| {
        progress.tell(&event);
        if let (Event::Finished(still), Ok(())) = (&event, &printed) {
            printed = progress.above(|| print(&line(still)));
        }
    });
    progress.finish();
    let Outcome { stills, rendered, kept, missing } = outcome?;
    let page = page(&stills);
    // An unchanged page keeps its date.
    if fs::read_to_string(&index).ok().as_ref() != Some(&page) {
        write_text(&index, &page).map_err(Failure::run)?;
    }
    printed.map_err(Failure::Run)?;
    if missing > 0 {
        console::note(&format!(
            "interrupted: {} missing; run the same command again to go on",
            counted(missing as u64, "picture")
        ));
        return Ok(interrupt.exit_code());
    }
    let took = seconds(begin.elapsed().as_secs_f64());
    let words = format!("{} rendered in {took}, {kept} unchanged", counted(rendered as u64, "picture"));
    print(&format!("{words}\nopen {}\n", index.display())).map_err(Failure::Run)?;
    Ok(ExitCode::SUCCESS)
}

/// A finished still on one line.
fn line(still: &Still) -> String {
    let size = format!("{}x{}", still.width, still.height);
    format!(
        "{:<18} {size:>9}, {:>4} spp, {:>15}, {}\n",
        still.stage,
        still.samples_per_pixel,
        still.time_words(),
        still.error_words()
    )
}

/// The stages of these ids of figures or stages, in the book's order; all stages if there are none.
fn chosen(ids: &[String]) -> Result<Vec<&'static Stage>, UnknownPicture> {
    let mut stages: Vec<&'static Stage> = Vec::new();
    for id in ids {
        match (Figure::find(id), Stage::find(id)) {
            (Ok(figure), stage) => {
                stages.extend(figure.panels.iter().map(|panel| panel.stage));
                stages.extend(stage.ok());
            }
            (Err(_), Ok(stage)) => stages.push(stage),
            (Err(_), Err(_)) => return Err(UnknownPicture::new(id)),
        }
    }
    let is_chosen = |stage: &&Stage| ids.is_empty() || stages.contains(stage);
    Ok(Stage::ALL.iter().filter(is_chosen).collect())
}

/// No figure and no stage has this id.
#[derive(Debug, Error)]
#[error("--only names {id:?}, which is neither a figure nor a stage; {}", remedy(near))]
struct UnknownPicture {
    id: String,
    near: Vec<&'static str>,
}

impl UnknownPicture {
    fn new(id: &str) -> Self {
        let figures = Figure::ALL.iter().map(|figure| figure.id);
        let stages = Stage::ALL.iter().map(|stage| stage.id);
        let mut near = similar_names(id, figures.chain(stages));
        near.dedup();
        UnknownPicture { id: id.to_owned(), near }
    }
}

fn remedy(near: &[&str]) -> String {
    match near {
        [] => "weekender --list shows the stages".to_owned(),
        near => format!("did you mean {}?", near.join(" or ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_and_stages_can_be_chosen() {
        let ids = |only: &[&str]| {
            let only: Vec<String> = only.iter().map(|id| (*id).to_owned()).collect();
            chosen(&only).map(|stages| stages.iter().map(|stage| stage.id).collect::<Vec<_>>())
        };
        assert_eq!(ids(&[]).unwrap().len(), Stage::ALL.len());
        assert_eq!(ids(&["book", "fuzz", "metal"]).unwrap(), ["metal", "metal-fuzzy", "book"]);
        assert_eq!(ids(&["aliased"]).unwrap(), ["aliased"]);
        let told = ids(&["hollow"]).unwrap_err().to_string();
        assert_eq!(
            told,
            "--only names \"hollow\", which is neither a figure nor a stage; did you mean hollow-glass?"
        );
        assert!(ids(&["quux-corge"]).unwrap_err().to_string().ends_with("weekender --list shows the stages"));
    }

    #[test]
    fn a_finished_still_is_told_on_one_line() {
        let stage = Stage::find("metal").unwrap();
        let mut still = Still::new(stage, &Quality::Full.recipe(stage), String::new());
        still.trace_seconds = 2.5;
        assert_eq!(line(&still), "metal                880x495, 1024 spp,           2.5 s, no noise\n");
    }
}
