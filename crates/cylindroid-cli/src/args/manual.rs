//! The arguments of `completions` and `man`.

use std::path::PathBuf;

use clap::Args;
use clap_complete::Shell;

pub(crate) const COMPLETIONS: &str = "\
Completions of commands and options for a shell

Prints a script, which the shell reads from a file.";

pub(crate) const COMPLETIONS_EXAMPLES: &str = "\
Examples:
  cylindroid completions bash
  cylindroid completions zsh
  cylindroid completions fish

Where shells look for it: ~/.local/share/bash-completion/completions/cylindroid for bash (with \
bash-completion), a file _cylindroid in a folder of $fpath for zsh, \
~/.config/fish/completions/cylindroid.fish for fish.";

pub(crate) const MAN: &str = "\
Manual pages: one of the binary and one of each command

They contain what --help prints.";

pub(crate) const MAN_EXAMPLES: &str = "\
Examples:
  cylindroid man man1
  cylindroid man manual/man1 --json

`man -l man1/cylindroid-move.1` shows a page; `man cylindroid-move` finds those in \
~/.local/share/man/man1.";

#[derive(Debug, Args)]
pub(crate) struct CompletionsArgs {
    /// The shell
    #[arg(value_enum)]
    pub(crate) shell: Shell,
}

#[derive(Debug, Args)]
pub(crate) struct ManArgs {
    /// The folder for the pages, which is made where it is missing
    pub(crate) folder: PathBuf,
}
