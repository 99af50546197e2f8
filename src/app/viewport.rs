//! The picture, and the hand on it.

use super::compare::Mode;
use super::navigation;
use super::theme;
use super::window::Window;
use crate::heat::{HeatScale, colour_at};
use crate::layers::Layer;
use crate::progressive::Phase;
use eframe::egui::{
    self, Align2, Color32, CornerRadius, CursorIcon, FontId, Key, PointerButton, Pos2, Rect, RichText, Sense,
    Stroke, TextStyle, TextureOptions, Ui, Vec2, WidgetInfo, pos2, vec2,
};
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

const WHOLE: Rect = Rect { min: pos2(0.0, 0.0), max: pos2(1.0, 1.0) };

fn paint(window: &mut Window, ui: &Ui, room: Rect, rect: Rect) {
    let painter = ui.painter().with_clip_rect(room);
    let options = |divisor: u32, times: f32| {
        // At 100 % and above a pixel is a square; a preview's are no pixels of the picture.
        if divisor == 1 && times >= 1.0 - 1e-4 { TextureOptions::NEAREST } else { TextureOptions::LINEAR }
    };
    let times = window.viewport.last_times;
    let context = ui.ctx();
    let other = window
        .compare
        .tracer
        .as_mut()
        .and_then(|tracer| tracer.shown_mut())
        .map(|shown| (shown.texture.id(context, options(shown.divisor, times)), shown.document.stage()));
    let layer = window.viewport.show.layer().and_then(|layer| window.layers.shown_mut(layer));
    let shown = match layer {
        Some(layer) => Some((layer.texture.id(context, options(layer.divisor, times)), layer.divisor)),
        None => window
            .main
            .shown_mut()
            .map(|shown| (shown.texture.id(context, options(shown.divisor, times)), shown.divisor)),
    };
    // The hole is a point smaller, so that no line stays free between the two.
    let hole = if shown.is_some() { rect.shrink(1.0).intersect(room) } else { Rect::NOTHING };
    fill_around(&painter, room, hole, theme::surround(ui));
    if let Some((texture, _)) = shown {
        painter.image(texture, rect, WHOLE, Color32::WHITE);
    }
    let divisor = shown.map_or(1, |(_, divisor)| divisor);
    let font = TextStyle::Body.resolve(ui.style());
    if window.compare.mode == Some(Mode::Wipe)
        && let Some((texture, stage)) = other
    {
        paint_wipe(window, ui, &painter, rect, texture, stage, &font);
    }
    let is_difference = window.compare.mode == Some(Mode::Difference);
    let scale = if is_difference { Some(HeatScale::ERROR) } else { window.viewport.show.scale() };
    if let Some(scale) = scale {
        paint_scale(ui, &painter, rect.intersect(room), &scale);
    }
    if divisor > 1 {
        let text = format!("preview 1/{divisor}");
        badge(ui, &painter, rect.intersect(room).left_top() + vec2(8.0, 8.0), Align2::LEFT_TOP, &text, &font);
    }
    if window.main.shown().is_none() {
        let text = match (&window.invalid, &window.main.status().phase) {
            (Some(reason), _) | (None, Phase::Failed(reason)) => reason.as_str(),
            _ => "preparing…",
        };
        let colour = ui.visuals().weak_text_color();
        painter.text(rect.center(), Align2::CENTER_CENTER, text, font.clone(), colour);
    }
    if let Zoom::Times(times) = window.viewport.zoom {
        let text = format!("{:.0} %", 100.0 * times);
        badge(
            ui,
            &painter,
            rect.intersect(room).right_top() + vec2(-8.0, 8.0),
            Align2::RIGHT_TOP,
            &text,
            &font,
        );
    }
    window.paths.paint(&window.document, ui, &painter, rect);
    paint_mark(window, ui, &painter, rect, &font);
}

/// Fills `room` but for `hole`: where a processor draws, each pixel that is drawn twice is time lost.
fn fill_around(painter: &egui::Painter, room: Rect, hole: Rect, colour: Color32) {
    if !hole.is_positive() {
        painter.rect_filled(room, 0.0, colour);
        return;
    }
    for rect in [
        Rect { max: pos2(room.right(), hole.top()), ..room },
        Rect { min: pos2(room.left(), hole.bottom()), ..room },
        Rect { min: pos2(room.left(), hole.top()), max: pos2(hole.left(), hole.bottom()) },
        Rect { min: pos2(hole.right(), hole.top()), max: pos2(room.right(), hole.bottom()) },
    ] {
        painter.rect_filled(rect, 0.0, colour);
    }
}

fn paint_wipe(
    window: &Window,
    ui: &Ui,
    painter: &egui::Painter,
    rect: Rect,
    texture: egui::TextureId,
    stage: Option<&'static crate::stages::Stage>,
    font: &FontId,
) {
    let share = window.compare.divider;
    let x = rect.left() + rect.width() * share;
    let right = Rect::from_min_max(pos2(x, rect.top()), rect.max);
    let uv = Rect::from_min_max(pos2(share, 0.0), pos2(1.0, 1.0));
    painter.image(texture, right, uv, Color32::WHITE);
    painter.vline(x, rect.y_range(), Stroke::new(3.0, Color32::from_black_alpha(120)));
    painter.vline(x, rect.y_range(), Stroke::new(1.5, Color32::WHITE));
    let knob = pos2(x, rect.center().y);
    painter.circle(knob, 9.0, Color32::WHITE, Stroke::new(1.0, Color32::from_black_alpha(120)));
    for side in [-1.0, 1.0] {
        let tip = knob + vec2(6.0 * side, 0.0);
        let back = knob + vec2(2.5 * side, 0.0);
        let points = vec![tip, back + vec2(0.0, -3.5), back + vec2(0.0, 3.5)];
        painter.add(egui::Shape::convex_polygon(points, Color32::from_gray(60), Stroke::NONE));
    }
    let name = |stage: &crate::stages::Stage| format!("{} {}", stage.section, stage.title);
    let y = rect.top().max(painter.clip_rect().top()) + 8.0;
    // Names that would reach beyond the picture stay within it.
    let painter = &painter.with_clip_rect(rect.intersect(painter.clip_rect()));
    if let Some(mine) = window.document.stage() {
        badge(ui, painter, pos2(x - 14.0, y), Align2::RIGHT_TOP, &name(mine), font);
    }
    if let Some(theirs) = stage {
        let is_of_cameras = window.document.stage().is_some_and(|mine| window.compare.is_of_cameras(mine));
        let whose = if is_of_cameras { ", with its own camera" } else { "" };
        badge(ui, painter, pos2(x + 14.0, y), Align2::LEFT_TOP, &format!("{}{whose}", name(theirs)), font);
    }
}

/// The colours of a heat map with what they mean.
fn paint_scale(ui: &Ui, painter: &egui::Painter, rect: Rect, scale: &HeatScale) {
    const STEPS: usize = 64;
    let font = TextStyle::Small.resolve(ui.style());
    let row = font.size + 4.0;
    let plate = vec2(228.0, 22.0 + 2.0 * row);
    let plate = Rect::from_min_size(rect.left_bottom() + vec2(10.0, -plate.y - 10.0), plate);
    painter.rect_filled(plate, CornerRadius::same(6), ui.visuals().panel_fill.gamma_multiply(0.9));
    let weak = ui.visuals().weak_text_color();
    painter.text(plate.min + vec2(24.0, 5.0), Align2::LEFT_TOP, scale.title, font.clone(), weak);
    let bar = Rect::from_min_size(plate.min + vec2(24.0, 6.0 + row), vec2(plate.width() - 48.0, 9.0));
    for step in 0..STEPS {
        let [red, green, blue] = colour_at((step as f64 + 0.5) / STEPS as f64);
        let left = bar.left() + bar.width() * step as f32 / STEPS as f32;
        let size = vec2(bar.width() / STEPS as f32 + 0.5, bar.height());
        painter.rect_filled(
            Rect::from_min_size(pos2(left, bar.top()), size),
            0.0,
            Color32::from_rgb(red, green, blue),
        );
    }
    for (value, name) in scale.marks {
        let at = pos2(bar.left() + bar.width() * scale.place(*value) as f32, bar.bottom() + 2.0);
        painter.text(at, Align2::CENTER_TOP, name, font.clone(), ui.visuals().text_color());
    }
}

/// What happens to files that are held over the window.
fn paint_drop(ui: &Ui, room: Rect) {
    let Some(files) = ui.input(|input| words_for_files(&input.raw.hovered_files)) else { return };
    let painter =
        ui.ctx().layer_painter(egui::LayerId::new(egui::Order::Foreground, egui::Id::unique("drop")));
    painter.rect_filled(room, CornerRadius::ZERO, ui.visuals().panel_fill.gamma_multiply(0.8));
    painter.rect_stroke(
        room.shrink(12.0),
        CornerRadius::same(8),
        Stroke::new(2.0, super::theme::accent(ui)),
        egui::StrokeKind::Inside,
    );
    let font = TextStyle::Heading.resolve(ui.style());
    painter.text(room.center(), Align2::CENTER_CENTER, files, font, ui.visuals().strong_text_color());
}

fn words_for_files(files: &[egui::HoveredFile]) -> Option<String> {
    let name = files.first()?.path.as_ref().and_then(|path| path.file_name());
    Some(
        name.map_or_else(
            || "Drop to open".to_owned(),
            |name| format!("Drop to open {}", name.to_string_lossy()),
        ),
    )
}

/// Text on a plate, so that it can be read on any picture.
fn badge(ui: &Ui, painter: &egui::Painter, at: Pos2, anchor: Align2, text: &str, font: &FontId) {
    let galley = painter.layout_no_wrap(text.to_owned(), font.clone(), ui.visuals().strong_text_color());
    let mut rect = anchor.anchor_size(at, galley.size() + vec2(14.0, 6.0));
    let clip = painter.clip_rect();
    let (beyond_left, beyond_right) = (clip.left() + 4.0 - rect.left(), rect.right() + 4.0 - clip.right());
    if beyond_left > 0.0 || beyond_right > 0.0 {
        let along = if beyond_left > 0.0 { beyond_left } else { -beyond_right };
        // A row lower, so that it does not cover what stands beside it.
        rect = rect.translate(vec2(along, rect.height() + 4.0));
    }
    painter.rect_filled(rect, CornerRadius::same(5), ui.visuals().panel_fill.gamma_multiply(0.9));
    painter.galley(rect.min + vec2(7.0, 3.0), galley, ui.visuals().strong_text_color());
}

fn paint_mark(window: &mut Window, ui: &Ui, painter: &egui::Painter, rect: Rect, font: &FontId) {
    let Some(mark) = &window.viewport.mark else { return };
    let age = mark.since.elapsed();
    if age > MARK {
        window.viewport.mark = None;
        return;
    }
    let at = rect.min + vec2(mark.place[0] as f32, mark.place[1] as f32) * rect.size();
    painter.circle_stroke(at, 9.0, Stroke::new(3.0, Color32::from_black_alpha(130)));
    painter.circle_stroke(at, 9.0, Stroke::new(1.5, Color32::WHITE));
    painter.circle_filled(at, 1.5, Color32::WHITE);
    badge(ui, painter, at + vec2(14.0, 0.0), Align2::LEFT_CENTER, &mark.text, font);
    ui.ctx().request_repaint_after(MARK - age);
}
