//! The command line of Lampyris.

mod args;

fn main() {
    let arguments = <args::Arguments as clap::Parser>::parse();
    if let args::Command::Schema = arguments.command {
        print!("{}", lampyris::scene::schema::json_schema());
    }
}
