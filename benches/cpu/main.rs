//! The parts of the CPU tracer, one by one, at every width of this processor: `cargo bench --bench cpu [FILTER]`.

#![allow(clippy::expect_used, reason = "a benchmark that cannot run has failed")]

mod features;
mod hierarchy;
mod intersect;
mod packet;
mod sampler;
mod scatter;
mod widths;

fn main() {
    divan::main();
}
