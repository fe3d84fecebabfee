#![no_main]
linden_fuzz::fuzz!("usd");
