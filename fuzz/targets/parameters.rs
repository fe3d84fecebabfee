#![no_main]
linden_fuzz::fuzz!("parameters");
