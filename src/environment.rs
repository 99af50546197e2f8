//! The environment in which graphics libraries are loaded.

/// The runtime directory of a user who has none. Nothing can be in it, and nobody can put a socket there.
#[cfg(target_os = "linux")]
const NOWHERE: &str = "/dev/null";

/// Makes sure that `XDG_RUNTIME_DIR` is set. Where it is not, as on a cluster node or under `su`, the graphics loader's
/// Wayland client prints an error of its own whenever adapters are listed.
///
/// A program cannot safely change its environment once a library may read it, so this starts the program again in place
/// of itself: the same process, arguments and open files. It must be called before anything else is done. If that fails,
/// the program simply goes on.
pub fn provide_runtime_directory() {
    #[cfg(target_os = "linux")]
    {
        use std::os::unix::process::CommandExt;
        use std::path::{Path, PathBuf};
        const VARIABLE: &str = "XDG_RUNTIME_DIR";
        if std::env::var_os(VARIABLE).is_some_and(|directory| Path::new(&directory).is_absolute()) {
            return;
        }
        let Ok(program) = std::env::current_exe() else { return };
        // Where a login session would have found it.
        let usual = PathBuf::from(format!("/run/user/{}", rustix::process::getuid().as_raw()));
        let directory = if usual.is_dir() { usual } else { PathBuf::from(NOWHERE) };
        let mut arguments = std::env::args_os();
        let mut again = std::process::Command::new(program);
        if let Some(name) = arguments.next() {
            again.arg0(name);
        }
        // Returns only if it fails.
        let _ = again.args(arguments).env(VARIABLE, directory).exec();
    }
}
