//! Singular configurations told from the mechanism alone, with the motions lost and gained.

use cylindroid::closure::{
    ClosedChain, Diagnosis, FiniteMobility, GenericMobility, Mobility, SingularityKind, assemble,
};
use cylindroid::model::{JointKind, formats};
use cylindroid::screws::Screw;
use cylindroid::spatial::{Vec3, Wrench};
use cylindroid::{Error, Mechanism, ReferenceFrame, catalogue};

use crate::support::Random;

/// Of `tests/data/mechanisms`.
fn file(name: &str) -> Mechanism {
    let path = format!("tests/data/mechanisms/{name}.toml");
    cylindroid::load(&path).unwrap()
}

fn of(m: &Mechanism, q: &[f64]) -> Diagnosis {
    Diagnosis::of(&m.state(q).unwrap(), None, None).unwrap()
}

fn at_home(m: &Mechanism) -> Diagnosis {
    of(m, m.home())
}

/// Pitch zero, through `point`, along `direction` (either way).
fn assert_line(screw: &Screw, point: Vec3, direction: Vec3, tolerance: f64) {
    let apart = (screw.axis.nearest(point) - point).norm();
    let across = screw.axis.direction.cross(direction).norm();
    let worst = apart.max(across).max(screw.pitch.abs());
    assert!(worst < tolerance, "{screw:?} through {point:?} along {direction:?}: {worst}");
}

#[test]
fn the_catalogue_is_regular_at_home() {
    for name in cylindroid::catalogue::names() {
        let found = at_home(&catalogue::load(name).unwrap());
        // The iiwa and the youbot stretch out at home, as their files have it.
        let straight = !found.verdict.is_regular();
        assert_eq!(straight, !found.blocked.is_empty(), "{name}: {:?}", found.verdict);
        assert!(found.generic.others >= 2, "{name}: {:?}", found.generic);
        if catalogue::load(name).unwrap().is_closed() {
            assert!(!straight && found.finite.is_ordinary(), "{name}: {found:?}");
        }
    }
}

/// A wrench that no joint feels is reciprocal to all of them; whichever frame is asked for.
#[test]
fn a_straight_elbow_blocks_a_wrench() {
    let arm = catalogue::load("ur5e").unwrap();
    let q = [0.3, -0.6, 0.0, 0.4, 1.0, 0.2];
    let found = of(&arm, &q);
    assert_eq!(found.verdict.kinds(), [SingularityKind::TypeI]);
    assert_eq!((found.blocked.len(), found.lost.len(), found.gained.len()), (1, 1, 0));
    assert!(found.separated && found.redundant.len() > 1, "{:?}", found.redundant);
    let state = arm.state(&q).unwrap();
    let unfelt = |wrench: Wrench, point: Vec3| {
        let j = state.jacobian(arm.tool(), ReferenceFrame::World).unwrap();
        for c in 0..6 {
            let twist = cylindroid::Twist::from_array(std::array::from_fn(|i| j[(i, c)]));
            assert!(twist.power(wrench).abs() < 1e-12, "joint {c}, {point:?}");
        }
    };
    let ray = found.blocked[0].twist();
    let wrench = Wrench { force: ray.angular, moment: ray.linear };
    unfelt(wrench, Vec3::ZERO);
    assert!(found.lost[0].twist().power(wrench).abs() > 0.1);
    // At another frame, with another length: the same wrench.
    let flange = arm.frame("link3").unwrap();
    let other = Diagnosis::of(&state, Some(arm.tool()), Some(0.3)).unwrap();
    assert!((other.blocked[0].pitch - found.blocked[0].pitch).abs() < 1e-9);
    assert_line(
        &Screw { pitch: 0.0, ..other.blocked[0] },
        found.blocked[0].axis.point,
        found.blocked[0].axis.direction,
        1e-9,
    );
    assert!(Diagnosis::of(&state, Some(flange), None).is_ok());
}

/// The turned platform turns and rises on a screw about the vertical (Hunt, Fichter).
#[test]
fn a_turned_stewart_platform_gains_a_screw() {
    let m = file("stewart-turned");
    let found = at_home(&m);
    assert_eq!(found.verdict.kinds(), [SingularityKind::TypeII]);
    assert_eq!((found.gained.len(), found.blocked.len()), (1, 0));
    let gained = &found.gained[0];
    assert_line(&Screw { pitch: 0.0, ..*gained }, Vec3::ZERO, Vec3::Z, 1e-9);
    // Every leg l at foot b: l . (h z + z x b) = 0, so h = -(b x l)_z / l_z.
    let chain = m.state(m.home()).unwrap();
    let foot = chain.pose(m.frame("cylinder1").unwrap()).unwrap().translation;
    let axis = m.joints().iter().find(|j| j.name == "leg1").unwrap().axis;
    let pitch = -foot.cross(axis).z / axis.z;
    assert!(pitch.abs() > 0.1 && (gained.pitch - pitch).abs() < 1e-9, "{gained:?} {pitch}");
    // The six equations stay independent: the legs may move it away finitely.
    assert_eq!((found.finite.infinitesimal, found.finite.finite), (6, Some(6)));
    assert!(found.distances.type_i > 0.0);
}

#[test]
fn a_five_bar_loses_and_gains() {
    let stretched = at_home(&file("five-bar-stretched"));
    assert_eq!(stretched.verdict.kinds(), [SingularityKind::TypeII]);
    assert_eq!(stretched.gained.len(), 1);
    // The rod turns about its crank's end.
    assert_line(&stretched.gained[0], Vec3::new(0.0, 1.0, 0.0), Vec3::Z, 1e-9);
    let dead = at_home(&file("five-bar-dead"));
    assert_eq!(dead.verdict.kinds(), [SingularityKind::TypeI]);
    // One wrench is resisted in every pose; the other acts along the links in line.
    assert_eq!((dead.generic.counts.zero_torque, dead.blocked.len()), (1, 1));
    assert!(dead.separated);
    assert_line(&dead.blocked[0], Vec3::ZERO, Vec3::X, 1e-6);
    assert_eq!(dead.redundant, ["q1"]);
}

#[test]
fn where_the_mechanism_folds() {
    let folded = at_home(&file("folded-parallelogram"));
    assert!(folded.verdict.kinds().contains(&SingularityKind::ConfigurationSpace));
    assert_eq!((folded.finite.finite, folded.finite.branches.len()), (Some(1), 2));
    // No other configuration closes: told from the motions that do not exist.
    let pair = at_home(&file("stretched-pair"));
    assert_eq!(pair.generic.others, 0);
    assert_eq!(pair.verdict.kinds(), [SingularityKind::ConfigurationSpace]);
    assert_eq!(pair.finite.finite, Some(0));
    // Overconstrained in every configuration is not singular.
    let spatial = at_home(&file("spatial-four-bar"));
    assert!(spatial.verdict.is_regular(), "{spatial:?}");
    assert_eq!(spatial.finite.finite, Some(1));
}

/// Singularities come and go with the configuration, not with the set of configurations that were looked at.
#[test]
fn generic_counts_are_those_of_random_postures() {
    let mut random = Random(17);
    for name in ["four-bar", "five-bar", "3rrr", "stewart", "delta", "watt", "two-arm"] {
        let m = catalogue::load(name).unwrap();
        let generic =
            |q: &[f64]| GenericMobility::of(&m.state(q).unwrap(), None, None).unwrap().counts;
        let home = generic(m.home());
        for _ in 0..2 {
            let guess: Vec<f64> = m.home().iter().map(|x| x + random.within(-0.2, 0.2)).collect();
            let other = assemble(&m, &guess, &[]).unwrap();
            assert!(other.closed);
            assert_eq!(generic(&other.q), home, "{name}");
        }
    }
}

/// Every strange request has an answer or one error.
#[test]
fn strange_mechanisms_have_an_answer() {
    // Nothing actuated: the object gains all its motions, in every configuration.
    let five_bar = catalogue::load("five-bar").unwrap();
    let idle = five_bar.with_actuated::<&str>(&[]).unwrap();
    let found = at_home(&idle);
    assert!(found.verdict.is_regular() && found.generic.counts.indeterminacy == 2);
    // Everything actuated.
    let all = five_bar.with_actuated(&["q1", "q2", "q3", "q4", "q5"]).unwrap();
    assert!(at_home(&all).verdict.is_regular());
    // Open.
    let open = of(&five_bar, &[0.3, 0.0, 0.0, 0.0]);
    assert_eq!(open.finite.finite, None);
    // A mechanism that cannot be assembled: links that do not reach.
    let pair = file("stretched-pair");
    let far = of(&pair, &[0.7, 0.0]);
    assert_eq!((far.finite.finite, far.finite.evidence.to_string().as_str()), (None, "not known"));
    assert!(!assemble(&five_bar, &[1.57, 0.0, 0.0, 0.0], &[0]).unwrap().closed);
    // A contact on a missing link.
    let text = "name = \"x\"\n[[joint]]\nname = \"q1\"\ntype = \"revolute\"\nbetween = \
                [\"ground\", \"finger\"]\norigin = [0.0, 0.0, 0.0]\naxis = [0.0, 0.0, 1.0]\n\
                [[contact]]\nname = \"c1\"\ntype = \"hard_finger\"\nbetween = [\"fingr\", \
                \"ground\"]\npoint = [1.0, 0.0, 0.0]\nnormal = [1.0, 0.0, 0.0]\n";
    let path = tempfile::Builder::new().suffix(".toml").tempfile().unwrap();
    std::fs::write(path.path(), text).unwrap();
    let refused = cylindroid::load(path.path().to_str().unwrap()).unwrap_err();
    assert!(refused.to_string().contains("fingr"), "{refused}");
    // A frame of another mechanism, a length that is none.
    let state = five_bar.state(five_bar.home()).unwrap();
    let panda = catalogue::load("panda").unwrap();
    assert!(Diagnosis::of(&state, Some(panda.tool()), None).is_err());
    assert!(matches!(
        Diagnosis::of(&state, None, Some(-1.0)),
        Err(Error::InvalidOption { option: "length", .. })
    ));
    assert!(FiniteMobility::of(&state, Some(f64::INFINITY)).is_err());
    // No joints at all: a link in the world, and a stone that nothing holds.
    for (text, dof) in [("type = \"fixed\"", 0), ("type = \"free\"\nactuated = false", 6)] {
        let text = format!("[[joint]]\nname = \"j\"\nbetween = [\"ground\", \"stone\"]\n{text}\n");
        let m = formats::toml::parse(&text, std::path::Path::new("stone.toml")).unwrap();
        let found = at_home(&m);
        assert!(found.verdict.is_regular(), "{found:?}");
        assert_eq!((found.finite.infinitesimal, found.finite.finite), (dof, Some(dof)));
        let chain = ClosedChain::of(&m.state(m.home()).unwrap(), None, None).unwrap();
        let mobility = Mobility::of(&chain.constraint);
        assert_eq!((mobility.dof.dimension(), mobility.zero_torque.dimension()), (dof, 6 - dof));
    }
}

/// A drive may turn a ball joint about one of its axes, or push a free body along one: the driven
/// components are a vector, and the others another one.
#[test]
fn components_are_driven_one_by_one() {
    for name in ["stewart", "delta", "two-arm"] {
        let m = catalogue::load(name).unwrap();
        let driven: Vec<&str> =
            m.coordinates().iter().filter(|c| c.actuated).map(|c| c.name.as_str()).collect();
        let mut vectors = m.joints().iter().filter(|j| {
            matches!(j.kind, JointKind::Spherical | JointKind::Free) && j.mimic.is_none()
        });
        let last = vectors.next_back().unwrap();
        for c in last.coordinates.clone() {
            let one = m.coordinates()[c].name.as_str();
            let m = m.with_actuated(&[&driven[..], &[one]].concat()).unwrap();
            let chain = ClosedChain::of(&m.state(m.home()).unwrap(), None, None).unwrap();
            let mobility = Mobility::of(&chain.constraint);
            let found = at_home(&m);
            let size = chain.actuated.len() + chain.passive.len();
            assert_eq!(mobility.joints.len(), size, "{name}, {one}");
            assert_eq!(found.counts.redundancy, mobility.redundancy.dimension(), "{name}, {one}");
            let column = chain.actuated.iter().position(|n| n == one).unwrap();
            assert!(!mobility.joints[column].free_of_actuators, "{name}, {one}");
            // The others are one vector: components of it have one share.
            let of = |n: &String| {
                let other = m.coordinates()[last.coordinates.clone()].iter().any(|c| c.name == *n);
                other
                    && m.coordinates()[c].kind
                        == m.coordinates()
                            [m.coordinates().iter().position(|c| c.name == *n).unwrap()]
                        .kind
            };
            let passive = chain.passive.iter().enumerate().filter(|(_, n)| of(n));
            let shares: Vec<f64> =
                passive.map(|(i, _)| mobility.joints[chain.actuated.len() + i].share).collect();
            assert!(shares.len() >= 2, "{name}, {one}: {shares:?}");
            assert!(shares.iter().all(|s| s == &shares[0]), "{name}, {one}: {shares:?}");
        }
    }
}

/// At round coordinates some residuals have no rounding, and Newton's method goes on far below it: one
/// mobility, whatever the order of the joints.
#[test]
fn round_coordinates_converge() {
    let joint = |name: &str, between: &str, origin: &str| {
        format!(
            "[[joint]]\nname = \"{name}\"\ntype = \"revolute\"\nbetween = {between}\norigin = {origin}\n"
        )
    };
    for x in ["-3", "-3.1"] {
        let mut joints = [
            joint("shoulder", "[\"ground\", \"arm\"]", "[0, 0]\nactuated = true"),
            joint("a1", "[\"ground\", \"a\"]", "[1, 1]"),
            joint("a2", "[\"a\", \"b\"]", "[1, 0]"),
            joint("a3", "[\"b\", \"ground\"]", &format!("[{x}, 0]")),
            joint("a4", "[\"b\", \"ground\"]", "[3, 3]"),
        ];
        for _ in 0..5 {
            joints.rotate_left(1);
            let text = format!("dimension = 2\nreference = \"arm\"\n{}", joints.concat());
            let m = formats::toml::parse(&text, std::path::Path::new("round.toml")).unwrap();
            let found = at_home(&m);
            assert_eq!((found.finite.finite, found.counts.redundancy), (Some(1), 0), "{found:?}");
            assert!(found.verdict.is_regular(), "{found:?}");
        }
    }
}
