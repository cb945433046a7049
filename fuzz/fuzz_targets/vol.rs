#![no_main]

lampyris_fuzz::target!("vol");
