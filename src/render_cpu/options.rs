//! Options of a CPU backend.

use super::Isa;

/// Options of a CPU backend; `None` lets the backend choose.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CpuOptions {
    /// Instruction level; by default the most capable one that the processor supports.
    pub isa: Option<Isa>,
    /// Number of lanes; by default one register's. 1 is scalar.
    pub lanes: Option<usize>,
    /// Number of threads; by default one per core.
    pub threads: Option<usize>,
    /// Whether the threads yield to other work, such as a window. Linux only.
    pub low_priority: bool,
    /// Whether every job gets the general kernel, to measure the gain of specialisation.
    pub general: bool,
}

/// Options that this machine cannot satisfy.
#[derive(Clone, Debug, thiserror::Error, PartialEq, Eq)]
pub enum CpuError {
    /// The processor does not support the level.
    #[error("this processor does not support {isa}; it supports {}", list(available))]
    Isa {
        /// The requested level.
        isa: Isa,
        /// The levels that the processor supports.
        available: Vec<Isa>,
    },
    /// The level has no kernel for this lane count.
    #[error("level {isa} has no kernel for {lanes} lanes; choose one of {}", list(available))]
    Lanes {
        /// The requested lane count.
        lanes: usize,
        /// The level without such a kernel.
        isa: Isa,
        /// The lane counts that the level supports.
        available: Vec<usize>,
    },
    /// The threads could not be started.
    #[error(
        "cannot start {threads} thread{}: {reason}; choose fewer with --threads, or allow more (ulimit -u, ulimit -v)",
        if *threads == 1 { "" } else { "s" }
    )]
    Threads {
        /// The requested number; 0 means one per core.
        threads: usize,
        /// The system's error message.
        reason: String,
    },
}

fn list<T: std::fmt::Display>(items: &[T]) -> String {
    items.iter().map(T::to_string).collect::<Vec<_>>().join(", ")
}
