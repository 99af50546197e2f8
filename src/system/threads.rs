//! Work shared among threads. A system may refuse to start a thread, for example in a full control group or at the
//! limit on a user's processes; the threads that do start then do all the work. WebAssembly has no threads, so there
//! the caller's thread does it.

use rayon::{ThreadPool, ThreadPoolBuildError, ThreadPoolBuilder};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Mutex, PoisonError};
use std::thread::{self, Builder};

/// Whether the system has threads.
pub const EXIST: bool = !cfg!(target_family = "wasm");

/// Threads that wait for work, or the caller's.
pub(crate) struct Pool(Option<ThreadPool>);

impl Pool {
    pub fn start(builder: ThreadPoolBuilder) -> Result<Pool, ThreadPoolBuildError> {
        Ok(Pool(EXIST.then(|| builder.build()).transpose()?))
    }

    pub fn count(&self) -> usize {
        self.0.as_ref().map_or(1, ThreadPool::current_num_threads)
    }

    /// Runs `work`, whose parallel iterators use these threads.
    pub fn install<R: Send>(&self, work: impl FnOnce() -> R + Send) -> R {
        match &self.0 {
            Some(threads) => threads.install(work),
            None => work(),
        }
    }
}

/// Applies `work` to each item, on as many threads as the system starts, the caller's included. Returns the results in
/// the order of the items. A panic fails only its own item.
pub(crate) fn shared<T: Send, R: Send>(
    items: Vec<T>,
    work: impl Fn(T) -> R + Sync,
) -> Vec<thread::Result<R>> {
    let count = items.len();
    let left = Mutex::new(items.into_iter().enumerate());
    let work_off = || {
        let mut done = Vec::new();
        loop {
            let next = left.lock().unwrap_or_else(PoisonError::into_inner).next();
            let Some((index, item)) = next else { return done };
            done.push((index, catch_unwind(AssertUnwindSafe(|| work(item)))));
        }
    };
    let mut results: Vec<thread::Result<R>> = Vec::with_capacity(count);
    results.resize_with(count, || Err(Box::new("its thread has failed")));
    thread::scope(|scope| {
        let start = |_| Builder::new().spawn_scoped(scope, work_off).ok();
        let helpers: Vec<_> = (1..count).map_while(start).collect();
        let mut done = work_off();
        for helper in helpers {
            done.extend(helper.join().unwrap_or_default());
        }
        for (index, result) in done {
            results[index] = result;
        }
    });
    results
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_are_in_the_order_of_the_items() {
        let doubled = shared((0..9).collect(), |item: u32| 2 * item);
        let doubled: Vec<u32> = doubled.into_iter().map(Result::unwrap).collect();
        assert_eq!(doubled, [0, 2, 4, 6, 8, 10, 12, 14, 16]);
        assert!(shared(Vec::<u32>::new(), |item| item).is_empty());
    }

    #[test]
    fn a_panic_fails_only_its_item() {
        let done = shared((0..5).collect(), |item: u32| {
            assert!(item != 2, "a slip");
            item
        });
        let done: Vec<Option<u32>> = done.into_iter().map(Result::ok).collect();
        assert_eq!(done, [Some(0), Some(1), None, Some(3), Some(4)]);
    }
}
