//! `secateur completions`: what shells complete, and man pages.

use std::fs;
use std::io::{self, Write};

use clap::ValueEnum;
use clap_complete::Shell;
use serde_json::json;

use super::args;
use super::failure::Failure;
use super::output;
use super::print::Printed;

/// For what completions are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum CompletionsFor {
    Bash,
    Elvish,
    Fish,
    Powershell,
    Zsh,
    /// Man pages, a file for each command, into the folder of `--output`
    Man,
}

impl CompletionsFor {
    fn shell(self) -> Option<Shell> {
        match self {
            Self::Bash => Some(Shell::Bash),
            Self::Elvish => Some(Shell::Elvish),
            Self::Fish => Some(Shell::Fish),
            Self::Powershell => Some(Shell::PowerShell),
            Self::Zsh => Some(Shell::Zsh),
            Self::Man => None,
        }
    }
}

/// Prints what a shell reads, or writes man pages.
pub(crate) fn run(args: &args::Completions) -> Result<Printed, Failure> {
    let mut command = args::command();
    if let Some(shell) = args.of.shell() {
        let mut script = Vec::new();
        clap_complete::generate(shell, &mut command, "secateur", &mut script);
        // As it is: scripts have tabs.
        let sent = io::stdout().lock().write_all(&script);
        sent.map_err(|e| Failure::machine(format!("standard output cannot be written: {e}")))?;
        return Ok(Printed::nothing());
    }
    let Some(folder) = &args.output else {
        return Err(Failure::usage(
            "man pages are files: name a folder for them with `--output`",
        ));
    };
    output::check_folder(folder)?;
    let written =
        fs::create_dir_all(folder).and_then(|()| clap_mangen::generate_to(command, folder));
    written.map_err(|e| Failure::of_file(folder, "cannot be written into", &e))?;
    let shown = folder.display();
    Ok(Printed::single(
        format!("man pages are in {shown}: man {shown}/secateur.1\n"),
        json!({ "output": folder }),
    ))
}
