//! The list of all spheres, to find and select one. Only the rows in sight are drawn.

use crate::app::commands::{Command, PanelContext};
use crate::app::model::{CheckedScene, kind_word};
use crate::app::toolkit::widgets::{hint, named, shown_albedo};
use crate::app::toolkit::{has_words, theme};
use crate::scene::Scene;
use eframe::egui::{
    Atom, Button, Color32, IdSalt, Key, Response, RichText, Role, ScrollArea, Stroke, TextEdit, Ui,
    WidgetInfo, vec2,
};
use std::sync::Arc;

/// Heights of a row, and of the list at most, points.
const ROW: f32 = 24.0;
const HEIGHT: f32 = 5.0 * ROW;

/// The text that is searched for, and what it finds.
#[derive(Clone, Default)]
struct List {
    text: String,
    /// The spheres that have the text, by rising index.
    found: Arc<[usize]>,
    /// The scene in which they were found.
    of: Option<Arc<CheckedScene>>,
    selected: Option<usize>,
    /// How far it is scrolled, points.
    offset: f32,
}

/// Draws the list.
pub fn ui(ui: &mut Ui, cx: &PanelContext) {
    let (place, checked) = (ui.scope_id().with("list"), &cx.document().checked);
    let mut list: List = ui.data(|data| data.get_temp(place)).unwrap_or_default();
    ui.spacing_mut().item_spacing.y = 4.0;
    let field = TextEdit::singleline(&mut list.text).hint_text("Name, kind or number");
    let field = ui.add(field.desired_width(f32::INFINITY));
    named(&field, "Find a sphere");
    if field.changed() || !list.of.as_ref().is_some_and(|of| Arc::ptr_eq(of, checked)) {
        (list.found, list.of) = (find(checked.scene(), &list.text), Some(Arc::clone(checked)));
    }
    let is_enter = field.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter));
    if let Some(first) = list.found.first().filter(|_| is_enter) {
        cx.send(Command::Sphere(*first));
    }
    if list.found.is_empty() {
        hint(
            ui,
            if list.text.is_empty() { "This scene has no spheres" } else { "No sphere has these words" },
        );
    }
    ui.spacing_mut().item_spacing.y = 0.0;
    let mut area = ScrollArea::vertical().id_salt("spheres").max_height(HEIGHT).auto_shrink([false, true]);
    let selected = cx.model.selected;
    if std::mem::replace(&mut list.selected, selected) != selected
        && let Some(row) = selected.and_then(|selected| list.found.binary_search(&selected).ok())
    {
        let top = row as f32 * ROW;
        if !(list.offset..=list.offset + HEIGHT - ROW).contains(&top) {
            area = area.vertical_scroll_offset((top - 0.5 * (HEIGHT - ROW)).max(0.0));
        }
    }
    let found = Arc::clone(&list.found);
    let shown = area.show_rows(ui, ROW, found.len(), |ui, rows| {
        for sphere in &found[rows] {
            if row(ui, checked.scene(), *sphere, selected == Some(*sphere)).clicked() {
                cx.send(Command::Sphere(*sphere));
            }
        }
    });
    list.offset = shown.state.clamped_offset().y;
    ui.data_mut(|data| data.insert_temp(place, list));
}

/// The spheres that have all words of a text in their name, kind or number.
fn find(scene: &Scene, text: &str) -> Arc<[usize]> {
    let is_found = |sphere: &usize| {
        let named = &scene.materials[scene.spheres[*sphere].material];
        has_words(&format!("{} {} {}", named.name, kind_word(&named.material), sphere + 1), text)
    };
    (0..scene.spheres.len()).filter(|sphere| text.is_empty() || is_found(sphere)).collect()
}

fn row(ui: &mut Ui, scene: &Scene, sphere: usize, is_on: bool) -> Response {
    let named = &scene.materials[scene.spheres[sphere].material];
    let number = RichText::new(format!("{} {}", kind_word(&named.material), sphere + 1)).small();
    let gutter = Atom::custom(IdSalt::new("colour"), vec2(12.0, 12.0));
    let atoms = (gutter, named.name.as_str(), Atom::grow(), number.color(theme::colours(ui).weak));
    let button = Button::selectable(is_on, atoms).truncate().min_size(vec2(ui.available_width(), ROW));
    let response = ui.add(button);
    let name = format!("Sphere {}, {}", sphere + 1, named.name);
    response.widget_info(|| WidgetInfo::selected(Role::Button, true, is_on, &name));
    let middle = response.rect.left_center() + vec2(14.0, 0.0);
    if let Some(albedo) = named.material.albedo() {
        let [r, g, b] = shown_albedo(albedo);
        ui.painter().circle_filled(middle, 5.0, Color32::from_rgb(r, g, b));
    } else {
        ui.painter().circle_stroke(middle, 4.5, Stroke::new(1.0, theme::colours(ui).text));
    }
    response
}
