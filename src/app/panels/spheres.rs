//! The list of all spheres, to select one. Only the rows in sight are drawn.

use crate::app::commands::{Command, PanelContext};
use crate::app::model::kind_word;
use crate::app::toolkit::number::shown_albedo;
use crate::app::toolkit::theme;
use crate::app::toolkit::widgets::{choice, hint};
use crate::scene::Scene;
use eframe::egui::{
    Atom, Color32, IdSalt, Response, RichText, Role, ScrollArea, Stroke, Ui, WidgetInfo, vec2,
};

/// Heights of a row, and of the list at most, points.
const ROW: f32 = 24.0;
const HEIGHT: f32 = 5.0 * ROW;

/// Draws the list. A sphere that is selected elsewhere comes into sight.
pub fn ui(ui: &mut Ui, cx: &PanelContext) {
    let (scene, selected, place) = (cx.document().scene(), cx.model.selected, ui.scope_id().with("list"));
    if scene.spheres.is_empty() {
        hint(ui, "This scene has no spheres");
    }
    ui.spacing_mut().item_spacing.y = 0.0;
    let (before, offset): (Option<usize>, f32) = ui.data(|data| data.get_temp(place)).unwrap_or_default();
    let mut area = ScrollArea::vertical().id_salt("spheres").max_height(HEIGHT).auto_shrink([false, true]);
    let top = selected.filter(|_| selected != before).map_or(offset, |sphere| sphere as f32 * ROW);
    if !(offset..=offset + HEIGHT - ROW).contains(&top) {
        area = area.vertical_scroll_offset((top - 0.5 * (HEIGHT - ROW)).max(0.0));
    }
    let shown = area.show_rows(ui, ROW, scene.spheres.len(), |ui, rows| {
        for sphere in rows {
            if row(ui, scene, sphere, selected == Some(sphere)).clicked() {
                cx.send(Command::Sphere(sphere));
            }
        }
    });
    ui.data_mut(|data| data.insert_temp(place, (selected, shown.state.clamped_offset().y)));
}

fn row(ui: &mut Ui, scene: &Scene, sphere: usize, is_on: bool) -> Response {
    let named = &scene.materials[scene.spheres[sphere].material];
    let number = RichText::new(format!("{} {}", kind_word(&named.material), sphere + 1)).small();
    let gutter = Atom::custom(IdSalt::new("colour"), vec2(12.0, 12.0));
    let button = choice(ui, is_on, (gutter, named.name.as_str(), Atom::grow(), number.weak())).truncate();
    let response = ui.add(button.frame_when_inactive(is_on).min_size(vec2(ui.available_width(), ROW)));
    let name = format!("Sphere {}, {}", sphere + 1, named.name);
    response.widget_info(|| WidgetInfo::selected(Role::Button, true, is_on, &name));
    let middle = response.rect.left_center() + vec2(14.0, 0.0);
    match named.material.albedo().map(shown_albedo) {
        Some([r, g, b]) => _ = ui.painter().circle_filled(middle, 5.0, Color32::from_rgb(r, g, b)),
        None => _ = ui.painter().circle_stroke(middle, 4.5, Stroke::new(1.0, theme::colours(ui).text)),
    }
    response
}
