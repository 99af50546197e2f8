//! What can be done: the table of all commands, and the snapshot of the window that panels and commands read.

pub mod facts;
pub mod table;
