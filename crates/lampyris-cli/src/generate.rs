//! `lampyris completions` and `lampyris man`: what a shell and `man` should know of the program.

use std::path::Path;

use clap::CommandFactory;
use clap_complete::{Shell, generate};
use lampyris::error::{Error, Result};
use lampyris::output::write_whole;

use crate::args::Arguments;
use crate::report::print;

/// What man pages say they come from.
const SOURCE: &str = concat!("lampyris ", env!("CARGO_PKG_VERSION"));

/// Prints the completions for a shell.
///
/// # Errors
/// If they cannot be printed.
pub fn completions(shell: Shell) -> Result<()> {
    let mut script = Vec::new();
    generate(shell, &mut Arguments::command(), "lampyris", &mut script);
    print(&String::from_utf8_lossy(&script))
}

/// Writes a man page for the program and one for each command into a folder, which is made if it is not there.
///
/// # Errors
/// What the operating system says.
pub fn man(folder: &Path) -> Result<()> {
    std::fs::create_dir_all(folder).map_err(|error| Error::io(folder, "create", &error))?;
    let mut program = Arguments::command().disable_help_subcommand(true);
    program.build();
    page(folder, &program, "lampyris")?;
    for command in program.get_subcommands().filter(|command| !command.is_hide_set()) {
        page(folder, command, &format!("lampyris-{}", command.get_name()))?;
    }
    Ok(())
}

fn page(folder: &Path, command: &clap::Command, name: &str) -> Result<()> {
    let path = folder.join(format!("{name}.1"));
    let mut text = Vec::new();
    let rendered = clap_mangen::Man::new(command.clone()).source(SOURCE).render(&mut text);
    rendered.map_err(|error| Error::io(&path, "write", &error))?;
    write_whole(&path, &text)
}
