//! `view`: serves the web viewer.

use std::io::{ErrorKind, Write};
use std::sync::{Arc, mpsc};

use anyhow::Context;
use cylindroid::Result;
use cylindroid::model::formats::srdf;
use serde::Serialize;

use crate::args::ViewArgs;
use crate::commands::shared::{
    Style, all_actuated, configuration, end_effector, limited, load, within_limits,
};
use crate::exit::Exit;
use crate::viewer::{Server, Start, StartBodies, Watch, check_count, page_is_built, random_name};

/// The usual port: an address that can be kept, with what the browser remembers of it.
const PORT: u16 = 7411;

#[derive(Debug, Serialize)]
struct ViewJson<'a> {
    url: &'a str,
    model: &'a str,
    /// False if the page is not built.
    page: bool,
}

pub(crate) fn run(args: &ViewArgs, style: Style, out: &mut dyn Write) -> anyhow::Result<Exit> {
    let token = if args.token { random_token()? } else { String::new() };
    let load = || start(args).map(|start| start.behind(&token));
    let (start, watch) = Watch::of(load)?;
    let model = start.mechanism.name().to_owned();
    let runtime = tokio::runtime::Builder::new_multi_thread().enable_all().build()?;
    let server = runtime.block_on(listening(start, args, &token))?;
    announce(&server, args, style, &model, out)?;
    if !args.check {
        let shown = server.shown(&args.configuration.model.name);
        std::thread::scope(|scope| {
            let (stop, stopped) = mpsc::channel();
            if !(args.no_watch || watch.is_empty()) {
                scope.spawn(move || watch.keep(&shown, load, &stopped));
            }
            let served = runtime.block_on(server.serve());
            drop(stop);
            served
        })?;
    }
    // Unfinished reports are discarded.
    runtime.shutdown_background();
    Ok(Exit::SUCCESS)
}

/// Prints the URL, and what is to be known about it.
fn announce(
    server: &Server,
    args: &ViewArgs,
    style: Style,
    model: &str,
    out: &mut dyn Write,
) -> anyhow::Result<()> {
    let (url, page) = (server.url(), page_is_built());
    match style {
        Style::Table => writeln!(out, "{url}")?,
        Style::Json => {
            let line = ViewJson { url: &url, model, page };
            writeln!(out, "{}", serde_json::to_string(&line)?)?;
        }
    }
    out.flush()?;
    if !page {
        note(NOT_BUILT);
    }
    if args.open
        && let Err(error) = opener::open_browser(&url)
    {
        note(&format!("no browser opens the page ({error}); open {url} yourself"));
    }
    if let Some(url) = server.url_for_others() {
        note(&format!(
            "everyone who reaches this machine can open {url}, and the meshes and images in the \
             folders of the model; without --host only this machine can"
        ));
    }
    Ok(())
}

/// At the port of `--port`; without it at the usual one, or at a free one where that is taken.
async fn listening(start: Start, args: &ViewArgs, token: &str) -> anyhow::Result<Server> {
    let start = Arc::new(start);
    let bind = |port| Server::bind(Arc::clone(&start), &args.host, port, token);
    let port = args.port.unwrap_or(PORT);
    let server = match bind(port).await {
        Err(error) if error.kind() == ErrorKind::AddrInUse && args.port.is_none() => bind(0).await,
        other => other,
    };
    server.with_context(|| {
        let host = &args.host;
        format!("cannot listen at {host} port {port}; choose others with --host and --port")
    })
}

/// A path that cannot be guessed: 128 random bits in hexadecimal.
fn random_token() -> anyhow::Result<String> {
    random_name::<16>().map_err(|error| anyhow::anyhow!("--token: {error}"))
}

const NOT_BUILT: &str = "the page is not built, only the protocol is served; run `cargo xtask \
                         viewer` in the source of cylindroid (it needs Node.js), then build it again";

#[allow(clippy::print_stderr)] // it is no output
fn note(what: &str) {
    eprintln!("note: {what}");
}

fn start(args: &ViewArgs) -> Result<Start> {
    let robot = load(&args.configuration.model, &args.actuated)?;
    let robot = limited(robot, &args.limits)?;
    if !args.actuated.is_empty() && !robot.is_closed() {
        return Err(all_actuated(&robot));
    }
    let q = configuration(&robot, &args.configuration)?;
    // The home configuration of a file is accepted as it is, as in the other commands.
    if q != robot.home() {
        within_limits(&robot, "--q", &q)?;
    }
    let mut tool = end_effector(&robot, &args.frame)?;
    if args.frame.frame.is_none() && robot.is_closed() {
        tool.frame = robot.reference();
    }
    check_count(args.obstacle.len())?;
    let disabled = match &args.configuration.model.srdf {
        Some(path) => srdf::load(path)?.pairs(&robot),
        None => Vec::new(),
    };
    let bodies = StartBodies {
        avoid: args.avoid || !args.obstacle.is_empty(),
        obstacles: args.obstacle.clone(),
        disabled,
    };
    Start::new((robot, &args.configuration.model.name), &q, tool, &args.meshes, bodies)
}
