//! `move` with several tasks, or at a distance from other bodies.

mod file;
mod job;
mod report;
mod walls;

use std::io::Write;

use cylindroid::control::Status;

pub(crate) use self::file::load as load_tasks;
use self::job::TaskJob;
use self::report::Report;
use crate::args::MoveArgs;
use crate::commands::shared::Style;
use crate::exit::Exit;
use crate::plot;
use crate::task_trajectory::TaskTrajectory;
use crate::trajectory;

/// True if the arguments ask for several tasks or distances.
pub(super) fn are_asked_for(args: &MoveArgs) -> bool {
    args.tasks.tasks.is_some() || args.tasks.avoids() || args.target.has_frame_tasks()
}

pub(super) fn run(args: &MoveArgs, style: Style, out: &mut dyn Write) -> anyhow::Result<Exit> {
    let mut job = TaskJob::new(args)?;
    let format = args.out.as_deref().map(trajectory::format_of).transpose()?;
    if let Some(path) = &args.plot {
        plot::check(path)?;
    }
    let keep = args.out.is_some() || args.plot.is_some();
    let mut trajectory = keep.then(|| TaskTrajectory::new(&job.robot, &job.servo)).transpose()?;
    let start = job.start.clone();
    let result = job.servo.simulate(&start, job.time_limit, |time, q, servo| {
        if let Some(trajectory) = &mut trajectory {
            trajectory.push(time, q, servo);
        }
    })?;
    if let Some(trajectory) = &trajectory {
        if let (Some(path), Some(format)) = (&args.out, format) {
            trajectory.write(path, format)?;
        }
        if let Some(path) = &args.plot {
            plot::tasks::draw(trajectory, path)?;
        }
    }
    Report { job: &job, result: &result }.write(style, out)?;
    Ok(Exit::answer(result.status == Status::Reached))
}
