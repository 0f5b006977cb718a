//! Closed chains of files that nobody here wrote, against models of their own in numpy
//! (`xtask/vectors/closed_chain_vectors.py`): Cassie from the twists of its links, two arms with an
//! object from Pinocchio's Jacobians.

use std::fs;

use cylindroid::closure::{ClosedChain, Mobility, MotionSpace};
use cylindroid::linalg::{ColumnSpace, Matrix, Threshold};
use cylindroid::manipulability::{Manipulability, Metrics};
use cylindroid::{Mechanism, load};
use serde_json::Value;

use crate::mjcf::numbers;
use crate::{motions_of, report, robots};

fn vectors(name: &str) -> Vec<Value> {
    let path = format!("{}/tests/vectors/closed_chains/{name}.json", env!("CARGO_MANIFEST_DIR"));
    let all: Value = serde_json::from_str(&fs::read_to_string(path).unwrap()).unwrap();
    all["cases"].as_array().unwrap().clone()
}

fn count(value: &Value) -> usize {
    value.as_u64().unwrap() as usize
}

fn at_home(m: &Mechanism) -> ClosedChain {
    ClosedChain::of(&m.state(m.home()).unwrap(), None, Some(1.0)).unwrap()
}

/// What the links say, taken one by one, the loops say too. Each leg of Cassie has five actuated
/// joints (roll, yaw, pitch, knee, foot) and two loops: the Achilles rod with its spring, one motion
/// beside the knee's, and the linkage of the foot.
///
/// - `cassie_v2`: all of it on a pelvis that is fixed, 2 x 6.
/// - `cassie_wo_gearbox_spring`: the pelvis slides in the world as well, 13.
/// - `cassie_reduced` and `cassie_simple` draw the rod of the foot turned by 0.1 rad. Its hinge is
///   not parallel to the others, and three hinges and a ball that are not in a plane do not move:
///   the feet stand still, 13 - 2.
/// - `cassie`: the motors of the ten actuated joints are links of their own, tied to them by
///   gearboxes, a kind of joint that is not modelled and named in the report: ten motions more. The
///   spring of the knee is a slide that closes a loop of two parallel hinges and blocks the shin at
///   the knee: 2 x (6 + 5 - 1). Were the slide square to the line between these hinges, the loop would
///   move a little; it is up to the digits of the file, and the report names this doubt.
#[test]
fn cassie_moves_as_its_links_do() {
    let folder = robots().join("cassie_description/robots");
    let expected = [
        ("cassie.sdf", 20, 6),
        ("cassie_reduced.sdf", 11, 4),
        ("cassie_simple.sdf", 11, 4),
        ("cassie_v2.sdf", 12, 4),
        ("cassie_wo_gearbox_spring.sdf", 13, 4),
    ];
    for (case, (file, dof, loops)) in vectors("cassie").iter().zip(expected) {
        assert_eq!((case["file"].as_str().unwrap(), count(&case["dof"])), (file, dof));
        let m = cylindroid::load_file(&folder.join(file)).unwrap();
        assert_eq!(m.loops().len(), loops, "{file}");
        assert_eq!(
            report(&m).contains("<joint> of type gearbox"),
            file == "cassie.sdf",
            "{}",
            report(&m)
        );
        let chain = at_home(&m);
        let mobility = Mobility::of(&chain.constraint);
        assert_eq!(mobility.dof.dimension(), dof, "{file}");
        assert_eq!(mobility.hyperstatic.dimension(), count(&case["redundant"]), "{file}");
        assert_eq!(
            mobility.gruebler_kutzbach + mobility.hyperstatic.dimension() as i64,
            dof as i64,
            "{file}"
        );
        // The same motions, as far as the conditioning of the links' equations carries.
        let joints: Vec<&str> =
            case["joints"].as_array().unwrap().iter().map(|j| j.as_str().unwrap()).collect();
        let rows: Vec<Vec<f64>> = case["motions"].as_array().unwrap().iter().map(numbers).collect();
        let theirs = Matrix::from_rows(&rows).unwrap();
        let ours = ColumnSpace::of(&motions_of(&chain, &joints), Threshold::Absolute(1e-6));
        assert_eq!(ours.rank(), theirs.cols(), "{file}");
        let sines = &ours.complement().transpose() * &theirs;
        let digits = 1e-14 / case["smallest"].as_f64().unwrap();
        let ambiguous_ranks: Vec<&str> = mobility.ambiguous_ranks.iter().map(|d| d.count).collect();
        assert_eq!(
            ambiguous_ranks,
            if file == "cassie.sdf" { &["dof"][..] } else { &[] },
            "{file}"
        );
        assert!(sines.frobenius_norm() < digits, "{file}: {:e}", sines.frobenius_norm());
    }
}

/// The file of a cell, with the robots where they were fetched to.
fn cell(file: &str) -> Mechanism {
    let source = format!("{}/tests/data/{file}", env!("CARGO_MANIFEST_DIR"));
    let text = fs::read_to_string(source).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(file);
    fs::write(&path, text.replace("ROBOTS", &robots().to_string_lossy())).unwrap();
    load(&path.to_string_lossy()).unwrap()
}

/// Two arms hold an object: 6 + 6 - 6 motions and 6 internal forces where both grip it; with a soft
/// finger 8 (a gripper is one of them) + 6 + 6 - 10 motions, of which four leave the object at rest.
#[test]
fn two_arms_hold_an_object() {
    for case in vectors("two_arms") {
        let m = cell(case["file"].as_str().unwrap());
        let chain = at_home(&m);
        assert!(
            chain.closure_error.distance < 1e-12 && chain.closure_error.angle < 1e-12,
            "{:?}",
            chain.closure_error
        );
        let motions = MotionSpace::of(&chain.constraint);
        let relation = motions.relation();
        let mobility = Mobility::from_parts(&chain.constraint, &motions, &relation);
        for (name, got) in [
            ("dof", mobility.dof.dimension()),
            ("redundancy", mobility.relation.redundancy),
            ("indeterminacy", mobility.relation.indeterminacy),
            ("internal", mobility.internal.dimension()),
            ("zero_torque", mobility.zero_torque.dimension()),
            ("hyperstatic", mobility.hyperstatic.dimension()),
        ] {
            assert_eq!(got, count(&case["counts"][name]), "{name} of {}", m.name());
        }
        assert!(mobility.ambiguous_ranks.is_empty(), "{:?}", mobility.ambiguous_ranks);
        let m = Manipulability::of(&relation, &Metrics::UNIT).unwrap();
        let expected = numbers(&case["kinematic"]);
        assert_eq!(m.kinematic.finite.len(), 6);
        let inverse: Vec<f64> = expected.iter().rev().map(|x| 1.0 / x).collect();
        for (got, expected) in [
            (m.kinematic.values(), &expected),
            (m.active_force().values(), &inverse),
            (m.passive_force().values(), &inverse),
        ] {
            for (g, e) in got.iter().zip(expected) {
                assert!((g - e).abs() < 1e-9 * e, "{got:?} {expected:?}");
            }
        }
    }
}
