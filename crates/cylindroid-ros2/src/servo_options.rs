//! The servo's options from the parameters.

use anyhow::{Context, Result};
use cylindroid::control::{InverseSelection, Plant, SecondaryTask, ServoGains, SpeedLimit, Task};
use cylindroid::{Mechanism, ServoOptions};

use crate::parameters::Config;

/// The options for this robot.
pub(crate) fn servo_options(config: &Config, robot: &Mechanism) -> Result<ServoOptions> {
    let mut options = ServoOptions::new(robot);
    if let Some(name) = &config.frame {
        options.end_effector = robot.frame(name)?.into();
    }
    options.task = Task::named(&config.task, robot)?;
    options.dt = 1.0 / config.rate;
    options.gain = ServoGains { position: config.gain, orientation: config.gain };
    options.speed = SpeedLimit { linear: config.linear_speed, angular: config.angular_speed };
    options.acceleration = config.acceleration;
    options.jerk = config.jerk;
    let (delay, time_constant, noise) = (config.delay, config.time_constant, config.noise);
    options.plant = Plant { delay, time_constant, noise };
    options.command_timeout = config.command_timeout;
    let (name, parameters) = named("inverse", &config.inverse)?;
    InverseSelection { name, parameters, ..Default::default() }.apply(&mut options)?;
    options.secondary = match &config.secondary {
        None => options.default_secondary(robot)?,
        Some(tasks) => {
            let mut all = Vec::new();
            for text in tasks.iter().filter(|text| *text != "none") {
                let (name, parameters) = named("secondary", text)?;
                let mut task = SecondaryTask::named(name, robot.home())?;
                for (parameter, value) in parameters {
                    task = task.with(parameter, value)?;
                }
                all.push(task);
            }
            all
        }
    };
    Ok(options)
}

/// `NAME` or `NAME,PARAMETER=VALUE,...`.
fn named<'a>(option: &str, text: &'a str) -> Result<(&'a str, Vec<(&'a str, f64)>)> {
    let mut parts = text.split(',').map(str::trim);
    let name = parts.next().unwrap_or_default();
    let mut parameters = Vec::new();
    for part in parts {
        let pair = part.split_once('=').and_then(|(p, v)| Some((p.trim(), v.trim().parse().ok()?)));
        let wrong = || format!("{option} = {text}: '{part}' is not of the form PARAMETER=NUMBER");
        parameters.push(pair.with_context(wrong)?);
    }
    Ok((name, parameters))
}
