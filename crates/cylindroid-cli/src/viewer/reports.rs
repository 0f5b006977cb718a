//! Reports: the objects printed by `cylindroid <command> --json`, made by the same functions.

use clap::Parser;
use cylindroid::{EndEffector, Error, Mechanism, State};
use serde::Serialize;
use serde_json::Value;
use serde_json::value::{RawValue, to_raw_value};

use super::json::text;
use super::messages::Complaint;
use super::names::REPORTS;
use super::session::Session;
use crate::args::{Cli, Command};
use crate::commands::closed::{Posed, manipulability, mobility};
use crate::commands::{info, screws};

/// A report request. It takes milliseconds and is processed on a thread of its own.
#[derive(Debug)]
pub(super) struct Report {
    name: &'static str,
    reply_to: Option<Value>,
    mechanism: Mechanism,
    q: Vec<f64>,
    end_effector: EndEffector,
}

#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[serde(tag = "type", rename = "report")]
pub(super) struct ReportJson<'a> {
    #[cfg_attr(test, ts(type = "string | number | null"))]
    reply_to: Option<&'a Value>,
    #[cfg_attr(test, ts(type = "ReportName"))]
    name: &'static str,
    #[cfg_attr(test, ts(type = "Record<string, unknown>"))]
    report: Box<RawValue>,
}

impl Report {
    /// For the current state of a session.
    pub(super) fn new(
        session: &Session,
        name: &str,
        id: Option<&Value>,
    ) -> Result<Self, Complaint> {
        let Some(name) = REPORTS.into_iter().find(|n| *n == name) else {
            let error = Error::unknown("report", name, REPORTS);
            return Err(Complaint::of("report.name", &error));
        };
        Ok(Self {
            name,
            reply_to: id.cloned(),
            mechanism: session.mechanism().clone(),
            q: session.state().q().to_vec(),
            end_effector: session.options().end_effector,
        })
    }

    /// The id of the message that asked for it.
    pub(super) fn reply_to(&self) -> Option<&Value> {
        self.reply_to.as_ref()
    }

    /// The message to the client, report or error.
    pub(super) fn text(self) -> String {
        let Self { name, reply_to, .. } = &self;
        let told = self.find().and_then(|report| {
            let reply_to = reply_to.as_ref();
            Ok(serde_json::to_string(&ReportJson { reply_to, name, report })?)
        });
        told.unwrap_or_else(|error| {
            let complaint = Complaint::new("report.name", name, &format!("{error:#}"), "");
            text(&Complaint { reply_to: self.reply_to.clone(), ..complaint })
        })
    }

    fn find(&self) -> anyhow::Result<Box<RawValue>> {
        // All options have their defaults.
        let plain = || Cli::try_parse_from(["cylindroid", self.name, self.mechanism.name()]);
        let state = || -> cylindroid::Result<State> { self.mechanism.state(&self.q) };
        let posed = || {
            let frame = Some(self.end_effector.frame);
            Posed::at(self.mechanism.clone(), self.q.clone(), frame, None)
        };
        match plain()?.command {
            Command::Mobility(_) => mobility::report(&posed()?),
            Command::Manipulability(args) => manipulability::report(posed()?, &args),
            Command::Screws(args) => screws::report(&state()?, self.end_effector, &args),
            _ => Ok(to_raw_value(&info::describe(&self.mechanism))?),
        }
    }
}
