//! Inverses and secondary tasks by name.

use cylindroid::control::{InverseSelection, NamedInverse, SecondaryTask, TaskProjection};
use cylindroid::{ServoOptions, Twist, catalogue};

use super::{fail, of_text};
use crate::record::{Record, check};
use crate::robots::Random;

fn of_projection(record: &mut Record, projection: &TaskProjection) {
    record.word(&projection.name());
    record.number(projection.pitch().unwrap_or(f64::INFINITY));
    of_text(record, &format!("{projection:?}"));
}

/// Any of the names, or one that is near to it.
fn name(random: &mut Random<'_>) -> String {
    let all: Vec<&str> = NamedInverse::all().map(|inverse| inverse.name).collect();
    let name = all[random.below(all.len())];
    if random.once_in(12) { format!("{name}s") } else { name.to_owned() }
}

/// Values of its parameters and now and then of those of another inverse.
fn parameters(name: &str, random: &mut Random<'_>) -> Vec<(&'static str, f64)> {
    let other = [name, "hyperbolic-gram", "damped", "truncated"][random.below(8).saturating_sub(4)];
    let mut chosen = Vec::new();
    for inverse in NamedInverse::all().filter(|i| i.name == name || i.name == other) {
        for parameter in inverse.parameters {
            if !random.once_in(4) {
                let size = [1.0, 1.0, 1.0, -1.0][random.below(4)];
                chosen.push((parameter.name, size * parameter.default * random.power(-0.5, 0.5)));
            }
        }
    }
    chosen
}

#[test]
fn inverses() {
    check("control_names", 45, |random, record| {
        let (name, other) = (name(random), name(random));
        let twist = Twist { linear: random.vec3(1.0), angular: random.vec3(1.0) };
        let selection = InverseSelection {
            name: &name,
            parameters: parameters(&name, random),
            complement: if random.once_in(4) { vec![twist] } else { Vec::new() },
            fallback: random.once_in(3).then_some(&other),
        };
        let mut options = ServoOptions::new(&catalogue::load("3r").unwrap());
        match selection.apply(&mut options) {
            Ok(()) => {
                of_text(record, &format!("{:?}", options.method));
                of_projection(record, &options.projection);
                if let Some(fallback) = &options.fallback {
                    of_projection(record, fallback);
                }
            }
            Err(error) => fail(record, &error),
        }
        match selection.choice(random.within(-0.1, 1.0)) {
            Ok(choice) => of_projection(record, &choice.projection),
            Err(error) => fail(record, &error),
        }
        match selection.method() {
            Ok(method) => record.word(&method.name()),
            Err(error) => fail(record, &error),
        }
    });
}

#[test]
fn secondary_tasks() {
    check("control_names_of_tasks", 30, |random, record| {
        let name = ["posture", "centring", "limit-avoidance", "manipulability", "gain"];
        let parameter = ["gain", "margin", "margins"][random.below(3)];
        let value = [f64::NAN, 0.0, random.within(-1.0, 1.0)][random.below(3)];
        let task = SecondaryTask::named(name[random.below(5)], &[0.5]);
        match task.and_then(|task| task.with(parameter, value)) {
            Ok(task) => of_text(record, &format!("{task:?}")),
            Err(error) => fail(record, &error),
        }
    });
}
