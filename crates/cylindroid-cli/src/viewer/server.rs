//! Listens, and hands out page, meshes and sessions.

use std::io;
use std::net::SocketAddr;
use std::sync::Arc;

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
use super::safety::{Guard, Names, guard};
use super::sessions::{Asked, Sessions};
use super::shared_session::SharedSession;
use super::socket::talk;
use super::start::Start;

/// Maximum frame size [bytes]. Longer messages than allowed are answered with an error up to this
/// size; beyond it the connection ends.
const LONGEST: usize = 1024 * 1024;
/// Maximum size of a mesh or image file [bytes].
const LARGEST_MESH: u64 = 256 << 20;

const NOT_BUILT: &str = "The page is not built: run `cargo xtask viewer` in the source of \
                         cylindroid, then build it again. The protocol (docs/viewer.md) is served \
                         at /ws.";

/// A server that listens.
#[derive(Debug)]
pub(crate) struct Server {
    listener: TcpListener,
    names: Names,
    shared: Shared,
    frame_ancestors: Option<String>,
}

#[derive(Debug, Clone)]
struct Shared {
    sessions: Sessions,
    /// The folder of all paths: empty, or a slash and the token.
    folder: Arc<str>,
}

/// Where a server listens, and for whom.
#[derive(Debug, Default)]
pub(super) struct Place<'a> {
    pub(super) host: &'a str,
    /// 0: any that is free.
    pub(super) port: u16,
    /// A secret without which nothing is served; empty: none.
    pub(super) token: &'a str,
    /// The pages that may show this one in a frame, as in a content security policy.
    pub(super) frame_ancestors: Option<String>,
}

impl Server {
    /// Listens at this host and port (0: any that is free).
    pub(crate) async fn bind(start: Start, host: &str, port: u16) -> io::Result<Self> {
        Self::of(Arc::new(start), None, Place { host, port, ..Place::default() }).await
    }

    /// Listens, for the session of a program if there is one.
    pub(super) async fn of(
        start: Arc<Start>,
        of_program: Option<Arc<SharedSession>>,
        Place { host, port, token, frame_ancestors }: Place<'_>,
    ) -> io::Result<Self> {
        let listener = TcpListener::bind((host.trim_matches(['[', ']']), port)).await?;
        let address: SocketAddr = listener.local_addr()?;
        let folder = if token.is_empty() { String::new() } else { format!("/{token}") };
        let shared = Shared { sessions: Sessions::new(start, of_program), folder: folder.into() };
        Ok(Self { listener, names: Names::new(host, address), shared, frame_ancestors })
    }

    /// The URL of the page.
    pub(crate) fn url(&self) -> String {
        let folder = &*self.shared.folder;
        match folder.strip_prefix('/') {
            None => self.names.url(),
            Some(token) => format!("{}{token}/", self.names.url()),
        }
    }

    /// The URL for other machines, if the server listens to them.
    pub(crate) fn url_for_others(&self) -> Option<String> {
        self.names.url_for_others()
    }

    /// Serves until ctrl-c.
    pub(crate) async fn serve(self) -> io::Result<()> {
        tokio::select! {
            ended = self.serve_on() => ended,
            stopped = tokio::signal::ctrl_c() => stopped,
        }
    }

    /// Serves as long as the runtime lives.
    pub(super) async fn serve_on(self) -> io::Result<()> {
        let folder = &*self.shared.folder;
        let router = Router::new()
            .route(&format!("{folder}/ws"), get(session))
            .route(&format!("{folder}/mesh/{{folder}}/{{*path}}"), get(mesh))
            .fallback(get(page))
            .with_state(self.shared.clone());
        let guarded = Guard { names: self.names, frame_ancestors: self.frame_ancestors };
        let router = router.layer(middleware::from_fn_with_state(guarded, guard));
        axum::serve(self.listener.tap_io(without_delay), router).await
    }
}

/// Small messages leave at once; a client that is gone shows when it is written to.
fn without_delay(stream: &mut TcpStream) {
    let _ = stream.set_nodelay(true);
}

async fn session(State(shared): State<Shared>, uri: Uri, upgrade: WebSocketUpgrade) -> Response {
    let asked = match Asked::of(uri.query().unwrap_or_default()) {
        Ok(asked) => asked,
        Err(what) => return (StatusCode::BAD_REQUEST, what).into_response(),
    };
    let Some(place) = shared.sessions.place() else {
        let what = "There are too many clients; close one of them.";
        return (StatusCode::SERVICE_UNAVAILABLE, what).into_response();
    };
    upgrade.max_message_size(LONGEST).max_frame_size(LONGEST).on_upgrade(async move |socket| {
        talk(socket, shared.sessions, asked).await;
        drop(place);
    })
}

async fn mesh(
    State(shared): State<Shared>,
    Path((folder, path)): Path<(usize, String)>,
) -> Response {
    let Some(file) = shared.sessions.start().folders.file(folder, &path) else {
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

async fn page(State(shared): State<Shared>, uri: Uri) -> Response {
    let Some(path) = uri.path().strip_prefix(&*shared.folder) else {
        let what = "There is no such page: its address contains a token, which the program prints.";
        return (StatusCode::NOT_FOUND, what).into_response();
    };
    let name = match path {
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
