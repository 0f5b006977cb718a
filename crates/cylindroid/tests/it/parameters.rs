//! The tables of inverses and their parameters: whole, consistent, and the only source.

use cylindroid::control::{InverseSelection, NamedInverse, SecondaryTask, TaskProjection};
use cylindroid::inverse::Domain;
use cylindroid::{Method, Servo, ServoOptions, catalogue};

/// Every row has a name of its own, defaults inside their domains, and a sentence for each entry.
#[test]
fn rows_are_whole() {
    let all: Vec<NamedInverse> = NamedInverse::all().collect();
    assert_eq!(all.len(), Method::ALL.len() + TaskProjection::NAMES.len());
    for (i, inverse) in all.iter().enumerate() {
        assert!(all[..i].iter().all(|other| other.name != inverse.name), "{}", inverse.name);
        assert_eq!(NamedInverse::named(inverse.name).unwrap(), *inverse);
        assert!(inverse.description.ends_with('.'), "{}", inverse.name);
        for parameter in inverse.parameters {
            assert!(parameter.domain.contains(parameter.default), "{parameter:?}");
            assert!(parameter.check(parameter.default).is_ok());
            assert!(!parameter.unit.is_empty() && parameter.description.ends_with('.'));
            assert!(!parameter.description.contains("  "), "{parameter:?}");
        }
    }
}

/// Fields of the variants, rows of the table, checks and names are one thing.
#[test]
fn methods_follow_their_rows() {
    for method in Method::ALL {
        assert_eq!(Method::named(method.name()).unwrap(), method);
        method.check().unwrap();
        let mut own = method;
        let values: Vec<(&str, f64)> = own.parameters_mut().map(|(p, v)| (p.name, *v)).collect();
        assert_eq!(values.len(), method.parameters().len());
        for (k, parameter) in method.parameters().iter().enumerate() {
            assert_eq!(values[k], (parameter.name, parameter.default));
            let mut broken = method;
            *broken.parameters_mut().nth(k).unwrap().1 = f64::NAN;
            let message = broken.check().unwrap_err().to_string();
            assert!(message.contains(parameter.name), "{message}");
            assert!(message.contains(parameter.domain.describe()), "{message}");
        }
    }
}

#[test]
fn domains_end_where_they_say() {
    for (domain, inside, outside) in [
        (Domain::Positive, [1e-300, 1e300], [0.0, f64::INFINITY]),
        (Domain::Fraction, [0.0, 0.999], [1.0, -1e-300]),
        (Domain::Finite, [-1e300, 0.0], [f64::INFINITY, f64::NAN]),
        (Domain::Extended, [f64::NEG_INFINITY, f64::INFINITY], [f64::NAN, -f64::NAN]),
    ] {
        assert!(inside.iter().all(|x| domain.contains(*x)), "{domain:?}");
        assert!(outside.iter().all(|x| !domain.contains(*x)), "{domain:?}");
        assert!(!domain.contains(f64::NAN) && !domain.describe().is_empty());
    }
}

/// Any inverse, any parameter, any fallback, by name alone.
#[test]
fn selections_reach_the_options() {
    let robot = catalogue::load("youbot").unwrap();
    for inverse in NamedInverse::all() {
        let parameters: Vec<(&str, f64)> =
            inverse.parameters.iter().map(|p| (p.name, 0.5 * p.default)).collect();
        for fallback in [None, Some("truncated"), Some("oblique")] {
            let mut options = ServoOptions::new(&robot);
            let selection = InverseSelection {
                name: inverse.name,
                parameters: parameters.clone(),
                fallback,
                ..InverseSelection::default()
            };
            let done = selection.apply(&mut options);
            if fallback.is_some() && !inverse.is_partial {
                assert!(done.unwrap_err().to_string().contains("always exists"));
                continue;
            }
            done.unwrap();
            options.check(&robot).unwrap();
            assert_eq!(options.fallback.is_some(), fallback.is_some());
            if inverse.is_partial {
                assert_eq!(options.projection.name(), inverse.name);
            } else {
                assert_eq!(options.method.name(), inverse.name);
                assert_eq!(selection.method().unwrap(), options.method);
                let values: Vec<f64> = options.method.parameters_mut().map(|(_, v)| *v).collect();
                assert_eq!(values, parameters.iter().map(|(_, v)| *v).collect::<Vec<f64>>());
            }
        }
        // A parameter that must be given, one of another inverse, and one that nobody has.
        for (k, parameter) in inverse.parameters.iter().enumerate().filter(|(_, p)| p.required) {
            let mut fewer = parameters.clone();
            fewer.remove(k);
            let message = refusal(inverse.name, fewer);
            assert!(message.contains(parameter.name) && message.contains("missing"), "{message}");
        }
        for other in NamedInverse::all().flat_map(|i| i.parameters) {
            let own = inverse.parameters.iter().any(|p| p.name == other.name);
            // Hyperbolic and oblique inverses truncate at singular configurations.
            let truncates = inverse.is_partial && other.name == "eps";
            if !own && !truncates {
                let given = [parameters.clone(), vec![(other.name, other.default)]].concat();
                assert!(refusal(inverse.name, given).contains("belongs to"));
            }
        }
        let message = refusal(inverse.name, [parameters, vec![("dampnig", 1.0)]].concat());
        assert!(message.contains("damping"), "{message}");
    }
    assert!(refusal("damp", Vec::new()).contains("damped"));
}

fn refusal(name: &str, parameters: Vec<(&str, f64)>) -> String {
    let mut options = ServoOptions::new(&catalogue::load("youbot").unwrap());
    let before = options.clone();
    let selection = InverseSelection { name, parameters, ..InverseSelection::default() };
    let error = selection.apply(&mut options).unwrap_err();
    assert_eq!(options, before, "{name}: a refused selection changed the options");
    error.to_string()
}

/// Names, rows, values and checks of the secondary tasks are one thing.
#[test]
fn secondary_tasks_follow_their_rows() {
    let robot = catalogue::load("panda").unwrap();
    let all = SecondaryTask::all(robot.home());
    assert_eq!(all.clone().map(|task| task.name()), SecondaryTask::NAMES);
    for task in all {
        assert_eq!(SecondaryTask::named(task.name(), robot.home()).unwrap(), task);
        assert!(task.description().ends_with('.') && task.parameters()[0].name == "gain");
        for parameter in task.parameters() {
            assert!(!parameter.unit.is_empty() && parameter.description.ends_with('.'));
            assert_eq!(task.values()[parameter.name], parameter.default);
            let other = task.clone().with(parameter.name, 0.7).unwrap();
            assert_eq!(other.values()[parameter.name], 0.7);
            let message = task.clone().with(parameter.name, f64::NAN).unwrap_err().to_string();
            assert!(message.contains(parameter.domain.describe()), "{message}");
            let mut broken = task.clone();
            broken
                .parameters_mut()
                .find(|(p, _)| p.name == parameter.name)
                .unwrap()
                .1
                .clone_from(&f64::NAN);
            let options = ServoOptions { secondary: vec![broken], ..ServoOptions::new(&robot) };
            let message = Servo::new(&robot, options).unwrap_err().to_string();
            assert!(message.contains(parameter.name), "{message}");
        }
        let message = task.clone().with("gian", 1.0).unwrap_err().to_string();
        assert!(message.contains("gain"), "{message}");
    }
    let message = SecondaryTask::named("center", &[]).unwrap_err().to_string();
    assert!(message.contains("centring"), "{message}");
}

/// Every secondary task on every robot and mechanism of the catalogue, infinite limits and loops
/// among them: a finite step, or an error that says which task to take instead.
#[test]
fn secondary_tasks_work_on_every_mechanism() {
    for name in catalogue::names() {
        let robot = catalogue::load(name).unwrap();
        for task in SecondaryTask::all(robot.home()) {
            let options = ServoOptions::new(&robot);
            let Ok(secondary) = options.default_secondary(&robot) else { continue };
            let options = ServoOptions { secondary: [secondary, vec![task]].concat(), ..options };
            let mut servo = match Servo::new(&robot, options) {
                Ok(servo) => servo,
                Err(error) => {
                    let message = error.to_string();
                    assert!(robot.is_closed(), "{name}: {message}");
                    assert!(message.contains("use posture, centring"), "{name}: {message}");
                    continue;
                }
            };
            let mut q = robot.home().to_vec();
            let pose = robot.state(&q).unwrap().pose(servo.options().end_effector).unwrap();
            for _ in 0..5 {
                servo.step(&q, pose).unwrap();
                servo.advance(&mut q);
                assert!(q.iter().all(|x| x.is_finite()), "{name}: {q:?}");
            }
        }
    }
}

const INVERSES: &str = include_str!("../../../../docs/guide/inverses.md");
const CONTROL: &str = include_str!("../../../../docs/guide/control.md");

/// The tables of parameters in the book have every row of the tables of the library.
#[test]
fn the_book_lists_every_parameter() {
    let tables = [
        ("inverses", INVERSES, NamedInverse::all().map(|i| (i.name, i.parameters)).collect()),
        (
            "control",
            CONTROL,
            SecondaryTask::all(&[]).iter().map(|t| (t.name(), t.parameters())).collect::<Vec<_>>(),
        ),
    ];
    for (page, text, rows) in tables {
        let mut table = String::from(
            "| name | parameter | unit | domain | default | |\n|---|---|---|---|---|---|\n",
        );
        for (name, parameters) in rows {
            for p in parameters {
                let default = if p.required { "required".to_owned() } else { short(p.default) };
                let (unit, domain) = (p.unit, p.domain.describe());
                let row = [p.name, unit, domain, &default, p.description].join(" | ");
                table += &format!("| `{name}` | {row} |\n");
            }
        }
        assert!(text.contains(&table), "docs/guide/{page}.md should have:\n{table}");
    }
}

/// As many digits as the default has.
fn short(value: f64) -> String {
    let rounded: f64 = format!("{value:.5e}").parse().unwrap();
    rounded.to_string()
}
