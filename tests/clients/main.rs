//! What other programs make of our files.

mod outside;
mod read_back;
mod references;
