//! The strip of all slots, below the picture.

use crate::app::command::{Command, SlotCommand};
use crate::app::facts::Facts;
use crate::app::menu::item;
use crate::app::model::slots::{Coming, Slot, SlotNumber, Slots};
use crate::app::texture::Texture;
use crate::app::theme;
use crate::app::tips::{self, Side};
use crate::job::output::OutputFormat;
use crate::system::memory::words;
use eframe::egui::{
    self, Align2, Button, Color32, CornerRadius, Pos2, Rect, RichText, Sense, Stroke, StrokeKind, TextEdit,
    TextStyle, TextureOptions, Ui, UiBuilder, pos2, vec2,
};

/// Height of a card in points.
const HEIGHT: f32 = 66.0;

/// Largest width of a thumbnail in points.
const THUMBNAIL: f32 = 112.0;

/// Least width of a name in points.
const NAME: f32 = 206.0;

/// Largest width of a name in points. Longer names are cut.
const LONG_NAME: f32 = 340.0;

/// The thumbnails of the slots.
#[derive(Default)]
pub struct Strip {
    /// Each with the number of its picture.
    textures: [Option<(u64, Texture)>; 9],
}

impl Strip {
    /// Draws the strip of all slots.
    pub fn ui(&mut self, ui: &mut Ui, slots: &mut Slots, facts: &Facts, commands: &mut Vec<Command>) {
        let frame = theme::panel(egui::Margin::symmetric(10, 5));
        egui::Panel::bottom("slots").frame(frame).show(ui, |ui| {
            egui::ScrollArea::horizontal().auto_shrink([false, true]).show(ui, |ui| {
                ui.horizontal_top(|ui| {
                    ui.spacing_mut().item_spacing.x = 6.0;
                    live(ui, facts, commands);
                    for number in SlotNumber::ALL {
                        // What is done to a card must reach it even if there is another one before it by then.
                        let own = UiBuilder::new().scope_id(egui::Id::unique(("slot", number.index())));
                        if let Some(coming) = slots.coming(number) {
                            ui.scope_builder(own, |ui| coming_card(ui, number, coming));
                        } else if slots.get(number).is_some() {
                            ui.scope_builder(own, |ui| self.card(ui, number, slots, facts, commands));
                        }
                    }
                });
            });
        });
    }

    /// A slot: its thumbnail, its name, what it holds, and what can be done with it.
    fn card(
        &mut self,
        ui: &mut Ui,
        number: SlotNumber,
        slots: &mut Slots,
        facts: &Facts,
        commands: &mut Vec<Command>,
    ) {
        let Some(slot) = slots.get(number).cloned() else { return };
        let is_shown = slots.looked() == Some(number);
        let is_chosen = slots.chosen() == Some(number);
        let is_compared = facts.model.view.compared_slot() == Some(number);
        let mut is_touched = false;
        let framed = egui::Frame::new().inner_margin(egui::Margin::same(4)).show(ui, |ui| {
            ui.horizontal_top(|ui| {
                if self.thumbnail(ui, number, &slot) {
                    commands.push(if is_shown {
                        Command::Slot(SlotCommand::LookLive)
                    } else {
                        Command::Slot(SlotCommand::Look(number))
                    });
                }
                ui.vertical(|ui| {
                    ui.spacing_mut().item_spacing = vec2(3.0, 2.0);
                    if let Some(name) = slots.name_mut(number) {
                        let (width, is_cut) = name_width(ui, name);
                        let edit = TextEdit::singleline(name).desired_width(width).margin(vec2(4.0, 1.0));
                        let response = ui.add(edit);
                        let mut help = "The name of this slot; click to change it".to_owned();
                        if is_cut && !response.has_focus() {
                            paint_ellipsis(ui, response.rect);
                            help = format!("{name}\n\n{help}");
                        }
                        let response = tips::explain(ui, response, Side::Above, &help, None);
                        let response = response.accessible_name(format!("Name of slot {number}"));
                        is_touched |= response.gained_focus();
                    }
                    ui.horizontal(|ui| {
                        let label = ui.label(about(ui, slot.kept.size(), slot.kept.samples()));
                        tips::explain(ui, label, Side::Above, &memory_words(&slot, slots), None);
                        if slots.is_passing(&slot.kept) {
                            let words = RichText::new("this window only").small();
                            let label = ui.label(words.color(ui.visuals().warn_fg_color));
                            let help =
                                "Its film could not be written, so it will not come back in the next window";
                            tips::explain(ui, label, Side::Above, help, None);
                        }
                        is_touched |= size_button(ui, number, facts, commands);
                    });
                    ui.horizontal(|ui| {
                        is_touched |= buttons(ui, number, is_compared, facts, commands);
                    });
                });
            });
        });
        if is_touched {
            slots.choose(number);
        }
        let rect = framed.response.rect;
        let colour = if is_shown || is_compared {
            theme::accent(ui)
        } else if is_chosen {
            ui.visuals().weak_text_color()
        } else {
            ui.visuals().window_stroke.color
        };
        let width = if is_shown || is_compared { 2.0 } else { 1.0 };
        ui.painter().rect_stroke(rect, CornerRadius::same(6), Stroke::new(width, colour), StrokeKind::Inside);
    }

    /// The thumbnail with the slot's number. Returns whether it was clicked.
    fn thumbnail(&mut self, ui: &mut Ui, number: SlotNumber, slot: &Slot) -> bool {
        let thumbnail = &slot.kept.thumbnail;
        let texture = match &mut self.textures[number.index()] {
            Some((of, texture)) if *of == slot.kept.number() => texture,
            place => {
                let texture = Texture::new(thumbnail.size, &thumbnail.rgb8, None);
                &mut place.insert((slot.kept.number(), texture)).1
            }
        };
        let [width, height] = thumbnail.size.map(|length| length as f32);
        let scale = ((HEIGHT - 8.0) / height).min(THUMBNAIL / width);
        let size = vec2(width, height) * scale;
        let (rect, response) = ui.allocate_exact_size(vec2(size.x.max(40.0), HEIGHT - 8.0), Sense::click());
        let name = format!("Slot {number}");
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &name));
        let id = texture.id(ui.ctx(), TextureOptions::LINEAR);
        let whole = Rect { min: Pos2::ZERO, max: pos2(1.0, 1.0) };
        let at = Rect::from_center_size(rect.center(), size);
        ui.painter().image(id, at, whole, Color32::WHITE);
        let font = TextStyle::Button.resolve(ui.style());
        let place = Rect::from_min_size(at.min, vec2(18.0, 18.0));
        ui.painter().rect_filled(place, CornerRadius::same(3), ui.visuals().panel_fill.gamma_multiply(0.85));
        let colour = ui.visuals().strong_text_color();
        ui.painter().text(place.center(), Align2::CENTER_CENTER, number.to_string(), font, colour);
        let keys = Command::Slot(SlotCommand::Look(number)).keys(ui.ctx()).unwrap_or_default();
        let help = format!("Look at this picture, or return to the live one ({keys}; J flips)");
        tips::explain(ui, response, Side::Above, &help, None).clicked()
    }
}

/// The width of a slot's name in points, and whether it is cut there.
fn name_width(ui: &Ui, name: &str) -> (f32, bool) {
    /// The margins and the place of the cursor.
    const AROUND: f32 = 12.0;
    let font = TextStyle::Body.resolve(ui.style());
    let text = ui.painter().layout_no_wrap(name.to_owned(), font, Color32::PLACEHOLDER);
    let width = text.size().x + AROUND;
    (width.clamp(NAME, LONG_NAME), width > LONG_NAME)
}

/// Shows at the end of a text field that its text goes on.
fn paint_ellipsis(ui: &Ui, field: Rect) {
    let end = Rect { min: pos2(field.right() - 18.0, field.top()), ..field }.shrink(1.0);
    ui.painter().rect_filled(end, CornerRadius::ZERO, ui.visuals().text_edit_bg_color());
    let (font, colour) = (TextStyle::Body.resolve(ui.style()), ui.visuals().text_color());
    ui.painter().text(end.center(), Align2::CENTER_CENTER, "…", font, colour);
}

/// The size and the samples of a picture.
fn about(ui: &Ui, [width, height]: [u32; 2], samples: u64) -> RichText {
    let words = format!("{width}x{height}, {samples} samples");
    RichText::new(words).small().color(ui.visuals().weak_text_color())
}

/// A slot whose picture is still being read.
fn coming_card(ui: &mut Ui, number: SlotNumber, coming: &Coming) {
    let framed = egui::Frame::new().inner_margin(egui::Margin::same(4)).show(ui, |ui| {
        ui.horizontal_top(|ui| {
            let [width, height] = coming.size.map(|length| length.max(1) as f32);
            let scale = ((HEIGHT - 8.0) / height).min(THUMBNAIL / width);
            let size = vec2((width * scale).max(40.0), HEIGHT - 8.0);
            let (rect, _) = ui.allocate_exact_size(size, Sense::hover());
            egui::Spinner::new().paint_at(ui, Rect::from_center_size(rect.center(), vec2(24.0, 24.0)));
            ui.vertical(|ui| {
                // As large as the slot will be, so that nothing moves when it is there.
                let (width, _) = name_width(ui, &coming.name);
                ui.set_min_size(vec2(width + 8.0, HEIGHT + 2.0));
                ui.set_max_width(width + 8.0);
                ui.spacing_mut().item_spacing.y = 2.0;
                ui.add(egui::Label::new(format!("{number}  {}", coming.name)).truncate());
                ui.label(about(ui, coming.size, coming.samples));
                ui.label(RichText::new("Reading it from disk").small());
            });
        });
    });
    let (rect, colour) = (framed.response.rect, ui.visuals().window_stroke.color);
    ui.painter().rect_stroke(rect, CornerRadius::same(6), Stroke::new(1.0, colour), StrokeKind::Inside);
}

/// The live picture, and a button to keep it.
fn live(ui: &mut Ui, facts: &Facts, commands: &mut Vec<Command>) {
    ui.vertical(|ui| {
        ui.spacing_mut().item_spacing.y = 4.0;
        for (command, label) in [
            (Command::Slot(SlotCommand::LookLive), "Live"),
            (Command::Slot(SlotCommand::Keep), "Keep"),
            (Command::Slot(SlotCommand::Swap), "Flip"),
        ] {
            let reason = facts.disabled_reason(command);
            // The live picture is pressed while it is shown, not disabled.
            let is_on = facts.is_on(command);
            let button = Button::new(label).small().selected(is_on).min_size(vec2(44.0, 19.0));
            let response = ui.add_enabled(reason.is_none() || is_on, button);
            let keys = command.keys(ui.ctx()).map_or_else(String::new, |keys| format!(" ({keys})"));
            let help = format!("{}{keys}", command.help());
            let response = tips::explain(ui, response, Side::Above, &help, reason.as_deref());
            if response.clicked() && !is_on {
                commands.push(command);
            }
        }
    });
}

/// A button that gives the picture the size of the slot, if it has another one. Returns whether it was clicked.
fn size_button(ui: &mut Ui, number: SlotNumber, facts: &Facts, commands: &mut Vec<Command>) -> bool {
    if facts.slot_of_other_size(number).is_none() {
        return false;
    }
    let command = Command::Slot(SlotCommand::TakeSize);
    let response = ui.add(Button::new(RichText::new("Set size").small()).small());
    let response = tips::explain(ui, response, Side::Above, command.help(), None)
        .accessible_name(format!("Set the picture to the size of slot {number}"));
    if response.clicked() {
        commands.push(command);
    }
    response.clicked()
}

/// What can be done with a slot. Returns whether a command was given, which is for this slot.
fn buttons(
    ui: &mut Ui,
    number: SlotNumber,
    is_compared: bool,
    facts: &Facts,
    commands: &mut Vec<Command>,
) -> bool {
    let mut is_given = false;
    let unequal = facts.slot_of_other_size(number);
    for (label, command, reason) in [
        ("Wipe", SlotCommand::Wipe, None),
        ("A − B", SlotCommand::Difference, unequal.as_deref()),
        ("Noise?", SlotCommand::OnlyNoise, unequal.as_deref()),
    ] {
        let command = Command::Slot(command);
        let is_on = is_compared && facts.is_on(command);
        let button = Button::new(label).small().selected(is_on);
        let response = ui.add_enabled(reason.is_none(), button);
        let response = tips::explain(ui, response, Side::Above, command.help(), reason)
            .accessible_name(format!("{} {number}", command.name()));
        if response.clicked() {
            commands.push(command);
            is_given = true;
        }
    }
    let more = egui::containers::menu::MenuButton::from_button(Button::new("More").small());
    let (response, inner) = more.ui(ui, |ui| {
        ui.set_width(250.0);
        let before = commands.len();
        item(ui, facts, commands, Command::Slot(SlotCommand::Open));
        ui.separator();
        for save in [
            Command::Save(OutputFormat::Png),
            Command::Save(OutputFormat::Exr),
            Command::CopyPicture,
            Command::SaveScene,
        ] {
            let at = commands.len();
            item(ui, facts, commands, save);
            if commands.len() > at {
                // Saving takes what is shown.
                commands.insert(at, Command::Slot(SlotCommand::Look(number)));
            }
        }
        ui.separator();
        item(ui, facts, commands, Command::Slot(SlotCommand::Delete));
        item(ui, facts, commands, Command::Slot(SlotCommand::BringBack));
        commands.len() > before
    });
    let help = "Go on from this picture, save it, or delete it";
    tips::explain(ui, response, Side::Above, help, None).accessible_name(format!("More about slot {number}"));
    is_given | inner.is_some_and(|inner| inner.inner)
}

fn memory_words(slot: &Slot, slots: &Slots) -> String {
    format!(
        "{} in memory, with the exact sums of all samples. All slots together take {} of at most {}",
        words(slot.kept.bytes()),
        words(slots.bytes()),
        words(crate::app::model::slots::BYTES_LIMIT)
    )
}

#[cfg(test)]
mod tests;
