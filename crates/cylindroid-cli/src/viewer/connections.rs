//! HTTP connections: how many there are at a time, and how long one of them may take.
//!
//! A connection that has become a WebSocket is no longer counted: clients have places of their own.

use std::io;
use std::sync::Arc;
use std::time::Duration;

use axum::Router;
use axum::serve::Listener;
use hyper::server::conn::http1;
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::service::TowerToHyperService;
use tokio::sync::Semaphore;
use tokio::time::timeout;

/// What a client may take of a server.
#[derive(Debug, Clone, Copy)]
pub(super) struct Limits {
    /// Maximum number of connections; with those of the clients they are fewer than the 1024 files
    /// that systems let a program have open. The next waits until one ends.
    pub(super) connections: usize,
    /// A connection without a complete header for longer is closed.
    pub(super) header: Duration,
    /// Maximum time of a request that opens a model, and of its wait for a place.
    pub(super) upload: Duration,
    /// A connection ends after this, whatever is under way.
    pub(super) most: Duration,
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            connections: 400,
            header: Duration::from_secs(10),
            upload: Duration::from_secs(240),
            most: Duration::from_secs(900),
        }
    }
}

/// Serves as long as the runtime lives.
pub(super) async fn serve<L>(mut listener: L, router: Router, limits: Limits) -> io::Result<()>
where
    L: Listener,
{
    let places = Arc::new(Semaphore::new(limits.connections));
    let mut http = http1::Builder::new();
    http.timer(TokioTimer::new()).header_read_timeout(limits.header);
    loop {
        // Nobody closes it.
        let place = Arc::clone(&places).acquire_owned().await.map_err(io::Error::other)?;
        let (stream, _) = listener.accept().await;
        let service = TowerToHyperService::new(router.clone());
        let connection = http.serve_connection(TokioIo::new(stream), service).with_upgrades();
        tokio::spawn(async move {
            // A client that is gone, or was too slow, needs no answer.
            let _ = timeout(limits.most, connection).await;
            drop(place);
        });
    }
}
