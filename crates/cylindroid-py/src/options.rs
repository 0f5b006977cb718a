//! From Python's keywords to the options of the servo, with the names of the command line.

use cylindroid::control::{Plant, SecondaryNullSpace, SecondaryTask, ServoGains, SpeedLimit, Task};
use cylindroid::model::JointLimits;
use cylindroid::{Error, Mechanism, ReferenceFrame, ServoOptions, Twist};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyString};

use crate::arrays::Numbers;
use crate::error::{Failure, Result, entry};

/// What a name means.
pub(crate) fn named<T: Copy>(what: &'static str, name: &str, known: &[(&str, T)]) -> Result<T> {
    match known.iter().find(|(known, _)| *known == name) {
        Some((_, meant)) => Ok(*meant),
        None => Err(Error::unknown(what, name, known.iter().map(|(known, _)| known)).into()),
    }
}

/// The reference frame of this name.
pub(crate) fn reference_of(name: &str) -> Result<ReferenceFrame> {
    named("reference", name, &ReferenceFrame::NAMES)
}

/// A number, or one for translations and one for rotations.
pub(crate) fn pair(name: &'static str, of: &Numbers<'_>, single: f64) -> Result<(f64, f64)> {
    match *of.values() {
        [a] => Ok((a, if single.is_nan() { a } else { single })),
        [a, b] => Ok((a, b)),
        _ => Err(Failure::option(
            name,
            format!("{} numbers", of.values().len()),
            "give one number, or one for translations and one for rotations",
        )),
    }
}

/// The components of the motion that matter.
pub(crate) fn task(
    robot: &Mechanism,
    name: Option<&str>,
    axes: Option<&str>,
    default: Task,
) -> Result<Task> {
    let mut task = name.map_or(Ok(default), |name| Task::named(name, robot))?;
    task.axes = match axes {
        None => task.axes,
        // The error is taken at the tool, so the world's axes are meant.
        Some("world") => ReferenceFrame::LocalWorldAligned,
        Some(name) => reference_of(name)?,
    };
    Ok(task)
}

/// The secondary tasks: names, with gains or without.
pub(crate) fn secondary(
    given: Option<&Bound<'_, PyAny>>,
    posture: &[f64],
    robot: &Mechanism,
    options: &ServoOptions,
) -> Result<Vec<SecondaryTask>> {
    let named = |name: &str| SecondaryTask::named(name, posture);
    let Some(given) = given else {
        return Ok(options.default_secondary(robot)?);
    };
    if let Ok(name) = given.cast::<PyString>() {
        let name: String = entry("secondary", name)?;
        return if name == "none" { Ok(Vec::new()) } else { Ok(vec![named(&name)?]) };
    }
    let words = "secondary is a name, a list of names, or a dict: for each name a gain or a dict of \
                 parameters";
    if let Ok(by_name) = given.cast::<PyDict>() {
        let each = by_name.iter().map(|(name, value)| {
            let mut task = named(&entry::<String>("secondary", &name)?)?;
            if let Ok(parameters) = value.cast::<PyDict>() {
                for (parameter, value) in parameters {
                    task = task.with(
                        &entry::<String>("secondary", &parameter)?,
                        entry("secondary", &value)?,
                    )?;
                }
                return Ok(task);
            }
            let gain: f64 = value.extract().map_err(|_| Failure::kind(words))?;
            Ok(task.with("gain", gain)?)
        });
        return each.collect();
    }
    let names: Vec<String> = given.extract().map_err(|_| Failure::kind(words))?;
    names.iter().map(|name| Ok(named(name)?)).collect()
}

/// Limits of joints: a dict of dicts.
pub(crate) fn limits(given: &Bound<'_, PyAny>) -> Result<Vec<(String, JointLimits)>> {
    let words = "limits is a dict: for each joint a dict of limits, {'wrist': {'velocity': 1.0}}";
    let joints = given.cast::<PyDict>().map_err(|_| Failure::kind(words))?;
    let each = joints.iter().map(|(joint, of)| {
        let joint: String = entry("limits", &joint)?;
        let of = of.cast::<PyDict>().map_err(|_| Failure::kind(words))?;
        let limits = of.iter().try_fold(JointLimits::default(), |limits, (name, value)| {
            let name: String = entry("limits", &name)?;
            Ok::<_, Failure>(limits.with(&name, entry("limits", &value)?)?)
        })?;
        Ok((joint, limits))
    });
    each.collect()
}

/// The argument of `with_limits`.
pub(crate) fn limits_dict<'py>(
    py: Python<'py>,
    limits: &[(String, JointLimits)],
) -> PyResult<Bound<'py, PyDict>> {
    let all = PyDict::new(py);
    for (joint, l) in limits {
        let of = PyDict::new(py);
        let values = [l.lower, l.upper, l.velocity, l.acceleration, l.jerk, l.effort];
        for (name, value) in JointLimits::NAMES.into_iter().zip(values) {
            if let Some(value) = value {
                of.set_item(name, value)?;
            }
        }
        all.set_item(joint, of)?;
    }
    Ok(all)
}

pub(crate) fn null_space(name: &str) -> Result<SecondaryNullSpace> {
    named(
        "null space",
        name,
        &[("exact", SecondaryNullSpace::Exact), ("retained", SecondaryNullSpace::Retained)],
    )
}

pub(crate) fn gain(of: &Numbers<'_>) -> Result<ServoGains> {
    let (position, orientation) = pair("gain", of, f64::NAN)?;
    Ok(ServoGains { position, orientation })
}

/// The robot behind a servo; what is not given is ideal.
pub(crate) fn plant(delay: Option<f64>, time_constant: Option<f64>, noise: Option<f64>) -> Plant {
    Plant {
        delay: delay.unwrap_or(0.0),
        time_constant: time_constant.unwrap_or(0.0),
        noise: noise.unwrap_or(0.0),
    }
}

pub(crate) fn speed(of: &Numbers<'_>) -> Result<SpeedLimit> {
    let (linear, angular) = pair("speed", of, f64::INFINITY)?;
    Ok(SpeedLimit { linear, angular })
}

/// Twists as rows, or names of components of the tool's motion.
pub(crate) fn twists(name: &'static str, of: &Bound<'_, PyAny>) -> Result<Vec<Twist>> {
    if let Ok(names) = of.extract::<Vec<String>>() {
        let one = |name: &String| match Task::COMPONENTS.iter().position(|c| c == name) {
            Some(i) => Ok(Twist::from_array(std::array::from_fn(|k| f64::from(u8::from(k == i))))),
            None => Err(Error::unknown("component", name, Task::COMPONENTS).into()),
        };
        return names.iter().map(one).collect();
    }
    let numbers: Numbers<'_> = entry(name, of)?;
    match *numbers.shape() {
        [6] | [_, 6] => {
            let rows = numbers.values().as_chunks::<6>().0;
            Ok(rows.iter().map(|r| Twist::from_array(*r)).collect())
        }
        _ => Err(Failure::option(
            name,
            format!("{} numbers", numbers.values().len()),
            "give twists as rows of six, linear part first, or names like 'rz'",
        )),
    }
}
