//! Names of files that are not finished: they say which run they are of, so that the next can tell those of runs
//! that were killed.

use std::fs;
use std::io;
use std::path::Path;
use std::time::Duration;

use tempfile::NamedTempFile;

const PREFIX: &str = ".secateur-";
const ENDING: &str = ".tmp";

/// A file that is older than this is of no run that still goes on.
const OLD: Duration = Duration::from_secs(24 * 3600);

/// A file in a folder under a name of this run, with the permissions of an ordinary one.
pub(super) fn new_file(folder: &Path) -> io::Result<NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    let prefix = format!("{PREFIX}{}-{}-", system(), std::process::id());
    builder.prefix(&prefix).suffix(ENDING);
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    builder.tempfile_in(folder)
}

/// Removes what runs have left in a folder that are over.
pub(super) fn remove_leftovers(folder: &Path) {
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let name = entry.file_name();
        let is_file = entry.file_type().is_ok_and(|kind| kind.is_file());
        if let (true, Some(name)) = (is_file, name.to_str())
            && let Some(run) = name
                .strip_prefix(PREFIX)
                .and_then(|name| name.strip_suffix(ENDING))
            && (is_over(run) || is_old(&entry).unwrap_or(false))
        {
            // Who may not remove it leaves it.
            let _ = fs::remove_file(entry.path());
        }
    }
}

/// Whether a name is of a process of this system that is there no more.
fn is_over(run: &str) -> bool {
    let mut parts = run.split('-');
    let (of_system, process) = (parts.next(), parts.next());
    let process = process.and_then(|process| process.parse::<u32>().ok());
    let known = system();
    !known.is_empty()
        && of_system == Some(&known)
        && process.is_some_and(|id| !Path::new("/proc").join(id.to_string()).exists())
}

fn is_old(entry: &fs::DirEntry) -> Option<bool> {
    let changed = entry.metadata().ok()?.modified().ok()?;
    Some(changed.elapsed().ok()? > OLD)
}

/// What tells the processes of this machine since it was started, and of this container, from those of others that
/// write into the same folder; empty where the system does not tell.
fn system() -> String {
    let boot = fs::read_to_string("/proc/sys/kernel/random/boot_id").unwrap_or_default();
    let container = fs::read_link("/proc/self/ns/pid").unwrap_or_default();
    let container = container.to_string_lossy();
    let letters = |text: &str| {
        text.chars()
            .filter(char::is_ascii_alphanumeric)
            .collect::<String>()
    };
    match boot.get(..8) {
        Some(boot) => letters(boot) + &letters(&container),
        None => String::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_killed_run_left_goes_and_what_goes_on_stays() {
        let folder = tempfile::tempdir().unwrap();
        let system = system();
        // No process has number 0 in /proc, and none is of another system.
        let (killed, other) = (
            format!(".secateur-{system}-0-x.tmp"),
            ".secateur-elsewhere-0-x.tmp",
        );
        for name in [&killed, other, "mine.tmp"] {
            fs::write(folder.path().join(name), "").unwrap();
        }
        let own = new_file(folder.path()).unwrap();
        remove_leftovers(folder.path());
        let is_there = |name: &str| folder.path().join(name).exists();
        assert_eq!(is_there(&killed), system.is_empty());
        assert!(own.path().exists() && is_there(other) && is_there("mine.tmp"));
    }
}
