//! `weekender bench` and `report`, and the plain C program that they compare with.

mod bench;
mod reference_c;
mod report;
