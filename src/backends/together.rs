//! Several renderers working on one film. Each takes more samples when it finishes, so faster ones take more.

use super::close;
use crate::film::Film;
use crate::job::render::{
    BackendInfo, Control, Diagnostics, KernelInfo, Outcome, RenderError, RenderJob, Renderer, Stats,
};
use crate::system::threads::shared;
use std::ops::Range;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

/// A member's next piece is this fraction of the remaining samples times its share of the total speed, so that members
/// finish together without asking often.
const PIECE_SHARE: f64 = 0.5;

struct Member {
    renderer: Box<dyn Renderer>,
    /// Samples of all pixels per second, as last measured.
    samples_per_second: Option<f64>,
    added: u64,
}

/// Renders with all members. If one fails, the others take over its samples.
pub struct Together {
    members: Vec<Member>,
    messages: Vec<String>,
    /// Samples that failed members added to the current range.
    departed: Vec<(BackendInfo, u64)>,
}

/// The result of a member's work on a range.
#[derive(Default)]
struct Share {
    film: Option<Film>,
    stats: Stats,
    error: Option<RenderError>,
}

/// Samples that no member has taken yet.
struct Pieces {
    left: Vec<Range<u64>>,
    grain: u64,
    /// Samples of all pixels per second of each member, as last measured.
    speeds: Vec<Option<f64>>,
}

impl Pieces {
    /// The member's share of the remaining samples in whole grains, at least one. `None` if another member would
    /// finish all of them before this one finished a grain.
    fn take(&mut self, member: usize) -> Option<Range<u64>> {
        let total: u64 = self.left.iter().map(|range| range.end - range.start).sum();
        let mut share = 0.0;
        // A member that has not been measured yet takes the smallest piece.
        if let Some(speed) = self.speeds[member] {
            let fastest = self.speeds.iter().flatten().copied().fold(speed, f64::max);
            if fastest > speed && self.grain as f64 * fastest / speed > total as f64 {
                return None;
            }
            share = PIECE_SHARE * speed / self.speeds.iter().flatten().sum::<f64>();
        }
        let range = self.left.last_mut()?;
        let wanted = (total as f64 * share) as u64 / self.grain * self.grain;
        let end = range.end.min(range.start + wanted.max(self.grain));
        let piece = range.start..end;
        range.start = end;
        if range.is_empty() {
            self.left.pop();
        }
        Some(piece)
    }
}

impl Together {
    /// Combines renderers; there must be at least one.
    pub fn new(renderers: Vec<Box<dyn Renderer>>) -> Self {
        let member = |renderer| Member { renderer, samples_per_second: None, added: 0 };
        Together {
            members: renderers.into_iter().map(member).collect(),
            messages: Vec::new(),
            departed: Vec::new(),
        }
    }

    /// Removes the members that failed. Returns the last error if none remains.
    fn leave_out(&mut self, failed: Vec<(usize, RenderError)>) -> Result<(), RenderError> {
        let mut last = None;
        for (index, error) in failed.into_iter().rev() {
            let mut member = self.members.remove(index);
            self.departed.extend((member.added > 0).then(|| (member.renderer.info(), member.added)));
            if !self.members.is_empty() {
                let names: Vec<&str> = self.members.iter().map(|m| m.renderer.info().name).collect();
                self.messages.push(format!("{error}; {} continues the same picture", names.join(", ")));
            }
            last = Some(error);
            self.messages.extend(member.renderer.take_messages());
            close(member);
        }
        match last {
            Some(error) if self.members.is_empty() => Err(error),
            _ => Ok(()),
        }
    }
}

impl Renderer for Together {
    fn info(&self) -> BackendInfo {
        let mut parts = self.members.iter().map(|member| member.renderer.info());
        let Some(first) = parts.next() else {
            return BackendInfo { name: "none", device: String::new(), lanes: 0, threads: 0 };
        };
        parts.fold(first, |all, part| BackendInfo {
            name: if all.name == "cpu" && part.name == "gpu" { "cpu,gpu" } else { all.name },
            device: format!("{} and {}", all.device, part.device),
            lanes: all.lanes,
            threads: all.threads + part.threads,
        })
    }

    fn take_messages(&mut self) -> Vec<String> {
        let members = self.members.iter_mut().flat_map(|member| member.renderer.take_messages());
        self.messages.drain(..).chain(members).collect()
    }

    /// Lists as left out the parts that any member leaves out.
    fn diagnostics(&self) -> Diagnostics {
        let members: Vec<Diagnostics> =
            self.members.iter().map(|member| member.renderer.diagnostics()).collect();
        let kernels = members.iter().map(|member| &member.kernel);
        let mut left_out = Vec::new();
        for name in kernels.clone().flat_map(|kernel| &kernel.left_out) {
            if !left_out.contains(name) {
                left_out.push(*name);
            }
        }
        let kernel = KernelInfo {
            about: kernels.clone().map(|kernel| kernel.about.as_str()).collect::<Vec<_>>().join(" | "),
            left_out,
            hierarchy_time: kernels.map(|kernel| kernel.hierarchy_time).sum(),
        };
        Diagnostics { kernel, ..Diagnostics::default() }
    }

    fn prepare(&mut self, job: &RenderJob, cancel: &AtomicBool) -> Result<(), RenderError> {
        let mut failed = Vec::new();
        for (index, member) in self.members.iter_mut().enumerate() {
            match member.renderer.prepare(job, cancel) {
                Ok(()) => {}
                Err(RenderError::Cancelled) => return Err(RenderError::Cancelled),
                Err(error) => failed.push((index, error)),
            }
        }
        self.leave_out(failed)
    }

    fn advance(
        &mut self,
        job: &RenderJob,
        range: Range<u64>,
        film: &mut Film,
        &Control { cancel, .. }: &Control,
    ) -> Result<Outcome, RenderError> {
        let begin = Instant::now();
        film.samples().check_new(&range)?;
        let grain = film.halves().len() as u64;
        let left = std::iter::once(range).filter(|range| !range.is_empty()).collect();
        let mut pieces = Mutex::new(Pieces { left, grain, speeds: Vec::new() });
        let mut stats = Stats::default();
        // Each member has its own film, which holds only whole pieces. They are added to the caller's film at the
        // end, so an error leaves that film unchanged.
        let mut films: Vec<Film> = Vec::new();
        self.members.iter_mut().for_each(|member| member.added = 0);
        self.departed.clear();
        loop {
            let speeds = self.members.iter().map(|member| member.samples_per_second).collect();
            pieces.get_mut().unwrap_or_else(PoisonError::into_inner).speeds = speeds;
            let members: Vec<_> = self.members.iter_mut().enumerate().collect();
            let shares = shared(members, |(index, member)| work_off(member, index, job, &pieces, cancel));
            let mut failed = Vec::new();
            for (index, share) in shares.into_iter().enumerate() {
                let share = share.unwrap_or_else(|payload| {
                    let error = Some(RenderError::of_panic("a renderer", payload.as_ref()));
                    Share { error, ..Share::default() }
                });
                stats.add(&share.stats);
                films.extend(share.film);
                match share.error {
                    Some(RenderError::Cancelled) => return Err(RenderError::Cancelled),
                    Some(error) => failed.push((index, error)),
                    None => {}
                }
            }
            let nothing_left = pieces.lock().unwrap_or_else(PoisonError::into_inner).left.is_empty();
            self.leave_out(failed)?;
            if nothing_left {
                break;
            }
        }
        for part in &films {
            film.merge(part)?;
        }
        stats.trace = begin.elapsed();
        let present = self.members.iter().map(|member| (member.renderer.info(), member.added));
        Ok(Outcome::Added { stats, credits: present.chain(self.departed.drain(..)).collect() })
    }
}

/// Takes pieces until none is left, and finishes their samples.
fn work_off(
    member: &mut Member,
    index: usize,
    job: &RenderJob,
    pieces: &Mutex<Pieces>,
    cancel: &AtomicBool,
) -> Share {
    let begin = Instant::now();
    let mut share = Share::default();
    let mut taken = Vec::new();
    let renderer = member.renderer.as_mut();
    let name = renderer.info().name;
    while share.error.is_none() {
        if cancel.load(Ordering::Relaxed) {
            share.error = Some(RenderError::Cancelled);
            return share;
        }
        let piece = pieces.lock().unwrap_or_else(PoisonError::into_inner).take(index);
        let is_last = piece.is_none();
        if is_last && taken.is_empty() {
            return share;
        }
        let film = share.film.get_or_insert_with(|| job.new_film());
        let work = || match piece {
            Some(piece) => {
                taken.push(piece.clone());
                renderer.advance(job, piece, film, &Control::deferring(cancel)).map(|outcome| outcome.stats())
            }
            None => renderer.finish(film),
        };
        // A panic leaves the film unchanged; samples not yet in it are left to the other members.
        match catch_unwind(AssertUnwindSafe(work)) {
            Ok(Ok(stats)) => share.stats.add(&stats),
            Ok(Err(error)) => share.error = Some(error),
            Err(payload) => share.error = Some(RenderError::of_panic(name, payload.as_ref())),
        }
        if is_last {
            break;
        }
    }
    if matches!(share.error, Some(RenderError::FilmLost { .. })) {
        share.film = Some(job.new_film());
    }
    let Some(film) = &share.film else { return share };
    // Samples that a member has not added to its film are left to the others.
    let is_lost = |piece: &Range<u64>| !piece.is_empty() && film.samples().overlap(piece).is_none();
    let lost: Vec<Range<u64>> = taken.into_iter().filter(is_lost).collect();
    if share.error.is_none() && !lost.is_empty() {
        let reason = "it did not add all of its samples".to_owned();
        share.error = Some(RenderError::Backend { backend: name, reason });
    }
    pieces.lock().unwrap_or_else(PoisonError::into_inner).left.extend(lost);
    let added = film.sample_count();
    member.added += added;
    if added > 0 {
        member.samples_per_second = Some(added as f64 / begin.elapsed().as_secs_f64().max(1e-9));
    }
    share
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pieces_cover_a_range_once_in_whole_grains() {
        let speeds = vec![None, Some(2.0), Some(1.0)];
        let mut pieces = Pieces { left: vec![6..50, 50..120], grain: 2, speeds };
        let mut covered = Vec::new();
        for turn in 0.. {
            if pieces.left.is_empty() {
                break;
            }
            let Some(piece) = pieces.take(turn % 3) else { continue };
            assert_eq!((piece.start % 2, piece.end % 2), (0, 0), "{piece:?} tears a pair of samples apart");
            if turn == 2 {
                pieces.left.push(piece);
                continue;
            }
            covered.extend(piece);
        }
        covered.sort_unstable();
        assert_eq!(covered, (6..120).collect::<Vec<u64>>());
    }

    #[test]
    fn piece_size_follows_relative_speed() {
        // Half of what is left, times the share of the total speed: 3/4 and 1/4.
        let [fast, slow, new] = [0, 1, 2];
        let take = |left: Vec<Range<u64>>, member| {
            let mut pieces = Pieces { left, grain: 2, speeds: vec![Some(30.0), Some(10.0), None] };
            (pieces.take(member), pieces.left)
        };
        let one = |range: Range<u64>| -> Vec<Range<u64>> { std::iter::once(range).collect() };
        assert_eq!(take(one(100..164), fast), (Some(100..124), one(124..164)));
        assert_eq!(take(one(100..164), slow), (Some(100..108), one(108..164)));
        assert_eq!(take(one(100..164), new), (Some(100..102), one(102..164)), "the smallest piece");
        // 3 / 8 of 64, but no more than the last range has.
        assert_eq!(take(vec![0..56, 90..98], fast), (Some(90..98), one(0..56)));
        // The fast member would trace six samples while the slow one traces a grain of two.
        assert_eq!(take(one(0..5), slow).0, None);
        assert_eq!(take(one(0..6), slow).0, Some(0..2));
        // An odd last sample is its own piece.
        assert_eq!(take(one(8..9), fast), (Some(8..9), vec![]));
        assert_eq!(take(vec![], fast), (None, vec![]));
        // The fastest takes it however close the others are.
        let mut pieces = Pieces { left: one(8..9), grain: 2, speeds: vec![Some(10.0), Some(9.0)] };
        assert_eq!((pieces.take(1), pieces.take(0)), (None, Some(8..9)));
    }
}
