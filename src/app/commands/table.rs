//! All commands of menus, keys, buttons and the palette: one table, with one row per command.

use super::snapshot::Snapshot;
use crate::app::model::{Device, Dock, Edit, Mode, Partner, Show, Tab, ViewState};
use crate::measure::stress::Case;
use crate::stages::Stage;
use eframe::egui::{Context, Key, KeyboardShortcut, ModifierNames, Modifiers, ThemePreference};
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

/// The menus of the bar.
pub const MENUS: [&str; 6] = ["File", "Edit", "View", "Render", "Stage", "Help"];

type Off = Box<dyn Fn(&Snapshot) -> Option<String> + Send + Sync>;
type On = Box<dyn Fn(&Snapshot) -> bool + Send + Sync>;

/// A command's metadata.
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
    /// Why it is unavailable; `None` if it is available.
    off: Off,
    /// Whether its switch is on; `None` if it is not a switch.
    on: Option<On>,
}

impl Row {
    fn new(menu: Option<&'static str>, command: Command, [name, help]: [&'static str; 2]) -> Self {
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

    /// Only for keys and buttons.
    fn unlisted(mut self) -> Self {
        self.is_listed = false;
        self
    }

    fn off(mut self, off: impl Fn(&Snapshot) -> Option<String> + Send + Sync + 'static) -> Self {
        self.off = Box::new(off);
        self
    }

    /// Unavailable unless `is_possible`, for this reason.
    fn needs(
        self,
        is_possible: impl Fn(&Snapshot) -> bool + Send + Sync + 'static,
        reason: &'static str,
    ) -> Self {
        self.off(move |snapshot| (!is_possible(snapshot)).then(|| reason.to_owned()))
    }

    fn on(mut self, on: impl Fn(&Snapshot) -> bool + Send + Sync + 'static) -> Self {
        self.on = Some(Box::new(on));
        self
    }
}

const CTRL: Modifiers = Modifiers::COMMAND;
const SHIFT: Modifiers = Modifiers::SHIFT;
const CTRL_SHIFT: Modifiers = Modifiers::COMMAND.plus(Modifiers::SHIFT);

/// The keys of the digits 1 to 6.
const DIGITS: [Key; 6] = [Key::Num1, Key::Num2, Key::Num3, Key::Num4, Key::Num5, Key::Num6];

/// All commands except places, menu by menu in the order of the menus.
pub static ROWS: LazyLock<Vec<Row>> =
    LazyLock::new(|| plain_rows().into_iter().chain(family_rows()).collect());

/// Makes the commands and their rows: the command, its name, one sentence about it, and optional methods.
macro_rules! table {
    (
        families { $($(#[$about:meta])* $family:ident($value:ty),)* }
        $([$menu:expr] $($command:ident $name:expr, $help:expr
            $(, $method:ident($($argument:expr),*))*;)*)*
    ) => {
        /// A command. Its metadata is in [`ROWS`]; places, such as stages and files, have no row.
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub enum Command {
            $($(#[$about])* $family($value),)*
            $($($command,)*)*
        }

        fn plain_rows() -> Vec<Row> {
            vec![$($(Row::new($menu, Command::$command, [$name, $help])$(.$method($($argument),*))*,)*)*]
        }
    };
}

// A row takes a few lines; rustfmt would give each argument one.
#[rustfmt::skip]
table! {
    families {
        Show(Show),
        Theme(ThemePreference),
        Device(Device),
        Stage(&'static Stage),
        Extreme(&'static Case),
        /// Opens a recent file.
        Recent(usize),
        Bookmark(usize),
        /// Changes the scene. It joins a move in progress.
        Edit(Edit),
        CompareWith(Partner),
        /// Goes to the field of this name in the left panel.
        Field(&'static str),
    }

    [Some("File")]
    NewScene "New scene", "Begins a scene of your own: a ball on the ground", keys(CTRL, Key::N), also("create empty own");
    Open "Open…", "Opens a scene, a picture or a film, and resumes it", keys(CTRL, Key::O),
        also("load import resume");
    CheckPicture "Check my picture…", "Finds the mistake in a picture that your own program rendered",
        also("wrong mistake homework verify compare");
    Save "Save…", "Saves the picture, the film or the scene", keys(CTRL, Key::S), line(),
        needs(is_live, KEPT_IS_SHOWN), also("save as export png ppm exr toml download film scene");
    SaveAnimation "Save animation…", "Renders the frames of a film: along the bookmarks, or once around",
        off(|f| f.no_rays().map(str::to_owned)), also("video movie frames turntable keyframes");
    Quit "Quit", "Closes the window; the next one begins where this one ends", keys(CTRL, Key::Q), line(),
        also("close exit");

    [Some("Edit")]
    Undo "Undo", "Undoes the last change", keys(CTRL, Key::Z),
        needs(|f| f.undo.is_some(), "Nothing has been changed yet"), also("back lost");
    Redo "Redo", "Redoes that change", keys(CTRL_SHIFT, Key::Z),
        needs(|f| f.redo.is_some(), "Nothing has been undone");
    ResetAll "Reset everything", "Returns to the stage as it is in the book; Undo brings your changes back",
        needs(|f| f.document().is_changed(), "This is the stage as it is in the book"),
        also("original lost back");
    Copy "Copy picture", "Copies the picture at full size", keys(CTRL, Key::C), line(),
        needs(is_live, KEPT_IS_SHOWN), also("clipboard");
    AddSphere "Add a sphere", "Puts a sphere where the pointer is", key(Key::Insert), line(),
        off(|f| f.no_rays().map(str::to_owned)), also("new ball");
    DuplicateSphere "Duplicate the sphere", "Puts a copy beside the selected sphere", keys(CTRL, Key::D),
        needs(has_selection, NO_SPHERE), also("copy ball");
    DeleteSphere "Delete the sphere", "Removes the selected sphere", key(Key::Delete),
        needs(has_selection, NO_SPHERE), also("remove ball");
    Home "Reset the camera", "Returns to the camera and lens of the stage", key(Key::Home), line(),
        needs(|f| f.document().camera != f.document().origin.recipe.camera, "This is the camera of the stage"),
        also("home lost back original");

    [Some("View")]
    Fit "Fit in the window", "Shows the whole picture as large as possible", key(Key::F), line();
    ActualSize "Actual size", "One pixel of the picture per pixel of the screen", key(Key::Num1),
        also("100 % zoom");
    Controls "Controls", "Shows or hides camera, lens and sphere at the left", key(Key::L), line(),
        off(no_presentation), on(|f| !f.model.remembered.hides_controls), also("left panel camera lens");
    Info "Stage and pixel", "Shows or hides the text and the numbers at the right", key(Key::I),
        off(no_presentation), on(|f| !f.model.remembered.hides_info), also("right panel text");
    ErrorDock "Error over time", "Opens the dock with the error over time", key(Key::P), off(no_presentation),
        on(|f| f.model.remembered.dock == Some(Dock::Error)), also("plot convergence noise quality");
    Panels "Only the picture", "Hides all panels; again shows them", key(Key::Tab),
        on(|f| f.model.hides_panels), also("hide panels");
    Present "Present", "Full screen with large captions, for a lecture; Escape ends it", key(Key::F5), line(),
        on(|f| f.model.presentation.is_some()), also("lecture slides projector beamer");
    FullScreen "Full screen", "Fills the screen with the window", key(Key::F11), on(|f| f.model.is_full_screen);

    [Some("Bookmarks")]
    AddBookmark "Bookmark this camera", "Keeps camera and lens, to jump back to and for the animation",
        keys(CTRL, Key::B), off(|f| f.no_rays().map(str::to_owned)), also("view position keyframe");
    DeleteBookmark "Delete this bookmark", "Deletes the bookmark of this camera",
        needs(|f| f.document().bookmark().is_some(), "This camera is not bookmarked"), also("remove keyframe");
    Play "Play the animation", "Moves the camera along the bookmarks; with fewer than two, once around",
        keys(SHIFT, Key::P), off(|f| f.no_rays().map(str::to_owned)), on(|f| f.model.playing.is_some()),
        also("preview video turntable path");

    [Some("Render")]
    Pause "Pause or resume", "Pauses or resumes; when done, continues to half the error. No sample is lost",
        key(Key::Space), needs(|f| f.is_working() || f.model.is_paused || f.further().is_some(),
            "More samples would change nothing"),
        on(|f| f.model.is_paused), also("stop resume continue");
    Restart "Start again", "Discards the samples and starts over", key(Key::R);
    SwitchDevice "Switch CPU and GPU", "Continues the same picture on the other device", key(Key::G), line(),
        off(|_| Device::Gpu.unavailable());
    Reference "Reference (f64)", "Traces in double precision (slow), to show rounding errors",
        on(|f| f.model.remembered.device == Device::Reference), also("double precision");
    Keep "Keep this picture", "Keeps a copy with all its samples, to compare with", key(Key::M), line(),
        needs(is_live, KEPT_IS_SHOWN), also("slot snapshot compare");
    GoOnFromKept "Continue the kept picture", "Traces the kept picture that is compared with, and adds samples",
        needs(|f| f.model.view.kept_partner().is_some_and(|kept| kept.document.is_some()), NOTHING_KEPT);
    DeleteKept "Delete the kept picture", "Frees the memory of the kept picture that is compared with",
        needs(|f| f.model.view.kept_partner().is_some(), NOTHING_KEPT);

    [Some("Stage")]
    Stages "All stages…", "Every picture of the book, and extreme scenes such as dust and soap bubbles",
        key(Key::O), also("list section chapter extreme stress stiff numerical");
    PreviousStage "Previous stage", "One step back in the book", key(Key::PageUp),
        needs(|f| f.model.neighbour(false).is_some(), "This is the first stage");
    NextStage "Next stage", "One step forward in the book", key(Key::PageDown),
        needs(|f| f.model.neighbour(true).is_some(), "This is the last stage");
    ShowMe "Show me", "Sets zoom, view or wipe so that you see what to look for; again returns", key(Key::H),
        line(), off(|f| match f.document().stage() {
            Some(stage) => f.model.useless_show(Show::of_means(stage.sight.means)),
            None => Some("Only stages of the book name something to look for".to_owned()),
        }),
        on(|f| f.has_sight);
    Wipe "Wipe", "Drag a divider between this picture and the one that it is compared with", key(Key::C), line(),
        off(|f| f.model.nothing_to_compare()), on(|f| f.model.view.mode() == Some(Mode::Wipe)), also("compare");
    Flip "Flip", "Shows the other picture in place of this one; again returns", key(Key::J),
        off(|f| f.model.nothing_to_compare()), on(|f| f.model.view.is_hidden()), also("compare blink kept");
    Difference "Difference", "Shows where the two differ, and by how much", key(Key::X),
        off(|f| f.model.nothing_to_compare().or_else(|| f.model.not_subtractable())),
        on(|f| f.model.view.mode() == Some(Mode::Difference)), also("compare subtract");
    AreSame "Are they the same?", "Tests whether the two differ by more than chance", keys(SHIFT, Key::N),
        off(|f| f.model.nothing_to_compare().or_else(|| f.model.not_subtractable())),
        also("compare only noise");
    CompareDevices "Compare CPU and GPU",
        "Traces on both in turns: their pictures, errors over time, and speeds", keys(SHIFT, Key::C),
        off(|_| Device::Gpu.unavailable()),
        on(|f| matches!(f.model.other_device(), Some(Device::Cpu | Device::Gpu))),
        also("speed fast benchmark rays factor against versus");
    CompareFile "Compare with a file…", "Compares with the picture of any program: PNG, PPM or EXR",
        also("picture open");
    ListPaths "Paths of this pixel", "Shows the paths of the pixel under the pointer, ray by ray", key(Key::T),
        line(), off(|f| match f.no_rays() {
            Some(reason) => Some(reason.to_owned()),
            None => (!f.has_pixel).then(|| "Point at the traced picture first".to_owned()),
        }),
        also("rays bounce trace");
    Code "Code", "Shows the lines of the tracer that are new in this stage", key(Key::K), off(no_presentation),
        on(|f| f.model.shows(Tab::Code)), also("source rust wgsl program");
    Book "Read in the book", "Opens this section in the browser", also("web section");

    [Some("Help")]
    Help "Keys and mouse", "All keys, and what the mouse does", key(Key::F1), also("shortcuts keyboard help");
    Companion "Companion", "Opens the page that explains the book, at this stage", also("web read explain");
    Palette "Find a command…", "Type what you want to do", keys(CTRL, Key::P), also("palette search");
    About "About Weekender", "Version, licences, and how to report a fault",
        also("version licence report bug");

    [None]
    Brighter "Brighter", "Shows the picture with half a stop more light; files are saved without it",
        key(Key::Plus), off(|f| f.model.no_exposure()), also("exposure bright dim");
    Darker "Darker", "Shows the picture with half a stop less light; files are saved without it",
        key(Key::Minus), off(|f| f.model.no_exposure()), also("exposure dim");
    NoExposure "No exposure", "Shows the picture as bright as it is saved", key(Key::Num0),
        off(|f| f.model.no_exposure()), also("exposure bright dim reset");
    ZoomIn "Zoom in", "Ctrl and the wheel zoom at the pointer", key(Key::CloseBracket);
    ZoomOut "Zoom out", "Ctrl and the wheel zoom at the pointer", key(Key::OpenBracket);
    Denoise "Denoise", "Filters the noise away and says how wrong the result is; films are saved as they are",
        key(Key::V),
        off(|f| f.model.view.mode().map(|_| "Pictures that are compared are shown raw".to_owned())),
        on(|f| f.model.view.is_denoised), also("filter smooth noise clean oidn");
    NextSphere "Next sphere", "Selects the next sphere of the scene", key(Key::Period),
        needs(has_spheres, "There is no sphere in this scene"), also("select");
    PreviousSphere "Previous sphere", "Selects the previous sphere of the scene", key(Key::Comma),
        needs(has_spheres, "There is no sphere in this scene"), also("select");
    FocusSphere "Focus on the sphere", "Sets the focus distance to the nearest point of the selected sphere",
        needs(has_selection, NO_SPHERE), also("sharp depth of field");
    NextPlace "Next place", "Enlarges the next place where your picture differs most", unlisted();
    RenderAtPartnerSize "Render at its size", "Gives the picture the size of the other one; the samples begin anew",
        unlisted();
    RenderAtSize "Render at this size",
        "Renders one pixel of the picture per pixel of the screen; the samples begin anew", unlisted();
    StopSaving "Stop", "Gives up what is being made", unlisted();
    DeleteFilms "Delete the kept films", "Pictures that come back begin anew then",
        needs(|f| f.films.count > 0, "No film is kept"), unlisted();
    NextRay "Next ray", "", key(Key::ArrowRight), needs(|f| f.has_paths, NO_PATHS), unlisted();
    PreviousRay "Previous ray", "", key(Key::ArrowLeft), needs(|f| f.has_paths, NO_PATHS), unlisted();
    ClearPaths "Close the paths", "", unlisted();
    FocusControls "Into the controls", "", key(Key::F6), unlisted();
    Blank "Blank the screen", "", key(Key::B),
        needs(|f| f.model.presentation.is_some(), "Only a presentation can be blanked; F5 begins one"),
        unlisted();
}

/// The rows of commands that differ in a value.
fn family_rows() -> Vec<Row> {
    let mut rows = Vec::new();
    for (show, digit) in Show::ALL.into_iter().zip(DIGITS) {
        let [name, help, synonyms] = show.words();
        let row = Row::new(Some("Show"), Command::Show(show), [name, help]);
        let is_on =
            move |view: &ViewState| view.show() == show && (show != Show::Picture || view.mode().is_none());
        let row = row.keys(CTRL, digit).also(synonyms).off(move |f| f.model.useless_show(show));
        rows.push(row.on(move |f| is_on(&f.model.view)));
    }
    for (theme, name, help, synonyms) in [
        (ThemePreference::System, "As the system", "Follows the system", "theme"),
        (ThemePreference::Dark, "Dark", "Light text on dark panels", "theme night"),
        (ThemePreference::Light, "Light", "Dark text on light panels", "theme bright"),
    ] {
        let row = Row::new(Some("Theme"), Command::Theme(theme), [name, help]);
        rows.push(row.on(move |f| f.model.remembered.theme == theme).also(synonyms));
    }
    for (device, help) in [
        (Device::Cpu, "Trace on the processor"),
        (Device::Gpu, "Trace on the graphics card, usually many times faster"),
    ] {
        let row = Row::new(None, Command::Device(device), [device.label(), help]);
        let row = row.off(move |_| device.unavailable()).also("device trace");
        rows.push(row.on(move |f| f.model.remembered.device == device));
    }
    rows
}

const NO_SPHERE: &str = "No sphere is selected; click one";
const NOTHING_KEPT: &str = "Compare with a kept picture first; M keeps this one";
const NO_PATHS: &str = "No paths are shown; point at the picture and press T";

const KEPT_IS_SHOWN: &str = "The other picture is shown; Escape returns to the one that is traced";

fn is_live(snapshot: &Snapshot) -> bool {
    !snapshot.model.view.is_hidden()
}

fn has_selection(snapshot: &Snapshot) -> bool {
    snapshot.model.selected.is_some()
}

fn has_spheres(snapshot: &Snapshot) -> bool {
    !snapshot.document().scene().spheres.is_empty()
}

fn no_presentation(snapshot: &Snapshot) -> Option<String> {
    snapshot.model.presentation.map(|_| "A presentation has no panels; Escape ends it".to_owned())
}

impl Command {
    /// Its row in the table; `None` for a place.
    pub fn row(self) -> Option<&'static Row> {
        ROWS.iter().find(|row| row.command == self)
    }

    /// Its general name. [`Snapshot::name`] knows more, such as the name of a file.
    pub fn name(self) -> String {
        match self {
            Command::Stage(stage) => format!("{} {}", stage.section, stage.title),
            Command::Extreme(case) => case.title().to_owned(),
            Command::Recent(place) => format!("Recent file {}", place + 1),
            Command::Bookmark(place) => format!("Bookmark {}", place + 1),
            Command::Field(name) => name.to_owned(),
            _ => self.row().map_or_else(String::new, |row| row.name.to_owned()),
        }
    }

    /// One sentence about it.
    pub fn help(self) -> &'static str {
        match self {
            Command::Stage(stage) => stage.what_is_new,
            Command::Extreme(case) => &case.claim.look_for,
            Command::Recent(_) => "Opens it again",
            Command::Bookmark(_) => "Jumps to this camera",
            Command::Field(_) => "Goes to this field of the controls",
            Command::CompareWith(Partner::Book) => {
                "By the book’s quadratic and its minimum distance of 0.001"
            }
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
}

impl Snapshot {
    /// The commands for the files that were opened or saved last, newest first.
    pub fn recent(&self) -> impl Iterator<Item = Command> {
        (0..self.model.remembered.recent.len()).map(Command::Recent)
    }

    /// The commands that go to the bookmarks, in their order.
    pub fn bookmarks(&self) -> impl Iterator<Item = Command> {
        (0..self.document().keyframes.len()).map(Command::Bookmark)
    }

    /// The file that a command opens, if it was opened or saved before.
    pub fn path(&self, command: Command) -> Option<&Path> {
        let Command::Recent(place) = command else { return None };
        self.model.remembered.recent.get(place).map(PathBuf::as_path)
    }

    /// The name of a command, with the change that it undoes, or the file that it opens.
    pub fn name(&self, command: Command) -> String {
        let named = match command {
            Command::Undo => self.undo.map(|change| format!("Undo: {change}")),
            Command::Redo => self.redo.map(|change| format!("Redo: {change}")),
            Command::CompareWith(partner) => Some(self.model.partner_name(partner)),
            Command::Recent(_) => {
                self.path(command).and_then(Path::file_name).map(|name| name.display().to_string())
            }
            _ => None,
        };
        named.unwrap_or_else(|| command.name())
    }

    /// Why a command is unavailable; `None` if it is available.
    pub fn disabled_reason(&self, command: Command) -> Option<String> {
        command.row().and_then(|row| (row.off)(self))
    }

    /// Whether a command's switch is on; `None` if it is not a switch.
    pub fn switch(&self, command: Command) -> Option<bool> {
        match command {
            Command::Stage(stage) => Some(self.document().stage() == Some(stage)),
            Command::Extreme(case) => Some(self.document().case() == Some(case)),
            Command::CompareWith(partner) => Some(self.model.view.partner == partner),
            Command::Bookmark(place) => Some(self.document().bookmark() == Some(place)),
            _ => command.row()?.on.as_ref().map(|on| on(self)),
        }
    }

    /// Whether a command's switch is on.
    pub fn is_on(&self, command: Command) -> bool {
        self.switch(command).unwrap_or(false)
    }
}
