//! The program `secateur`: see `secateur --help`.

use std::process::ExitCode;

fn main() -> ExitCode {
    secateur_cli::main(std::env::args_os())
}
