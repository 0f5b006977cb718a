//! The viewer inside another program, which holds a session of its own.

use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use cylindroid::model::Geometry;
use cylindroid::{EndEffector, Error, Mechanism, Pose, Result};
use tokio::runtime::{Builder, Runtime};

use super::assets::page_is_built;
use super::drags::Drag;
use super::drawings::Drawing;
use super::server::{Place, Server};
use super::shared_session::{Inner, Program, SharedSession};
use super::start::{Start, StartBodies};
use crate::obstacle::ObstacleArg;

/// Threads of the server.
const THREADS: usize = 2;
/// Longest wait for a report that is not finished when the viewer is closed, which is discarded.
const PATIENCE: Duration = Duration::from_millis(500);

/// What a [`Viewer`] shows, and where it listens.
#[derive(Debug)]
pub struct ShowOptions {
    /// The model.
    pub mechanism: Mechanism,
    /// The file of the model, whose folder may have meshes; empty: none.
    pub model: String,
    /// The first configuration; loops are closed from there.
    pub q: Vec<f64>,
    /// The tool of the target.
    pub end_effector: EndEffector,
    /// Additional folders from which meshes may be served.
    pub meshes: Vec<PathBuf>,
    /// An address of this machine.
    pub host: String,
    /// 0: any that is free.
    pub port: u16,
    /// A secret in the address of the page, of letters, digits, `-` and `_`.
    pub token: String,
    /// The pages that may show this one in a frame, as in the directive `frame-ancestors` of a
    /// content security policy; `None`: no page.
    pub frame_ancestors: Option<String>,
}

/// A page in the browser that shows a robot while this value lives.
///
/// All pages at its address see one session: the configuration, target and obstacles that the
/// program or the page that drives sets.
#[derive(Debug)]
pub struct Viewer {
    shared: Arc<SharedSession>,
    url: String,
    url_for_others: Option<String>,
    /// `None` once it is closed.
    runtime: Mutex<Option<Runtime>>,
}

impl Viewer {
    /// Starts to serve.
    ///
    /// # Errors
    /// A configuration, model or option that does not fit; an address that is in use.
    pub fn new(options: ShowOptions) -> Result<Self> {
        let ShowOptions { mechanism, model, q, end_effector, meshes, host, port, token, .. } =
            options;
        let frame_ancestors = options.frame_ancestors;
        check("token", &token, |c| c.is_ascii_alphanumeric() || "-_".contains(c))?;
        let plain = |c: char| c.is_ascii_graphic() && c != ';' && c != ',' || c == ' ';
        check("frame_ancestors", frame_ancestors.as_deref().unwrap_or("*"), plain)?;
        let bodies = StartBodies::default();
        let mut start = Start::new((mechanism, &model), &q, end_effector, &meshes, bodies)?;
        start.folders = std::mem::take(&mut start.folders).behind(&token);
        let start = Arc::new(start);
        let failed = |error: std::io::Error| Error::InvalidOption {
            option: "port",
            value: format!("{port} of {host}"),
            reason: format!("the server cannot listen there ({error}); choose another, or 0"),
        };
        let runtime = Builder::new_multi_thread()
            .worker_threads(THREADS)
            .thread_name("cylindroid-viewer")
            .enable_all()
            .build()
            .map_err(failed)?;
        let (shared, server) = runtime.block_on(async {
            let program = Some(Program::default());
            let shared = SharedSession::begin(Arc::clone(&start), None, program)?;
            let place =
                Place { host: &host, port, token: &token, frame_ancestors, ..Place::default() };
            let server = Server::of(start, Some(Arc::clone(&shared)), place).await;
            Ok::<_, Error>((shared, server.map_err(failed)?))
        })?;
        let (url, url_for_others) = (server.url(), server.url_for_others());
        runtime.spawn(server.serve_on());
        Ok(Self { shared, url, url_for_others, runtime: Mutex::new(Some(runtime)) })
    }

    /// True if the page is a part of this library; otherwise only the protocol is served.
    #[must_use]
    pub fn has_page() -> bool {
        page_is_built()
    }

    /// The address of the page, with the token.
    pub fn url(&self) -> &str {
        &self.url
    }

    /// The address of the page for other machines, with the token; `None` if only this one reaches
    /// it.
    pub fn url_for_others(&self) -> Option<&str> {
        self.url_for_others.as_deref()
    }

    /// The number of pages that show it.
    pub fn clients(&self) -> usize {
        self.shared.clients()
    }

    /// The number of pages that have shown it.
    pub fn visits(&self) -> u64 {
        self.shared.visits()
    }

    /// The configuration that is shown.
    pub fn q(&self) -> Vec<f64> {
        self.shared.read(|inner| inner.session.state().q().to_vec())
    }

    /// Shows this configuration as it is, loops closed or not, and pauses the servo of the page.
    /// The target moves with the tool until somebody has placed it.
    ///
    /// # Errors
    /// Another number of coordinates, or values that are not finite.
    pub fn set_q(&self, q: &[f64]) -> Result<()> {
        self.shared.change(|inner| inner.session.follow_program(q))
    }

    /// `world_from_target`.
    pub fn target(&self) -> Pose {
        self.shared.read(|inner| inner.session.target())
    }

    /// Moves the target; the servo of the page follows it if it plays.
    pub fn set_target(&self, target: Pose) {
        let moved = |inner: &mut Inner| {
            inner.session.aim_at(target);
            Ok(())
        };
        // It cannot fail.
        let _ = self.shared.change(moved);
    }

    /// True if the servo of the page moves the robot to the target.
    pub fn is_playing(&self) -> bool {
        self.shared.read(|inner| inner.session.is_playing())
    }

    /// Starts or pauses the servo of the page.
    pub fn play(&self, on: bool) {
        let changed = |inner: &mut Inner| {
            if on {
                inner.session.play()
            } else {
                inner.session.pause()
            }
            Ok(())
        };
        // It cannot fail.
        let _ = self.shared.change(changed);
    }

    /// Adds an obstacle.
    ///
    /// # Errors
    /// A name that is taken, a shape that the page cannot draw, too many of them.
    pub fn add_obstacle(&self, name: &str, shape: Geometry, pose: Pose) -> Result<()> {
        if matches!(shape, Geometry::ConvexHull { .. }) {
            return Err(Error::InvalidOption {
                option: "shape",
                value: "convex_hull".to_owned(),
                reason: "the page cannot draw it; give one of the other shapes".to_owned(),
            });
        }
        let obstacle = ObstacleArg { name: name.to_owned(), shape, world_from_shape: pose };
        self.shared.change(|inner| {
            inner.session.add_obstacle(obstacle)?;
            inner.show_scene();
            Ok(())
        })
    }

    /// Moves an obstacle.
    ///
    /// # Errors
    /// An unknown name.
    pub fn move_obstacle(&self, name: &str, pose: Pose) -> Result<()> {
        self.shared.change(|inner| inner.session.move_obstacle(name, pose))
    }

    /// Draws something beside the robot; it replaces the drawing of this name.
    ///
    /// # Errors
    /// A bad name, values that are not finite, too many drawings or points.
    pub fn draw(&self, name: &str, drawing: Drawing) -> Result<()> {
        self.shared.change(|inner| {
            let Some(program) = &mut inner.program else { return Ok(()) };
            program.is_redrawn = true;
            program.drawings.put(name, drawing)
        })
    }

    /// Removes the drawing or the obstacle of this name.
    ///
    /// # Errors
    /// An unknown name.
    pub fn remove(&self, name: &str) -> Result<()> {
        self.shared.change(|inner| {
            let Some(program) = &mut inner.program else { return Ok(()) };
            if program.drawings.remove(name) {
                program.is_redrawn = true;
                return Ok(());
            }
            let obstacles = inner.session.obstacles().iter().map(|o| o.name.as_str());
            let known: Vec<&str> = obstacles.chain(program.drawings.names()).collect();
            if !known.contains(&name) {
                return Err(Error::unknown("drawing or obstacle", name, known));
            }
            inner.session.remove_obstacle(name)?;
            inner.show_scene();
            Ok(())
        })
    }

    /// What somebody has moved on a page since the last call, of each thing the newest; waits for it
    /// as long as this. `None` after `close`.
    pub fn next_drags(&self, patience: Duration) -> Option<Vec<Drag>> {
        self.shared.next_drags(patience)
    }

    /// Stops the server, and wakes who waits in `next_drags`. Not to be called in an asynchronous
    /// task.
    pub fn close(&self) {
        let closed = |inner: &mut Inner| {
            if let Some(program) = &mut inner.program {
                program.is_closed = true;
            }
            Ok(())
        };
        // It cannot fail.
        let _ = self.shared.change(closed);
        let runtime = self.runtime.lock().unwrap_or_else(PoisonError::into_inner).take();
        if let Some(runtime) = runtime {
            runtime.shutdown_timeout(PATIENCE);
        }
    }
}

impl Drop for Viewer {
    fn drop(&mut self) {
        self.close();
    }
}

fn check(option: &'static str, value: &str, is_plain: impl Fn(char) -> bool) -> Result<()> {
    match value.chars().find(|c| !is_plain(*c)) {
        None if !value.is_empty() => Ok(()),
        found => {
            let reason = found.map_or_else(
                || "it must not be empty".to_owned(),
                |c| format!("the character {c:?} is not allowed there"),
            );
            Err(Error::InvalidOption { option, value: value.to_owned(), reason })
        }
    }
}
