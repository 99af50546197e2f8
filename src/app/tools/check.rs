//! A picture of another program: what is wrong with it, and where.

use crate::app::commands::{Command, PanelContext};
use crate::app::model::{Kept, Partner, Remembered, Tab, middle_of};
use crate::app::panels::compare;
use crate::app::panels::right::{foot, scrolling};
use crate::app::panels::stage_panel::paragraph;
use crate::app::toolkit::widgets::{
    About, command_button, entry, fold, hint, list, panel_line, primary, small, tip,
};
use crate::app::toolkit::{Answers, caught, theme};
use crate::comparison::check::{Answer, AnswerKind, Damage, Finding, Mine, POLL_INTERVAL, Watched, judge};
use crate::stages::{Stage, Transfer};
use eframe::egui::text::LayoutJob;
use eframe::egui::{self, Align, FontSelection, Label, RichText, Ui};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::{Builder, sleep};

/// The finding for one state of the file.
pub struct Checked {
    pub answer: Answer,
    /// Rows of the file so far, and of the picture.
    rows: [u32; 2],
    /// The picture of the file, if it could be compared with that of its stage.
    compared: Option<(&'static Stage, Arc<Kept>)>,
}

impl Checked {
    fn of(found: anyhow::Result<(Mine, Finding)>, name: String) -> Self {
        match found {
            Ok((mine, finding)) => {
                let (stage, rows) = (finding.stage, [mine.rows, mine.height]);
                let kept = Kept::of_mine(name, &mine, stage.recipe().rules.transfer);
                let compared = kept.ok().map(|kept| (stage, Arc::new(kept)));
                Checked { answer: finding.answer(&mine), rows, compared }
            }
            Err(reason) => Checked { answer: Answer::cannot_check(&reason), rows: [0; 2], compared: None },
        }
    }
}

enum News {
    /// What is being tried; `None` between two checks.
    Trying(Option<String>),
    Read(Arc<Kept>),
    Judged(Box<Checked>),
}

/// The check of a picture, which a background thread repeats whenever the file has changed.
#[derive(Default)]
pub struct Check {
    /// The picture that is checked.
    path: Option<PathBuf>,
    /// The stage that the user has chosen for it.
    chosen: Option<&'static Stage>,
    /// What is being tried; `None` between two checks.
    trying: Option<String>,
    pub shown: Option<Checked>,
    /// The picture of the file as it is now.
    pub mine: Option<Arc<Kept>>,
    /// The finding is about an earlier state of the file.
    is_old: bool,
    /// The user has begun a check.
    has_news: bool,
    /// The picture of the last window was looked for.
    has_resumed: bool,
    /// The number of the place that is shown enlarged.
    pub place: Option<usize>,
    answers: Answers<News>,
    /// Ends the check that is under way.
    stop: Arc<AtomicBool>,
}

impl Check {
    /// Checks a picture until it is closed; it is one of `stage` if that is known.
    pub fn begin(&mut self, context: &egui::Context, path: &Path, stage: Option<&'static Stage>) {
        self.close();
        (self.path, self.chosen, self.has_news) = (Some(path.to_owned()), stage, true);
        let (answer, mut watched) = (self.answers.promise(context), Watched::new(path));
        self.trying = Some("reading it".to_owned());
        let (name, stop) = (self.name(), Arc::clone(&self.stop));
        let watch = move || {
            let say = |what| answer.give(Ok(News::Trying(what)));
            while answer.is_wanted() {
                let found = caught(|| {
                    let found = watched.judged(|mine| {
                        say(Some("the right picture".to_owned()));
                        let transfer = stage.map_or(Transfer::Gamma2, |stage| stage.recipe().rules.transfer);
                        let read = Kept::of_mine(name.clone(), mine, transfer);
                        read.into_iter().for_each(|read| answer.give(Ok(News::Read(Arc::new(read)))));
                        judge(mine, stage, &stop, |what| say(Some(what)))
                    });
                    found.map(|found| Checked::of(found, name.clone()))
                });
                if let Some(found) = found.transpose() {
                    say(None);
                    answer.give(found.map(|found| News::Judged(Box::new(found))));
                }
                sleep(POLL_INTERVAL);
            }
        };
        // Without a thread, the answer is dropped, which gives an error.
        let _ = Builder::new().name("check".to_owned()).spawn(watch);
    }

    /// Takes answers; returns whether there was one. Opens the tab of a check that was begun, and resumes that of the last
    /// window.
    pub fn follow(&mut self, context: &egui::Context, remembered: &mut Remembered) -> bool {
        if !std::mem::replace(&mut self.has_resumed, true)
            && self.path.is_none()
            && let Some(path) = remembered.mine.take().filter(|path| path.exists())
        {
            let stage = remembered.mine_stage.as_deref().and_then(|id| Stage::find(id).ok());
            self.begin(context, &path, stage);
            self.has_news = false;
        }
        let mut is_answered = false;
        while let Some(outcome) = self.answers.take() {
            is_answered |= !matches!(outcome, Ok(News::Trying(_)));
            let checked = match outcome {
                Ok(News::Trying(what)) => {
                    self.trying = what;
                    continue;
                }
                Ok(News::Read(mine)) => {
                    (self.mine, self.is_old) = (Some(mine), true);
                    continue;
                }
                Ok(News::Judged(checked)) => *checked,
                Err(reason) => Checked::of(Err(anyhow::Error::msg(reason)), self.name()),
            };
            (self.mine, self.is_old) = (checked.compared.as_ref().map(|(_, mine)| Arc::clone(mine)), false);
            let is_first = self.found().is_none();
            if let Some(path) = self.path.as_ref().filter(|_| is_first && checked.compared.is_some()) {
                remembered.note_recent(path);
            }
            if let Some(stage) = checked.answer.stage.filter(|_| checked.answer.kind == AnswerKind::Right) {
                remembered.done.insert(stage.id.to_owned());
            }
            self.shown = Some(checked);
        }
        // A path that is not Unicode could not be stored.
        if remembered.mine != self.path {
            remembered.mine = self.path.clone().filter(|path| path.to_str().is_some());
        }
        if remembered.mine_stage.as_deref() != self.chosen.map(|stage| stage.id) {
            remembered.mine_stage = self.chosen.map(|stage| stage.id.to_owned());
        }
        if std::mem::take(&mut self.has_news) {
            (remembered.hides_info, remembered.tab) = (false, Tab::Check);
        }
        is_answered
    }

    /// The stage and the picture that are compared, if the check knows them.
    pub fn found(&self) -> Option<(&'static Stage, &Arc<Kept>)> {
        let (stage, kept) = self.shown.as_ref()?.compared.as_ref()?;
        Some((*stage, kept))
    }

    /// Where the two differ most, if they do.
    pub fn places(&self) -> &[[u32; 2]] {
        self.shown.as_ref().map_or(&[], |shown| &shown.answer.places)
    }

    /// The part of the picture around the next place, as shares of its width and height.
    pub fn next_place(&mut self) -> Option<[f64; 4]> {
        /// From the place to the edges of the part.
        const REACH: f64 = 0.125;
        let next = self.place.map_or(0, |place| (place + 1) % self.places().len().max(1));
        let (at, size) = (*self.places().get(next)?, self.found()?.1.size());
        self.place = Some(next);
        let [x, y] = middle_of(at, size);
        Some([x - REACH, y - REACH, x + REACH, y + REACH])
    }

    /// Whether an answer is shown or awaited.
    pub fn is_open(&self) -> bool {
        self.path.is_some()
    }

    /// Closes the answer. One that is awaited is not shown.
    pub fn close(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        *self = Check { has_resumed: self.has_resumed, ..Check::default() };
    }

    /// The name of the picture; empty without one.
    pub fn name(&self) -> String {
        let name = self.path.as_deref().and_then(Path::file_name);
        name.map_or_else(String::new, |name| name.display().to_string())
    }

    /// Draws the answer, or that it is awaited; `numbers` draws those of the pixel under the pointer.
    pub fn ui(&mut self, ui: &mut Ui, cx: &PanelContext, numbers: impl FnOnce(&mut Ui)) {
        let (mut is_closed, mut of_section) = (false, None);
        foot(ui, |ui| {
            ui.horizontal(|ui| {
                ui.set_height(32.0);
                let word = if self.shown.is_some() { "Close" } else { "Stop" };
                is_closed = ui.button(word).clicked();
                if ui.button("Another picture…").clicked() {
                    cx.send(Command::CheckPicture);
                }
            });
            if self.found().is_some() {
                numbers(ui);
            }
        });
        scrolling(ui, |ui| {
            self.progress(ui);
            if let Some(shown) = &self.shown {
                if self.is_old {
                    ui.multiply_opacity(0.45);
                }
                of_section = shown.ui(ui, cx, self.chosen, self.place);
                if shown.compared.is_some() {
                    hint(ui, &format!("{} is checked again whenever it changes.", self.name()));
                }
            }
        });
        if let Some((path, stage)) = self.path.clone().zip(of_section) {
            self.begin(ui.ctx(), &path, stage);
        } else if is_closed {
            self.close();
        }
    }

    /// What is being tried, also when the picture is checked again.
    fn progress(&self, ui: &mut Ui) {
        let Some(trying) = &self.trying else { return };
        let name = self.name();
        let what = self.chosen.map_or("every section", |stage| stage.section);
        let words = match &self.shown {
            Some(_) => format!("{name} has changed and is checked again. Now: {trying}."),
            None => format!("Comparing {name} with {what} and the known mistakes. Now: {trying}."),
        };
        ui.horizontal_top(|ui| {
            ui.spinner();
            hint(ui, &words);
        });
    }
}

impl Checked {
    /// Draws the answer. Returns the choice of another section; `None` in it looks for the section.
    fn ui(
        &self,
        ui: &mut Ui,
        cx: &PanelContext,
        chosen: Option<&'static Stage>,
        place: Option<usize>,
    ) -> Option<Option<&'static Stage>> {
        let Checked { answer, rows: [rows, height], compared } = self;
        verdict(ui, answer);
        if rows < height {
            hint(ui, &format!("This is about the first {rows} of {height} rows. The others are awaited."));
        }
        if let Some(remedy) = &answer.remedy {
            change(ui, remedy);
        }
        for Damage { title, remedy } in &answer.damages {
            paragraph(ui, "The file, too", &format!("{title}: {remedy}."));
        }
        links(ui, answer, cx);
        if compared.is_some() {
            ui.add_space(4.0);
            small(ui, "Compare");
            if cx.model.view.partner == Partner::Mine {
                compare::verdict(ui, cx);
                compare::tools(ui, cx);
                if !answer.places.is_empty() {
                    ui.horizontal(|ui| {
                        let words = if place.is_none() { "Show where" } else { "Next place" };
                        command_button(ui, cx, Command::NextPlace, words);
                        if place.is_some() {
                            command_button(ui, cx, Command::Fit, "Whole picture");
                        }
                    });
                }
            } else {
                command_button(ui, cx, Command::CompareWith(Partner::Mine), "Show it beside ours");
            }
        }
        let is_picture = answer.kind != AnswerKind::CannotCheck;
        let of_section = if is_picture { section(ui, answer, chosen) } else { None };
        if !answer.evidence.is_empty() {
            ui.add_space(4.0);
            panel_line(ui);
            fold(ui, ["Figures", ""], false, |ui| {
                for line in &answer.evidence {
                    hint(ui, &format!("{line}."));
                }
            });
        }
        of_section
    }
}

/// A list to choose the section in that the picture belongs to. Returns the choice; `None` in it looks for the section.
fn section(ui: &mut Ui, answer: &Answer, chosen: Option<&'static Stage>) -> Option<Option<&'static Stage>> {
    let mut choice = None;
    let shown = match (chosen, answer.stage) {
        (Some(stage), _) => format!("{} {}", stage.section, stage.title),
        (None, Some(stage)) => format!("found: {} {}", stage.section, stage.title),
        (None, None) => "not found".to_owned(),
    };
    let about = About::new("Section", "Checks it as a picture of the section that you choose");
    ui.scope(|ui| {
        ui.spacing_mut().combo_width = ui.available_width() - 64.0;
        list(ui, about, &shown, |ui| {
            if entry(ui, chosen.is_none(), About::new("Find it", "Compares it with all sections")) {
                choice = Some(None);
            }
            for stage in Stage::ALL {
                let name = format!("{} {}", stage.section, stage.title);
                if entry(ui, chosen == Some(stage), About::new(&name, "")) {
                    choice = Some(Some(stage));
                }
            }
        });
    });
    choice
}

/// The verdict, and one sentence.
fn verdict(ui: &mut Ui, answer: &Answer) {
    let colours = theme::colours(ui);
    let color = match answer.kind {
        AnswerKind::Right => colours.good,
        AnswerKind::Mistake | AnswerKind::LikelyMistake | AnswerKind::Unknown => colours.warn,
        AnswerKind::CannotCheck => colours.bad,
    };
    ui.add(Label::new(RichText::new(&answer.title).heading().color(color)).wrap());
    let text = RichText::new(format!("{}.", answer.explanation)).line_height(Some(20.0));
    ui.add(Label::new(text).wrap());
}

/// What to change: code stands between backticks.
fn change(ui: &mut Ui, remedy: &str) {
    ui.add_space(4.0);
    small(ui, "What to change");
    ui.add_space(-4.0);
    let (colours, mut words) = (theme::colours(ui), LayoutJob::default());
    for (index, part) in remedy.split('`').enumerate() {
        let text = RichText::new(part).line_height(Some(20.0));
        let text = if index % 2 == 1 { text.monospace().color(colours.accent) } else { text };
        text.append_to(&mut words, ui.style(), FontSelection::Default, Align::LEFT);
    }
    ui.add(Label::new(words).wrap());
}

/// Buttons that lead to the section of the mistake, or on.
fn links(ui: &mut Ui, answer: &Answer, cx: &PanelContext) {
    ui.add_space(4.0);
    let next = answer.stage.and_then(Stage::next).filter(|_| answer.kind == AnswerKind::Right);
    if let Some(next) = next {
        hint(ui, &format!("Section {} adds: {}.", next.section, next.title));
    }
    ui.horizontal_wrapped(|ui| {
        if let Some(next) = next
            && ui.add(primary(format!("Next: {}", next.section))).clicked()
        {
            cx.send(Command::Stage(next));
        }
        if let Some(section) = &answer.section {
            let stage = section.stage;
            let go = ui.add(primary(format!("Go to {}", stage.section)));
            if tip(ui, go, stage.title, None).clicked() {
                cx.send(Command::Stage(stage));
            }
            let read = ui.button(format!("Read {} in the book", section.number));
            if tip(ui, read, &section.url, None).clicked() {
                ui.open_url(egui::OpenUrl::new_tab(&section.url));
            }
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::{Duration, Instant, SystemTime};

    /// A file that nobody has changed for a minute.
    fn old_file(path: &Path, content: &[u8]) {
        std::fs::write(path, content).unwrap();
        let file = std::fs::File::options().write(true).open(path).unwrap();
        file.set_modified(SystemTime::now() - Duration::from_secs(60)).unwrap();
    }

    fn answered(check: &mut Check, remembered: &mut Remembered) {
        let context = egui::Context::default();
        check.shown = None;
        let begin = Instant::now();
        while check.shown.is_none() && begin.elapsed() < Duration::from_secs(60) {
            check.follow(&context, remembered);
            sleep(Duration::from_millis(5));
        }
    }

    /// The tiny picture of the book, as the first lines of its program print it, with this much blue.
    fn tiny(blue: u8) -> Vec<u8> {
        let [width, height] = [16_u32, 9];
        let share = |at: u32, count: u32| (255.999 * f64::from(at) / f64::from(count - 1)) as u8;
        let pixels = (0..height).flat_map(|y| (0..width).map(move |x| [x, y]));
        let rgb8: Vec<u8> =
            pixels.flat_map(|[x, y]| [share(x, width), share(y, height), blue * u8::from(x > 2)]).collect();
        [b"P6\n16 9\n255\n".as_slice(), &rgb8].concat()
    }

    #[test]
    fn a_changed_picture_is_checked_again() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("mine.ppm");
        old_file(&path, &tiny(0));
        let (context, mut check, mut remembered) =
            (egui::Context::default(), Check::default(), Remembered::default());
        let stage = Stage::find("ppm-tiny").unwrap();
        check.begin(&context, &path, Some(stage));
        answered(&mut check, &mut remembered);
        assert_eq!((&remembered.recent, &remembered.mine), (&vec![path.clone()], &Some(path.clone())));
        assert!(remembered.done.contains("ppm-tiny"));
        let Checked { answer, compared, .. } = check.shown.as_ref().unwrap();
        assert_eq!((answer.stage, answer.kind), (Some(stage), AnswerKind::Right));
        let (of, kept) = compared.as_ref().unwrap();
        assert_eq!((*of, kept.size()), (stage, [16, 9]));
        assert_eq!(kept.film.to_rgb8(kept.transfer), tiny(0)[12..], "its bytes are shown as they are");
        // The place and the tab stay where they are.
        (check.place, remembered.tab) = (Some(0), Tab::Code);
        old_file(&path, &tiny(200));
        answered(&mut check, &mut remembered);
        assert_ne!(check.shown.as_ref().unwrap().answer.kind, AnswerKind::Right);
        assert!(check.place == Some(0) && remembered.tab == Tab::Code);
        let mut next = Check::default();
        next.follow(&context, &mut remembered);
        assert!(next.is_open() && remembered.tab == Tab::Code);
        next.close();
        next.follow(&context, &mut remembered);
        assert_eq!(remembered.mine, None, "a picture that was closed does not come back");
    }
}
