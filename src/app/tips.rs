//! Tooltips by their earlier names: use [`super::widgets::tip`].

use super::widgets::tip;
use eframe::egui::{Rangef, Response, Ui};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    Beside,
    Above,
    Below,
}

pub fn explain(ui: &Ui, response: Response, _: Side, help: &str, reason: Option<&str>) -> Response {
    tip(ui, response, help, reason)
}

pub fn beside(ui: &Ui, response: Response, help: &str) -> Response {
    tip(ui, response, help, None)
}

pub fn explain_in_column(response: Response, _: Rangef, help: &str, reason: Option<&str>) -> Response {
    let reason = reason.filter(|_| !response.enabled()).unwrap_or_default();
    response.on_hover_text(help).on_disabled_hover_text(reason)
}
