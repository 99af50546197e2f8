//! The error against the seconds that were traced, both on scales of powers of ten.

use super::theme;
use super::window::Window;
use eframe::egui::{self, RichText, Ui};
use egui_plot::{HLine, HoverPosition, Line, LineStyle, Plot, PlotPoints, Points};

pub fn ui(window: &mut Window, ui: &mut Ui) {
    let status = window.main.status();
    let mut points: Vec<[f64; 2]> = status
        .history
        .iter()
        .filter(|point| point.rmse_estimate > 0.0 && point.trace_seconds > 0.0)
        .map(|point| [point.trace_seconds.log10(), point.rmse_estimate.log10()])
        .collect();
    let now = status.error.filter(|error| error.rmse > 0.0 && !status.trace.is_zero());
    points.extend(now.map(|error| [status.trace.as_secs_f64().log10(), error.rmse.log10()]));
    let target = window.document.stop.noise;
    let accent = theme::accent(ui);
    let weak = ui.visuals().weak_text_color();
    let frame = egui::Frame::side_top_panel(ui.style()).inner_margin(egui::Margin::symmetric(12, 6));
    egui::Panel::bottom("plot")
        .frame(frame)
        .resizable(true)
        .default_size(150.0)
        .size_range(90.0..=400.0)
        .show(ui, |ui| {
            ui.label(
                RichText::new("Estimated error (RMSE, linear radiance) against seconds").small().color(weak),
            );
            if points.is_empty() {
                ui.centered_and_justified(|ui| ui.label(RichText::new("No estimate yet").color(weak)));
                return;
            }
            Plot::new("error")
                .allow_drag(false)
                .allow_zoom(false)
                .allow_scroll(false)
                .allow_boxed_zoom(false)
                .show_background(false)
                .set_margin_fraction(egui::vec2(0.03, 0.12))
                .x_axis_formatter(|mark, _| power(mark.value, " s"))
                .y_axis_formatter(|mark, _| power(mark.value, ""))
                .x_grid_spacer(egui_plot::uniform_grid_spacer(|_| [1.0, 1.0, 1.0]))
                .y_grid_spacer(egui_plot::uniform_grid_spacer(|_| [1.0, 1.0, 1.0]))
                .label_formatter(|hover| {
                    let (HoverPosition::NearDataPoint { position: at, .. }
                    | HoverPosition::Elsewhere { position: at }) = hover;
                    Some(format!("{:.2} s\nerror {:.5}", 10_f64.powf(at.x), 10_f64.powf(at.y)))
                })
                .show(ui, |plot| {
                    if let Some(target) = target.filter(|target| *target > 0.0) {
                        let style = LineStyle::dashed_loose();
                        plot.hline(HLine::new("target", target.log10()).color(weak).style(style));
                    }
                    plot.line(Line::new("error", PlotPoints::from(points.clone())).color(accent).width(1.5));
                    plot.points(Points::new("error", PlotPoints::from(points)).color(accent).radius(2.5));
                });
        });
}

/// A mark of a scale in powers of ten.
fn power(exponent: f64, unit: &str) -> String {
    let value = 10_f64.powf(exponent);
    if (exponent - exponent.round()).abs() > 1e-6 {
        String::new()
    } else {
        format!("{}{unit}", super::widgets::compact(value))
    }
}
