//! Whether a film fits into memory, found out before it is asked for: a system that promises more than it has
//! ends the program in the middle.

use crate::film::Film;
use crate::render::RenderSettings;

/// A picture that is too large for this machine.
#[derive(Clone, Debug, thiserror::Error, PartialEq, Eq)]
#[error(
    "a picture of {width}x{height} needs {} of memory, but {} are free; choose a smaller --size{}",
    gigabytes(*needed_bytes), gigabytes(*free_bytes),
    if *half_count > 1 { ", or halve that with --estimate-error off" } else { "" }
)]
pub(super) struct MemoryError {
    pub width: u32,
    pub height: u32,
    pub half_count: usize,
    pub needed_bytes: u64,
    pub free_bytes: u64,
}

fn gigabytes(bytes: u64) -> String {
    format!("{:.1} GB", bytes as f64 / 1e9)
}

/// What a pixel takes besides its sums while the picture is written.
const OUTPUT_BYTES_PER_PIXEL: u64 = 4;

/// What everything else takes: program, scene, threads.
const BASE_BYTES: u64 = 64 << 20;

/// Refuses what does not fit, where the system says how much there is.
pub(super) fn check(settings: &RenderSettings) -> Result<(), MemoryError> {
    free_bytes().map_or(Ok(()), |free| check_against(settings, free))
}

fn check_against(settings: &RenderSettings, free_bytes: u64) -> Result<(), MemoryError> {
    let RenderSettings { width, height, .. } = *settings;
    let half_count = settings.half_count();
    let output_bytes = u64::from(width) * u64::from(height) * OUTPUT_BYTES_PER_PIXEL;
    let needed_bytes = Film::bytes(width, height, half_count) + output_bytes + BASE_BYTES;
    if needed_bytes > free_bytes {
        return Err(MemoryError { width, height, half_count, needed_bytes, free_bytes });
    }
    Ok(())
}

/// Memory that can be had: the lesser of what the system and the process's group have left. `None` where the
/// system does not say.
fn free_bytes() -> Option<u64> {
    let of_system = std::fs::read_to_string("/proc/meminfo").ok().and_then(|text| available(&text));
    [of_system, free_of_group()].into_iter().flatten().min()
}

fn available(meminfo: &str) -> Option<u64> {
    let line = meminfo.lines().find_map(|line| line.strip_prefix("MemAvailable:"))?;
    Some(line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok()? * 1024)
}

/// What the limits of the process's control groups leave. Cached files do not count: they make room when need
/// be.
fn free_of_group() -> Option<u64> {
    let groups = std::fs::read_to_string("/proc/self/cgroup").ok()?;
    let of_own = groups.lines().filter_map(|line| line.splitn(3, ':').nth(2));
    // Within a container the own group is the root of what can be seen, whatever its name outside.
    of_own.chain(["/"]).flat_map(|group| [free_of_group_v2(group), free_of_group_v1(group)]).flatten().min()
}

fn free_of_group_v2(group: &str) -> Option<u64> {
    free_of(&format!("/sys/fs/cgroup{group}"), "memory.max", "memory.current")
}

fn free_of_group_v1(group: &str) -> Option<u64> {
    free_of(&format!("/sys/fs/cgroup/memory{group}"), "memory.limit_in_bytes", "memory.usage_in_bytes")
}

fn free_of(directory: &str, limit: &str, used: &str) -> Option<u64> {
    let read = |name: &str| std::fs::read_to_string(format!("{directory}/{name}")).ok();
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
    // The first version of control groups has sums over subgroups besides.
    sum(["total_inactive_file ", "total_active_file "]).max(sum(["inactive_file ", "active_file "]))
}

#[cfg(test)]
mod tests {
    use super::*;

    const HUGE: RenderSettings = RenderSettings {
        width: 16_384,
        height: 16_384,
        max_depth: 50,
        sampler: crate::render::SamplerKind::Sobol,
        seed: 0,
        estimate_error: true,
    };

    #[test]
    fn what_does_not_fit_is_refused_with_the_numbers_and_a_remedy() {
        let message = check_against(&HUGE, 8_000_000_000).unwrap_err().to_string();
        for part in ["16384x16384", "14.0 GB", "8.0 GB", "--estimate-error off", "--size"] {
            assert!(message.contains(part), "{message}");
        }
        let one_half = RenderSettings { estimate_error: false, ..HUGE };
        assert_eq!(check_against(&one_half, 8_000_000_000), Ok(()));
        assert!(!check_against(&one_half, 1).unwrap_err().to_string().contains("--estimate-error"));
    }

    #[test]
    fn the_systems_words_are_understood() {
        assert_eq!(available("MemTotal: 9 kB\nMemAvailable:    2048 kB\n"), Some(2 << 20));
        assert_eq!(available("nothing"), None);
        assert_eq!(file_cache("anon 5\ninactive_file 10\nactive_file 20\n"), 30);
        assert_eq!(file_cache("active_file 1\ntotal_inactive_file 7\ntotal_active_file 2\n"), 9);
    }
}
