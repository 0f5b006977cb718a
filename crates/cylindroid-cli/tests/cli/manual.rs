//! Completions and manual pages.

use std::fs;
#[cfg(unix)]
use std::process::Command;

use crate::documents::commands;
use crate::{json, refused, text};

/// In the shell itself: of two letters, the commands that begin with them.
#[cfg(unix)]
#[test]
fn bash_completes_commands_and_options() {
    let folder = tempfile::tempdir().unwrap();
    let script = folder.path().join("completions");
    fs::write(&script, text(&["completions", "bash"])).unwrap();
    let complete = |words: &[&str]| {
        let code = format!(
            "source '{}'; COMP_WORDS=({}); COMP_CWORD={}; _cylindroid cylindroid {:?} {:?}; \
             echo \"${{COMPREPLY[@]}}\"",
            script.display(),
            words.join(" "),
            words.len() - 1,
            words.last().unwrap(),
            words[words.len() - 2],
        );
        let output = Command::new("bash").args(["--norc", "-c", &code]).output().unwrap();
        assert!(output.stderr.is_empty(), "{}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8(output.stdout).unwrap()
    };
    assert_eq!(complete(&["cylindroid", "mo"]).trim(), "models move mobility");
    assert_eq!(complete(&["cylindroid", "move", "panda", "--avo"]).trim(), "--avoid");
}

#[test]
fn every_shell_knows_every_command() {
    for shell in ["bash", "elvish", "fish", "powershell", "zsh"] {
        let script = text(&["completions", shell]);
        for command in commands() {
            assert!(script.contains(&command), "{command} in {shell}");
        }
        assert_eq!(json(&["completions", shell], 0)["script"], script.as_str());
    }
    assert!(refused(&["completions", "cmd"]).contains("possible values: bash"));
}

#[test]
fn every_command_has_a_page() {
    let folder = tempfile::tempdir().unwrap();
    let man1 = folder.path().join("share/man1");
    let printed = text(&["man", &man1.to_string_lossy()]);
    let names = commands().into_iter().map(|command| format!("cylindroid-{command}"));
    for name in std::iter::once("cylindroid".to_owned()).chain(names) {
        let path = man1.join(format!("{name}.1"));
        assert!(printed.lines().any(|line| line == path.to_string_lossy()), "{printed}");
        let page = fs::read_to_string(&path).unwrap();
        assert!(page.contains(&format!(".TH {name} 1")), "{page}");
        assert!(page.contains("json") && page.contains(".SH DESCRIPTION"), "{name}");
    }
    let page = fs::read_to_string(man1.join("cylindroid-move.1")).unwrap();
    assert!(page.contains("Examples:") && page.contains("cylindroid move panda"), "{page}");
    let count = fs::read_dir(&man1).unwrap().count();
    assert_eq!(printed.lines().count(), count);
    assert_eq!(
        json(&["man", &man1.to_string_lossy()], 0)["pages"].as_array().unwrap().len(),
        count
    );
}

#[test]
fn a_folder_that_cannot_be_made_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("file");
    fs::write(&file, "").unwrap();
    let message = refused(&["man", &file.join("man1").to_string_lossy()]);
    assert!(message.contains("cannot write") && message.contains("man1"), "{message}");
}
