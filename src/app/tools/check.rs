//! A picture of another program: what is wrong with it, and where.

use super::inspector;
use crate::app::commands::{Command, PanelContext};
use crate::app::model::{Remembered, Tab};
use crate::app::panels::right::scrolling;
use crate::app::panels::stage_panel::paragraph;
use crate::app::toolkit::widgets::{
    About, Header, entry, fold, hint, list, panel_line, primary, small, switch, tip,
};
use crate::app::toolkit::{Answers, Texture, overlay, theme};
use crate::pictures::check::{Answer, AnswerKind, Damage, Mine, judge, pictures};
use crate::stages::Stage;
use eframe::egui::{
    self, Align2, Color32, Label, Rect, RichText, Sense, TextureOptions, Ui, Vec2, WidgetInfo, vec2,
};
use std::path::{Path, PathBuf};

/// A size, and mine, ours and the difference, if the picture could be compared.
type Compared = Option<([u32; 2], [Texture; 3])>;

/// A picture that was checked.
type Checked = (Answer, Compared);

/// The picture in the middle of the window.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
enum Side {
    Yours,
    #[default]
    Wipe,
    Ours,
    Difference,
}

/// The check of a picture, made by a background thread.
#[derive(Default)]
pub struct Check {
    /// The picture that is checked or was checked last.
    path: Option<PathBuf>,
    pub shown: Option<Checked>,
    /// Something is to be shown that was not there before.
    has_news: bool,
    side: Side,
    divider: f32,
    /// The pixel under the pointer, and whether it is one of the user's picture.
    hovered: Option<[u32; 2]>,
    is_over_yours: bool,
    answers: Answers<Checked>,
}

impl Check {
    /// Checks a picture; it is one of `stage` if that is known.
    pub fn begin(&mut self, context: &egui::Context, path: &Path, stage: Option<&'static Stage>) {
        self.close();
        let checked = path.to_owned();
        let work = move || {
            let found = Mine::read(&checked)
                .and_then(|mine| judge(&mine, stage, |_| {}).map(|finding| (mine, finding)));
            let (mine, finding) = match found {
                Ok(found) => found,
                Err(error) => return Ok((Answer::cannot_check(&error), None)),
            };
            let size = [mine.width, mine.height];
            let views = pictures(&mine, &finding).map(|rgb8| Texture::new(size, rgb8.as_flattened(), None));
            Ok((finding.answer(&mine), Some((size, views))))
        };
        self.answers.ask("check", context, work);
        (self.path, self.has_news) = (Some(path.to_owned()), true);
        (self.side, self.divider, self.hovered) = (Side::Wipe, 0.5, None);
    }

    /// Takes the answer, and opens its tab when there is something new in it.
    pub fn follow(&mut self, remembered: &mut Remembered) {
        if let Some(outcome) = self.answers.take() {
            let failed = |reason| (Answer::cannot_check(&anyhow::Error::msg(reason)), None);
            let (answer, pictures) = outcome.unwrap_or_else(failed);
            if let Some(path) = pictures.as_ref().and(self.path.as_ref()) {
                remembered.note_recent(path);
            }
            self.shown = Some((answer, pictures));
            self.has_news = true;
        }
        if std::mem::take(&mut self.has_news) {
            (remembered.has_info, remembered.tab) = (true, Tab::Check);
        }
    }

    /// A description of the checked picture.
    pub fn words(&self) -> Option<String> {
        let (_, pictures) = self.shown.as_ref()?;
        let ([width, height], _) = pictures.as_ref()?;
        Some(format!("Checked {}, {width} × {height} pixels", self.name()))
    }

    /// Whether an answer is shown or awaited.
    pub fn is_open(&self) -> bool {
        self.path.is_some()
    }

    /// Closes the answer. One that is awaited is not shown.
    pub fn close(&mut self) {
        self.answers = Answers::default();
        (self.path, self.shown) = (None, None);
    }

    fn name(&self) -> String {
        let name = self.path.as_deref().and_then(Path::file_name);
        name.map_or_else(String::new, |name| name.display().to_string())
    }

    /// Draws the answer, or that it is awaited.
    pub fn ui(&mut self, ui: &mut Ui, cx: &PanelContext) {
        let name = self.name();
        let Some((answer, pictures)) = &self.shown else {
            scrolling(ui, |ui| {
                hint(ui, &format!("Comparing {name} with every stage and every known mistake…"));
                ui.horizontal(|ui| {
                    if ui.button("Stop").clicked() {
                        self.close();
                    }
                    ui.spinner();
                });
            });
            return;
        };
        let (mut is_again, mut is_closed, mut of_section) = (false, false, None);
        crate::app::panels::right::foot(ui, |ui| {
            ui.horizontal(|ui| {
                ui.set_height(32.0);
                is_again = ui.button("Check again").clicked();
                is_closed = ui.button("Close").clicked();
                if ui.button("Another picture…").clicked() {
                    cx.send(Command::CheckPicture);
                }
            });
            numbers(ui, self.hovered, pictures.as_ref(), self.is_over_yours, self.side);
        });
        scrolling(ui, |ui| {
            verdict(ui, answer);
            if let Some(stage) = answer.stage {
                ui.add_space(4.0);
                let text = format!("Your picture shows stage {} {}.", stage.section, stage.title);
                ui.add(Label::new(RichText::new(text).line_height(Some(20.0))).wrap());
            }
            if let Some(remedy) = &answer.remedy {
                paragraph(ui, "What to change", &format!("{remedy}."));
            }
            for Damage { title, remedy } in &answer.damages {
                paragraph(ui, "The file, too", &format!("{title}: {remedy}."));
            }
            links(ui, answer, cx);
            of_section = section(ui, answer);
            if pictures.is_some() {
                ui.add_space(4.0);
                small(ui, "Compare");
                let sides = [
                    (Side::Yours, About::new("Yours", "Your picture")),
                    (Side::Wipe, About::new("Wipe", "Drag a divider between the two")),
                    (Side::Ours, About::new("Ours", "The same stage by Weekender")),
                    (Side::Difference, About::new("Difference", "Where the two differ, and by how much")),
                ];
                self.side = switch(ui, 0.0, self.side, &sides).unwrap_or(self.side);
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
        if let Some(path) = self.path.clone().filter(|_| is_again || of_section.is_some()) {
            self.begin(ui.ctx(), &path, of_section);
        } else if is_closed {
            self.close();
        }
    }

    /// Draws the two pictures in the middle of the window, in place of the traced one. Returns the room; `None` without pictures.
    pub fn picture(&mut self, ui: &mut Ui) -> Option<Rect> {
        let (answer, pictures) = self.shown.as_ref()?;
        let (pixels, [yours, ours, difference]) = pictures.as_ref()?;
        let room = ui.available_rect_before_wrap();
        let size = vec2(pixels[0] as f32, pixels[1] as f32);
        let scale = ((room.size() - Vec2::splat(16.0)) / size).min_elem().max(0.0);
        let rect = Rect::from_center_size(room.center(), size * scale);
        let response = ui.allocate_rect(room, Sense::drag());
        response.widget_info(|| WidgetInfo::labeled(egui::Role::Image, true, "Your picture and ours"));
        let painter = ui.painter().with_clip_rect(room);
        painter.rect_filled(room, 0, theme::colours(ui).surround);
        let options = if scale < 4.0 { TextureOptions::LINEAR } else { TextureOptions::NEAREST };
        let whole = match self.side {
            Side::Yours => yours,
            Side::Wipe | Side::Ours => ours,
            Side::Difference => difference,
        };
        painter.image(whole.id(ui.ctx(), options), rect, overlay::WHOLE, Color32::WHITE);
        let your_title = format!("Yours: {}", self.name());
        let our_title = match answer.stage {
            Some(stage) => format!("Ours: {} {}", stage.section, stage.title),
            None => "Ours".to_owned(),
        };
        match self.side {
            Side::Wipe => {
                if let Some(pointer) = response.interact_pointer_pos() {
                    self.divider = ((pointer.x - rect.left()) / rect.width()).clamp(0.0, 1.0);
                }
                let left = (yours.id(ui.ctx(), options), rect);
                overlay::wipe(ui, &painter, rect, self.divider, left, [&your_title, &our_title]);
            }
            Side::Yours => overlay::title(ui, &painter, rect, Align2::LEFT_TOP, &your_title),
            Side::Ours => overlay::title(ui, &painter, rect, Align2::RIGHT_TOP, &our_title),
            Side::Difference => {
                let words = format!("Difference: {}", self.name());
                overlay::title(ui, &painter, rect, Align2::LEFT_TOP, &words);
            }
        }
        if let Some(at) = response.hover_pos().filter(|at| rect.contains(*at)) {
            let place = (at - rect.min) / rect.size();
            let pixel = |share: f32, side: u32| ((share * side as f32) as u32).min(side - 1);
            self.hovered = Some([pixel(place.x, pixels[0]), pixel(place.y, pixels[1])]);
            let is_left = self.side == Side::Wipe && place.x < self.divider;
            self.is_over_yours = is_left || self.side == Side::Yours;
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
    side: Side,
) {
    let Some((_, [yours, ours, _])) = pictures else { return };
    let found = at.and_then(|at| Some((at, yours.colour(at)?, ours.colour(at)?)));
    inspector::frame(ui, found.is_some(), |ui| {
        let Some((at, yours, ours)) = found else { return };
        inspector::header(ui, at, None);
        let change = [0, 1, 2].map(|i| format!("{:+}", i32::from(ours[i]) - i32::from(yours[i])));
        let is_difference = side == Side::Difference;
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

/// A list to choose the section in that the picture belongs to. Returns the one that was chosen.
fn section(ui: &mut Ui, answer: &Answer) -> Option<&'static Stage> {
    let mut chosen = None;
    let shown = answer.stage.map_or("unknown", |stage| stage.section);
    let about = About::new("It is of section", "Checks it again as a picture of the section that you choose");
    list(ui, about, shown, |ui| {
        for stage in Stage::walk() {
            let name = format!("{} {}", stage.section, stage.title);
            if entry(ui, answer.stage == Some(stage), About::new(&name, "")) {
                chosen = Some(stage);
            }
        }
    });
    chosen
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

/// Buttons that lead to the section of the mistake, or on.
fn links(ui: &mut Ui, answer: &Answer, cx: &PanelContext) {
    ui.add_space(4.0);
    ui.horizontal_wrapped(|ui| {
        let next = answer.stage.and_then(Stage::next).filter(|_| answer.kind == AnswerKind::Right);
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

    #[test]
    fn files_that_are_not_pictures_get_an_answer() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("notes.txt");
        std::fs::write(&path, "no picture").unwrap();
        let (context, mut check) = (egui::Context::default(), Check::default());
        check.begin(&context, &path, None);
        let mut remembered = Remembered::default();
        check.follow(&mut remembered);
        assert!(check.is_open() && remembered.tab == Tab::Check && check.shown.is_none());
        let checked = check.answers.wait().unwrap();
        check.answers.answer(&context).give(checked);
        check.follow(&mut remembered);
        assert!(remembered.recent.is_empty());
        let (answer, _) = check.shown.as_ref().unwrap();
        assert_eq!(answer.kind, AnswerKind::CannotCheck);
        assert!(answer.explanation.contains("notes.txt"), "{}", answer.explanation);
    }

    #[test]
    fn an_answer_is_about_the_picture_that_was_checked() {
        // The tiny picture of the book, as the first lines of its program print it.
        let [width, height] = [16_u32, 9];
        let share = |at: u32, count: u32| (255.999 * f64::from(at) / f64::from(count - 1)) as u8;
        let pixels = (0..height).flat_map(|y| (0..width).map(move |x| [x, y]));
        let rgb8: Vec<u8> = pixels.flat_map(|[x, y]| [share(x, width), share(y, height), 0]).collect();
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("mine.ppm");
        std::fs::write(&path, [b"P6\n16 9\n255\n".as_slice(), &rgb8].concat()).unwrap();
        let (context, mut check) = (egui::Context::default(), Check::default());
        let stage = Stage::find("ppm-tiny").unwrap();
        check.begin(&context, &path, Some(stage));
        let checked = check.answers.wait().unwrap();
        let (size, views) = checked.as_ref().unwrap().1.as_ref().unwrap();
        assert!(
            *size == [16, 9] && views[0].colour([3, 2]) == Some([rgb8[105], rgb8[106], rgb8[107]]),
            "the first picture is the reader's"
        );
        check.answers.answer(&context).give(checked);
        let mut remembered = Remembered::default();
        check.follow(&mut remembered);
        assert_eq!(remembered.recent, [path]);
        assert_eq!(check.shown.unwrap().0.stage, Some(stage));
    }
}
