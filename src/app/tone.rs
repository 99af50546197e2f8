//! Exposure, the range of the luminance view, and the histogram.

use super::answers::Answers;
use super::facts::Facts;
use super::kept::{FilmId, Subject};
use super::model::show::Show;
use super::model::tone::Tone;
use super::model::view::{Mode, ViewState};
use super::theme;
use super::tips;
use super::widgets::{About, FIELD, Number, above, compact};
use crate::film::Histogram;
use eframe::egui::{
    self, Align2, Color32, Pos2, Rect, RichText, Sense, Shape, Stroke, TextStyle, Ui, WidgetInfo, pos2, vec2,
};
use std::sync::{Arc, Weak};
use std::time::{Duration, Instant};

/// Height of the histogram in points.
const HEIGHT: f32 = 84.0;

/// Time between two histograms of a picture that refines: counting takes the tracer's time.
const INTERVAL: Duration = Duration::from_millis(500);

/// The channels' colours, on light and on dark panels.
const CHANNELS: [Color32; 3] =
    [Color32::from_rgb(226, 80, 70), Color32::from_rgb(66, 168, 84), Color32::from_rgb(72, 128, 236)];

/// The histogram on the screen.
#[derive(Default)]
pub struct ToneUi {
    is_open: bool,
    histogram: Option<Histogram>,
    /// Film, samples and white of the last query, and when it was made.
    asked: Option<(FilmId, u64, f64, Instant)>,
    /// Can be upgraded as long as the query waits for the film.
    waiting: Weak<()>,
    answers: Answers<Histogram>,
}

impl ToneUi {
    /// Takes the film's answer, and asks again if the picture has changed.
    pub fn follow(&mut self, subject: &Subject<'_>, white: f64, context: &egui::Context) {
        while let Some(histogram) = self.answers.take() {
            self.histogram = Some(histogram);
        }
        let (film, samples) = (subject.film_id(), subject.samples());
        if !self.is_open || !subject.has_samples() || self.waiting.strong_count() > 0 {
            return;
        }
        if let Some((asked_film, asked_samples, asked_white, at)) = self.asked {
            let is_same_picture = asked_film == film && asked_white == white;
            let wait = INTERVAL.saturating_sub(at.elapsed());
            if is_same_picture && asked_samples == samples {
                return;
            }
            if is_same_picture && wait > Duration::ZERO {
                context.request_repaint_after(wait);
                return;
            }
        }
        let question = Arc::new(());
        self.waiting = Arc::downgrade(&question);
        self.asked = Some((film, samples, white, Instant::now()));
        let answer = self.answers.answer(context);
        subject.inspect(move |film| {
            let histogram = Histogram::of(film, white);
            // Dropped first: the answer wakes a frame, which may ask the next question.
            drop(question);
            answer.give(histogram);
        });
    }

    /// Draws the controls of the current view, and the histogram.
    pub fn ui(&mut self, ui: &mut Ui, view: &mut ViewState, facts: &Facts) {
        let is_difference = view.mode() == Some(Mode::Difference);
        if view.show() == Show::Picture && !is_difference {
            exposure_ui(ui, &mut view.tone);
        } else if view.show() == Show::Luminance {
            range_ui(ui, &mut view.tone);
        }
        let header = egui::CollapsingHeader::new(RichText::new("Histogram").small())
            .id_salt("histogram")
            .show_unindented(ui, |ui| match &self.histogram {
                Some(histogram) => paint(ui, histogram, view.tone.exposure),
                None => {
                    let text = if facts.is_working() { "Counting…" } else { "No samples yet" };
                    ui.label(RichText::new(text).color(ui.visuals().weak_text_color()));
                }
            });
        tips::beside(ui, header.header_response, "How often each brightness occurs, red, green and blue");
        self.is_open = header.openness > 0.0;
        ui.add_space(4.0);
    }
}

fn exposure_ui(ui: &mut Ui, tone: &mut Tone) {
    let about = About::new(
        "Exposure",
        "Shows the picture brighter or darker, in stops: each stop doubles the light (keys + and -, 0 for none). \
         It changes only what you see; files are saved without it",
    );
    Number::new(about, Tone::EXPOSURES).speed(0.02).slider(ui, &mut tone.exposure, Tone::EXPOSURES, false);
}

fn range_ui(ui: &mut Ui, tone: &mut Tone) {
    let about = About::new(
        "Range of luminances",
        "The luminances at the two ends of the colours, as powers of two: 0 is white, -1 half as much",
    );
    above(ui, about);
    ui.horizontal(|ui| {
        let before = tone.range;
        let [low, high] = &mut tone.range;
        let field = |name| Number::new(About { name, ..about }, Tone::RANGES).speed(0.1);
        field("Darkest luminance, power of two").field(ui, FIELD, low);
        ui.label("to");
        field("Brightest luminance, power of two").field(ui, FIELD, high);
        ui.label("stops");
        tone.mend_range(before);
    });
}

/// Draws the counts, with a line at the radiance that is shown as white.
fn paint(ui: &mut Ui, histogram: &Histogram, exposure: f64) {
    let (whole, response) = ui.allocate_exact_size(vec2(ui.available_width(), HEIGHT), Sense::hover());
    let share = 100.0 * f64::from(histogram.clipped) / f64::from(histogram.pixels.max(1));
    let words = format!("{share:.1} % of pixels clipped; largest value {}", compact(histogram.largest));
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Image, true, format!("Histogram: {words}")));
    let font = TextStyle::Small.resolve(ui.style());
    let area = Rect { max: pos2(whole.right(), whole.bottom() - font.size - 3.0), ..whole };
    let painter = ui.painter().with_clip_rect(whole.intersect(ui.clip_rect()));
    painter.rect_filled(area, 3.0, theme::surround(ui));
    let [low, high] = Histogram::STOPS;
    let across = |stops: f64| area.left() + ((stops - low) / (high - low)) as f32 * area.width();
    // The outer bins also hold everything beyond, such as black, and would dwarf the others.
    let inner = histogram.bins.iter().flat_map(|bins| &bins[1..bins.len() - 1]);
    let most = f64::from(inner.copied().max().unwrap_or(0).max(1)).sqrt();
    for (bins, colour) in histogram.bins.iter().zip(CHANNELS) {
        let mut points: Vec<Pos2> = Vec::with_capacity(2 * bins.len());
        for (bin, count) in bins.iter().enumerate() {
            let height = (f64::from(*count).sqrt() / most).min(1.0) as f32 * (area.height() - 4.0);
            let y = area.bottom() - height;
            let [from, to] = [bin, bin + 1].map(|bin| across(Histogram::stop_of(bin)));
            points.extend([pos2(from, y), pos2(to, y)]);
        }
        painter.add(Shape::line(points, Stroke::new(1.25, colour)));
    }
    let white = across(-exposure);
    let line = Stroke::new(1.0, ui.visuals().strong_text_color());
    painter.add(Shape::dashed_line(&[pos2(white, area.top()), pos2(white, area.bottom())], line, 3.0, 3.0));
    for stops in (low as i32 + 4..high as i32).step_by(4) {
        let text = if stops == 0 { "white".to_owned() } else { format!("{stops:+}") };
        let at = pos2(across(f64::from(stops)), area.bottom() + 1.0);
        painter.text(at, Align2::CENTER_TOP, text, font.clone(), ui.visuals().weak_text_color());
    }
    let help = "Linear radiance in stops: each step to the right is twice the light. Heights are square roots of counts. \
         What is right of the dashed line is shown as white";
    tips::beside(ui, response, help);
    ui.add(egui::Label::new(RichText::new(words).small().color(ui.visuals().weak_text_color())).wrap());
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::kept::on_screen::{OnScreen, small_film};

    use crate::app::tests::sleep_after;

    #[test]
    fn a_picture_that_refines_is_counted_again_after_a_while_and_another_one_at_once() {
        let (screen, context) = (OnScreen::new(small_film(8, 16.0)), egui::Context::default());
        let mut tone = ToneUi::default();
        let is_asked = |tone: &mut ToneUi, white: f64| {
            screen.before_answers(|subject| {
                tone.follow(subject, white, &context);
                tone.waiting.strong_count() > 0
            })
        };
        assert!(!is_asked(&mut tone, 1.0), "nobody looks at it");
        tone.is_open = true;
        assert!(is_asked(&mut tone, 1.0));
        assert!(!is_asked(&mut tone, 1.0), "it is known");
        let counted = tone.histogram.take().unwrap();
        assert_eq!((counted.pixels, counted.clipped, counted.largest), (8, 1, 2.0));
        assert!(is_asked(&mut tone, 4.0), "another white");
        assert!(!is_asked(&mut tone, 4.0));
        assert_eq!(tone.histogram.as_ref().map(|histogram| histogram.clipped), Some(0));

        let film = screen.subject().film_id();
        let (just_now, earlier) = (Instant::now() + Duration::from_secs(3600), Instant::now() - INTERVAL);
        tone.asked = Some((film, 7, 4.0, just_now));
        let mut is_waiting = true;
        let sleep = sleep_after(&context, |context| {
            tone.follow(&screen.subject(), 4.0, context);
            is_waiting = tone.waiting.strong_count() > 0;
        });
        assert!(!is_waiting && sleep <= INTERVAL && sleep > INTERVAL / 2, "{sleep:?}");
        tone.asked = Some((film, 7, 4.0, earlier));
        assert!(is_asked(&mut tone, 4.0));
        tone.asked = Some((FilmId::Live(9), 8, 4.0, just_now));
        assert!(is_asked(&mut tone, 4.0), "another film");
    }
}
