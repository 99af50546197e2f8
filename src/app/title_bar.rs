//! The bar at the top: menus, stage, devices, pause and save. What has no room gives way: the button that goes on says
//! less, the devices fold into a menu, and at last there are two rows.

use super::command::{Command, Menu};
use super::facts::Facts;
use super::menu::{MENU_WIDTH, item, menus};
use super::model::device::Device;
use super::model::further::Further;
use super::stage_list;
use super::theme;
use super::tips::{self, Side};
use eframe::egui::{self, Align, Button, Layout, RichText, Shape, Stroke, TextStyle, Ui, vec2};

/// Between the menus and the stage, points.
const AFTER_MENUS: f32 = 12.0;

/// Between groups of buttons, points.
const BETWEEN_GROUPS: f32 = 8.0;

/// Between buttons of a group, points.
const WITHIN_GROUP: f32 = 3.0;

/// Around the name of a menu, points.
const MENU_PADDING: f32 = 5.0;

/// Between menus, points.
const BETWEEN_MENUS: f32 = 2.0;

/// The widest button of the stage, points. It has room for nearly all titles.
const STAGE: f32 = 284.0;

/// The narrowest button of the stage beside the menus, points.
const LEAST_STAGE: f32 = 150.0;

/// The narrowest button of the stage before buttons say less, points.
const READABLE_STAGE: f32 = 220.0;

/// Width of Pause and "Go on", points. It is the same for both, so that nothing beside the button moves.
const PAUSE: f32 = 58.0;

/// The button that goes on after the end has room for this, so that the stage stays where it is when a render ends.
const USUAL_GO_ON: &str = "Go on to 16384 spp";

/// What fits.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Fit {
    /// Width of the button of the stage, points.
    stage: f32,
    /// The button that goes on says until when. Otherwise it takes the place of Pause.
    says_until_when: bool,
    /// Each device has its button. Otherwise they are in a menu.
    has_all_devices: bool,
}

/// Widths of the parts, points.
#[derive(Clone, Copy, Debug)]
struct Widths {
    menus: f32,
    steps: f32,
    go_on: f32,
    devices: f32,
    device: f32,
    save: f32,
}

impl Widths {
    fn of(ui: &Ui, facts: &Facts) -> Widths {
        let padding = 2.0 * ui.spacing().button_padding.x;
        let text = |text: &str| {
            let font = TextStyle::Button.resolve(ui.style());
            ui.painter().layout_no_wrap(text.to_owned(), font, egui::Color32::PLACEHOLDER).size().x
        };
        let sum = |widths: &[f32], between: f32| -> f32 {
            widths.iter().sum::<f32>() + between * widths.len().saturating_sub(1) as f32
        };
        let button = |words: &str| (text(words) + padding).max(0.0);
        let further = facts.further().map_or(0.0, |further| button(&go_on_words(&further)));
        let current = facts.model.remembered.device;
        Widths {
            menus: sum(&Menu::BAR.map(|group| text(group.name()) + 2.0 * MENU_PADDING), BETWEEN_MENUS),
            steps: button("‹") + button("›") + 2.0 * BETWEEN_STEPS,
            go_on: further.max(button(USUAL_GO_ON)),
            devices: sum(&Device::ALL.map(|device| button(device.label())), WITHIN_GROUP),
            device: button(&folded_words(current)),
            save: button("Save"),
        }
    }

    /// What fits into `room` points without the menus. The stage has at least `least` points.
    fn fit(&self, room: f32, least: f32) -> Option<Fit> {
        let ways = [(true, true, READABLE_STAGE.max(least)), (false, true, least), (false, false, least)];
        ways.into_iter().find_map(|(says_until_when, has_all_devices, least)| {
            let go_on = if says_until_when { BETWEEN_GROUPS + self.go_on + WITHIN_GROUP } else { 0.0 };
            let devices = if has_all_devices { self.devices } else { self.device };
            let right = go_on + devices + PAUSE + self.save + 2.0 * BETWEEN_GROUPS + 4.0 * WITHIN_GROUP;
            let stage = (room - right - self.steps).min(STAGE).floor();
            (stage >= least).then_some(Fit { stage, says_until_when, has_all_devices })
        })
    }
}

/// Between the button of the stage and its arrows, points.
const BETWEEN_STEPS: f32 = 4.0;

/// Draws the bar.
pub fn ui(ui: &mut Ui, facts: &Facts, commands: &mut Vec<Command>) {
    let frame = theme::panel(egui::Margin::symmetric(10, 6));
    egui::Panel::top("menu").frame(frame).show(ui, |ui| {
        let (room, widths) = (ui.available_width(), Widths::of(ui, facts));
        let beside = widths.fit(room - widths.menus - AFTER_MENUS, LEAST_STAGE);
        let height = ui.spacing().interact_size.y + 2.0;
        if let Some(fit) = beside {
            ui.horizontal(|ui| {
                ui.set_min_height(height);
                ui.scope(|ui| all_menus(ui, facts, commands));
                ui.add_space(AFTER_MENUS);
                parts(ui, fit, facts, commands);
            });
            return;
        }
        ui.horizontal_wrapped(|ui| all_menus(ui, facts, commands));
        let fit = [LEAST_STAGE, 0.0].into_iter().find_map(|least| widths.fit(room, least));
        let nothing = Fit { stage: 0.0, says_until_when: false, has_all_devices: false };
        ui.horizontal(|ui| parts(ui, fit.unwrap_or(nothing), facts, commands));
    });
}

fn all_menus(ui: &mut Ui, facts: &Facts, commands: &mut Vec<Command>) {
    egui::containers::menu::menu_style(ui.style_mut());
    ui.spacing_mut().item_spacing.x = BETWEEN_MENUS;
    ui.spacing_mut().button_padding.x = MENU_PADDING;
    menus(ui, facts, commands);
}

/// The stage, and the buttons at the right.
fn parts(ui: &mut Ui, fit: Fit, facts: &Facts, commands: &mut Vec<Command>) {
    stage(ui, fit.stage, facts, commands);
    ui.with_layout(Layout::right_to_left(Align::Center), |ui| buttons(ui, fit, facts, commands));
}

/// The stage between the arrows to its neighbours.
fn stage(ui: &mut Ui, width: f32, facts: &Facts, commands: &mut Vec<Command>) {
    ui.spacing_mut().item_spacing.x = BETWEEN_STEPS;
    step(ui, facts, commands, Command::PreviousStage, "‹");
    let title = match facts.document().stage() {
        Some(stage) if facts.document().has_changed_scene() => {
            format!("{}  {} (changed)", stage.section, stage.title)
        }
        Some(stage) => format!("{}  {}", stage.section, stage.title),
        None => facts.document().title(),
    };
    let help = format!("{title}\n\n{}", with_keys(ui, Command::Stages));
    let button = Button::new(RichText::new(title).strong()).min_size(vec2(width, 0.0)).truncate();
    let sized = ui.scope(|ui| {
        ui.set_max_width(width);
        egui::containers::menu::MenuButton::from_button(button).ui(ui, |ui| {
            ui.set_width(stage_list::WIDTH);
            stage_list::ui(ui, facts, commands);
        })
    });
    let response =
        tips::explain(ui, sized.inner.0, Side::Below, &help, None).accessible_name("Choose a stage");
    if stage_list::take_open(ui).is_some() {
        egui::Popup::open_id(ui.ctx(), egui::Popup::default_response_id(&response));
        ui.ctx().request_repaint();
    }
    step(ui, facts, commands, Command::NextStage, "›");
}

fn step(ui: &mut Ui, facts: &Facts, commands: &mut Vec<Command>, command: Command, label: &str) {
    let reason = facts.disabled_reason(command);
    let response = ui.add_enabled(reason.is_none(), Button::new(label)).accessible_name(command.name());
    let help = with_keys(ui, command);
    if tips::explain(ui, response, Side::Below, &help, reason.as_deref()).clicked() {
        commands.push(command);
    }
}

/// A command's help text with its keys.
fn with_keys(ui: &Ui, command: Command) -> String {
    match command.keys(ui.ctx()) {
        Some(keys) => format!("{} ({keys})", command.help()),
        None => command.help().to_owned(),
    }
}

/// The buttons on the right side, laid out from right to left.
fn buttons(ui: &mut Ui, fit: Fit, facts: &Facts, commands: &mut Vec<Command>) {
    ui.spacing_mut().item_spacing.x = WITHIN_GROUP;
    let further = facts.further();
    let command = Command::Save;
    let response = ui.button("Save");
    if tips::explain(ui, response, Side::Below, &with_keys(ui, command), None).clicked() {
        commands.push(command);
    }
    match &further {
        Some(further) if !fit.says_until_when => go_on(ui, "Go on", further, commands),
        _ => pause(ui, facts, commands),
    }
    ui.add_space(BETWEEN_GROUPS);
    if fit.has_all_devices {
        for device in Device::ALL.into_iter().rev() {
            device_button(ui, facts, commands, device);
        }
    } else {
        folded_devices(ui, facts, commands);
    }
    if let Some(further) = further.filter(|_| fit.says_until_when) {
        ui.add_space(BETWEEN_GROUPS);
        go_on(ui, &go_on_words(&further), &further, commands);
    }
}

fn pause(ui: &mut Ui, facts: &Facts, commands: &mut Vec<Command>) {
    let is_paused = facts.model.is_paused;
    let label = if is_paused { "Go on" } else { "Pause" };
    let button = Button::new(label).min_size(vec2(PAUSE, 0.0)).selected(is_paused);
    let can_pause = facts.is_working() || is_paused;
    let response = ui.add_enabled(can_pause, button);
    let reason = "The picture is done; the Stop panel sets when it ends";
    let help = with_keys(ui, Command::Pause);
    if tips::explain(ui, response, Side::Below, &help, Some(reason)).clicked() {
        commands.push(Command::Pause);
    }
}

fn go_on_words(further: &Further) -> String {
    format!("Go on to {}", further.words)
}

/// Offers to go on after the end of a render.
fn go_on(ui: &mut Ui, label: &str, further: &Further, commands: &mut Vec<Command>) {
    let response = ui.add(Button::new(label).min_size(vec2(PAUSE, 0.0)));
    let help = format!("{}; no sample is lost", go_on_words(further));
    if tips::explain(ui, response, Side::Below, &help, None).clicked() {
        commands.push(Command::Pause);
    }
}

fn device_button(ui: &mut Ui, facts: &Facts, commands: &mut Vec<Command>, device: Device) {
    let is_chosen = facts.model.remembered.device == device;
    let unavailable = device.unavailable();
    let mut label = RichText::new(device.label());
    if is_chosen {
        label = label.color(ui.visuals().selection.stroke.color);
    }
    let mut button = Button::new(label);
    if is_chosen {
        button = button.fill(theme::accent(ui));
    }
    let response = ui.add_enabled(unavailable.is_none(), button);
    let help =
        format!("{}. The same picture continues. (G switches between CPU and GPU)", device.long_help());
    let response = tips::explain(ui, response, Side::Below, &help, unavailable.as_deref())
        .accessible_name(Command::Device(device).name());
    if response.clicked() {
        commands.push(Command::Device(device));
    }
}

/// The label of the menu of devices, with room for a triangle at the right.
fn folded_words(device: Device) -> String {
    format!("{}     ", device.label())
}

/// The devices in a menu.
fn folded_devices(ui: &mut Ui, facts: &Facts, commands: &mut Vec<Command>) {
    let button = Button::new(folded_words(facts.model.remembered.device));
    let (response, _) = egui::containers::menu::MenuButton::from_button(button).ui(ui, |ui| {
        ui.set_width(MENU_WIDTH);
        for device in Device::ALL {
            item(ui, facts, commands, Command::Device(device));
        }
    });
    let tip = response.rect.right_center() + vec2(-12.0, 2.5);
    let triangle = [vec2(0.0, 0.0), vec2(-4.0, -5.0), vec2(4.0, -5.0)].map(|corner| tip + corner);
    let colour = ui.visuals().text_color();
    ui.painter().add(Shape::convex_polygon(triangle.to_vec(), colour, Stroke::NONE));
    let help = "What traces; the same picture continues. (G switches between CPU and GPU)";
    tips::explain(ui, response, Side::Below, help, None).accessible_name("Choose a device");
}
