//! The server of the web viewer: docs/viewer.md is its contract.
//!
//! Every WebSocket has a session of its own. From the leaves up: `json`, `obstacle_messages`,
//! `messages`, `names`, `inverse_parameters`, `assets`, `reaching` and `avoidance` do not depend on a session; `start` is
//! the initial state of sessions, `bodies` their obstacles and distances; `session` is the
//! configuration, target and servo of one client; `measures`,
//! `overlays`, `compare`, `reports`, `snapshot` and `scene` describe a session; `dispatcher`
//! executes messages; `socket` exchanges messages and states in real time; `safety` protects `server`, which
//! listens. All mathematics is in the library.

mod assets;
mod avoidance;
mod bodies;
mod compare;
mod dispatcher;
mod inverse_parameters;
mod json;
mod measures;
mod messages;
mod names;
mod obstacle_messages;
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
pub(crate) use self::bodies::check_count;
pub(crate) use self::server::Server;
pub(crate) use self::start::{Start, StartBodies};
