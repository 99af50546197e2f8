//! Threads that yield to other work.

/// The nice value added to low-priority threads. Under contention each step costs about a tenth of the time.
#[cfg(target_os = "linux")]
pub(super) const NICENESS: i32 = 10;

/// Lowers the priority of this thread, and of threads that it starts. If the system refuses, the priority stays unchanged.
pub fn give_way() {
    // On Linux this changes the thread's priority, not the process's.
    #[cfg(target_os = "linux")]
    let _ = rustix::process::nice(NICENESS);
}
