//! Cycles at absolute deadlines, and real-time scheduling: the part of a hard real-time loop that
//! knows no robot, for `05_real_time_loop.rs` and the bench `jitter`.

use std::time::{Duration, Instant};

/// The cycles of a run (ns).
#[derive(Debug)]
pub(crate) struct Times {
    /// From the planned time of a cycle to its begin, the step, and from the planned time to the
    /// command, sorted.
    pub(crate) waking: Vec<u64>,
    pub(crate) step: Vec<u64>,
    pub(crate) command: Vec<u64>,
    /// Commands later than a period.
    pub(crate) missed: usize,
}

/// Runs a function once in every period, with the number of the cycle; it returns the time of its
/// step, and ends with the command. All memory is there before the first cycle.
pub(crate) fn at_deadlines<E>(
    period: Duration,
    cycles: usize,
    mut cycle: impl FnMut(usize) -> Result<Duration, E>,
) -> Result<Times, E> {
    let memory = || Vec::with_capacity(cycles);
    let mut times = Times { waking: memory(), step: memory(), command: memory(), missed: 0 };
    let whole = |time: Duration| u64::try_from(time.as_nanos()).unwrap_or(u64::MAX);
    let mut planned = Instant::now() + period;
    for i in 0..cycles {
        // Until an absolute time: what a cycle takes does not shift the next ones.
        std::thread::sleep(planned.saturating_duration_since(Instant::now()));
        times.waking.push(whole(planned.elapsed()));
        times.step.push(whole(cycle(i)?));
        let late = planned.elapsed();
        times.command.push(whole(late));
        times.missed += usize::from(late > period);
        planned += period;
    }
    for column in [&mut times.waking, &mut times.step, &mut times.command] {
        column.sort_unstable();
    }
    Ok(times)
}

impl Times {
    /// Prints median, 99.9 % and largest time of each column, and the missed deadlines.
    pub(crate) fn print(&self) {
        println!("{:16}{:>9}{:>9}{:>9}", "us", "median", "99.9 %", "largest");
        let columns =
            [("waking up", &self.waking), ("step", &self.step), ("command", &self.command)];
        for (what, times) in columns {
            let last = times.len().saturating_sub(1);
            let at = |share: f64| {
                times.get((last as f64 * share) as usize).map_or(f64::NAN, |t| *t as f64 * 1e-3)
            };
            println!("{what:16}{:9.1}{:9.1}{:9.1}", at(0.5), at(0.999), at(1.0));
        }
        println!("{} of {} commands later than a period", self.missed, self.command.len());
    }
}

/// Locks memory and schedules this thread before all others, and prints which of both the system
/// permits; both need a right (`CAP_IPC_LOCK`, `CAP_SYS_NICE`, or limits.conf).
pub(crate) fn become_real_time() {
    for (what, done) in
        [("memory locked", system::lock_memory()), ("SCHED_FIFO", system::schedule_first())]
    {
        match done {
            Ok(()) => println!("{what}: yes"),
            Err(error) => println!("{what}: no ({error})"),
        }
    }
}

#[cfg(target_os = "linux")]
mod system {
    use std::io::{Error, Result};

    /// Priority of the loop, of 1 to 99: above the interrupts of ordinary devices.
    const PRIORITY: i32 = 80;

    /// Keeps all pages in memory.
    #[expect(unsafe_code, reason = "a call of the system")]
    pub(super) fn lock_memory() -> Result<()> {
        // SAFETY: it takes flags and no memory of ours.
        let code = unsafe { libc::mlockall(libc::MCL_CURRENT | libc::MCL_FUTURE) };
        if code == 0 { Ok(()) } else { Err(Error::last_os_error()) }
    }

    /// Runs this thread before all ordinary ones.
    #[expect(unsafe_code, reason = "a call of the system")]
    pub(super) fn schedule_first() -> Result<()> {
        let parameters = libc::sched_param { sched_priority: PRIORITY };
        // SAFETY: 0 is this thread; the parameters live until the call returns, and are only read.
        let code = unsafe { libc::sched_setscheduler(0, libc::SCHED_FIFO, &raw const parameters) };
        if code == 0 { Ok(()) } else { Err(Error::last_os_error()) }
    }
}

#[cfg(not(target_os = "linux"))]
mod system {
    use std::io::{Error, Result};

    pub(super) fn lock_memory() -> Result<()> {
        Err(Error::other("known on Linux alone"))
    }

    pub(super) fn schedule_first() -> Result<()> {
        Err(Error::other("known on Linux alone"))
    }
}
