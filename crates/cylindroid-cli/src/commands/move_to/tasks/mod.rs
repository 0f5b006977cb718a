//! `move` with several tasks, or at a distance from other bodies.

mod file;
mod job;
mod report;
mod walls;

use std::io::Write;
use std::process::ExitCode;

use cylindroid::control::Status;

pub(crate) use self::file::load as load_tasks;
use self::job::TaskJob;
use self::report::Report;
use crate::args::MoveArgs;
use crate::commands::shared::{Style, answer};

/// True if the arguments ask for several tasks or distances.
pub(super) fn are_asked_for(args: &MoveArgs) -> bool {
    args.tasks.tasks.is_some() || args.tasks.avoids() || args.target.has_frame_tasks()
}

pub(super) fn run(args: &MoveArgs, style: Style, out: &mut dyn Write) -> anyhow::Result<ExitCode> {
    let mut job = TaskJob::new(args)?;
    let start = job.start.clone();
    let result = job.servo.simulate(&start, job.time_limit, |_, _, _| ())?;
    Report { job: &job, result: &result }.write(style, out)?;
    Ok(answer(result.status == Status::Reached))
}
