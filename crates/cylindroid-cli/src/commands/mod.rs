//! One file per command: arguments in, text or JSON out, an exit code.

pub(crate) mod closed;
mod configurations;
mod distance;
mod fk;
mod ik;
pub(crate) mod info;
mod interrupt;
pub(crate) mod inverse_selection;
mod jacobian;
mod manual;
mod map;
mod models;
pub(crate) mod move_to;
mod optimise;
mod progress;
pub(crate) mod screws;
pub(crate) mod shared;
mod sweep;
mod target;
mod view;
mod zone;

use std::io::Write;

use self::shared::Style;
use crate::args::{Cli, Command};
use crate::exit::Exit;

/// Runs the command of a command line.
pub(crate) fn run(cli: &Cli, out: &mut dyn Write) -> anyhow::Result<Exit> {
    let style = if cli.json { Style::Json } else { Style::Table };
    match &cli.command {
        Command::Models => models::run(style, out),
        Command::Info(args) => info::run(args, style, out),
        Command::Fk(args) => fk::run(args, style, out),
        Command::Jacobian(args) => jacobian::run(args, style, out),
        Command::Ik(args) => ik::run(args, style, out),
        Command::Move(args) => move_to::run(args, style, out),
        Command::Screws(args) => screws::run(args, style, out),
        Command::Distance(args) => distance::run(args, style, out),
        Command::Assemble(args) => closed::assemble::run(args, style, out),
        Command::Mobility(args) => closed::mobility::run(args, style, out),
        Command::Manipulability(args) => closed::manipulability::run(args, style, out),
        Command::Statics(args) => closed::statics::run(args, style, out),
        Command::Grasp(args) => closed::grasp::run(args, style, out),
        Command::Sweep(args) => sweep::run(args, style, out),
        Command::Optimise(args) => optimise::run(args, style, out),
        Command::Map(args) => map::run(args, style, out),
        Command::Zone(args) => zone::run(args, style, out),
        Command::View(args) => view::run(args, style, out),
        Command::Completions(args) => manual::completions(args, style, out),
        Command::Man(args) => manual::man(args, style, out),
    }
}
