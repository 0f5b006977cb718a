//! The server of the web viewer: docs/viewer.md is its contract.
//!
//! Every WebSocket is a session of its own. From the leaves up: `json`, `messages`, `names`,
//! `inverse_parameters`, `assets` and `reaching` know no session; `start` is what sessions begin
//! with, `session` one client's configuration, target and servo; `measures`, `overlays`, `compare`,
//! `reports`, `snapshot` and `scene` show a session; `dispatcher` lets a message change one;
//! `socket` moves messages and states in time; `safety` guards `server`, which listens.
//! No mathematics: what is drawn is the library's.

mod assets;
mod compare;
mod dispatcher;
mod inverse_parameters;
mod json;
mod measures;
mod messages;
mod names;
mod overlays;
mod reaching;
mod reports;
mod safety;
mod scene;
mod server;
mod session;
mod snapshot;
mod socket;
mod start;

pub(crate) use self::assets::page_is_built;
pub(crate) use self::server::Server;
pub(crate) use self::start::Start;
