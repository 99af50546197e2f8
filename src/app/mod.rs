//! The window: a picture that gets better while one watches, and everything that one can do to it.
//!
//! `model` is what the user has chosen, free of controls and drawing. A panel is a function of the part of it that it may
//! change, of `Facts` to show, and of a list of [`Command`]s that it adds to; menus, keys and the palette add to the same
//! list. Whoever asks another thread keeps the place where the answers arrive. Only [`Window`] knows everything: it
//! carries out the commands and says what is to be rendered. The tracer has a thread of its own, which this one never
//! waits for.

mod answers;
mod changes;
mod command;
mod dialogs;
mod facts;
mod files;
mod frame;
mod frame_log;
mod info;
mod input;
mod inspector;
mod layers;
mod menu;
mod model;
mod navigation;
mod panels;
mod paths;
mod perform;
mod plot;
mod prediction;
mod receive;
mod second;
mod status_bar;
mod texture;
mod theme;
mod toasts;
mod tracer;
mod viewport;
mod widgets;
mod window;

pub use command::{Command, Group};
pub use model::device::Device;
pub use model::document::Document;
pub use model::origin::{Origin, Source};
pub use model::remembered::Theme;
pub use model::show::Show;
pub use window::Window;

use crate::cli::{DrawWith, WindowOptions};
use anyhow::{Result, anyhow, bail};
use eframe::egui;
use std::process::ExitCode;

/// What to do where there is no window to be had.
const REMEDY: &str = "add --batch to render to a file without a window, for example: \
                      weekender --batch --stage glass-schlick --out glass.png";

/// Opens the window and returns when it is closed.
///
/// # Errors
/// If there is no display, or nothing that can draw on it; the message says how to do without.
pub fn run(options: WindowOptions) -> Result<ExitCode> {
    if !has_display() {
        bail!(
            "there is no display to open a window on (neither DISPLAY nor WAYLAND_DISPLAY is set); {REMEDY}"
        );
    }
    let mut failures = Vec::new();
    for &renderer in renderers(options.draw_with) {
        let (native, options) = (native_options(renderer), options.clone());
        let create = Box::new(|context: &eframe::CreationContext<'_>| {
            Ok(Box::new(Window::new(options, context.storage)?) as Box<dyn eframe::App>)
        });
        match eframe::run_native("weekender", native, create) {
            Ok(()) => return Ok(ExitCode::SUCCESS),
            // The window system's own words name places in its source; another renderer would not help.
            Err(eframe::Error::WinitEventLoop(_)) => {
                bail!("the display {} does not answer; {REMEDY}", display())
            }
            Err(error) => failures.push(format!("with {renderer}: {error}")),
        }
    }
    Err(anyhow!("the window cannot be opened; {}; {REMEDY}", failures.join("; ")))
}

/// What may draw the window, to be tried in turn. A processor takes several times as long for a frame by way of wgpu
/// as by way of OpenGL, since egui's shader for wgpu computes all that it might need.
fn renderers(wish: DrawWith) -> &'static [eframe::Renderer] {
    use eframe::Renderer::{Glow, Wgpu};
    match wish {
        DrawWith::Wgpu => &[Wgpu],
        DrawWith::Gl => &[Glow],
        DrawWith::Auto if model::device::adapter().is_ok_and(|adapter| !adapter.is_software) => &[Wgpu, Glow],
        DrawWith::Auto => &[Glow, Wgpu],
    }
}

fn native_options(renderer: eframe::Renderer) -> eframe::NativeOptions {
    eframe::NativeOptions {
        viewport: egui::ViewportBuilder::default()
            .with_title("Weekender")
            .with_app_id("weekender")
            .with_inner_size([1280.0, 800.0])
            .with_min_inner_size([480.0, 320.0])
            .with_icon(theme::icon())
            .with_drag_and_drop(true),
        renderer,
        dithering: false,
        ..Default::default()
    }
}

/// Whether the system has somewhere to put a window.
fn has_display() -> bool {
    !cfg!(all(unix, not(target_vendor = "apple"))) || !display().is_empty()
}

/// The displays that the environment names.
fn display() -> String {
    let values = ["DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET"].map(std::env::var_os);
    let named: Vec<_> = values.iter().flatten().map(|value| value.to_string_lossy()).collect();
    named.join(" ").trim().to_owned()
}
