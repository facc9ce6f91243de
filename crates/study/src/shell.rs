//! Words of commands, as a POSIX shell reads them.

use std::path::Path;

/// A word that a shell takes as it is: in quotes, unless it has nothing but letters that mean nothing else.
pub(crate) fn quoted(word: &str) -> String {
    let is_plain = |c: char| c.is_alphanumeric() || "_@%+=:,./-".contains(c);
    match !word.is_empty() && word.chars().all(is_plain) {
        true => word.to_owned(),
        false => format!("'{}'", word.replace('\'', r"'\''")),
    }
}

/// A path as a word.
pub(crate) fn path(path: &Path) -> String {
    quoted(&path.display().to_string())
}

/// The command with other words in place of those that are to change.
pub(crate) fn with_words(command: &str, change: impl Fn(&str) -> Option<String>) -> String {
    // Each word as it stands and as it reads.
    let mut words = vec![(String::new(), String::new())];
    let (mut is_quoted, mut letters) = (false, command.chars());
    while let Some(c) = letters.next() {
        if c == ' ' && !is_quoted {
            words.push(Default::default());
            continue;
        }
        let (stands, reads) = words.last_mut().expect("a first word");
        stands.push(c);
        match c {
            '\'' => is_quoted = !is_quoted,
            '\\' if !is_quoted => {
                let next = letters.next();
                stands.extend(next);
                reads.extend(next);
            }
            c => reads.push(c),
        }
    }
    let words = words
        .into_iter()
        .map(|(stands, reads)| change(&reads).map_or(stands, |word| quoted(&word)));
    words.collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shell_reads_words_as_they_were() {
        assert_eq!(quoted("trees/oak-2.glb"), "trees/oak-2.glb");
        assert_eq!(quoted("a b;rm *.glb"), "'a b;rm *.glb'");
        assert_eq!(quoted("it's"), r"'it'\''s'");
        for word in ["a b", "it's", "$(x)", "", "\\"] {
            let command = format!("secateur {} -o out.glb", quoted(word));
            let changed = with_words(&command, |reads| (reads == word).then(|| "oak".to_owned()));
            assert_eq!(changed, "secateur oak -o out.glb");
            assert_eq!(with_words(&command, |_| None), command);
        }
    }
}
