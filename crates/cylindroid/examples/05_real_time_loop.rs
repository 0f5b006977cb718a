//! A hard real-time loop at 1 kHz: real-time scheduling and locked memory where the system permits
//! them, absolute deadlines, nothing allocated; at the end the worst times, in microseconds.
//! `cargo run --release -p cylindroid --example 05_real_time_loop -- 60` runs it for a minute (ten seconds without a
//! number).
#![allow(clippy::print_stdout)]

use std::time::{Duration, Instant};

use cylindroid::{Servo, ServoOptions, Twist, Vec3, control::Target};

const PERIOD: Duration = Duration::from_millis(1);

/// The cycles of a run.
#[derive(Debug)]
struct Times {
    /// From the planned time of a cycle to its begin, the servo step, and from the planned time to the
    /// command (ns), sorted.
    waking: Vec<u64>,
    step: Vec<u64>,
    command: Vec<u64>,
    /// Commands later than a period.
    missed: usize,
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let seconds: u32 = std::env::args().nth(1).map_or(Ok(10), |n| n.parse())?;
    match system::become_real_time() {
        Ok(()) => println!("SCHED_FIFO, memory locked"),
        Err(error) => println!("ordinary scheduling: {error}"),
    }
    let times = control(seconds)?;
    println!("{:16}{:>9}{:>9}{:>9}", "us", "median", "99.9 %", "largest");
    for (what, times) in
        [("waking up", times.waking), ("servo step", times.step), ("command", times.command)]
    {
        let at = |share: f64| times[((times.len() - 1) as f64 * share) as usize] as f64 * 1e-3;
        println!("{what:16}{:9.1}{:9.1}{:9.1}", at(0.5), at(0.999), at(1.0));
    }
    println!("{} of {seconds}000 commands later than a period", times.missed);
    Ok(())
}

/// Follows a circle.
fn control(seconds: u32) -> cylindroid::Result<Times> {
    let robot = cylindroid::load("panda")?;
    let options = ServoOptions { dt: PERIOD.as_secs_f64(), ..ServoOptions::new(&robot) };
    let mut servo = Servo::new(&robot, options)?;
    let mut q = robot.home().to_vec();
    let start = robot.state(&q)?.pose(robot.tool())?;

    // All memory before the first cycle.
    let cycles = seconds as usize * 1000;
    let memory = || Vec::with_capacity(cycles);
    let mut times = Times { waking: memory(), step: memory(), command: memory(), missed: 0 };
    servo.step(&q, start)?;
    servo.reset();

    let whole = |time: Duration| u64::try_from(time.as_nanos()).unwrap_or(u64::MAX);
    let mut planned = Instant::now() + PERIOD;
    for cycle in 0..cycles {
        // Until an absolute time: what a cycle takes does not shift the next ones.
        std::thread::sleep(planned.saturating_duration_since(Instant::now()));
        let began = Instant::now();
        times.waking.push(whole(began.saturating_duration_since(planned)));
        let (sin, cos) = (cycle as f64 * 1e-3 * 2.0).sin_cos();
        let mut target = Target::from(start);
        target.pose.translation += Vec3::new(0.0, sin, cos - 1.0) * 0.05;
        let linear = Vec3::new(0.0, cos, -sin) * 0.1;
        target.feed_forward = Twist { linear, angular: Vec3::ZERO };
        servo.step(&q, target)?; // from the robot's encoders: q
        times.step.push(whole(began.elapsed()));
        servo.advance(&mut q); // to the robot's motors: servo.joint_velocities()
        let late = planned.elapsed();
        times.command.push(whole(late));
        times.missed += usize::from(late > PERIOD);
        planned += PERIOD;
    }
    for column in [&mut times.waking, &mut times.step, &mut times.command] {
        column.sort_unstable();
    }
    Ok(times)
}

#[cfg(target_os = "linux")]
mod system {
    use std::io::{Error, Result};

    /// Priority of the loop, of 1 to 99: above the interrupts of ordinary devices.
    const PRIORITY: i32 = 80;

    /// Keeps all pages in memory and runs this thread before all ordinary ones; both need a right
    /// (`CAP_SYS_NICE`, `CAP_IPC_LOCK`, or limits.conf).
    #[expect(unsafe_code, reason = "two calls of the system")]
    pub(crate) fn become_real_time() -> Result<()> {
        // SAFETY: it takes flags and no memory of ours.
        if unsafe { libc::mlockall(libc::MCL_CURRENT | libc::MCL_FUTURE) } != 0 {
            return Err(Error::last_os_error());
        }
        let parameters = libc::sched_param { sched_priority: PRIORITY };
        // SAFETY: 0 is this thread; the parameters live until the call returns, and are only read.
        if unsafe { libc::sched_setscheduler(0, libc::SCHED_FIFO, &raw const parameters) } != 0 {
            return Err(Error::last_os_error());
        }
        Ok(())
    }
}

#[cfg(not(target_os = "linux"))]
mod system {
    pub(crate) fn become_real_time() -> std::io::Result<()> {
        Err(std::io::Error::other("this example knows real-time scheduling on Linux alone"))
    }
}
