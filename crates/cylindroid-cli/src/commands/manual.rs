//! `completions` and `man`: what a shell and its manual know of the command line.

use std::fs;
use std::io::Write;
use std::path::Path;

use clap::{Command, CommandFactory};
use serde::Serialize;

use crate::args::{Cli, CompletionsArgs, ManArgs};
use crate::commands::shared::Style;
use crate::exit::Exit;
use crate::{output, output_file, trajectory};

#[derive(Debug, Serialize)]
struct CompletionsJson {
    shell: String,
    script: String,
}

#[derive(Debug, Serialize)]
struct ManJson {
    pages: Vec<String>,
}

pub(crate) fn completions(
    args: &CompletionsArgs,
    style: Style,
    out: &mut dyn Write,
) -> anyhow::Result<Exit> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut Cli::command(), "cylindroid", &mut script);
    if style == Style::Json {
        let script = String::from_utf8(script)?;
        output::json(out, &CompletionsJson { shell: args.shell.to_string(), script })?;
    } else {
        out.write_all(&script)?;
    }
    Ok(Exit::SUCCESS)
}

pub(crate) fn man(args: &ManArgs, style: Style, out: &mut dyn Write) -> anyhow::Result<Exit> {
    let folder = &args.folder;
    fs::create_dir_all(folder).map_err(|error| trajectory::cannot_write(folder, &error))?;
    let mut whole = Cli::command().disable_help_subcommand(true);
    whole.build();
    let mut pages = vec![page(&whole, folder)?];
    for command in whole.get_subcommands() {
        pages.push(page(command, folder)?);
    }
    if style == Style::Json {
        output::json(out, &ManJson { pages })?;
    } else {
        pages.iter().try_for_each(|page| writeln!(out, "{page}"))?;
    }
    Ok(Exit::SUCCESS)
}

/// Writes the page of a command and gives its path.
fn page(command: &Command, folder: &Path) -> anyhow::Result<String> {
    let page = clap_mangen::Man::new(command.clone());
    let path = folder.join(page.get_filename());
    let mut text = Vec::new();
    page.render(&mut text)?;
    output_file::write(&path, text).map_err(|error| trajectory::cannot_write(&path, &error))?;
    Ok(path.display().to_string())
}
