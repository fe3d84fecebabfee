//! The program as scripts see it: what it prints, what it writes, with which code it ends.

mod bad_input;
mod describe;
mod interrupt;
mod jobs;
mod pipes;
mod program;
