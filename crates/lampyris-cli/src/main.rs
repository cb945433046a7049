//! The command line of Lampyris.

#[cfg(test)]
mod args;

fn main() {}
