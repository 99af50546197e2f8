//! The panels around the picture.

pub mod bar;
pub mod compare;
pub mod controls;
pub mod plot;
pub mod present;
pub mod right;
pub mod stage_panel;
pub mod status;
pub mod tone;
