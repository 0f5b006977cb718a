//! The server of the web viewer: docs/viewer.md is its contract.
//!
//! Clients join sessions, each alone or several by name. From the leaves up: `json`, `beside`,
//! `obstacle_messages`, `repeated`, `messages`, `names`, `inverse_parameters`, `assets`, `reaching` and
//! `avoidance` do not depend on a session; `start` is the initial state of sessions, `bodies` their
//! obstacles and distances; `session` is a configuration with target and servo; `client_view` what
//! one client wants to see of it; `measures`, `overlays`, `posture`, `elsewhere`, `compare`, `reports`,
//! `snapshot` and `scene` describe a session; `dispatcher` executes messages; `shared_session` moves a session in
//! real time and gives its clients the newest of everything in a `mailbox`, `sessions` finds it, `opened` those of further
//! models, `refusal` says why one is not shown; `watch` loads a model again whose files change;
//! `answers` queue for a client, to which `socket` talks; `safety` and `connections` protect `server`,
//! which listens; `embedded` is all of it inside another program, with its `drawings` and `drags`;
//! `fed` is a client of tests. `typescript` writes the messages as types of the page. All mathematics
//! is in the library.

mod answers;
mod assets;
mod avoidance;
mod beside;
mod bodies;
mod client_view;
mod compare;
mod connections;
mod dispatcher;
mod drags;
mod drawings;
mod elsewhere;
mod embedded;
#[cfg(any(test, fuzzing))]
mod fed;
mod inverse_parameters;
mod json;
mod mailbox;
mod measures;
mod messages;
mod names;
mod obstacle_messages;
mod opened;
mod overlays;
mod posture;
mod reaching;
mod refusal;
mod repeated;
mod reports;
mod safety;
mod scene;
mod server;
mod session;
mod sessions;
mod shared_session;
mod snapshot;
mod socket;
mod start;
#[cfg(test)]
mod typescript;
mod watch;

pub(crate) use self::assets::page_is_built;
pub(crate) use self::bodies::check_count;
pub use self::drags::Drag;
pub use self::drawings::{Drawing, DrawnShape};
pub use self::embedded::{ShowOptions, Viewer};
#[cfg(fuzzing)]
pub(crate) use self::fed::feed;
pub(crate) use self::names::random_name;
pub(crate) use self::server::Server;
pub(crate) use self::start::{Start, StartBodies};
pub(crate) use self::watch::Watch;
