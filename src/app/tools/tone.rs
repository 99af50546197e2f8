//! The view of the picture, its brightness, and the histogram.

use crate::app::commands::{Command, PanelContext};
use crate::app::model::{Channel, Show, Tone, ViewState};
use crate::app::toolkit::widgets::{
    About, Header, Number, add_command, compact, entry, fold, hint, list, row, small, switch, tip,
};
use crate::app::toolkit::{Query, theme};
use crate::app::tracing::subject::{PictureId, Subject};
use crate::film::Histogram;
use eframe::egui::{
    self, Align2, Checkbox, Pos2, Sense, Shape, Stroke, TextStyle, Ui, WidgetInfo, pos2, vec2,
};

/// Height of the histogram in points.
const HEIGHT: f32 = 72.0;

/// The histogram on the screen.
#[derive(Default)]
pub struct ToneUi {
    is_open: bool,
    /// By film, white, and how often its samples have doubled.
    query: Query<(PictureId, f64, u32), Histogram>,
}

impl ToneUi {
    /// Takes the film's answer, and asks again if the picture has changed.
    pub fn follow(&mut self, subject: &Subject<'_>, white: f64, context: &egui::Context) {
        self.query.follow();
        if !self.is_open || !subject.has_samples() {
            return;
        }
        // Counting takes the tracer's time.
        let doublings = subject.samples().ilog2();
        let key = (subject.id(), white, doublings);
        subject.ask(context, &mut self.query, key, move |film| Some(Histogram::of(film, white)));
    }

    /// Draws the view, its brightness, and the histogram.
    pub fn ui(&mut self, ui: &mut Ui, view: &mut ViewState, cx: &PanelContext) {
        self.is_open = false;
        let (show, channel) = (view.show(), view.tone.channel);
        let mut summary = vec![show.name().trim_end_matches('…').to_lowercase()];
        summary.extend(view.shows_denoised().then(|| "denoised".to_owned()));
        summary.extend(channel.map(|channel| channel.name().to_lowercase()));
        if view.tone.exposure != 0.0 {
            let sign = if view.tone.exposure > 0.0 { "+" } else { "" };
            summary.push(format!("{sign}{} stops", compact(view.tone.exposure)));
        }
        let header = Header { title: "View", summary: &summary.join(", "), ..Header::default() };
        fold(ui, header, false, |ui| {
            self.is_open = true;
            let about = About::new("Show", "What is shown; files are saved as Picture");
            list(ui, about, show.name(), |ui| {
                for show in Show::ALL {
                    let (command, reason) = (Command::Show(show), cx.model.useless_show(show));
                    let about = About::new(show.name(), command.help()).disabled_if(reason.as_deref());
                    if entry(ui, cx.is_on(command), about) {
                        cx.send(command);
                    }
                }
            });
            let mut is_denoised = view.is_denoised;
            let denoise = Checkbox::new(&mut is_denoised, Command::Denoise.name());
            add_command(ui, cx, Command::Denoise, denoise);
            let reason = cx.model.no_exposure();
            brightness_ui(ui, &mut view.tone, reason.as_deref());
            match &self.query.answer {
                Some(histogram) => paint(ui, histogram, view.tone.exposure),
                None => _ = hint(ui, if cx.is_working() { "Counting…" } else { "No samples yet" }),
            }
        });
    }
}

fn brightness_ui(ui: &mut Ui, tone: &mut Tone, reason: Option<&str>) {
    let help = "Show one channel alone, as grey (Shift+R, G, B)";
    row(ui, About::new("Channels", help).disabled_if(reason), |ui| {
        let [red, green, blue] = Channel::ALL.map(Some);
        let options = [(None, "RGB"), (red, "R"), (green, "G"), (blue, "B")]
            .map(|(channel, name)| (channel, About::new(name, help).disabled_if(reason)));
        tone.channel = switch(ui, 0.0, tone.channel, &options).unwrap_or(tone.channel);
    });
    let help = "Brightens what you see by powers of two; saved files stay as they are (+, −, 0)";
    let about = About::new("Exposure", help).disabled_if(reason);
    let number = Number::new(about, Tone::EXPOSURES).unit(" stops").speed(0.02);
    number.slider(ui, &mut tone.exposure, Tone::EXPOSURES, false);
}

/// A sentence about clipping.
fn clipping(histogram: &Histogram) -> String {
    match 100.0 * f64::from(histogram.clipped) / f64::from(histogram.pixels.max(1)) {
        0.0 => "Nothing is brighter than white.".to_owned(),
        share if share < 0.1 => {
            "Less than 0.1 % of the pixels are brighter than white and lose detail.".to_owned()
        }
        share => format!("{share:.1} % of the pixels are brighter than white and lose detail."),
    }
}

/// Draws the counts, with a line at the radiance that is shown as white.
fn paint(ui: &mut Ui, histogram: &Histogram, exposure: f64) {
    let (area, response) = ui.allocate_exact_size(vec2(ui.available_width(), HEIGHT), Sense::hover());
    let (words, colours) = (clipping(histogram), theme::colours(ui));
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Image, true, format!("Histogram: {words}")));
    let painter = ui.painter().with_clip_rect(area.intersect(ui.clip_rect()));
    painter.rect_filled(area, 4.0, colours.well);
    let [low, high] = Histogram::STOPS;
    let across = |stops: f64| area.left() + ((stops - low) / (high - low)) as f32 * area.width();
    // The outer bins also hold everything beyond, such as black, and would dwarf the others.
    let inner = histogram.bins.iter().flat_map(|bins| &bins[1..bins.len() - 1]);
    let most = f64::from(inner.copied().max().unwrap_or(0).max(1)).sqrt();
    for (bins, colour) in histogram.bins.iter().zip([colours.bad, colours.good, colours.accent]) {
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
    let line = Stroke::new(1.0, colours.edge);
    painter.add(Shape::dashed_line(&[pos2(white, area.top()), pos2(white, area.bottom())], line, 3.0, 3.0));
    let font = TextStyle::Small.resolve(ui.style());
    painter.text(pos2(white + 4.0, area.top() + 2.0), Align2::LEFT_TOP, "white", font, colours.weak);
    let help = "How many pixels are how bright, from black to white: each twentieth of the width is twice the light, \
                and heights are square roots of counts";
    tip(ui, response, help, None);
    ui.scope(|ui| {
        // Two lines, so that what is below stays where it is.
        ui.set_min_height(2.0 * ui.text_style_height(&TextStyle::Small));
        small(ui, words);
    });
}
