//! The error over time.

use crate::harness::{open, send, until};
use crate::questions::Ask as _;
use weekender::app::Command;

#[test]
fn renders_end_at_the_goal_and_continue_to_a_lower_one() {
    let mut harness = open("--scene three-spheres --size 64x36 --device cpu --noise-target 0.01");
    send(&mut harness, Command::ErrorDock);
    until(&mut harness, "the end", |window| window.status().phase.is_over());
    let done = harness.state().status().samples_per_pixel;
    send(&mut harness, Command::Pause);
    let goal = harness.state().shown_document().stop.noise.unwrap();
    assert!(goal < 0.01, "{goal}");
    until(&mut harness, "more samples", |window| window.status().samples_per_pixel > done);
}
