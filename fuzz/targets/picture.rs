#![no_main]
linden_fuzz::fuzz!("picture");
