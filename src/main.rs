//! The command line of `cartilage_contact`.

mod cli;

fn main() -> std::process::ExitCode {
    cli::run()
}
