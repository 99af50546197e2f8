//! The foundation of every room: files written whole or not at all, the log, signals, the memory check, the console.

pub mod console;
pub mod failure;
pub mod files;
pub mod foreign;
pub mod interrupt;
pub mod journal;
pub mod memory;
pub mod shell;
pub mod terminal;
pub mod threads;
