//! The window. The image refines while the user watches, and can be explored and edited meanwhile.
//!
//! `model` holds the user's choices, without widgets or drawing. Each panel is a function of the part of the model that
//! it may change, and of a snapshot of the rest; whatever else it wants, it requests as a [`Command`], like menus, keys
//! and the palette. Whoever asks a background thread owns the slot for its answers. Only [`Window`] knows everything: it
//! carries out the commands and decides what to render. The tracer runs on its own thread, and the window's thread never
//! waits for it.

mod commands;
mod dialogs;
mod files;
mod model;
mod panels;
mod toolkit;
mod tools;
mod tracing;
mod viewport;
mod window;

pub use commands::{Command, ROWS};
pub use eframe::egui::ThemePreference as Theme;
pub use model::{Device, Dock, Document, Origin, Partner, Remembered, Show, Sizing, Source, Tab};
pub use window::Window;

use crate::cli::{DrawWith, WindowOptions};
use crate::job::render::panic_text;
use crate::system::files::state_directory;
use crate::system::foreign::Captured;
use crate::system::interrupt::Interrupt;
use crate::system::journal;
use anyhow::{Result, anyhow, bail};
use eframe::egui::{self, Vec2, vec2};
use std::ops::RangeInclusive;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::process::ExitCode;
use std::sync::{Arc, OnceLock};

/// Scale factors that a window can have.
const SCALE_FACTORS: RangeInclusive<f64> = 0.1..=16.0;

/// The remedy when no window can be opened.
const REMEDY: &str = "add --batch to render to a file without a window, for example: \
                      weekender --batch --stage glass-schlick --out glass.png";

/// Opens the window and returns when it is closed.
///
/// # Errors
/// If there is no display, or no way to draw on it. The message says how to render without a window.
pub fn run(options: WindowOptions) -> Result<ExitCode> {
    if !has_display() {
        bail!(
            "there is no display to open a window on (neither DISPLAY nor WAYLAND_DISPLAY is set); {REMEDY}"
        );
    }
    // winit panics at what is not a positive number. At 100 times its size, the window ends some window managers and the
    // libraries of some displays.
    let factor = std::env::var("WINIT_X11_SCALE_FACTOR").unwrap_or_default();
    let is_factor = |text: &str| text.parse().is_ok_and(|factor: f64| SCALE_FACTORS.contains(&factor));
    if !factor.is_empty() && !factor.eq_ignore_ascii_case("randr") && !is_factor(&factor) {
        bail!(
            "WINIT_X11_SCALE_FACTOR is {factor:?}; set it to a number from {} to {} with a point, such as 1.5, or to randr",
            SCALE_FACTORS.start(),
            SCALE_FACTORS.end()
        );
    }
    let options = WindowOptions { state_directory: state_directory(), ..options };
    let drawn = Arc::new(OnceLock::<egui::Context>::new());
    let waker = Arc::clone(&drawn);
    // SIGTERM, as at the end of a desktop session, closes the window in order.
    let interrupt = Arc::new(Interrupt::install_with(move || {
        if let Some(context) = waker.get() {
            context.request_repaint();
        }
    })?);
    let mut failures = Vec::new();
    for &renderer in renderers(options.draw_with) {
        let (native, options) = (native_options(renderer), options.clone());
        let (drawn, heeded) = (Arc::clone(&drawn), Arc::clone(&interrupt));
        // Until the window is there, faults of the display are not the program's.
        journal::expect_panics(true);
        let captured = Captured::begin();
        let create = Box::new(move |context: &eframe::CreationContext<'_>| {
            drop(captured);
            journal::expect_panics(false);
            fit_to_monitor(context);
            let mut window = Window::with(options, context.storage)?;
            (window.shell.interrupt, window.shell.dialogs.system.is_there) = (Some(heeded), true);
            // The first frame would have egui's own style otherwise.
            window.dress(&context.egui_ctx);
            // A second renderer has a context of its own, but the first one never drew.
            let _ = drawn.set(context.egui_ctx.clone());
            Ok(Box::new(window) as Box<dyn eframe::App>)
        });
        let outcome = catch_unwind(AssertUnwindSafe(|| eframe::run_native("weekender", native, create)));
        let is_opening = journal::expect_panics(false);
        let outcome = match outcome {
            Ok(outcome) => outcome,
            Err(panic) if is_opening => {
                let reason = panic_text(panic.as_ref());
                check_libraries(reason)?;
                bail!(
                    "the display {} cannot open a window: {reason}; use another display, or {REMEDY}",
                    display()
                )
            }
            Err(panic) => resume_unwind(panic),
        };
        match outcome {
            Ok(()) if interrupt.is_set() => return Ok(interrupt.exit_code()),
            Ok(()) => return Ok(ExitCode::SUCCESS),
            // The window system's own message names places in its source code, and another renderer would not help.
            Err(eframe::Error::WinitEventLoop(error)) => {
                check_libraries(&format!("{error:?}"))?;
                bail!("the display {} does not answer; {REMEDY}", display())
            }
            Err(error) => failures.push(format!("with {renderer}: {error}")),
        }
    }
    Err(anyhow!("the window cannot be opened; {}; {REMEDY}", failures.join("; ")))
}

/// Refuses if a message of the window system names a library, which it then could not load.
fn check_libraries(message: &str) -> Result<()> {
    let mut words = message.split(|c: char| !c.is_alphanumeric() && !"-_.".contains(c));
    words.find(|word| word.starts_with("lib") && word.contains(".so")).map_or(Ok(()), |library| {
        Err(anyhow!("a window needs {library}, which cannot be loaded; install it, or {REMEDY}"))
    })
}

/// Makes a window smaller that would not fit its monitor with its frame: the first one leaves room for a task bar, too.
fn fit_to_monitor(context: &eframe::CreationContext) {
    let Some(window) = context.winit_window() else { return };
    let monitor = window.current_monitor().or_else(|| window.available_monitors().next());
    let Some(monitor) = monitor.map(|monitor| monitor.size()) else { return };
    let is_first = context.storage.and_then(|storage| storage.get_string("window")).is_none();
    let (mut inside, scale) = (window.inner_size(), window.scale_factor() as f32);
    let [size, monitor] = [inside, monitor].map(|size| vec2(size.width as f32, size.height as f32));
    let fitting = fitting_size(size, monitor, scale, is_first);
    if fitting != size {
        (inside.width, inside.height) = (fitting.x as u32, fitting.y as u32);
        let _ = window.request_inner_size(inside);
    }
}

/// The size in pixels of the inside of a window that should have `size`, on a monitor where a point has `scale` pixels.
fn fitting_size(size: Vec2, monitor: Vec2, scale: f32, is_first: bool) -> Vec2 {
    /// Points of a usual frame with its title bar, and of a task bar.
    const FRAME: Vec2 = vec2(4.0, 40.0);
    const TASK_BAR: Vec2 = vec2(0.0, 48.0);
    let around = if is_first { FRAME + TASK_BAR } else { FRAME };
    size.min((monitor - scale * around).max(vec2(480.0, 320.0))).floor()
}

/// The renderers to try for drawing the window, in order. Without a GPU a frame takes several times as long with wgpu
/// as with OpenGL, because egui's wgpu shader computes everything that it might need.
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
            .with_clamp_size_to_monitor_size(true)
            .with_min_inner_size([480.0, 320.0])
            .with_icon(toolkit::theme::icon())
            .with_drag_and_drop(true),
        renderer,
        dithering: false,
        ..Default::default()
    }
}

/// Whether the system has a display.
fn has_display() -> bool {
    !cfg!(all(unix, not(target_vendor = "apple"))) || !display().is_empty()
}

/// The displays named by the environment.
fn display() -> String {
    let values = ["DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET"].map(std::env::var_os);
    let named: Vec<_> = values.iter().flatten().map(|value| value.to_string_lossy()).collect();
    named.join(" ").trim().to_owned()
}

#[cfg(test)]
mod tests {
    use super::commands::Snapshot;
    use super::*;
    use crate::cli::{Request, parse};
    use egui_kittest::{Harness, HarnessBuilder};

    /// The window of a command line, without a display.
    pub(super) fn window(words: &str) -> Window {
        Window::new(options(words)).unwrap()
    }

    #[test]
    fn a_library_that_is_missing_is_named() {
        let told = |message: &str| check_libraries(message).map_err(|error| error.to_string());
        assert_eq!(told("the server does not answer"), Ok(()));
        let refused = told("cannot open shared object file: (libX11.so.6: No such file)").unwrap_err();
        assert!(refused.contains("needs libX11.so.6") && refused.contains("install it"), "{refused}");
    }

    fn options(words: &str) -> WindowOptions {
        match parse(words.split_whitespace().map(Into::into)).unwrap() {
            Request::Window(options) => *options,
            other => panic!("{words}: {other:?}"),
        }
    }

    /// A snapshot of the window of a command line before its first frame.
    pub(super) fn snapshot_of(words: &str) -> Snapshot {
        window(&format!("weekender {words} --device cpu")).snapshot()
    }

    /// A harness that draws a part of the window in the window's own dark style.
    pub(super) fn dressed<State>(size: [f32; 2]) -> HarnessBuilder<State> {
        Harness::<State>::builder().with_size(size).with_context_setup(toolkit::theme::install)
    }

    #[test]
    fn the_window_fits_its_monitor_with_its_frame() {
        for (monitor, scale, is_first, expected) in [
            ([1920.0, 1080.0], 1.0, true, [1280.0, 800.0]),
            ([1280.0, 800.0], 1.0, true, [1276.0, 712.0]),
            ([1366.0, 768.0], 1.0, true, [1280.0, 680.0]),
            ([1366.0, 768.0], 1.0, false, [1280.0, 728.0]),
            ([1280.0, 800.0], 2.0, true, [1272.0, 624.0]),
            ([320.0, 200.0], 1.0, true, [480.0, 320.0]),
        ] {
            let found = fitting_size(vec2(1280.0, 800.0), monitor.into(), scale, is_first);
            assert_eq!(<[f32; 2]>::from(found), expected, "{monitor:?} {scale} {is_first}");
        }
    }
}
