//! Listens, and hands out page, meshes and sessions.

use std::io;
use std::net::SocketAddr;
use std::sync::Arc;

use axum::body::Bytes;
use axum::extract::ws::{Message as Frame, WebSocketUpgrade};
use axum::extract::{DefaultBodyLimit, FromRequest, Path, Request, State};
use axum::http::{StatusCode, Uri, header};
use axum::response::{IntoResponse, Response};
use axum::routing::get;
use axum::serve::{ListenerExt, TapIo};
use axum::{Router, middleware};
use cylindroid::model::read_regular_file;
use serde::Serialize;
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::Semaphore;
use tokio::time::timeout;

use super::assets::{Folders, Page, page_is_built};
use super::connections::{self, Limits};
use super::json::text;
use super::messages::Complaint;
use super::opened::{self, Known, Offer, Opened};
use super::refusal::Refusal;
use super::safety::{Guard, Names, guard};
use super::sessions::{Asked, Sessions};
use super::shared_session::SharedSession;
use super::socket::{Silence, talk};
use super::start::Start;
use super::watch::Shown;

/// Maximum frame size [bytes]. Longer messages than allowed are answered with an error up to this
/// size; beyond it the connection ends.
const LONGEST: usize = 1024 * 1024;
/// Maximum size of a mesh or image file [bytes].
const LARGEST_MESH: u64 = 256 << 20;
/// Maximum size of a request that opens a model, with the line before its files [bytes].
const LARGEST_REQUEST: usize = opened::LARGEST + (1 << 20);
/// Maximum number of requests that open a model at the same time; others wait, not yet read.
const UPLOADS: usize = 2;

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
    opened: Arc<Opened>,
    /// False if other machines reach the server, or a program holds its session.
    opens: bool,
    /// The folder of all paths: empty, or a slash and the token.
    folder: Arc<str>,
    silence: Silence,
    limits: Limits,
    uploads: Arc<Semaphore>,
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
    pub(super) silence: Silence,
    pub(super) limits: Limits,
}

impl Server {
    /// Listens at this host and port (0: any that is free), for those who know the token.
    pub(crate) async fn bind(
        start: Arc<Start>,
        host: &str,
        port: u16,
        token: &str,
    ) -> io::Result<Self> {
        Self::of(start, None, Place { host, port, token, ..Place::default() }).await
    }

    /// Listens, for the session of a program if there is one.
    pub(super) async fn of(
        start: Arc<Start>,
        of_program: Option<Arc<SharedSession>>,
        Place { host, port, token, frame_ancestors, silence, limits }: Place<'_>,
    ) -> io::Result<Self> {
        let listener = TcpListener::bind((host.trim_matches(['[', ']']), port)).await?;
        let address: SocketAddr = listener.local_addr()?;
        let folder = if token.is_empty() { String::new() } else { format!("/{token}") };
        let (names, sessions) = (Names::new(host, address), Sessions::new(start, of_program));
        let opens = names.is_local() && !sessions.are_of_program();
        let (opened, uploads) = (Arc::default(), Arc::new(Semaphore::new(UPLOADS)));
        let folder = folder.into();
        let shared = Shared { sessions, opened, opens, folder, silence, limits, uploads };
        Ok(Self { listener, names, shared, frame_ancestors })
    }

    /// The URL of the page.
    pub(crate) fn url(&self) -> String {
        self.with_token(self.names.url())
    }

    fn with_token(&self, url: String) -> String {
        match self.shared.folder.strip_prefix('/') {
            None => url,
            Some(token) => format!("{url}{token}/"),
        }
    }

    /// The URL for other machines, if the server listens to them.
    pub(crate) fn url_for_others(&self) -> Option<String> {
        self.names.url_for_others().map(|url| self.with_token(url))
    }

    /// What a watch over the file of the model keeps up to date.
    pub(crate) fn shown(&self, model: &str) -> Shown {
        Shown::new(self.shared.sessions.clone(), model)
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
            .route(&format!("{folder}/models"), get(models).post(open))
            .route(&format!("{folder}/models/{{id}}"), get(opened_request))
            .route(&format!("{folder}/models/{{id}}/mesh/{{folder}}/{{*path}}"), get(opened_mesh))
            .layer(DefaultBodyLimit::max(LARGEST_REQUEST))
            .fallback(get(page))
            .with_state(self.shared.clone());
        let guarded = Guard { names: self.names, frame_ancestors: self.frame_ancestors };
        let router = router.layer(middleware::from_fn_with_state(guarded, guard));
        connections::serve(without_delay(self.listener), router, self.shared.limits).await
    }
}

/// Small messages of its connections leave at once.
fn without_delay(listener: TcpListener) -> TapIo<TcpListener, fn(&mut TcpStream)> {
    // A client that is gone shows when it is written to.
    listener.tap_io(|stream| {
        let _ = stream.set_nodelay(true);
    })
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
    let upgrade = upgrade.max_message_size(LONGEST).max_frame_size(LONGEST);
    let silence = shared.silence;
    let sessions = match &asked.model {
        None => Some(shared.sessions),
        Some(id) => shared.opened.sessions(id),
    };
    let Some(sessions) = sessions else {
        let id = asked.model.unwrap_or_default();
        // A refused upgrade would tell a page nothing.
        return upgrade.on_upgrade(async move |mut socket| {
            let what = format!("model {id} is not open on this server");
            let complaint = Complaint::new("model", &id, &what, "open its file again");
            let _ = socket.send(Frame::Text(text(&complaint).into())).await;
            drop(place);
        });
    };
    upgrade.on_upgrade(async move |socket| {
        talk(socket, sessions, asked, silence).await;
        drop(place);
    })
}

const JSON: [(header::HeaderName, &str); 1] = [(header::CONTENT_TYPE, "application/json")];

#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS), ts(rename = "Models"))]
pub(super) struct ModelsJson<'a> {
    name: &'a str,
    catalogue: Vec<Offer>,
    opened: Vec<Known>,
    opens: bool,
}

async fn models(State(shared): State<Shared>) -> Response {
    let list = move || {
        let (opened, opens) = (shared.opened.known(), shared.opens);
        let start = shared.sessions.start();
        let name = start.mechanism.name();
        text(&ModelsJson { name, catalogue: opened::offers(), opened, opens })
    };
    match tokio::task::spawn_blocking(list).await {
        Ok(list) => (JSON, list).into_response(),
        Err(_) => StatusCode::INTERNAL_SERVER_ERROR.into_response(),
    }
}

async fn open(State(shared): State<Shared>, request: Request) -> Response {
    if !shared.opens {
        let what = "This server opens no files and no other models: other machines reach it, or a \
                    program holds its session.";
        return (StatusCode::FORBIDDEN, what).into_response();
    }
    let limit = shared.limits.upload;
    let uploads = Arc::clone(&shared.uploads);
    let Ok(Ok(place)) = timeout(limit, uploads.acquire_owned()).await else {
        let what = "Too many models are being opened; try it again once they are.";
        return (StatusCode::SERVICE_UNAVAILABLE, what).into_response();
    };
    let body = match timeout(limit, Bytes::from_request(request, &())).await {
        Ok(Ok(body)) => body,
        Ok(Err(refused)) => return refused.into_response(),
        Err(_) => {
            let seconds = limit.as_secs_f64();
            let what = format!("The files did not arrive within {seconds} s; send fewer.");
            return (StatusCode::REQUEST_TIMEOUT, what).into_response();
        }
    };
    let opened = move || {
        let _place = place;
        shared.opened.open(&shared.sessions, &body)
    };
    let opened = tokio::task::spawn_blocking(opened).await;
    let failed = |_| Err(Refusal::new("the model could not be loaded", "try another file"));
    match opened.unwrap_or_else(failed) {
        Ok(known) => (JSON, text(&known)).into_response(),
        Err(refusal) => (StatusCode::UNPROCESSABLE_ENTITY, JSON, text(&refusal)).into_response(),
    }
}

async fn opened_request(State(shared): State<Shared>, Path(id): Path<String>) -> Response {
    let read = move || shared.opened.request(&id);
    match tokio::task::spawn_blocking(read).await {
        Ok(Some(request)) => {
            ([(header::CONTENT_TYPE, "application/octet-stream")], request).into_response()
        }
        _ => (StatusCode::NOT_FOUND, "There is no such model.").into_response(),
    }
}

async fn mesh(
    State(shared): State<Shared>,
    Path((folder, path)): Path<(usize, String)>,
) -> Response {
    mesh_in(&shared.sessions.start().folders, folder, &path).await
}

async fn opened_mesh(
    State(shared): State<Shared>,
    Path((id, folder, path)): Path<(String, usize, String)>,
) -> Response {
    match shared.opened.sessions(&id) {
        Some(sessions) => mesh_in(&sessions.start().folders, folder, &path).await,
        None => (StatusCode::NOT_FOUND, "There is no such model.").into_response(),
    }
}

async fn mesh_in(folders: &Folders, folder: usize, path: &str) -> Response {
    let Some(file) = folders.file(folder, path) else {
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

#[cfg(test)]
mod tests {
    use std::io::{ErrorKind, Read, Write};
    use std::net::TcpStream;
    use std::thread;
    use std::time::{Duration, Instant};

    use axum::serve::Listener;
    use cylindroid::catalogue;
    use tokio::runtime::Runtime;
    use tungstenite::{Message, WebSocket, client};

    use super::*;
    use crate::viewer::StartBodies;

    const WAIT: Duration = Duration::from_secs(60);
    const MOST: Duration = Duration::from_millis(800);

    fn connect(url: &str) -> WebSocket<TcpStream> {
        let stream = TcpStream::connect(url.split('/').nth(2).unwrap()).unwrap();
        stream.set_read_timeout(Some(WAIT)).unwrap();
        client(url.replacen("http", "ws", 1) + "ws", stream).unwrap().0
    }

    #[test]
    fn small_messages_leave_at_once() {
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().unwrap();
        runtime.block_on(async {
            let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
            let _client = TcpStream::connect(listener.local_addr().unwrap()).unwrap();
            let (stream, _) = without_delay(listener).accept().await;
            assert!(stream.nodelay().unwrap());
        });
    }

    /// A server of a panda with its URL, which serves as long as the runtime lives.
    fn served(silence: Silence, limits: Limits) -> (String, Runtime) {
        let robot = catalogue::load("panda").unwrap();
        let (q, tool) = (robot.home().to_vec(), robot.tool().into());
        let start = Start::new((robot, "panda"), &q, tool, &[], StartBodies::default()).unwrap();
        let place = Place { host: "127.0.0.1", silence, limits, ..Place::default() };
        let runtime = tokio::runtime::Builder::new_multi_thread().enable_all().build().unwrap();
        let server = runtime.block_on(Server::of(Arc::new(start), None, place)).unwrap();
        let url = server.url();
        runtime.spawn(server.serve_on());
        (url, runtime)
    }

    /// A connection on which this was written.
    fn written(url: &str, text: &str) -> TcpStream {
        let mut stream = TcpStream::connect(url.split('/').nth(2).unwrap()).unwrap();
        stream.set_read_timeout(Some(WAIT)).unwrap();
        stream.write_all(text.as_bytes()).unwrap();
        stream
    }

    /// All that comes until the connection ends.
    fn rest(mut stream: TcpStream) -> String {
        let mut text = Vec::new();
        let ended = stream.read_to_end(&mut text);
        assert!(ended.map_or_else(|e| e.kind() == ErrorKind::ConnectionReset, |_| true));
        String::from_utf8(text).unwrap()
    }

    /// They neither stay nor keep others out; a client is no such connection.
    #[test]
    fn silent_connections_end() {
        let limits =
            Limits { connections: 2, header: Duration::from_millis(200), ..Limits::default() };
        let (url, _runtime) = served(Silence::default(), limits);
        let mut clients = [(); 3].map(|()| connect(&url));
        let silent = ["", "GET / HTTP/1.1\r\n", "", "POST /models", ""];
        let silent = silent.map(|text| written(&url, text));
        let host = url.split('/').nth(2).unwrap();
        let asked = written(
            &url,
            &format!("GET /models HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\n\r\n"),
        );
        assert!(rest(asked).starts_with("HTTP/1.1 200"));
        for stream in silent {
            assert!(!rest(stream).contains("200"));
        }
        clients.iter_mut().for_each(|client| assert!(client.read().is_ok()));
    }

    /// Files that do not come, those that wait for their turn meanwhile, and what comes after them.
    #[test]
    fn slow_uploads_end() {
        let limits = Limits { upload: Duration::from_millis(300), ..Limits::default() };
        let (url, _runtime) = served(Silence::default(), limits);
        let host = url.split('/').nth(2).unwrap();
        let head = format!("POST /models HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\n");
        let slow: Vec<TcpStream> = (0..=UPLOADS)
            .map(|_| written(&url, &format!("{head}Content-Length: 100\r\n\r\n{{")))
            .collect();
        for stream in slow {
            let answer = rest(stream);
            let status = answer.split(' ').nth(1);
            assert!(matches!(status, Some("408" | "503")), "{answer}");
        }
        let model = r#"{"open": "3r"}"#;
        let good = written(&url, &format!("{head}Content-Length: {}\r\n\r\n{model}", model.len()));
        assert!(rest(good).starts_with("HTTP/1.1 200"));
    }

    /// One client reads, and by that answers pings; the other is gone, but its connection is not.
    #[test]
    fn half_open_connections_end() {
        let silence = Silence { ping: Duration::from_millis(50), most: MOST };
        let (url, _runtime) = served(silence, Limits::default());
        // The silence of a client counts from its connection, which comes after this.
        let begin = Instant::now();
        let (mut gone, mut there) = (connect(&url), connect(&url));
        let end = thread::spawn(move || {
            let mut bytes = [0; 4096];
            while begin.elapsed() < WAIT {
                match gone.get_mut().read(&mut bytes) {
                    Ok(0) => return begin.elapsed(),
                    Err(error) if error.kind() != ErrorKind::Interrupted => return begin.elapsed(),
                    _ => {}
                }
            }
            WAIT
        });
        let mut pings = 0;
        while !end.is_finished() || begin.elapsed() < 3 * MOST {
            pings += u32::from(matches!(there.read().unwrap(), Message::Ping(_)));
        }
        let end = end.join().unwrap();
        assert!((MOST..WAIT).contains(&end), "{end:?}");
        assert!(pings > 3, "{pings}");
        there.send(Message::text(r#"{"type": "report", "name": "info"}"#)).unwrap();
        while !there.read().unwrap().to_text().is_ok_and(|text| text.contains("report")) {}
    }
}
