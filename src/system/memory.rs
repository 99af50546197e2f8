//! Checks whether data fits into memory before it is allocated. A system that overcommits memory would kill the program
//! later, and a failed allocation would abort it.
//!
//! Code that needs memory in proportion to a number from outside (films, pictures, scenes) first calls [`check`], or
//! allocates with [`zeroed`].

use indicatif::DecimalBytes;
use std::fs;

/// Something needs more memory than is available.
#[derive(Clone, Debug, thiserror::Error, PartialEq, Eq)]
#[error("{what} needs {} of memory, but {}{remedy}", words(*needed_bytes), room.limit.replace("{}", &words(room.bytes)))]
pub struct MemoryError {
    /// The purpose of the memory.
    pub what: String,
    /// Bytes needed, including what the rest of the program takes.
    pub needed_bytes: u64,
    pub room: Room,
    pub remedy: &'static str,
}

/// Memory that can still be allocated, and the limit that is reached first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Room {
    pub bytes: u64,
    /// What a message says about it, with `{}` for the bytes.
    limit: &'static str,
}

const MACHINE: &str = "only {} is free; ";
const GROUP: &str =
    "its control group (container, service or job) has only {} left; raise the group's limit, or ";
const ADDRESS_SPACE: &str = "ulimit -v leaves only {}; raise that limit, or ";
const DATA: &str = "ulimit -d leaves only {}; raise that limit, or ";
/// A limit that the system does not report.
const UNKNOWN: &str = "the system refuses it; ";

/// A number of bytes with a unit.
pub fn words(bytes: u64) -> String {
    DecimalBytes(bytes).to_string()
}

/// Everything else: program, threads, files.
const BASE_BYTES: u64 = 64 << 20;

/// Smaller sizes are not checked with the system; [`zeroed`] notices if the allocation fails.
const SMALL_BYTES: u64 = 16 << 20;

/// Returns an error if `bytes` do not fit into the free memory that the system reports. `what` names their purpose.
///
/// # Errors
/// [`MemoryError`] with this `remedy`.
pub fn check(what: impl FnOnce() -> String, bytes: u64, remedy: &'static str) -> Result<(), MemoryError> {
    if bytes < SMALL_BYTES {
        return Ok(());
    }
    room().map_or(Ok(()), |room| check_against(what(), bytes, room, remedy))
}

fn check_against(what: String, bytes: u64, room: Room, remedy: &'static str) -> Result<(), MemoryError> {
    let needed_bytes = bytes.saturating_add(BASE_BYTES);
    let fits = needed_bytes <= room.bytes;
    fits.then_some(()).ok_or(MemoryError { what, needed_bytes, room, remedy })
}

/// `count` zeros. The system provides each page when it is first written to, so this takes no time.
///
/// # Errors
/// [`MemoryError`] with this `remedy` if they do not fit.
pub fn zeroed<T: bytemuck::Zeroable>(
    count: usize,
    what: impl Fn() -> String,
    remedy: &'static str,
) -> Result<Vec<T>, MemoryError> {
    let bytes = (count as u64).saturating_mul(size_of::<T>() as u64);
    check(&what, bytes, remedy)?;
    bytemuck::allocation::try_zeroed_vec(count).map_err(|()| MemoryError {
        what: what(),
        needed_bytes: bytes,
        // If the known limits leave room, an unknown one was reached.
        room: room().filter(|room| room.bytes < bytes).unwrap_or(Room { bytes: 0, limit: UNKNOWN }),
        remedy,
    })
}

/// The smallest of what the machine, the process's control groups and its own limits allow. `None` if the system does
/// not report it.
pub fn room() -> Option<Room> {
    let groups = fs::read_to_string("/proc/self/cgroup").unwrap_or_default();
    let [address_space, data] = left_by_limits();
    let rooms = [
        (MACHINE, free_of_machine()),
        (GROUP, free_of_groups(&groups, "/sys/fs/cgroup")),
        (ADDRESS_SPACE, address_space),
        (DATA, data),
    ];
    let known = rooms.into_iter().filter_map(|(limit, bytes)| Some(Room { bytes: bytes?, limit }));
    known.min_by_key(|room| room.bytes)
}

/// What `ulimit -v` and `ulimit -d` leave of the process's address space and data.
#[cfg(target_os = "linux")]
fn left_by_limits() -> [Option<u64>; 2] {
    use rustix::process::{Resource, getrlimit};
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    [(Resource::As, "VmSize:"), (Resource::Data, "VmData:")].map(|(resource, used)| {
        let limit = getrlimit(resource).current?;
        Some(limit.saturating_sub(in_bytes(&status, used).unwrap_or(0)))
    })
}

#[cfg(not(target_os = "linux"))]
fn left_by_limits() -> [Option<u64>; 2] {
    [None; 2]
}

#[cfg(any(windows, target_vendor = "apple"))]
fn free_of_machine() -> Option<u64> {
    let mut system = sysinfo::System::new().ok()?;
    system.refresh_memory();
    Some(system.available_memory()).filter(|bytes| *bytes > 0)
}

/// In a browser, a program has 4 GiB and never gives memory back.
#[cfg(target_family = "wasm")]
fn free_of_machine() -> Option<u64> {
    Some((1 << 32) - 65_536 * core::arch::wasm32::memory_size::<0>() as u64)
}

#[cfg(not(any(windows, target_vendor = "apple", target_family = "wasm")))]
fn free_of_machine() -> Option<u64> {
    in_bytes(&fs::read_to_string("/proc/meminfo").ok()?, "MemAvailable:")
}

/// The value of a line such as `MemAvailable:  2048 kB` of a file in `/proc`, in bytes.
#[cfg(any(test, not(any(windows, target_vendor = "apple", target_family = "wasm"))))]
fn in_bytes(text: &str, name: &str) -> Option<u64> {
    let line = text.lines().find_map(|line| line.strip_prefix(name))?;
    line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok()?.checked_mul(1024)
}

/// The memory that the process's control `groups` (`/proc/self/cgroup`) and their ancestors below `root` still allow:
/// groups of version 2, of version 1, and of both at once. In a container, the process's own group is the visible root,
/// whatever its name outside.
fn free_of_groups(groups: &str, root: &str) -> Option<u64> {
    let free = |line: &str| {
        let (controllers, own) = line.split_once(':')?.1.split_once(':')?;
        let mounts: &[&str] = match controllers {
            "" => &["", "/unified"],
            _ if controllers.split(',').any(|name| name == "memory") => &["/memory"],
            _ => return None,
        };
        let around = own.match_indices('/').map(|(end, _)| &own[..end]).chain([own]);
        around
            .flat_map(|group| mounts.iter().map(move |mount| format!("{root}{mount}{group}")))
            .filter_map(|directory| free_of_group(&directory))
            .min()
    };
    groups.lines().filter_map(free).min()
}

/// Cached files do not count, because the system drops them when memory is short. (sysinfo's `cgroup_limits` counts
/// them, so a job that has written large films would be refused.)
fn free_of_group(directory: &str) -> Option<u64> {
    let read = |name: &str| fs::read_to_string(format!("{directory}/{name}")).ok();
    // Version 2, or version 1.
    let number = |names: [&str; 2]| names.into_iter().find_map(read)?.trim().parse::<u64>().ok();
    let stat = read("memory.stat").unwrap_or_default();
    let bytes =
        |name: &str| stat.lines().find_map(|line| line.strip_prefix(name)?.trim().parse::<u64>().ok());
    // In version 1, only the totals include the groups below.
    let cached =
        |name: &str| bytes(&format!("total_{name} ")).or_else(|| bytes(&format!("{name} "))).unwrap_or(0);
    let used = number(["memory.current", "memory.usage_in_bytes"])?;
    let used = used.saturating_sub(cached("active_file") + cached("inactive_file"));
    Some(number(["memory.max", "memory.limit_in_bytes"])?.saturating_sub(used))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn refusals_have_numbers_and_a_remedy() {
        let of = |limit| move |bytes| Room { bytes, limit };
        let check = |bytes, free| check_against("a film".to_owned(), bytes, of(MACHINE)(free), "do less");
        let message = check(14_000_000_000, 8_000_000_000).unwrap_err().to_string();
        let parts = ["a film", "14.07 GB", "8.00 GB", "do less"];
        assert!(parts.iter().all(|part| message.contains(part)), "{message}");
        assert!(check(u64::MAX, u64::MAX - 1).is_err());
        for (limit, name) in [(ADDRESS_SPACE, "ulimit -v"), (GROUP, "control group")] {
            let refused = check_against("a film".to_owned(), 9, of(limit)(5_000_000), "do less");
            assert!(refused.unwrap_err().to_string().contains(name));
        }
        let rest = (9 << 30) - BASE_BYTES;
        assert_eq!(check(rest, 9 << 30), Ok(()));
        assert!(check(rest + 1, 9 << 30).is_err(), "the program needs the rest");

        let fill = |count: usize| zeroed::<u64>(count, || "a list".to_owned(), "make it shorter");
        assert_eq!(fill(3).unwrap(), [0; 3]);
        for count in [1 << 50, usize::MAX] {
            let message = fill(count).unwrap_err().to_string();
            assert!(message.contains("a list") && message.contains("make it shorter"), "{message}");
        }
    }

    /// Groups of version 2, of version 1 and of both, whose limits and use are in files at a path below the root.
    #[test]
    fn groups_allow_the_smallest_limit_less_uncached_use() {
        const V2: [&str; 2] = ["memory.max", "memory.current"];
        const V1: [&str; 2] = ["memory.limit_in_bytes", "memory.usage_in_bytes"];
        let free = |groups: &str, put: &[(&str, [&str; 2], &str, &str)]| {
            let root = tempfile::tempdir().unwrap();
            for (at, names, limit, stat) in put {
                let at = root.path().join(at);
                fs::create_dir_all(&at).unwrap();
                for (name, text) in [(names[0], *limit), (names[1], "700\n"), ("memory.stat", *stat)] {
                    fs::write(at.join(name), text).unwrap();
                }
            }
            free_of_groups(groups, root.path().to_str().unwrap())
        };
        let own = "0::/a/b\n";
        assert_eq!(free(own, &[("a/b", V2, "1000\n", "")]), Some(300));
        let cached = "anon 5\nactive_file 150\ninactive_file 50\n";
        assert_eq!(free(own, &[("a/b", V2, "1000\n", cached), ("a", V2, "900\n", "")]), Some(200));
        assert_eq!(free(own, &[("a/b", V2, "100\n", "active_file 0\n")]), Some(0));
        assert_eq!(free(own, &[("a/b", V2, "max\n", ""), ("c", V2, "1\n", "")]), None);
        assert_eq!(free(own, &[("", V2, "800\n", "")]), Some(100), "in a container");
        let old = "5:cpu,cpuacct:/c\n4:memory:/a/b\n1:name=systemd:/c\n0::/\n";
        let totals = "active_file 1\ntotal_active_file 150\ninactive_file 1\ntotal_inactive_file 50\n";
        assert_eq!(
            free(old, &[("memory/a/b", V1, "1000\n", totals), ("memory/c", V1, "1\n", "")]),
            Some(500)
        );
        let unlimited = "9223372036854771712\n";
        assert_eq!(
            free(old, &[("memory/a", V1, "1000\n", ""), ("memory/a/b", V1, unlimited, "")]),
            Some(300)
        );
        assert_eq!(
            free("4:memory:/a\n0::/c\n", &[("unified/c", V2, "900\n", ""), ("memory/a", V1, "1000\n", "")]),
            Some(200)
        );
        assert_eq!(free("", &[]), None);
        let meminfo = "MemTotal: 9 kB\nMemAvailable:    2048 kB\n";
        assert_eq!(in_bytes(meminfo, "MemAvailable:"), Some(2 << 20));
        assert_eq!(in_bytes("nothing", "MemAvailable:"), None);
    }
}
