//! A picture of another program: what is wrong with it, and where.

use super::inspector;
use crate::app::commands::{Command, PanelContext};
use crate::app::model::{Mode, Remembered, Tab};
use crate::app::panels::right::scrolling;
use crate::app::panels::stage_panel::paragraph;
use crate::app::toolkit::widgets::{
    About, Header, command_button, entry, fold, hint, list, panel_line, primary, small, switch, tip,
};
use crate::app::toolkit::{Answers, Texture, caught, overlay, theme};
use crate::comparison::check::{
    Answer, AnswerKind, Damage, Finding, Mine, POLL_INTERVAL, Watched, judge, pictures,
};
use crate::numbers::heat::HeatScale;
use crate::stages::Stage;
use eframe::egui::text::LayoutJob;
use eframe::egui::{
    self, Align, Align2, Color32, FontSelection, Label, Rect, RichText, Sense, Stroke, StrokeKind,
    TextureOptions, Ui, Vec2, WidgetInfo, vec2,
};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::{Builder, sleep};

/// The finding for one state of the file.
pub struct Checked {
    pub answer: Answer,
    /// Rows of the file so far, and of the picture.
    rows: [u32; 2],
    /// The size, and mine, ours and the difference, if the picture could be compared.
    compared: Option<([u32; 2], [Texture; 3])>,
}

impl Checked {
    fn of(found: anyhow::Result<(Mine, Finding)>) -> Self {
        match found {
            Ok((mine, finding)) => {
                let size = [mine.width, mine.height];
                let views =
                    pictures(&mine, &finding).map(|rgb8| Texture::new(size, rgb8.as_flattened(), None));
                let rows = [mine.rows, mine.height];
                Checked { answer: finding.answer(&mine), rows, compared: Some((size, views)) }
            }
            Err(reason) => Checked { answer: Answer::cannot_check(&reason), rows: [0; 2], compared: None },
        }
    }
}

/// The check of a picture, which a background thread repeats whenever the file has changed.
#[derive(Default)]
pub struct Check {
    /// The picture that is checked.
    path: Option<PathBuf>,
    /// The stage that the user has chosen for it.
    chosen: Option<&'static Stage>,
    /// What is being tried.
    trying: Arc<Mutex<String>>,
    pub shown: Option<Checked>,
    /// Something is to be shown that was not there before.
    has_news: bool,
    /// The picture of the last window was looked for.
    has_resumed: bool,
    /// How the two pictures are shown; ours alone without a mode.
    mode: Option<Mode>,
    divider: f32,
    /// The number of the place that is shown enlarged.
    place: Option<usize>,
    /// The pixel under the pointer, and whether it is one of the user's picture.
    hovered: Option<[u32; 2]>,
    is_over_yours: bool,
    answers: Answers<Checked>,
}

impl Check {
    /// Checks a picture until it is closed; it is one of `stage` if that is known.
    pub fn begin(&mut self, context: &egui::Context, path: &Path, stage: Option<&'static Stage>) {
        self.close();
        let (answer, mut watched) = (self.answers.promise(context), Watched::new(path));
        self.trying = Arc::new(Mutex::new("reading it".to_owned()));
        let (trying, window) = (Arc::clone(&self.trying), context.clone());
        let say = move |what| {
            *trying.lock().unwrap_or_else(PoisonError::into_inner) = what;
            window.request_repaint();
        };
        let watch = move || {
            let outcome = caught(|| {
                while answer.is_wanted() {
                    let found = watched.judged(|mine| judge(mine, stage, &say));
                    if let Some(found) = found {
                        answer.give(Ok(Checked::of(found)));
                    }
                    sleep(POLL_INTERVAL);
                }
            });
            if let Err(reason) = outcome {
                answer.give(Err(reason));
            }
        };
        // Without a thread, the answer is dropped, which gives an error.
        let _ = Builder::new().name("check".to_owned()).spawn(watch);
        (self.path, self.chosen, self.has_news) = (Some(path.to_owned()), stage, true);
        (self.mode, self.divider, self.place, self.hovered) = (Some(Mode::Wipe), 0.5, None, None);
    }

    /// Takes answers, and opens their tab when they are about another picture. Resumes the check of the last window.
    pub fn follow(&mut self, context: &egui::Context, remembered: &mut Remembered) {
        if !std::mem::replace(&mut self.has_resumed, true)
            && self.path.is_none()
            && let Some(path) = remembered.mine.take().filter(|path| path.exists())
        {
            let stage = remembered.mine_stage.as_deref().and_then(|id| Stage::find(id).ok());
            self.begin(context, &path, stage);
            self.has_news = false;
        }
        while let Some(outcome) = self.answers.take() {
            let checked = outcome.unwrap_or_else(|reason| Checked::of(Err(anyhow::Error::msg(reason))));
            let is_first = self.shown.is_none();
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
            (remembered.has_info, remembered.tab) = (true, Tab::Check);
        }
    }

    /// A description of the checked picture.
    pub fn words(&self) -> Option<String> {
        let ([width, height], _) = self.shown.as_ref()?.compared.as_ref()?;
        Some(format!("Checked {}, {width} × {height} pixels", self.name()))
    }

    /// The stage and the size of the checked picture, if the check knows them.
    pub fn found(&self) -> Option<(&'static Stage, [u32; 2])> {
        let Checked { answer, compared, .. } = self.shown.as_ref()?;
        Some((answer.stage?, compared.as_ref()?.0))
    }

    /// Whether an answer is shown or awaited.
    pub fn is_open(&self) -> bool {
        self.path.is_some()
    }

    /// Closes the answer. One that is awaited is not shown.
    pub fn close(&mut self) {
        self.answers = Answers::default();
        (self.path, self.chosen, self.shown) = (None, None, None);
    }

    fn name(&self) -> String {
        let name = self.path.as_deref().and_then(Path::file_name);
        name.map_or_else(String::new, |name| name.display().to_string())
    }

    /// Draws the answer, or that it is awaited.
    pub fn ui(&mut self, ui: &mut Ui, cx: &PanelContext) {
        let name = self.name();
        let Some(Checked { answer, rows: [rows, height], compared }) = &self.shown else {
            scrolling(ui, |ui| {
                let what = self.chosen.map_or("every section", |stage| stage.section);
                hint(ui, &format!("Comparing {name} with {what} and the known mistakes…"));
                let trying = self.trying.lock().unwrap_or_else(PoisonError::into_inner).clone();
                hint(ui, &format!("Now: {trying}."));
                ui.horizontal(|ui| {
                    if ui.button("Stop").clicked() {
                        self.close();
                    }
                    ui.spinner();
                });
            });
            return;
        };
        let (mut is_closed, mut of_section) = (false, None);
        crate::app::panels::right::foot(ui, |ui| {
            ui.horizontal(|ui| {
                ui.set_height(32.0);
                is_closed = ui.button("Close").clicked();
                if ui.button("Another picture…").clicked() {
                    cx.send(Command::CheckPicture);
                }
            });
            numbers(ui, self.hovered, compared.as_ref(), self.is_over_yours, self.mode);
        });
        scrolling(ui, |ui| {
            verdict(ui, answer);
            if rows < height {
                hint(
                    ui,
                    &format!("This is about the first {rows} of {height} rows. The others are awaited."),
                );
            }
            if let Some(remedy) = &answer.remedy {
                change(ui, remedy);
            }
            for Damage { title, remedy } in &answer.damages {
                paragraph(ui, "The file, too", &format!("{title}: {remedy}."));
            }
            links(ui, answer, cx);
            of_section = section(ui, answer, self.chosen);
            hint(ui, &format!("{name} is checked again whenever it changes."));
            if compared.is_some() {
                ui.add_space(4.0);
                small(ui, "Compare");
                let sides = [
                    (Some(Mode::Flip), About::new("Yours", "Your picture")),
                    (Some(Mode::Wipe), About::new("Wipe", "Drag a divider between the two")),
                    (None, About::new("Ours", "The same stage by Weekender")),
                    (
                        Some(Mode::Difference),
                        About::new("Difference", "Where the two differ, and by how much"),
                    ),
                ];
                self.mode = switch(ui, 0.0, self.mode, &sides).unwrap_or(self.mode);
                let next = self.place.map_or(0, |place| (place + 1) % answer.places.len().max(1));
                let words = if self.place.is_none() { "Show where" } else { "Next place" };
                ui.horizontal(|ui| {
                    if !answer.places.is_empty() && ui.button(words).clicked() {
                        (self.place, self.divider) = (Some(next), f32::NAN);
                    }
                    if self.place.is_some() && ui.button("Whole picture").clicked() {
                        (self.place, self.divider) = (None, 0.5);
                    }
                    command_button(ui, cx, Command::CompareMine, "With paths and zoom");
                });
                if answer.evidence.is_empty() {
                    return;
                }
                ui.add_space(8.0);
                panel_line(ui);
                fold(ui, Header { title: "Figures", ..Header::default() }, false, |ui| {
                    for line in &answer.evidence {
                        hint(ui, &format!("{line}."));
                    }
                });
            }
        });
        if let Some((path, stage)) = self.path.clone().zip(of_section) {
            self.begin(ui.ctx(), &path, stage);
        } else if is_closed {
            self.close();
        }
    }

    /// Draws the two pictures in the middle of the window, in place of the traced one. Returns the room; `None` without pictures.
    pub fn picture(&mut self, ui: &mut Ui) -> Option<Rect> {
        let Checked { answer, compared, .. } = self.shown.as_ref()?;
        let (pixels, [yours, ours, difference]) = compared.as_ref()?;
        let room = ui.available_rect_before_wrap();
        let size = vec2(pixels[0] as f32, pixels[1] as f32);
        let fitting = ((room.size() - Vec2::splat(16.0)) / size).min_elem().max(0.0);
        let place = self.place.and_then(|place| answer.places.get(place));
        let share = place.map_or(Vec2::splat(0.5), |[x, y]| vec2(*x as f32, *y as f32) / size);
        let scale = if place.is_some() { (4.0 * fitting).max(8.0) } else { fitting };
        let rect = Rect::from_min_size(room.center() - share * size * scale, size * scale);
        if self.divider.is_nan() {
            self.divider = share.x;
        }
        let response = ui.allocate_rect(room, Sense::drag());
        response.widget_info(|| WidgetInfo::labeled(egui::Role::Image, true, "Your picture and ours"));
        let painter = ui.painter().with_clip_rect(room);
        painter.rect_filled(room, 0, theme::colours(ui).surround);
        let options = if scale < 4.0 { TextureOptions::LINEAR } else { TextureOptions::NEAREST };
        let whole = match self.mode {
            Some(Mode::Flip) => yours,
            Some(Mode::Wipe) | None => ours,
            Some(Mode::Difference) => difference,
        };
        painter.image(whole.id(ui.ctx(), options), rect, overlay::WHOLE, Color32::WHITE);
        let seen = rect.intersect(room);
        let your_title = format!("Yours: {}", self.name());
        let our_title = match answer.stage {
            Some(stage) => format!("Ours: {} {}", stage.section, stage.title),
            None => "Ours".to_owned(),
        };
        match self.mode {
            Some(Mode::Wipe) => {
                if let Some(pointer) = response.interact_pointer_pos() {
                    self.divider = ((pointer.x - rect.left()) / rect.width()).clamp(0.0, 1.0);
                }
                let left = (yours.id(ui.ctx(), options), rect);
                overlay::wipe(ui, &painter, rect, self.divider, left, [&your_title, &our_title]);
            }
            Some(Mode::Flip) => overlay::title(ui, &painter, seen, Align2::LEFT_TOP, &your_title),
            None => overlay::title(ui, &painter, seen, Align2::RIGHT_TOP, &our_title),
            Some(Mode::Difference) => {
                let words = format!("Difference: {}", self.name());
                overlay::title(ui, &painter, seen, Align2::LEFT_TOP, &words);
                overlay::legend(ui, &painter, seen, &HeatScale::DISPLAYED);
            }
        }
        for [x, y] in &answer.places {
            let middle = rect.min + vec2(*x as f32, *y as f32) * scale;
            let mark = Rect::from_center_size(middle, Vec2::splat(10.0 * scale));
            for (width, colour) in [(3.0, Color32::from_black_alpha(140)), (1.0, Color32::WHITE)] {
                painter.rect_stroke(mark, 2.0, Stroke::new(width, colour), StrokeKind::Outside);
            }
        }
        if let Some(at) = response.hover_pos().filter(|at| rect.contains(*at)) {
            let place = (at - rect.min) / rect.size();
            let pixel = |share: f32, side: u32| ((share * side as f32) as u32).min(side - 1);
            self.hovered = Some([pixel(place.x, pixels[0]), pixel(place.y, pixels[1])]);
            let is_left = self.mode == Some(Mode::Wipe) && place.x < self.divider;
            self.is_over_yours = is_left || self.mode == Some(Mode::Flip);
        }
        Some(room)
    }
}

/// The bytes of both pictures under the pointer.
fn numbers(
    ui: &mut Ui,
    at: Option<[u32; 2]>,
    pictures: Option<&([u32; 2], [Texture; 3])>,
    is_yours: bool,
    mode: Option<Mode>,
) {
    let Some((_, [yours, ours, _])) = pictures else { return };
    let found = at.and_then(|at| Some((at, yours.colour(at)?, ours.colour(at)?)));
    inspector::frame(ui, found.is_some(), |ui| {
        let Some((at, yours, ours)) = found else { return };
        inspector::header(ui, at, None);
        let change = [0, 1, 2].map(|i| format!("{:+}", i32::from(ours[i]) - i32::from(yours[i])));
        let is_difference = mode == Some(Mode::Difference);
        let words = |bytes: [u8; 3]| bytes.map(|byte| byte.to_string());
        inspector::table(
            ui,
            &[
                ("yours", "Your picture, 0 to 255".to_owned(), words(yours), is_yours && !is_difference),
                (
                    "ours",
                    "The same stage by Weekender, 0 to 255".to_owned(),
                    words(ours),
                    !is_yours && !is_difference,
                ),
                (
                    "change",
                    "How much brighter ours is".to_owned(),
                    change.map(|n| n.replace('-', "−")),
                    is_difference,
                ),
            ],
        );
    });
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

/// What to change: code stands between backticks, and long code on a line of its own.
fn change(ui: &mut Ui, remedy: &str) {
    const LONG: usize = 16;
    ui.add_space(4.0);
    small(ui, "What to change");
    ui.add_space(-4.0);
    let colours = theme::colours(ui);
    let mut words = LayoutJob::default();
    let parts: Vec<&str> = remedy.split('`').collect();
    let is_long = |index: usize| index % 2 == 1 && parts.get(index).is_some_and(|code| code.len() > LONG);
    for (index, part) in parts.iter().enumerate() {
        let text = match index % 2 {
            1 if is_long(index) => RichText::new(format!("{part}\n")).monospace().color(colours.accent),
            1 => RichText::new(*part).monospace(),
            // A line of code needs no comma after it.
            _ => {
                let before = if index > 0 && is_long(index - 1) {
                    part.trim_start_matches([',', ';', ' '])
                } else {
                    part
                };
                let end = if is_long(index + 1) && !before.is_empty() { "\n" } else { "" };
                RichText::new(format!("{}{end}", if end.is_empty() { before } else { before.trim_end() }))
            }
        };
        let text = text.line_height(Some(20.0));
        text.append_to(&mut words, ui.style(), FontSelection::Default, Align::LEFT);
    }
    ui.add(Label::new(words).wrap());
}

/// Buttons that lead to the section of the mistake, or on.
fn links(ui: &mut Ui, answer: &Answer, cx: &PanelContext) {
    ui.add_space(4.0);
    ui.horizontal_wrapped(|ui| {
        let next = answer.stage.and_then(Stage::next).filter(|_| answer.kind == AnswerKind::Right);
        if let Some(next) = next {
            hint(ui, &format!("Section {} adds: {}.", next.section, next.title));
            if ui.add(primary(format!("Next: {}", next.section))).clicked() {
                cx.send(Command::Stage(next));
            }
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
    fn files_that_are_not_pictures_get_an_answer() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("notes.txt");
        old_file(&path, b"no picture");
        let (mut check, mut remembered) = (Check::default(), Remembered::default());
        check.begin(&egui::Context::default(), &path, None);
        check.follow(&egui::Context::default(), &mut remembered);
        assert!(check.is_open() && remembered.tab == Tab::Check && check.shown.is_none());
        answered(&mut check, &mut remembered);
        assert!(remembered.recent.is_empty());
        let Checked { answer, .. } = check.shown.as_ref().unwrap();
        assert_eq!(answer.kind, AnswerKind::CannotCheck);
        assert!(answer.explanation.contains("notes.txt"), "{}", answer.explanation);
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
        let (size, views) = compared.as_ref().unwrap();
        assert!(
            *size == [16, 9] && views[0].colour([3, 2]) == Some([51, 63, 0]),
            "the first picture is the reader's"
        );
        // The side, the place and the tab stay where they are.
        (check.mode, check.place, remembered.tab) = (Some(Mode::Flip), Some(0), Tab::Code);
        old_file(&path, &tiny(200));
        answered(&mut check, &mut remembered);
        assert_ne!(check.shown.as_ref().unwrap().answer.kind, AnswerKind::Right);
        assert!(check.mode == Some(Mode::Flip) && check.place == Some(0) && remembered.tab == Tab::Code);
        let mut next = Check::default();
        next.follow(&context, &mut remembered);
        assert!(next.is_open() && remembered.tab == Tab::Code);
        next.close();
        next.follow(&context, &mut remembered);
        assert_eq!(remembered.mine, None, "a picture that was closed does not come back");
    }
}
