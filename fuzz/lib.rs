//! The targets of `tests/fuzz`, for a fuzzer that sees which code an input reaches.

#[path = "../tests/fuzz/targets.rs"]
pub mod targets;
#[path = "../tests/fuzz/words.rs"]
pub mod words;

pub use libfuzzer_sys;

/// A target by its name.
pub fn target(name: &str) -> &'static targets::Target {
    targets::TARGETS.iter().find(|target| target.name == name).expect("the targets of tests/fuzz")
}

/// A program that feeds one of the targets.
#[macro_export]
macro_rules! fuzz {
    ($name:literal) => {
        $crate::libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
            let _ = ($crate::target($name).run)(bytes);
        });
    };
}
