#![no_main]

lampyris_fuzz::target!("mitsuba");
