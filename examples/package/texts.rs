//! Manual pages and completions, made from the command line's own description.

use clap::builder::{PossibleValuesParser, ValueParser};
use clap::{Arg, Command};
use clap_complete::{Shell, generate_to};
use std::io;
use std::path::Path;
use weekender::render_cpu::Isa;
use weekender::scene::builtin::BuiltinScene;
use weekender::stages::Stage;

/// The shells that get completions.
pub const SHELLS: [Shell; 5] = [Shell::Bash, Shell::Zsh, Shell::Fish, Shell::PowerShell, Shell::Elvish];

/// Writes `man/weekender.1`, a page for each subcommand, and `completions/` below `directory`.
///
/// # Errors
/// If a file cannot be written.
pub fn write(directory: &Path) -> io::Result<()> {
    let [man, completions] = ["man", "completions"].map(|folder| directory.join(folder));
    for folder in [&man, &completions] {
        std::fs::create_dir_all(folder)?;
    }
    clap_mangen::generate_to(weekender::cli::command(), &man)?;
    for shell in SHELLS {
        let path = generate_to(shell, &mut completed(&weekender::cli::command()), "weekender", &completions)?;
        let text = std::fs::read_to_string(&path)?;
        std::fs::write(&path, with_scenes(shell, text))?;
    }
    Ok(())
}

/// The command as shells complete it: without what is hidden, and with the values that its own parsers do not list. It is
/// made anew, because arguments may conflict with hidden ones.
fn completed(command: &Command) -> Command {
    let arguments =
        command.get_arguments().filter(|argument| !argument.is_hide_set()).map(completed_argument);
    let commands = command.get_subcommands().filter(|command| !command.is_hide_set()).map(completed);
    Command::new(lasting(command.get_name()))
        .about(command.get_about().cloned().unwrap_or_default())
        .disable_version_flag(true)
        .args(arguments)
        .subcommands(commands)
}

/// clap's names live as long as the program.
fn lasting(name: &str) -> &'static str {
    name.to_owned().leak()
}

fn completed_argument(argument: &Arg) -> Arg {
    let levels = || ["auto"].into_iter().chain(Isa::ALL.map(Isa::name));
    let values: ValueParser = match argument.get_id().as_str() {
        "stage" => PossibleValuesParser::new(Stage::ALL.iter().map(|stage| stage.id)).into(),
        "isa" => PossibleValuesParser::new(levels()).into(),
        "simd" => PossibleValuesParser::new(["auto", "off", "4", "8", "16"]).into(),
        _ => argument.get_value_parser().clone(),
    };
    let mut shown = Arg::new(argument.get_id().clone())
        .help(argument.get_help().cloned().unwrap_or_default())
        .action(argument.get_action().clone())
        .value_hint(argument.get_value_hint())
        .value_parser(values)
        .global(argument.is_global_set());
    if let Some(long) = argument.get_long() {
        shown = shown.long(lasting(long));
    }
    if let Some(short) = argument.get_short() {
        shown = shown.short(short);
    }
    if let Some(names) = argument.get_value_names() {
        shown = shown.value_names(names.to_vec());
    }
    if let Some(count) = argument.get_num_args() {
        shown = shown.num_args(count);
    }
    shown
}

/// Adds the built-in scenes to the files that complete `--scene`, which clap cannot express.
fn with_scenes(shell: Shell, text: String) -> String {
    let names: Vec<&str> = BuiltinScene::ALL.iter().map(|scene| scene.name).collect();
    match shell {
        Shell::Bash => {
            let files = "compgen -f \"${cur}\"";
            let both = format!("compgen -f -W $'{}' -- \"${{cur}}\"", names.join("\\n"));
            let mut parts = text.split("--scene)\n");
            let first = parts.next().unwrap_or_default().to_owned();
            parts.fold(first, |text, part| text + "--scene)\n" + &part.replacen(files, &both, 1))
        }
        Shell::Zsh => {
            let both = format!(":NAME|FILE.toml:{{compadd -- {}; _files}}", names.join(" "));
            text.replace(":NAME|FILE.toml:_files", &both)
        }
        Shell::Fish => {
            let line = format!("complete -c weekender -l scene -r -F -a \"{}\"\n", names.join(" "));
            text + &line
        }
        _ => text,
    }
}
