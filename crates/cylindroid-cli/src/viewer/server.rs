//! Listens, and hands out page, meshes and sessions.

use std::io;
use std::net::SocketAddr;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use axum::extract::ws::WebSocketUpgrade;
use axum::extract::{Path, State};
use axum::http::{StatusCode, Uri, header};
use axum::response::{IntoResponse, Response};
use axum::routing::get;
use axum::serve::ListenerExt;
use axum::{Router, middleware};
use cylindroid::model::read_regular_file;
use tokio::net::{TcpListener, TcpStream};

use super::assets::{Page, page_is_built};
use super::safety::{Names, guard};
use super::socket::talk;
use super::start::Start;

/// Maximum frame size [bytes]. Longer messages than allowed are answered with an error up to this
/// size; beyond it the connection ends.
const LONGEST: usize = 1024 * 1024;
/// Maximum size of a mesh or image file [bytes].
const LARGEST_MESH: u64 = 256 << 20;
/// Maximum number of concurrent sessions.
const MOST_SESSIONS: usize = 100;

const NOT_BUILT: &str = "The page is not built: run `cargo xtask viewer` in the source of \
                         cylindroid, then build it again. The protocol (docs/viewer.md) is served \
                         at /ws.";

/// A server that listens.
#[derive(Debug)]
pub(crate) struct Server {
    listener: TcpListener,
    names: Names,
    shared: Shared,
}

#[derive(Debug, Clone)]
struct Shared {
    start: Arc<Start>,
    sessions: Arc<AtomicUsize>,
}

/// A slot for a session, released when dropped.
#[derive(Debug)]
struct Place(Arc<AtomicUsize>);

impl Place {
    fn of(sessions: &Arc<AtomicUsize>) -> Option<Self> {
        let more = |n| (n < MOST_SESSIONS).then_some(n + 1);
        sessions.fetch_update(Ordering::Relaxed, Ordering::Relaxed, more).ok()?;
        Some(Self(Arc::clone(sessions)))
    }
}

impl Drop for Place {
    fn drop(&mut self) {
        self.0.fetch_sub(1, Ordering::Relaxed);
    }
}

impl Server {
    /// Listens at this host and port (0: any that is free).
    pub(crate) async fn bind(start: Start, host: &str, port: u16) -> io::Result<Self> {
        let listener = TcpListener::bind((host.trim_matches(['[', ']']), port)).await?;
        let address: SocketAddr = listener.local_addr()?;
        let shared = Shared { start: Arc::new(start), sessions: Arc::new(AtomicUsize::new(0)) };
        Ok(Self { listener, names: Names::new(host, address), shared })
    }

    /// The URL of the page.
    pub(crate) fn url(&self) -> String {
        self.names.url()
    }

    /// The URL for other machines, if the server listens to them.
    pub(crate) fn url_for_others(&self) -> Option<String> {
        self.names.url_for_others()
    }

    /// Serves until ctrl-c.
    pub(crate) async fn serve(self) -> io::Result<()> {
        let router = Router::new()
            .route("/ws", get(session))
            .route("/mesh/{folder}/{*path}", get(mesh))
            .fallback(get(page))
            .with_state(self.shared)
            .layer(middleware::from_fn_with_state(self.names, guard));
        tokio::select! {
            ended = axum::serve(self.listener.tap_io(without_delay), router) => ended,
            stopped = tokio::signal::ctrl_c() => stopped,
        }
    }
}

/// Small messages leave at once; a client that is gone shows when it is written to.
fn without_delay(stream: &mut TcpStream) {
    let _ = stream.set_nodelay(true);
}

async fn session(State(shared): State<Shared>, upgrade: WebSocketUpgrade) -> Response {
    let Some(place) = Place::of(&shared.sessions) else {
        let what = "There are too many sessions; close one of them.";
        return (StatusCode::SERVICE_UNAVAILABLE, what).into_response();
    };
    upgrade.max_message_size(LONGEST).max_frame_size(LONGEST).on_upgrade(async move |socket| {
        talk(socket, shared.start).await;
        drop(place);
    })
}

async fn mesh(
    State(shared): State<Shared>,
    Path((folder, path)): Path<(usize, String)>,
) -> Response {
    let Some(file) = shared.start.folders.file(folder, &path) else {
        return (StatusCode::NOT_FOUND, "There is no such mesh in the folders of the model.")
            .into_response();
    };
    let kind = mime_guess(&file);
    let read = move || read_regular_file(&file, LARGEST_MESH);
    let read = tokio::task::spawn_blocking(read).await;
    match read {
        Ok(Ok(bytes)) => ([(header::CONTENT_TYPE, kind)], bytes).into_response(),
        _ => (StatusCode::NOT_FOUND, "The mesh could not be read.").into_response(),
    }
}

/// For meshes and images only.
fn mime_guess(file: &std::path::Path) -> &'static str {
    let extension = file.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase);
    match extension.as_deref() {
        Some("dae") => "model/vnd.collada+xml",
        Some("obj") => "model/obj",
        Some("mtl") => "model/mtl",
        Some("stl") => "model/stl",
        Some("png") => "image/png",
        Some("jpg" | "jpeg") => "image/jpeg",
        Some("gif") => "image/gif",
        Some("bmp") => "image/bmp",
        Some("webp") => "image/webp",
        Some("tif" | "tiff") => "image/tiff",
        _ => "application/octet-stream",
    }
}

async fn page(uri: Uri) -> Response {
    let name = match uri.path() {
        "/" => "index.html",
        path => path.trim_start_matches('/'),
    };
    match Page::get(name) {
        Some(file) => {
            let kind = file.metadata.mimetype().to_owned();
            ([(header::CONTENT_TYPE, kind)], file.data).into_response()
        }
        None if !page_is_built() => (StatusCode::NOT_FOUND, NOT_BUILT).into_response(),
        None => (StatusCode::NOT_FOUND, "There is no such page.").into_response(),
    }
}
