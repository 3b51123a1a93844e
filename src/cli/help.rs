//! Grouped help, and hints for unknown commands.

use clap::error::{ContextKind, ContextValue};
use clap::{CommandFactory, FromArgMatches};
use std::ffi::OsString;

use super::{Arguments, Scenes};
use scene::nearest;

const GROUPS: [(&str, &[&str]); 6] = [
    ("Judge", &["run", "gate", "baseline", "fit", "verify", "report"]),
    ("Understand", &["list", "check", "solve", "diagnose"]),
    ("Theory", &["audit", "bound", "gronwall"]),
    ("Cost and limits", &["trade", "extremes"]),
    ("Many machines", &["merge"]),
    ("Shell", &["completions", "man", "help"]),
];

pub(super) fn parsed(words: impl IntoIterator<Item = OsString>) -> Result<Arguments, clap::Error> {
    let mut command = Arguments::command();
    // The command `help` exists only once the command is built.
    command.build();
    let template = template(&command);
    let mut command = Arguments::command().help_template(template);
    let matches = command.try_get_matches_from_mut(words)?;
    Arguments::from_arg_matches(&matches).map_err(|error| error.format(&mut command))
}

fn template(command: &clap::Command) -> String {
    let about = |name: &str| {
        let about_command = command.find_subcommand(name).and_then(clap::Command::get_about);
        format!("  {name:<12} {}\n", about_command.map(ToString::to_string).unwrap_or_default())
    };
    let group = |(title, names): &(&str, &[&str])| {
        let lines: String = names.iter().map(|name| about(name)).collect();
        format!("{title}:\n{lines}\n")
    };
    let groups: String = GROUPS.iter().map(group).collect();
    format!(
        "{{about-with-newline}}\n{{usage-heading}} {{usage}}\n\n{groups}Options:\n{{options}}{{after-help}}\n"
    )
}

/// A suggestion for an unknown command.
pub(super) fn hint(said: &clap::Error) -> Option<String> {
    let Some(ContextValue::String(word)) = said.get(ContextKind::InvalidSubcommand) else {
        return None;
    };
    let registry = Scenes::new(None).registry().ok();
    let scenes: Vec<&str> = registry.iter().flat_map(|registry| registry.names()).collect();
    let commands = GROUPS.iter().flat_map(|(_, names)| names.iter().copied());
    let of_scene =
        |scene: &str| format!("`sweep run {scene}` runs it, `sweep check {scene}` says what it is");
    if scenes.contains(&word.as_str()) {
        return Some(format!("hint: `{word}` is a scene: {}", of_scene(word)));
    }
    let command = nearest(word, commands).map(|near| format!("hint: did you mean `sweep {near}`?"));
    let scene = || {
        nearest(word, scenes.iter().copied())
            .map(|near| format!("hint: did you mean the scene `{near}`? {}", of_scene(near)))
    };
    command.or_else(scene)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_command_is_in_one_group() {
        let mut command = Arguments::command();
        command.build();
        let mut there: Vec<&str> = command.get_subcommands().map(clap::Command::get_name).collect();
        let mut grouped: Vec<&str> =
            GROUPS.iter().flat_map(|(_, names)| names.iter().copied()).collect();
        there.sort_unstable();
        grouped.sort_unstable();
        assert_eq!(there, grouped);
        let text = template(&command);
        assert!(
            text.contains("  run          Run refinement sweeps")
                && !text.contains("  run          \n")
        );
    }

    #[test]
    fn a_word_that_is_no_command_gets_a_hint() {
        let hint = |word: &str| {
            parsed(["sweep", word].map(Into::into)).err().and_then(|error| hint(&error))
        };
        assert_eq!(hint("rnu").as_deref(), Some("hint: did you mean `sweep run`?"));
        assert!(hint("pure-mild").is_some_and(|said| said.contains("sweep run pure-mild")));
        assert!(hint("pure-mlid").is_some_and(|said| said.contains("the scene `pure-mild`")));
        assert_eq!(hint("xyzzy-quux"), None);
    }
}
