//! The list of backends and their factory. A new backend is a variant of [`BackendChoice`] and an arm of
//! [`create`]; command line, window and reports read the rest from here.

use crate::render::Renderer;
use crate::render_cpu::{CpuError, CpuOptions, CpuRenderer, Isa};
use thiserror::Error;

/// Which backend renders, and with what.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum BackendChoice {
    /// `f32` on the CPU, in SIMD packets or scalar.
    Cpu(CpuOptions),
    /// Scalar `f64` on the CPU: what rounding is measured against.
    Reference {
        /// Threads; by default one a core.
        threads: Option<usize>,
    },
}

impl BackendChoice {
    /// The best for this machine: the widest CPU kernel.
    pub fn auto(cpu: CpuOptions) -> Self {
        BackendChoice::Cpu(cpu)
    }

    /// What goes on when another backend fails: the CPU, with everything at its default.
    pub fn fallback() -> Self {
        BackendChoice::Cpu(CpuOptions::default())
    }

    /// "cpu" or "reference".
    pub fn name(&self) -> &'static str {
        match self {
            BackendChoice::Cpu(_) => "cpu",
            BackendChoice::Reference { .. } => "reference",
        }
    }
}

/// A backend that cannot be had.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum BackendError {
    /// The CPU's options cannot be met.
    #[error(transparent)]
    Cpu(#[from] CpuError),
    /// There is no GPU backend.
    #[error("device gpu: this build has no GPU backend; use --device cpu, or auto for the fastest there is")]
    NoGpu,
}

/// Starts a backend.
///
/// # Errors
/// [`BackendError`], with what can be had instead.
pub fn create(choice: &BackendChoice) -> Result<Box<dyn Renderer>, BackendError> {
    Ok(match choice {
        BackendChoice::Cpu(options) => Box::new(CpuRenderer::new(*options)?),
        BackendChoice::Reference { threads } => Box::new(CpuRenderer::reference(*threads)?),
    })
}

/// One line of `--list`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BackendListing {
    /// The `--device` that uses it.
    pub device: &'static str,
    /// Instruction level or adapter, with what there is to choose.
    pub about: String,
    /// Whether `--device auto` takes it.
    pub is_auto: bool,
}

/// The backends of this machine, in the order of the command line's names.
pub fn list() -> Vec<BackendListing> {
    let levels = Isa::available();
    let best = levels.last().copied();
    let cpu = levels.into_iter().map(|isa| {
        let lanes: Vec<String> = isa.lane_counts().iter().map(usize::to_string).collect();
        let chosen = isa.native_lanes();
        BackendListing {
            device: "cpu",
            about: format!("--isa {isa}: --simd {} lanes, {chosen} by default", lanes.join(", ")),
            is_auto: Some(isa) == best,
        }
    });
    let reference = BackendListing {
        device: "reference",
        about: "f64, one lane: slow, and what rounding is measured against".to_owned(),
        is_auto: false,
    };
    cpu.chain([reference]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_listed_backend_is_the_automatic_one() {
        assert_eq!(list().iter().filter(|line| line.is_auto).count(), 1);
    }
}
