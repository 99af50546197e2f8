//! Checks whether data fits into memory before it is allocated. A system that overcommits memory kills the program
//! later, and a failed allocation also ends it.
//!
//! Code that needs memory in proportion to a number from outside (films, pictures, scenes) first calls [`check`], or
//! allocates with [`filled`].

use std::fs;

/// Something needs more memory than this machine has.
#[derive(Clone, Debug, thiserror::Error, PartialEq, Eq)]
#[error("{what} needs {} of memory, but only {} is free; {remedy}", words(*needed_bytes), words(*free_bytes))]
pub struct MemoryError {
    /// What the memory is for.
    pub what: String,
    /// Bytes needed, including what the rest of the program takes.
    pub needed_bytes: u64,
    /// Bytes available.
    pub free_bytes: u64,
    /// What to do.
    pub remedy: &'static str,
}

/// A number of bytes with a unit.
pub fn words(bytes: u64) -> String {
    match bytes {
        0..1_000_000 => format!("{bytes} bytes"),
        1_000_000..1_000_000_000 => format!("{:.1} MB", bytes as f64 / 1e6),
        _ => format!("{:.1} GB", bytes as f64 / 1e9),
    }
}

/// What everything else takes: program, threads, files.
const BASE_BYTES: u64 = 64 << 20;

/// Smaller sizes are not checked with the system; [`filled`] notices if the allocation fails.
const SMALL_BYTES: u64 = 16 << 20;

/// Returns an error if `bytes` do not fit, provided the system tells what is free. `what` names their purpose.
///
/// # Errors
/// [`MemoryError`] with this `remedy`.
pub fn check(what: impl FnOnce() -> String, bytes: u64, remedy: &'static str) -> Result<(), MemoryError> {
    if bytes < SMALL_BYTES {
        return Ok(());
    }
    free_bytes().map_or(Ok(()), |free| check_against(what, bytes, free, remedy))
}

fn check_against(
    what: impl FnOnce() -> String,
    bytes: u64,
    free_bytes: u64,
    remedy: &'static str,
) -> Result<(), MemoryError> {
    let needed_bytes = bytes.saturating_add(BASE_BYTES);
    if needed_bytes > free_bytes {
        return Err(MemoryError { what: what(), needed_bytes, free_bytes, remedy });
    }
    Ok(())
}

/// `count` copies of `value`.
///
/// # Errors
/// [`MemoryError`] with this `remedy` if they do not fit.
pub fn filled<T: Clone>(
    count: usize,
    value: T,
    what: impl FnOnce() -> String,
    remedy: &'static str,
) -> Result<Vec<T>, MemoryError> {
    let bytes = (count as u64).saturating_mul(size_of::<T>() as u64);
    let free_bytes = if bytes < SMALL_BYTES { u64::MAX } else { free_bytes().unwrap_or(u64::MAX) };
    if bytes.saturating_add(BASE_BYTES) <= free_bytes {
        let mut items = Vec::new();
        if items.try_reserve_exact(count).is_ok() {
            items.resize(count, value);
            return Ok(items);
        }
    }
    Err(MemoryError {
        what: what(),
        needed_bytes: bytes.saturating_add(BASE_BYTES),
        free_bytes: self::free_bytes().unwrap_or(0),
        remedy,
    })
}

/// Bytes available: the least of what the system, the process's control group and the process's own limits allow.
/// `None` if the system does not tell.
pub fn free_bytes() -> Option<u64> {
    let of_system =
        fs::read_to_string("/proc/meminfo").ok().and_then(|text| kilobytes(&text, "MemAvailable:"));
    [of_system, free_of_group(), free_of_process()].into_iter().flatten().min()
}

/// The value of a line such as `MemAvailable:  2048 kB`, in bytes.
fn kilobytes(text: &str, name: &str) -> Option<u64> {
    let line = text.lines().find_map(|line| line.strip_prefix(name))?;
    line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok()?.checked_mul(1024)
}

/// Address space that the system's allocator reserves for each thread.
#[cfg(target_os = "linux")]
const ARENA_BYTES: u64 = 64 << 20;

/// Threads besides one per core: those of the program and the render, and those that it waits for.
#[cfg(target_os = "linux")]
const OTHER_THREADS: u64 = 6;

/// What `ulimit -v` and `ulimit -d` still allow.
#[cfg(target_os = "linux")]
fn free_of_process() -> Option<u64> {
    use rustix::process::{Resource, getrlimit};
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let left = |resource, used| {
        let limit = getrlimit(resource).current?;
        Some(limit.saturating_sub(kilobytes(&status, used)?))
    };
    let cores = std::thread::available_parallelism().map_or(1, |cores| cores.get() as u64);
    let arenas = (cores + OTHER_THREADS) * ARENA_BYTES;
    let addresses = left(Resource::As, "VmSize:").map(|bytes| bytes.saturating_sub(arenas));
    [addresses, left(Resource::Data, "VmData:")].into_iter().flatten().min()
}

#[cfg(not(target_os = "linux"))]
fn free_of_process() -> Option<u64> {
    None
}

/// What the limits of the process's control groups still allow. Cached files do not count, because the system drops
/// them if memory is needed.
fn free_of_group() -> Option<u64> {
    let groups = fs::read_to_string("/proc/self/cgroup").ok()?;
    let of_own = groups.lines().filter_map(|line| line.splitn(3, ':').nth(2));
    // Within a container, the process's own group is the visible root, whatever its name outside.
    let all = of_own.flat_map(with_parents).chain(["/"]);
    all.flat_map(|group| [free_of_group_v2(group), free_of_group_v1(group)]).flatten().min()
}

/// A control group and those that contain it, whose limits hold as well. The root, `/`, is left out.
fn with_parents(group: &str) -> impl Iterator<Item = &str> {
    let groups = std::iter::successors(Some(group), |group| group.rsplit_once('/').map(|(parent, _)| parent));
    groups.filter(|group| group.starts_with('/') && *group != "/")
}

fn free_of_group_v2(group: &str) -> Option<u64> {
    free_of(&format!("/sys/fs/cgroup{group}"), "memory.max", "memory.current")
}

fn free_of_group_v1(group: &str) -> Option<u64> {
    free_of(&format!("/sys/fs/cgroup/memory{group}"), "memory.limit_in_bytes", "memory.usage_in_bytes")
}

fn free_of(directory: &str, limit: &str, used: &str) -> Option<u64> {
    let read = |name: &str| fs::read_to_string(format!("{directory}/{name}")).ok();
    let number = |name: &str| read(name)?.trim().parse::<u64>().ok();
    let cached = read("memory.stat").map_or(0, |stat| file_cache(&stat));
    Some(number(limit)?.saturating_sub(number(used)?.saturating_sub(cached)))
}

fn file_cache(stat: &str) -> u64 {
    let value = |name: &str| {
        let line = stat.lines().find_map(|line| line.strip_prefix(name))?;
        line.trim().parse::<u64>().ok()
    };
    let sum = |names: [&str; 2]| names.into_iter().filter_map(value).sum::<u64>();
    // Version 1 of control groups also has sums over subgroups.
    sum(["total_inactive_file ", "total_active_file "]).max(sum(["inactive_file ", "active_file "]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_of_containing_groups_hold_as_well() {
        let all = |group| with_parents(group).collect::<Vec<_>>();
        assert_eq!(
            all("/user.slice/user-1.slice/a.scope"),
            ["/user.slice/user-1.slice/a.scope", "/user.slice/user-1.slice", "/user.slice"]
        );
        assert!(all("/").is_empty() && all("").is_empty());
    }

    #[test]
    fn what_does_not_fit_is_refused_with_the_numbers_and_a_remedy() {
        let check = |bytes, free| check_against(|| "a film".to_owned(), bytes, free, "do less");
        assert_eq!(check(8 << 30, 9 << 30), Ok(()));
        let message = check(14_000_000_000, 8_000_000_000).unwrap_err().to_string();
        assert_eq!(message, "a film needs 14.1 GB of memory, but only 8.0 GB is free; do less");
        assert!(check(u64::MAX, u64::MAX - 1).is_err());
        let rest = (9 << 30) - BASE_BYTES;
        assert_eq!(check(rest, 9 << 30), Ok(()));
        assert!(check(rest + 1, 9 << 30).is_err(), "the program needs the rest");
    }

    #[test]
    fn more_than_there_is_is_not_asked_for() {
        let fill = |count: usize| filled(count, 7_u64, || "a list".to_owned(), "make it shorter");
        assert_eq!(fill(3).unwrap(), [7; 3]);
        for count in [1 << 50, usize::MAX] {
            let message = fill(count).unwrap_err().to_string();
            assert!(message.starts_with("a list needs") && message.ends_with("make it shorter"), "{message}");
        }
    }

    #[test]
    fn a_group_has_what_its_limit_leaves_and_what_is_cached() {
        let group = tempfile::tempdir().unwrap();
        let free = |limit: &str, stat: Option<&str>| {
            let write = |name: &str, text: &str| fs::write(group.path().join(name), text).unwrap();
            write("limit", limit);
            write("used", "700\n");
            stat.into_iter().for_each(|stat| write("memory.stat", stat));
            free_of(group.path().to_str().unwrap(), "limit", "used")
        };
        assert_eq!(free("1000\n", None), Some(300));
        assert_eq!(free("1000\n", Some("active_file 150\ninactive_file 50\n")), Some(500));
        assert_eq!(free("100\n", Some("active_file 0\n")), Some(0));
        assert_eq!(free("max\n", None), None);
    }

    #[test]
    fn the_systems_words_are_understood() {
        let available = |text| kilobytes(text, "MemAvailable:");
        assert_eq!(available("MemTotal: 9 kB\nMemAvailable:    2048 kB\n"), Some(2 << 20));
        assert_eq!(available("nothing"), None);
        assert_eq!(file_cache("anon 5\ninactive_file 10\nactive_file 20\n"), 30);
        assert_eq!(file_cache("active_file 1\ntotal_inactive_file 7\ntotal_active_file 2\n"), 9);
        assert_eq!([words(999), words(2_500_000), words(3_000_000_000)], ["999 bytes", "2.5 MB", "3.0 GB"]);
        let at_limits = [999_999, 1_000_000, 999_999_999, 1_000_000_000].map(words);
        assert_eq!(at_limits, ["999999 bytes", "1.0 MB", "1000.0 MB", "1.0 GB"]);
    }
}
