//! The spectra of the reference mechanisms to 1e-9, in any frame, basis and unit.

use cylindroid::Matrix;
use cylindroid::closure::{MotionSpace, Relation};
use cylindroid::manipulability::{Index, Manipulability, Metrics};

use crate::closure::case::{Anew, Case, Problem, case, cases, described_anew, numbers};
use crate::support::assert_close;

/// Relative.
const TOLERANCE: f64 = 1e-9;

fn relation(problem: &Problem) -> Relation {
    let relation = MotionSpace::of(&problem.constraint).relation();
    problem.task.as_ref().map_or(relation.clone(), |t| relation.task(t).unwrap())
}

fn metrics(problem: &Problem) -> Metrics {
    Metrics::UNIT.with_object(&problem.wu).unwrap().with_joint(&problem.wq).unwrap()
}

#[track_caller]
fn assert_relative(what: &str, got: &[f64], expected: &[f64]) {
    let ratio: Vec<f64> = got.iter().zip(expected).map(|(g, e)| g / e).collect();
    assert_eq!(got.len(), expected.len(), "{what}: {got:?} instead of {expected:?}");
    assert_close(what, &ratio, &vec![1.0; got.len()], TOLERANCE);
}

#[track_caller]
fn check(case: &Case, problem: &Problem) {
    let m = Manipulability::of(&relation(problem), &metrics(problem)).unwrap();
    for (kind, spectrum) in [
        ("kinematic", m.kinematic.clone()),
        ("active_force", m.active_force()),
        ("passive_force", m.passive_force()),
    ] {
        let what = format!("{kind} of {}", case.name);
        let expected = &case.value[kind];
        assert_relative(&what, &spectrum.values(), &numbers(&expected["finite"]));
        let count = |name: &str| expected[name].as_u64().unwrap_or(0) as usize;
        assert_eq!(spectrum.zeros.cols(), count("zeros"), "zeros of {what}");
        assert_eq!(spectrum.infinite.cols(), count("infinite"), "infinite ones of {what}");
    }
}

#[test]
fn spectra() {
    cases().iter().for_each(|case| check(case, &case.problem()));
}

#[test]
fn spectra_do_not_depend_on_the_frame() {
    described_anew(Anew::Frame, 81, check);
}

#[test]
fn spectra_do_not_depend_on_the_unit() {
    described_anew(Anew::Unit, 0, check);
}

#[test]
fn spectra_do_not_depend_on_where_a_contact_is_drawn() {
    described_anew(Anew::Drawing, 82, check);
}

#[test]
fn spectra_do_not_depend_on_bases() {
    described_anew(Anew::Basis, 83, check);
}

#[test]
fn spectra_do_not_depend_on_anything() {
    described_anew(Anew::Everything, 84, check);
}

/// The five-bar of figure 3 in closed form: N and D are known integers.
#[test]
fn five_bar_exactly() {
    let root = f64::sqrt;
    let exact = [
        ("a", [7.0 + root(41.0), 7.0 - root(41.0)]),
        ("b", [(15.0 + root(97.0)) / 16.0, (15.0 - root(97.0)) / 16.0]),
        ("c", [0.4 + 2.0 * root(3.0) / 15.0, 0.4 - 2.0 * root(3.0) / 15.0]),
    ];
    for (name, values) in exact {
        let case = case(&format!("fivebar_sec5_case_{name}"));
        let m = Manipulability::of(&relation(&case.problem()), &Metrics::UNIT).unwrap();
        let inverse = [1.0 / values[1], 1.0 / values[0]];
        let close = |what: &str, got: &[f64], expected: &[f64]| {
            let ratio: Vec<f64> = got.iter().zip(expected).map(|(g, e)| g / e).collect();
            assert_close(what, &ratio, &[1.0, 1.0], 1e-13);
        };
        close("kinematic", &m.kinematic.values(), &values);
        close("force", &m.force.values(), &inverse);
    }
}

/// Directions belong to the relation, have the stated sizes, and are orthogonal in the metrics.
#[test]
fn directions_are_what_they_say() {
    for case in cases() {
        let relation = relation(&case.problem());
        let m = Manipulability::of(&relation, &metrics(&case.problem())).unwrap();
        let forces = relation.forces().basis();
        let norm = |w: &Matrix, x: &[f64]| -> f64 {
            let wx = w.mul_vec(x);
            x.iter().zip(&wx).map(|(a, b)| a * b).sum::<f64>()
        };
        for direction in &m.kinematic.finite {
            let mut both = direction.joint.clone();
            both.extend(&direction.object);
            let work = forces.transpose().mul_vec(&both);
            assert_close("work", &work, &vec![0.0; work.len()], 1e-12);
            let (q, u) = (norm(&case.wq, &direction.joint), norm(&case.wu, &direction.object));
            assert!((q - direction.pair.input.powi(2)).abs() < 1e-12, "{}", case.name);
            assert!((u - direction.pair.output.powi(2)).abs() < 1e-12, "{}", case.name);
        }
        // Power of force and motion along different principal directions is nothing.
        for (i, motion) in m.kinematic.finite.iter().enumerate() {
            for (j, force) in m.force.finite.iter().rev().enumerate() {
                let power: f64 = motion.object.iter().zip(&force.object).map(|(u, w)| u * w).sum();
                let (e, f) = (motion.pair.efficiency(), 1.0 / force.pair.efficiency());
                if i != j && (e / f - 1.0).abs() > 1e-6 {
                    assert!(power.abs() < 1e-11, "{} {i} {j}: {power}", case.name);
                }
            }
        }
    }
}

#[test]
fn six_indices() {
    let case = case("fivebar_typeII");
    let m = Manipulability::of(&relation(&case.problem()), &Metrics::UNIT).unwrap();
    let infinite = f64::INFINITY;
    let expected: [&[f64]; 6] =
        [&[0.5], &[0.5], &[infinite, 0.5], &[2.0], &[2.0, 0.0], &[infinite, 2.0]];
    for (index, values) in Index::ALL.iter().zip(expected) {
        let got = index.values(&m);
        assert_eq!(got.len(), values.len(), "{}", index.name());
        for (g, e) in got.iter().zip(values) {
            assert!(g == e || (g - e).abs() < 1e-13, "{}: {got:?}", index.name());
        }
    }
}
