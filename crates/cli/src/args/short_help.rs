//! `-h`: one screen for each command. All options, and all of each, are in `--help`.

use clap::{Arg, Command, CommandFactory};

use super::{Cli, OF_OTHERS, OF_RECORDS, OF_VDS};

/// Headings of options that belong to the laboratory.
const OF_LABORATORY: [&str; 3] = [OF_VDS, OF_OTHERS, OF_RECORDS];

/// Options that few people need, by their identifiers.
const SELDOM: [&str; 24] = [
    "keep_going",
    "alpha",
    "sides",
    "vertex_alpha",
    "wind",
    "as_one",
    "field_of_view",
    "occluder",
    "cutoffs",
    "colors",
    "fit",
    "shadow_steps",
    "max_pop",
    "morph",
    "cost",
    "impostor_textures",
    "textures",
    "strips",
    "height_px",
    "field_of_view_degrees",
    "frames_up_to",
    "only",
    "seeds",
    "engine",
];

/// The command line, with short help.
pub(crate) fn command() -> Command {
    shortened(Cli::command())
}

fn shortened(command: Command) -> Command {
    let names: Vec<String> = command
        .get_subcommands()
        .map(|sub| sub.get_name().to_owned())
        .collect();
    let command = command.mut_args(short);
    names.into_iter().fold(command, |command, name| {
        command.mut_subcommand(name, shortened)
    })
}

/// An option with its first clause as its short help.
fn short(argument: Arg) -> Arg {
    let is_hidden = argument
        .get_help_heading()
        .is_some_and(|heading| OF_LABORATORY.contains(&heading))
        || SELDOM.contains(&argument.get_id().as_str());
    let argument = argument.hide_short_help(is_hidden);
    match (argument.get_help(), argument.get_long_help()) {
        (Some(help), None) => {
            let help = help.to_string();
            let first = first_clause(&help).to_owned();
            argument.help(first).long_help(help)
        }
        _ => argument,
    }
}

/// A sentence up to where it goes into details.
fn first_clause(help: &str) -> &str {
    let ends = ["; ", ": ", ". ", ", such as", ", made ", " (", " [default"];
    let end = ends.iter().filter_map(|end| help.find(end)).min();
    help[..end.unwrap_or(help.len())].trim_end_matches('.')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_help_of_each_command_fits_a_screen() {
        let mut command = command().term_width(100);
        command.build();
        for sub in command.get_subcommands_mut() {
            let lines = sub.render_help().to_string().lines().count();
            assert!(lines <= 45, "{}: {lines} lines", sub.get_name());
        }
    }

    #[test]
    fn short_help_is_the_first_clause() {
        assert_eq!(
            first_clause("The tree, .glb or .gltf; - reads it."),
            "The tree, .glb or .gltf"
        );
        assert_eq!(first_clause("Do not draw."), "Do not draw");
    }
}
