//! Everything that a menu entry, a key, a button or the palette can do: one table, one row a command.

use super::facts::Facts;
use crate::app::dialogs::stage_list;
use crate::app::dialogs::{Dialog, Purpose};
use crate::app::model::spheres::neighbour;
use crate::app::model::{Channel, Device, Dock, Edit, Mode, Origin, Show, Tab, Tone, ViewState, With};
use crate::app::toolkit::finder::Finder;
use crate::app::window::Window;
use crate::app::window::layout::NARROW;
use crate::job::output::OutputFormat;
use crate::measure::stress::Case;
use crate::stages::{BOOK_URL, Stage};
use eframe::egui::{
    Context, FocusDirection, Key, KeyboardShortcut, ModifierNames, Modifiers, ThemePreference,
    ViewportCommand,
};
use std::sync::LazyLock;

/// The menus of the bar.
pub const MENUS: [&str; 6] = ["File", "Edit", "View", "Render", "Stage", "Help"];

type Off = Box<dyn Fn(&Facts) -> Option<String> + Send + Sync>;
type On = Box<dyn Fn(&Facts) -> bool + Send + Sync>;
type Run = Box<dyn Fn(&mut Window, &Context) + Send + Sync>;

/// All about a command.
pub struct Row {
    pub command: Command,
    pub name: &'static str,
    pub help: &'static str,
    pub keys: Option<KeyboardShortcut>,
    /// The menu or submenu in which it stands, in the order of the table.
    pub menu: Option<&'static str>,
    /// A line separates it from the entry above.
    pub has_line: bool,
    /// The palette lists it.
    pub is_listed: bool,
    /// Other words by which the palette finds it.
    pub synonyms: &'static str,
    /// Why it cannot be used now, if so.
    off: Off,
    /// Whether what it switches is on; none if it is no switch.
    on: Option<On>,
    run: Run,
}

impl Row {
    fn new(
        menu: Option<&'static str>,
        command: Command,
        [name, help]: [&'static str; 2],
        run: impl Fn(&mut Window, &Context) + Send + Sync + 'static,
    ) -> Self {
        Row {
            command,
            name,
            help,
            keys: None,
            menu,
            has_line: false,
            is_listed: true,
            synonyms: "",
            off: Box::new(|_| None),
            on: None,
            run: Box::new(run),
        }
    }

    fn keys(mut self, modifiers: Modifiers, key: Key) -> Self {
        self.keys = Some(KeyboardShortcut::new(modifiers, key));
        self
    }

    fn key(self, key: Key) -> Self {
        self.keys(Modifiers::NONE, key)
    }

    fn line(mut self) -> Self {
        self.has_line = true;
        self
    }

    fn also(mut self, synonyms: &'static str) -> Self {
        self.synonyms = synonyms;
        self
    }

    /// For keys and buttons alone.
    fn unlisted(mut self) -> Self {
        self.is_listed = false;
        self
    }

    fn off(mut self, off: impl Fn(&Facts) -> Option<String> + Send + Sync + 'static) -> Self {
        self.off = Box::new(off);
        self
    }

    /// Off unless `is_possible`, for this reason.
    fn needs(
        self,
        is_possible: impl Fn(&Facts) -> bool + Send + Sync + 'static,
        reason: &'static str,
    ) -> Self {
        self.off(move |facts| (!is_possible(facts)).then(|| reason.to_owned()))
    }

    fn on(mut self, on: impl Fn(&Facts) -> bool + Send + Sync + 'static) -> Self {
        self.on = Some(Box::new(on));
        self
    }
}

const CTRL: Modifiers = Modifiers::COMMAND;
const SHIFT: Modifiers = Modifiers::SHIFT;
const CTRL_SHIFT: Modifiers = Modifiers::COMMAND.plus(Modifiers::SHIFT);

/// The keys of the digits 1 to 9.
pub const DIGITS: [Key; 9] =
    [Key::Num1, Key::Num2, Key::Num3, Key::Num4, Key::Num5, Key::Num6, Key::Num7, Key::Num8, Key::Num9];

/// All commands but places, menu by menu in the order of the menus.
pub static ROWS: LazyLock<Vec<Row>> =
    LazyLock::new(|| plain_rows().into_iter().chain(family_rows()).collect());

/// Makes the commands and their rows. A row has the command, its name, one sentence about it, what it does, and more.
macro_rules! table {
    (
        families { $($(#[$about:meta])* $family:ident($value:ty),)* }
        $([$menu:expr] $($command:ident $name:expr, $help:expr, $run:expr
            $(, $method:ident($($argument:expr),*))*;)*)*
    ) => {
        /// A thing that can be done. Its row in [`ROWS`] says all about it; places, such as stages and files, have none.
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub enum Command {
            $($(#[$about])* $family($value),)*
            $($($command,)*)*
        }

        fn plain_rows() -> Vec<Row> {
            vec![$($(
                Row::new($menu, Command::$command, [$name, $help], $run)$(.$method($($argument),*))*,
            )*)*]
        }
    };
}

// A row takes a few lines; rustfmt would give each argument one.
#[rustfmt::skip]
table! {
    families {
        /// Opens the dialog of `Save` with this format.
        SaveAs(OutputFormat),
        Show(Show),
        Theme(ThemePreference),
        Device(Device),
        Channel(Channel),
        Stage(&'static Stage),
        Extreme(&'static Case),
        /// Opens a recent file.
        Recent(usize),
        Bookmark(usize),
        /// Looks at a kept picture, counted from 0.
        Kept(usize),
        /// Goes to the field of this name in the left panel.
        Field(&'static str),
    }

    [Some("File")]
    Open "Open…", "Opens a scene, a picture or a film, and goes on with it",
        |w, c| w.ask_path(c, Purpose::Open),
        keys(CTRL, Key::O), also("load import resume");
    CheckPicture "Check my picture…",
        "Finds the mistake in a picture that your own program has rendered",
        |w, c| w.ask_path(c, Purpose::Check),
        also("wrong mistake homework verify compare");
    Save "Save…", "Saves the picture, the film or the scene",
        |w, _| w.ask_save(OutputFormat::Png), keys(CTRL, Key::S), line(), needs(is_live, KEPT_IS_SHOWN),
        also("export png ppm exr toml download film scene");
    ShowInFolder "Show in folder", "Opens the folder of the file that was saved or opened last",
        |w, c| w.show_in_folder(c),
        needs(|f| !f.model.remembered.recent.is_empty(), "Nothing has been saved or opened yet"),
        also("directory explorer finder");
    CopyPicture "Copy picture", "Copies the picture at full size",
        |w, _| w.files.pending_copy = true, keys(CTRL, Key::C), needs(is_live, KEPT_IS_SHOWN), also("clipboard");
    CopyCommand "Copy as command", "Copies the command line that renders this picture",
        |w, c| w.copy_command(c), keys(CTRL_SHIFT, Key::C), also("batch terminal shell clipboard");
    Fresh "Start fresh", "Goes back to the first picture, with the usual settings; Undo returns",
        |w, _| w.start_fresh(), line();
    Quit "Quit", "Closes the window; the next one begins where this one ends",
        |_, c| c.send_viewport_cmd(ViewportCommand::Close), keys(CTRL, Key::Q), also("close exit");

    [Some("Edit")]
    Undo "Undo", "Takes back the last change", |w, _| w.undo(), keys(CTRL, Key::Z),
        needs(|f| f.undo.is_some(), "Nothing has been changed yet"), also("back lost");
    Redo "Redo", "Makes that change again", |w, _| w.redo(), keys(CTRL_SHIFT, Key::Z),
        needs(|f| f.redo.is_some(), "Nothing has been undone");
    ResetAll "Reset everything",
        "Returns to the stage as it is in the book; Undo brings your changes back",
        |w, _| w.change(|w| w.model.document.reset()),
        needs(|f| f.document().is_changed(), "This is the stage as it is in the book"),
        also("original lost back");
    AddSphere "Add a sphere", "Puts a sphere where the pointer is", |w, _| w.add_sphere(),
        key(Key::Insert), line(), off(|f| f.no_rays().map(str::to_owned)), also("new ball");
    DuplicateSphere "Duplicate the sphere", "Puts a copy beside the selected sphere",
        |w, _| w.duplicate_sphere(), keys(CTRL, Key::D), needs(has_selection, NO_SPHERE), also("copy ball");
    DeleteSphere "Delete the sphere", "Removes the selected sphere",
        |w, _| w.model.selected.into_iter().for_each(|sphere| w.edit(Edit::Delete(sphere))),
        key(Key::Delete), needs(has_selection, NO_SPHERE), also("remove ball");
    SkyColours "Sky colours…", "Changes the two colours that the sky fades between",
        |w, _| w.shell.dialogs.open(Dialog::Sky), off(|f| f.no_rays().map(str::to_owned)),
        also("background light gradient");
    Home "Reset the camera", "Returns to the camera and lens of the stage",
        |w, _| w.model.document.camera = w.document().origin.recipe.camera,
        key(Key::Home), line(),
        needs(|f| f.document().camera != f.document().origin.recipe.camera, "This is the camera of the stage"),
        also("home lost back original");

    [Some("View")]
    Fit "Fit in the window", "Shows the whole picture as large as possible",
        |w, _| w.display.viewport.placement.fit(), key(Key::F), line();
    ActualSize "Actual size", "One pixel of the picture per pixel of the screen",
        |w, _| w.display.viewport.placement.actual_size(), key(Key::Num1), also("100 % zoom");
    Controls "Controls", "Shows or hides camera, lens and sphere at the left",
        |w, _| w.toggle(|r| &mut r.has_controls), key(Key::L), line(), off(no_presentation),
        on(|f| f.model.remembered.has_controls), also("left panel camera lens");
    Info "Stage and pixel", "Shows or hides the text and the numbers at the right",
        |w, _| w.toggle(|r| &mut r.has_info), key(Key::I), off(no_presentation),
        on(|f| f.model.remembered.has_info), also("right panel text");
    KeptDock "Kept pictures", "Opens the dock with the pictures that you have kept",
        |w, _| w.toggle_dock(Dock::Kept), keys(SHIFT, Key::M), off(no_presentation),
        on(|f| f.model.remembered.dock == Some(Dock::Kept)), also("slot snapshot compare");
    LanesDock "Lanes", "Opens the dock with what each lane does, step by step",
        |w, _| w.toggle_dock(Dock::Lanes), key(Key::N), off(no_presentation),
        on(|f| f.model.remembered.dock == Some(Dock::Lanes)), also("simd avx packet");
    ErrorDock "Error", "Opens the dock with the error over time",
        |w, _| w.toggle_dock(Dock::Error), key(Key::P), off(no_presentation),
        on(|f| f.model.remembered.dock == Some(Dock::Error)), also("plot convergence noise quality");
    Panels "Only the picture", "Hides all panels; again shows them", |w, _| w.toggle_panels(),
        key(Key::Tab), on(|f| !f.model.remembered.has_panels), also("hide panels");
    Present "Present", "Full screen with large captions, for a lecture; Escape ends it",
        |w, c| w.toggle_presentation(c), key(Key::F5), line(), on(|f| f.model.presentation.is_some()),
        also("lecture slides projector beamer");
    FullScreen "Full screen", "Fills the screen with the window",
        |w, c| w.fill_screen(c, !w.model.is_full_screen),
        key(Key::F11), on(|f| f.model.is_full_screen);

    [Some("Bookmarks")]
    AddBookmark "Bookmark this camera", "Keeps this camera and lens to jump back to",
        |w, _| w.add_bookmark(), keys(CTRL, Key::B), off(|f| f.no_rays().map(str::to_owned)),
        also("view position");

    [Some("Render")]
    Pause "Pause or go on",
        "Stops and continues; when done, goes on to half the error. No sample is lost",
        |w, c| w.pause_or_go_on(c), key(Key::Space),
        needs(
            |f| f.is_working() || f.model.is_paused || f.further().is_some(),
            "More samples would change nothing"
        ),
        on(|f| f.model.is_paused), also("stop resume continue");
    Restart "Start again", "Throws the samples away and begins anew", |w, _| {
            if std::mem::take(&mut w.model.is_paused) {
                w.tracing.resume();
            }
            w.tracing.restart();
        },
        key(Key::R);
    SwitchDevice "Switch CPU and GPU", "The same picture goes on with the other device",
        |w, _| w.model.remembered.device.toggle(Device::Gpu), key(Key::G), line(), off(|_| Device::Gpu.unavailable());
    Reference "Reference (f64)",
        "Traces with twice the digits, slowly, to show rounding errors",
        |w, _| w.model.remembered.device.toggle(Device::Reference),
        on(|f| f.model.remembered.device == Device::Reference), also("double precision");
    Keep "Keep this picture", "Keeps a copy with all its samples, to compare with",
        |w, _| w.display.kept.is_wanted = true, key(Key::M), line(), needs(is_live, KEPT_IS_SHOWN),
        also("slot snapshot compare");

    [Some("Stage")]
    Stages "All stages…", "Every picture of the book, with a small image; type to search",
        |w, _| w.shell.dialogs.open(Dialog::Stages(stage_list::list(&w.facts(), false))),
        key(Key::O), also("list section chapter");
    PreviousStage "Previous stage", "One step back in the book", |w, _| w.step_stage(false),
        key(Key::PageUp), needs(|f| f.neighbour(false).is_some(), "This is the first stage");
    NextStage "Next stage", "One step forward in the book", |w, _| w.step_stage(true),
        key(Key::PageDown), needs(|f| f.neighbour(true).is_some(), "This is the last stage");
    ShowMe "Show me", "Sets zoom, view or wipe so that you see what to look for; again returns",
        |w, _| w.toggle_sight(), key(Key::H), line(),
        off(|f| match f.document().stage() {
            Some(stage) => f.useless_show(Show::of_means(stage.sight.means)),
            None => Some("Only stages of the book name something to look for".to_owned()),
        }),
        on(|f| f.has_sight);
    Wipe "Wipe", "Drag a divider between this stage and the one that it is compared with",
        |w, _| w.compare(Mode::Wipe), key(Key::C), off(Facts::nothing_to_compare),
        on(|f| f.model.view.mode() == Some(Mode::Wipe) && f.model.view.with() == With::Stage),
        also("slot snapshot compare");
    Difference "Difference", "Shows where the two differ, and by how much",
        |w, _| w.compare(Mode::Difference), key(Key::X), off(Facts::nothing_to_compare),
        on(|f| f.model.view.mode() == Some(Mode::Difference) && f.model.view.compared_kept().is_none()),
        also("slot snapshot compare subtract");
    BookArithmetic "The book’s arithmetic",
        "Wipes against the same picture with the book’s own formulas",
        |w, _| w.model.view.toggle(Mode::Wipe, With::Book),
        needs(
            |f| f.document().origin.is_other_by_the_book(),
            "This picture already has the book’s arithmetic, or traces no rays"
        ),
        on(|f| f.model.view.mode().is_some() && f.model.view.with() == With::Book),
        also("rounding f64 precision");
    ListPaths "Paths of a pixel", "Shows the paths of the pixel under the pointer, ray by ray",
        |w, c| w.list_paths(c), key(Key::T), line(),
        off(|f| match f.no_rays() {
            Some(reason) => Some(reason.to_owned()),
            None if !is_live(f) => Some(KEPT_IS_SHOWN.to_owned()),
            None => (!f.has_pixel).then(|| "Point at the picture first".to_owned()),
        }),
        also("rays bounce trace");
    Code "Code", "Shows the lines of the tracer that are new in this stage",
        |w, _| {
            let tab = if w.model.shows(Tab::Code) { Tab::Stage } else { Tab::Code };
            let r = &mut w.model.remembered;
            (r.tab, r.has_panels, r.has_info) = (tab, true, true);
        }, key(Key::K),
        off(no_presentation),
        on(|f| f.model.shows(Tab::Code)), also("source rust wgsl program");
    Book "Read in the book", "Opens this section in the browser", |w, c| {
            let url = w.document().stage().map_or_else(|| BOOK_URL.into(), Stage::url);
            w.open_url(c, url);
        },
        also("web section");
    Companion "Read in the companion",
        "Opens the companion at this stage; writes it first, which takes 3 seconds",
        |w, c| w.write_companion(c, true), also("web page explain");
    ExtremeScenes "Extreme scenes…",
        "Opens the list of stages at its end: dust, soap bubbles, a planet’s pole and others",
        |w, _| w.shell.dialogs.open(Dialog::Stages(stage_list::list(&w.facts(), true))),
        line(), also("stress stiff numerical");

    [Some("Help")]
    FirstSteps "First steps", "Brings back the card with three things to try",
        |w, _| (w.model.has_first_steps, w.model.remembered.is_greeted) =
            (!w.model.has_first_steps, w.model.has_first_steps),
        off(no_presentation), on(|f| f.model.has_first_steps),
        also("tutorial introduction");
    Help "Keys and mouse", "All keys, and what the mouse does",
        |w, _| w.shell.dialogs.open(Dialog::Help), key(Key::F1),
        also("shortcuts keyboard help");
    Palette "Find a command…", "Type what you want to do",
        |w, c| w.shell.dialogs.open(Dialog::Palette(Finder::typed(c))), keys(CTRL, Key::P),
        also("palette search");
    About "About Weekender", "Version, licences, folder of the log, and how to report a fault",
        |w, _| w.shell.dialogs.open(Dialog::About), also("version licence report bug");

    [None]
    Brighter "Brighter",
        "Shows the picture with half a stop more light; files are saved without it",
        |w, _| w.model.view.tone.expose(Tone::STEP), key(Key::Plus), off(Facts::no_exposure),
        also("exposure bright dim");
    Darker "Darker", "Shows the picture with half a stop less light; files are saved without it",
        |w, _| w.model.view.tone.expose(-Tone::STEP), key(Key::Minus), off(Facts::no_exposure),
        also("exposure dim");
    NoExposure "As bright as it is saved", "Shows the picture without exposure",
        |w, _| w.model.view.tone.exposure = 0.0, key(Key::Num0), off(Facts::no_exposure),
        also("exposure bright dim reset");
    ZoomIn "Zoom in", "Ctrl and the wheel zoom at the pointer",
        |w, _| w.display.viewport.placement.zoom_by(1.25), key(Key::CloseBracket);
    ZoomOut "Zoom out", "Ctrl and the wheel zoom at the pointer",
        |w, _| w.display.viewport.placement.zoom_by(0.8), key(Key::OpenBracket);
    Denoise "Denoise", "Filters the noise away and says how wrong the result is; films are saved as they are",
        |w, _| w.model.view.is_denoised ^= true, key(Key::V),
        needs(|f| f.document().settings.estimate_error, "The film has one half; denoising compares two"),
        on(|f| f.model.view.is_denoised), also("filter smooth noise clean oidn");
    NextSphere "Next sphere", "Selects the next sphere of the scene",
        |w, _| w.model.selected = neighbour(w.document().scene(), w.model.selected, true),
        key(Key::Period), needs(has_spheres, "There is no sphere in this scene"), also("select");
    PreviousSphere "Previous sphere", "Selects the previous sphere of the scene",
        |w, _| w.model.selected = neighbour(w.document().scene(), w.model.selected, false), key(Key::Comma),
        needs(has_spheres, "There is no sphere in this scene"), also("select");
    FocusSphere "Focus on the sphere",
        "Sets the focus distance to the nearest point of the selected sphere", |w, _| w.focus_sphere(),
        needs(has_selection, NO_SPHERE), also("sharp depth of field");
    Flip "Flip between the two", "Shows the traced picture and the kept one in turn",
        |w, _| w.model.view.flip(), key(Key::J), needs(has_kept, NOTHING_KEPT),
        on(|f| f.model.view.looked().is_some()),
        also("kept slot compare blink");
    KeptWipe "Wipe with the kept picture", "Drag a divider between it and the picture",
        |w, _| w.model.view.toggle(Mode::Wipe, With::Kept), keys(SHIFT, Key::C), needs(has_kept, NOTHING_KEPT),
        on(|f| f.model.view.mode() == Some(Mode::Wipe) && f.model.view.compared_kept().is_some() && is_live(f)),
        also("slot compare");
    KeptDifference "Difference from the kept picture", "Subtracts it from the picture",
        |w, _| w.model.view.toggle(Mode::Difference, With::Kept), keys(SHIFT, Key::X), off(Facts::not_subtractable),
        on(|f| f.model.view.mode() == Some(Mode::Difference) && f.model.view.compared_kept().is_some()),
        also("slot compare subtract");
    OnlyNoise "Is it only noise?", "Tests whether the two differ by more than chance",
        |w, c| w.ask_only_noise(c), keys(SHIFT, Key::N), off(Facts::not_subtractable),
        also("kept slot compare same");
    RenderAtSize "Render at this size",
        "Renders one pixel of the picture per pixel of the screen; the samples begin anew",
        |w, _| {
            w.model.document.has_own_size = false;
            w.tracing.sizer.ask();
        }, unlisted();
    StopSaving "Stop", "Gives up this render", |w, _| w.files.stop_saving(), unlisted();
    Recover "Go on with it", "Shows it, and adds more samples",
        |w, c| w.autosave.left().into_iter().for_each(|path| w.files.open(c, path)), unlisted();
    WholeCompanion "Write the full one",
        "Renders its pictures at full size and without noise, which takes some minutes",
        |w, c| w.write_companion(c, false), unlisted();
    StopCompanion "Stop", "Leaves out the pictures that are missing",
        |w, _| w.files.stop_companion(), unlisted();
    GoOnFromKept "Go on from it", "Makes it the picture that is traced, and adds more samples",
        |w, _| w.go_on_from_kept(), needs(has_kept, NOTHING_KEPT), unlisted();
    DeleteKept "Delete", "Deletes the kept picture", |w, _| w.model.view.delete_kept(),
        needs(has_kept, NOTHING_KEPT), unlisted();
    NextRay "Next ray", "", |w, _| w.tools.paths.step(true), key(Key::ArrowRight),
        needs(|f| f.has_paths, NO_PATHS), unlisted();
    PreviousRay "Previous ray", "", |w, _| w.tools.paths.step(false), key(Key::ArrowLeft),
        needs(|f| f.has_paths, NO_PATHS), unlisted();
    ClearPaths "Close the paths", "", |w, _| {
            w.tools.paths.forget();
            w.model.remembered.dock.take_if(|dock| *dock == Dock::Path);
        }, unlisted();
    FocusControls "Into the controls", "",
        |_, c| c.memory_mut(|memory| memory.move_focus(FocusDirection::Next)), key(Key::F6), unlisted();
    Blank "Blank the screen", "",
        |w, _| w.model.presentation.iter_mut().for_each(|shown| shown.is_blank ^= true), key(Key::B),
        needs(|f| f.model.presentation.is_some(), "Only a presentation can be blanked; F5 begins one"),
        unlisted();
}

/// The rows of commands that differ in a value.
fn family_rows() -> Vec<Row> {
    let mut rows = Vec::new();
    for (show, digit) in Show::ALL.into_iter().zip(DIGITS) {
        let [name, help, synonyms] = show.words();
        let row = Row::new(Some("Show"), Command::Show(show), [name, help], move |w, _| {
            w.model.view.choose(show);
        });
        let is_on =
            move |view: &ViewState| view.show() == show && (show != Show::Picture || view.mode().is_none());
        let row = row.keys(CTRL, digit).also(synonyms).off(move |f| f.useless_show(show));
        rows.push(row.on(move |f| is_on(&f.model.view)));
    }
    for (theme, name, help, synonyms) in [
        (ThemePreference::System, "As the system", "Follows the system", "theme"),
        (ThemePreference::Dark, "Dark", "Light text on dark panels", "theme night"),
        (ThemePreference::Light, "Light", "Dark text on light panels", "theme bright"),
    ] {
        let row = Row::new(Some("Theme"), Command::Theme(theme), [name, help], move |w, c| {
            w.model.remembered.theme = theme;
            c.set_theme(theme);
        });
        rows.push(row.on(move |f| f.model.remembered.theme == theme).also(synonyms));
    }
    for channel in Channel::ALL {
        let words = [channel.name(), "Shows one channel alone, as grey; again shows all"];
        let row = Row::new(None, Command::Channel(channel), words, move |w, _| {
            w.model.view.tone.toggle(channel);
        });
        let row = row.keys(SHIFT, channel.key()).off(Facts::no_exposure).also("channel rgb");
        rows.push(row.on(move |f| f.model.view.tone.channel == Some(channel)));
    }
    for device in [Device::Cpu, Device::Gpu, Device::Both] {
        let name = if device == Device::Both { "CPU and GPU together" } else { device.label() };
        let row = Row::new(None, Command::Device(device), [name, device.help()], move |w, _| {
            w.model.remembered.device = device;
        });
        let row = row.off(move |_| device.unavailable()).also("device trace");
        rows.push(row.on(move |f| f.model.remembered.device == device));
    }
    for (format, name, modifiers, key) in [
        (OutputFormat::P6, "Save as PPM…", CTRL_SHIFT, Key::S),
        (OutputFormat::Exr, "Save film…", CTRL, Key::E),
    ] {
        let row = Row::new(None, Command::SaveAs(format), [name, ""], move |w, _| w.ask_save(format));
        rows.push(row.keys(modifiers, key).needs(is_live, KEPT_IS_SHOWN).unlisted());
    }
    for (place, digit) in DIGITS.into_iter().enumerate() {
        let row =
            Row::new(None, Command::Kept(place), ["", "Shows it instead of the picture"], move |w, _| {
                w.model.view.look(place);
            });
        let is_there = move |f: &Facts| f.model.view.kept.get(place).is_some();
        rows.push(
            row.keys(Modifiers::ALT, digit)
                .needs(is_there, "No picture is kept under this number")
                .unlisted(),
        );
    }
    rows
}

const NO_SPHERE: &str = "No sphere is selected; click one";
const NOTHING_KEPT: &str = "No picture is kept; M keeps this one";
const NO_PATHS: &str = "No paths are shown; point at the picture and press T";

const KEPT_IS_SHOWN: &str = "A kept picture is shown; Escape returns to the one that is traced";

fn is_live(facts: &Facts) -> bool {
    facts.model.view.looked().is_none()
}

fn has_selection(facts: &Facts) -> bool {
    facts.model.selected.is_some()
}

fn has_spheres(facts: &Facts) -> bool {
    !facts.document().scene().spheres.is_empty()
}

fn has_kept(facts: &Facts) -> bool {
    facts.model.view.kept.chosen().is_some()
}

fn no_presentation(facts: &Facts) -> Option<String> {
    facts.model.presentation.map(|_| "A presentation has no panels; Escape ends it".to_owned())
}

impl Command {
    /// Its row in the table; none for a place.
    pub fn row(self) -> Option<&'static Row> {
        ROWS.iter().find(|row| row.command == self)
    }

    /// Without what only the window knows, such as the name of a bookmark: see [`Facts::name`].
    pub fn name(self) -> String {
        match self {
            Command::Stage(stage) => format!("{} {}", stage.section, stage.title),
            Command::Extreme(case) => case.title().to_owned(),
            Command::Recent(place) => format!("Recent file {}", place + 1),
            Command::Bookmark(place) => format!("Bookmark {}", place + 1),
            Command::Kept(place) => format!("Kept picture {}", place + 1),
            Command::Field(name) => name.to_owned(),
            _ => self.row().map_or_else(String::new, |row| row.name.to_owned()),
        }
    }

    /// One sentence about it.
    pub fn help(self) -> &'static str {
        match self {
            Command::Stage(stage) => stage.what_is_new,
            Command::Extreme(case) => case.watch.map_or("An extreme scene", |watch| watch.look_for),
            Command::Recent(_) => "Opens it again",
            Command::Bookmark(_) => "Jumps to this camera",
            Command::Field(_) => "Goes to this field of the controls",
            _ => self.row().map_or("", |row| row.help),
        }
    }

    /// As shown to the user, such as `Ctrl+O`.
    pub fn keys(self, context: &Context) -> Option<String> {
        let keys = self.row()?.keys?;
        // The font has no arrows.
        let is_short = !matches!(keys.logical_key, Key::ArrowLeft | Key::ArrowRight);
        let names = ModifierNames { is_short, ..ModifierNames::NAMES };
        Some(keys.format(&names, context.os().is_mac()).replace("Page", "Page "))
    }

    /// Opens a dialog, which takes the keys that follow.
    pub fn opens_dialog(self) -> bool {
        matches!(self, Command::Help | Command::About) || self.name().ends_with('…')
    }

    /// Carries it out, whether or not it is off.
    pub(in crate::app) fn run(self, window: &mut Window, context: &Context) {
        match self {
            Command::Stage(stage) => window.show_origin(Origin::of_stage(stage)),
            Command::Extreme(case) => window.show_origin(Origin::of_case(case)),
            Command::Recent(place) => window.open_recent(context, place),
            Command::Bookmark(place) => {
                let bookmark = window.model.remembered.bookmarks.get(place);
                let camera = bookmark.map(|bookmark| bookmark.camera);
                window.model.document.camera = camera.unwrap_or(window.document().camera);
            }
            Command::Field(name) => {
                let remembered = &mut window.model.remembered;
                (remembered.has_panels, remembered.has_controls) = (true, true);
                if context.content_rect().width() < NARROW {
                    remembered.tab = Tab::Controls;
                }
                crate::app::toolkit::widgets::focus(context, name);
            }
            _ => {
                if let Some(row) = self.row() {
                    (row.run)(window, context);
                }
            }
        }
    }
}

impl Facts {
    /// Why a command cannot be used now, if so.
    pub fn disabled_reason(&self, command: Command) -> Option<String> {
        command.row().and_then(|row| (row.off)(self))
    }

    /// Whether what a command switches is on; none if it is no switch.
    pub fn switch(&self, command: Command) -> Option<bool> {
        match command {
            Command::Stage(stage) => Some(self.document().stage() == Some(stage)),
            Command::Extreme(case) => Some(self.document().case() == Some(case)),
            _ => command.row()?.on.as_ref().map(|on| on(self)),
        }
    }

    /// Whether what a command switches is on.
    pub fn is_on(&self, command: Command) -> bool {
        self.switch(command).unwrap_or(false)
    }
}
