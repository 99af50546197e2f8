//! The picture, and the hand on it.

mod paint;

use super::compare::Mode;
use super::navigation;
use super::window::Window;
use crate::heat::HeatScale;
use crate::layers::Layer;
use eframe::egui::{
    self, CursorIcon, Key, PointerButton, Pos2, Rect, RichText, Sense, Ui, Vec2, WidgetInfo, vec2,
};
use paint::{paint, paint_drop};
use std::time::{Duration, Instant};

/// What the picture shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Show {
    /// The picture.
    #[default]
    Picture,
    /// Normals of what is seen first.
    Normals,
    /// The materials' own colours.
    Albedo,
    /// Rays per path.
    Bounces,
    /// Standard error of each pixel.
    Error,
    /// How full packets were.
    Occupancy,
    /// Difference from a loaded film.
    Difference,
}

impl Show {
    /// All of them.
    pub const ALL: [Show; 7] = [
        Show::Picture,
        Show::Normals,
        Show::Albedo,
        Show::Bounces,
        Show::Error,
        Show::Occupancy,
        Show::Difference,
    ];

    /// Its name, after "Show".
    pub fn name(self) -> &'static str {
        match self {
            Show::Picture => "picture",
            Show::Normals => "normals",
            Show::Albedo => "albedo",
            Show::Bounces => "bounces per path",
            Show::Error => "standard error",
            Show::Occupancy => "lane occupancy",
            Show::Difference => "difference to reference",
        }
    }

    /// What it is.
    pub fn help(self) -> &'static str {
        match self {
            Show::Picture => "The film, as it will be saved",
            Show::Normals => "Which way surfaces face: x red, y green, z blue",
            Show::Albedo => {
                "What surfaces reflect, without light and shadow; glass takes nothing and is white"
            }
            Show::Bounces => "How many rays a path takes, the camera's included: where the time goes",
            Show::Error => "Standard error of each pixel's mean, linear radiance: where the noise is",
            Show::Occupancy => {
                "How full the packets were, tile by tile: a lane whose tile has no more work waits until the \
                 last one there is done"
            }
            Show::Difference => "Distance from a loaded film, linear radiance",
        }
    }

    /// The key that stands for it, with Ctrl.
    pub fn key(self) -> Key {
        match self {
            Show::Picture => Key::Num1,
            Show::Normals => Key::Num2,
            Show::Albedo => Key::Num3,
            Show::Bounces => Key::Num4,
            Show::Error => Key::Num5,
            Show::Occupancy => Key::Num6,
            Show::Difference => Key::Num7,
        }
    }

    /// The layer that it is, if it is one.
    pub fn layer(self) -> Option<Layer> {
        match self {
            Show::Normals => Some(Layer::Normals),
            Show::Albedo => Some(Layer::Albedo),
            Show::Bounces => Some(Layer::RaysPerPath),
            Show::Picture | Show::Error | Show::Occupancy | Show::Difference => None,
        }
    }

    /// What its colours mean, if it is a heat map.
    fn scale(self) -> Option<HeatScale> {
        match self {
            Show::Bounces => Some(HeatScale::RAYS),
            Show::Error | Show::Difference => Some(HeatScale::ERROR),
            Show::Occupancy => Some(HeatScale::OCCUPANCY),
            Show::Picture | Show::Normals | Show::Albedo => None,
        }
    }
}

/// How large the picture is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Zoom {
    /// As large as there is room.
    Fit,
    /// Pixels of the screen for one of the picture.
    Times(f32),
}

const ZOOM_LIMITS: [f32; 2] = [0.05, 64.0];

/// Radians that a point of dragging turns.
const TURN_PER_POINT: f64 = 0.006;

/// The share of the distance that a point of scrolling covers.
const DOLLY_PER_POINT: f64 = 0.002;

/// How long the mark of a click stays.
const MARK: Duration = Duration::from_millis(1600);

struct Mark {
    place: [f64; 2],
    text: String,
    since: Instant,
}

/// How the picture is looked at.
pub struct Viewport {
    /// What it shows.
    pub show: Show,
    /// How large.
    pub zoom: Zoom,
    /// Where the picture's middle is, points from the middle of the room.
    pan: Vec2,
    mark: Option<Mark>,
    is_dragging_divider: bool,
    /// Where the menu of a right click was asked for, if on the picture.
    menu_at: Option<Pos2>,
    last_times: f32,
    /// Where the picture was drawn last.
    pub rect: Rect,
}

impl Default for Viewport {
    fn default() -> Self {
        Viewport {
            show: Show::Picture,
            zoom: Zoom::Fit,
            pan: Vec2::ZERO,
            mark: None,
            is_dragging_divider: false,
            menu_at: None,
            last_times: 1.0,
            rect: Rect::ZERO,
        }
    }
}

impl Viewport {
    pub fn actual_size(&mut self) {
        self.zoom = Zoom::Times(1.0);
        self.pan = Vec2::ZERO;
    }

    pub fn zoom_by(&mut self, factor: f32) {
        let [low, high] = ZOOM_LIMITS;
        let times = (self.last_times * factor).clamp(low, high);
        self.pan *= times / self.last_times;
        self.zoom = Zoom::Times(times);
    }

    /// Where the picture goes in `room`, on whole pixels of the screen.
    fn place(&mut self, room: Rect, size: Vec2, pixels_per_point: f32) -> Rect {
        let fitting = (room.width() / size.x).min(room.height() / size.y) * pixels_per_point;
        let times = match self.zoom {
            Zoom::Fit => {
                self.pan = Vec2::ZERO;
                fitting
            }
            Zoom::Times(times) => times,
        };
        self.last_times = times;
        let rect = Rect::from_center_size(room.center() + self.pan, size * times / pixels_per_point);
        let corner = (rect.min.to_vec2() * pixels_per_point).round() / pixels_per_point;
        Rect::from_min_size(corner.to_pos2(), rect.size())
    }

    /// The whole pixel of the picture under a point of the screen.
    pub fn pixel_at(&self, at: Pos2, size: [u32; 2]) -> Option<[u32; 2]> {
        if !self.rect.contains(at) || self.rect.width() <= 0.0 {
            return None;
        }
        let along = (at - self.rect.min) / self.rect.size();
        Some([
            ((along.x * size[0] as f32) as u32).min(size[0] - 1),
            ((along.y * size[1] as f32) as u32).min(size[1] - 1),
        ])
    }
}

pub fn ui(window: &mut Window, ui: &mut Ui) {
    let room = ui.available_rect_before_wrap();
    let response = ui.allocate_rect(room, Sense::click_and_drag());
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Image, true, "Picture"));
    let settings = window.document.settings;
    let size = vec2(settings.width as f32, settings.height as f32);
    let margin = if window.remembered.has_panels { 10.0 } else { 0.0 };
    let inner = room.shrink(margin);
    let rect = window.viewport.place(inner, size, ui.ctx().pixels_per_point());
    window.viewport.rect = rect;

    let is_over_divider = handle_divider(window, ui, &response, rect);
    if !is_over_divider {
        handle_mouse(window, ui, &response, rect);
    }
    paint(window, ui, room, rect);
    window.inspector.hover(
        response.hover_pos().and_then(|at| window.viewport.pixel_at(at, [settings.width, settings.height])),
    );
    if response.secondary_clicked() {
        window.viewport.menu_at = response.interact_pointer_pos().filter(|at| rect.contains(*at));
    }
    response.context_menu(|ui| context_menu(window, ui, rect));
    window.toasts.ui(ui, room);
    paint_drop(ui, room);
}

fn handle_divider(window: &mut Window, ui: &Ui, response: &egui::Response, rect: Rect) -> bool {
    if window.compare.mode != Some(Mode::Wipe) {
        window.viewport.is_dragging_divider = false;
        return false;
    }
    let x = rect.left() + rect.width() * window.compare.divider;
    let pointer = response.interact_pointer_pos().or(response.hover_pos());
    let is_near = pointer.is_some_and(|at| (at.x - x).abs() < 8.0);
    if response.drag_started_by(PointerButton::Primary) {
        let origin = ui.input(|input| input.pointer.press_origin());
        window.viewport.is_dragging_divider = origin.is_some_and(|at| (at.x - x).abs() < 8.0);
    }
    if window.viewport.is_dragging_divider {
        if let Some(at) = response.interact_pointer_pos() {
            window.compare.divider = ((at.x - rect.left()) / rect.width()).clamp(0.0, 1.0);
        }
        if !response.dragged() {
            window.viewport.is_dragging_divider = false;
        }
    }
    let is_on_it = window.viewport.is_dragging_divider || (is_near && !response.dragged());
    if is_on_it {
        ui.ctx().set_cursor_icon(CursorIcon::ResizeHorizontal);
    }
    is_on_it
}

fn handle_mouse(window: &mut Window, ui: &Ui, response: &egui::Response, rect: Rect) {
    let camera = window.document.camera;
    let (modifiers, scroll, zoom) =
        ui.input(|input| (input.modifiers, input.smooth_scroll_delta().y, input.zoom_delta()));
    let delta = response.drag_delta();
    let turn = vec_turn(delta);
    let mut moved = camera;
    let is_panning = response.dragged_by(PointerButton::Middle)
        || (response.dragged_by(PointerButton::Primary) && modifiers.shift);
    if is_panning {
        if window.viewport.zoom == Zoom::Fit {
            window.viewport.zoom = Zoom::Times(window.viewport.last_times);
        }
        window.viewport.pan += delta;
        ui.ctx().set_cursor_icon(CursorIcon::Grabbing);
    } else if response.dragged_by(PointerButton::Primary) {
        moved = navigation::orbit(&moved, turn.0, turn.1);
    } else if response.dragged_by(PointerButton::Secondary) {
        moved = navigation::look(&moved, turn.0, -turn.1);
    }
    if response.hovered() {
        if zoom != 1.0 {
            zoom_at(window, response.hover_pos(), rect, zoom);
        } else if scroll != 0.0 {
            moved = navigation::dolly(&moved, (-f64::from(scroll) * DOLLY_PER_POINT).exp());
        }
    }
    if moved != camera {
        window.document.camera = moved;
        window.note_move();
    }
    if let Some(at) = response.interact_pointer_pos().filter(|at| rect.contains(*at)) {
        if response.double_clicked() {
            Spot::Centre.use_at(window, ui, rect, at);
        } else if response.clicked() && (modifiers.alt || is_alt_release(ui)) {
            Spot::Paths.use_at(window, ui, rect, at);
        } else if response.clicked() {
            Spot::Focus.use_at(window, ui, rect, at);
        }
    }
}

/// What can be done with a place of the picture.
#[derive(Clone, Copy)]
enum Spot {
    Focus,
    Centre,
    Paths,
}

impl Spot {
    /// Its name in the menu, and the mouse's way to it.
    fn names(self) -> [&'static str; 2] {
        match self {
            Spot::Focus => ["Focus on this", "Click"],
            Spot::Centre => ["Look at this", "Double click"],
            Spot::Paths => ["List the paths of this pixel", "Alt and click"],
        }
    }

    fn use_at(self, window: &mut Window, ui: &Ui, rect: Rect, at: Pos2) {
        let along = (at - rect.min) / rect.size();
        let place = [f64::from(along.x), f64::from(along.y)];
        match self {
            Spot::Focus => focus(window, place),
            Spot::Centre => recentre(window, place),
            Spot::Paths => {
                let settings = window.document.settings;
                if let Some(pixel) = window.viewport.pixel_at(at, [settings.width, settings.height]) {
                    let sender = window.messages.0.clone();
                    window.paths.list(&window.document, pixel, &sender, ui.ctx());
                }
            }
        }
    }
}

fn context_menu(window: &mut Window, ui: &mut Ui, rect: Rect) {
    ui.set_width(super::menu::MENU_WIDTH);
    if let Some(at) = window.viewport.menu_at {
        for spot in [Spot::Focus, Spot::Centre, Spot::Paths] {
            let [name, mouse] = spot.names();
            let mouse = RichText::new(mouse).color(ui.visuals().weak_text_color());
            let button = egui::Button::new(name).shortcut_text(mouse);
            if ui.add(button.min_size(vec2(ui.available_width(), 0.0))).clicked() {
                spot.use_at(window, ui, rect, at);
                ui.close();
            }
        }
        ui.separator();
    }
    for command in [super::Command::Home, super::Command::AddBookmark, super::Command::CopyCommand] {
        super::menu::item(window, ui, command);
    }
}

/// Whether Alt was held when a button was let go: in a long frame it may have been let go since.
fn is_alt_release(ui: &Ui) -> bool {
    let is_it = |event: &egui::Event| matches!(event, egui::Event::PointerButton { pressed: false, modifiers, .. } if modifiers.alt);
    ui.input(|input| input.events.iter().any(is_it))
}

fn vec_turn(delta: Vec2) -> (f64, f64) {
    (f64::from(delta.x) * TURN_PER_POINT, f64::from(delta.y) * TURN_PER_POINT)
}

/// Zooms so that what is under the pointer stays there.
fn zoom_at(window: &mut Window, pointer: Option<Pos2>, rect: Rect, factor: f32) {
    let viewport = &mut window.viewport;
    let before = viewport.last_times;
    if viewport.zoom == Zoom::Fit {
        viewport.pan = Vec2::ZERO;
    }
    let [low, high] = ZOOM_LIMITS;
    let times = (before * factor).clamp(low, high);
    viewport.zoom = Zoom::Times(times);
    if let Some(at) = pointer {
        let from_middle = at - rect.center();
        viewport.pan += from_middle * (1.0 - times / before);
    }
}

/// Where the ray through a place of the picture meets the scene.
fn pick(window: &Window, place: [f64; 2]) -> Option<crate::scene::Pick> {
    let document = &window.document;
    let direction = document.camera.direction_through(place, document.aspect());
    document.scene().pick(document.camera.look_from, direction)
}

fn focus(window: &mut Window, place: [f64; 2]) {
    let text = match pick(window, place) {
        Some(pick) => {
            let camera = navigation::focus(&window.document.camera, pick.point);
            let is_pinhole = camera.defocus_angle_degrees == 0.0;
            window.document.camera = camera;
            let distance = camera.depth_of(pick.point);
            let note = if is_pinhole { " (a pinhole is sharp everywhere)" } else { "" };
            format!("focus {distance:.3}{note}")
        }
        None => "sky".to_owned(),
    };
    window.viewport.mark = Some(Mark { place, text, since: Instant::now() });
}

fn recentre(window: &mut Window, place: [f64; 2]) {
    if let Some(pick) = pick(window, place) {
        window.document.camera = navigation::recentre(&window.document.camera, pick.point);
        let text = "centre".to_owned();
        window.viewport.mark = Some(Mark { place: [0.5, 0.5], text, since: Instant::now() });
    }
}
