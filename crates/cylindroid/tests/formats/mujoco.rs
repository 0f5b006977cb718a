//! The constraint of closed chains against MuJoCo's own: its equality rows leave the motions that
//! ours leave, in configurations that meet both.

use cylindroid::closure::{ClosedChain, Mobility};
use cylindroid::linalg::{ColumnSpace, Matrix, Threshold};
use cylindroid::model::{Joint, JointKind};
use cylindroid::{Mechanism, State};

use crate::mjcf::{
    LOOPS, TENDONS, coordinates, moving, numbers, read, read_mjcf, robosuite, vectors, world,
};
use crate::{motions_of, report};

/// MuJoCo closes its loops to 1e-13 before it writes them.
const ANGLE: f64 = 1e-13;

/// The coordinate that a joint of one coordinate reads, and how many times.
fn leader(m: &Mechanism, joint: &Joint) -> (usize, f64) {
    match &joint.mimic {
        None => (joint.coordinates.start, 1.0),
        Some(mimic) => {
            let source = m.joints().iter().find(|j| j.name == mimic.joint).unwrap();
            let (coordinate, ratio) = leader(m, source);
            (coordinate, mimic.multiplier * ratio)
        }
    }
}

/// MuJoCo's qvel by our rates: angular velocities in the axes of the body in both, the linear
/// velocity of a free body in those of the world there and of the body here.
fn qvel_from_rates(state: &State) -> Matrix {
    let m = state.mechanism();
    let nv = moving(m).map(|j| j.kind.dof()).sum();
    let mut map = Matrix::zeros(nv, m.n());
    let mut row = 0;
    for joint in m.joints().iter().filter(|j| j.kind.dof() > 0) {
        let c = joint.coordinates.start;
        if joint.name.contains('+') {
            // Moves with the joint before it, and follows another one.
            let (leader, ratio) = leader(m, joint);
            map[(row - 1, leader)] += ratio;
            continue;
        }
        if joint.kind.dof() == 1 {
            let (leader, ratio) = leader(m, joint);
            map[(row, leader)] = ratio;
        } else {
            for i in 0..joint.kind.dof() {
                map[(row + i, c + i)] = 1.0;
            }
        }
        if joint.kind == JointKind::Free {
            let body = m.frame(&m.links()[joint.child].name).unwrap();
            let turn = state.pose(body).unwrap().rotation.matrix().to_rows();
            for i in 0..3 {
                for k in 0..3 {
                    map[(row + i, c + k)] = turn[i][k];
                }
            }
        }
        row += joint.kind.dof();
    }
    map
}

fn against_mujoco(name: &str, m: &Mechanism, expected_dof: usize) {
    let vectors = vectors(name);
    let joints: Vec<&str> =
        vectors["joints"].as_array().unwrap().iter().map(|j| j.as_str().unwrap()).collect();
    let own: Vec<&str> = moving(m).map(|j| j.name.as_str()).collect();
    assert_eq!(joints, own);
    let cases = vectors["closed"].as_array().unwrap();
    assert_eq!(cases.len(), 3, "{name}");
    for case in cases {
        let state = m.state(&coordinates(m, &case["q"])).unwrap();
        let chain = ClosedChain::of(&state, None, None).unwrap();
        assert!(
            chain.closure_error.distance < 1e-12 && chain.closure_error.angle < 1e-12,
            "{name}: {:?}",
            chain.closure_error
        );
        let names: Vec<&str> = m.coordinates().iter().map(|c| c.name.as_str()).collect();
        let ours = &qvel_from_rates(&state) * &motions_of(&chain, &names);
        let ours = ColumnSpace::of(&ours, Threshold::Relative(1e-9)).basis();
        let rows: Vec<Vec<f64>> =
            case["jacobian"].as_array().unwrap().iter().map(numbers).collect();
        let rank = case["rank"].as_u64().unwrap() as usize;
        let constrained = ColumnSpace::of(
            &Matrix::from_rows(&rows).unwrap().transpose(),
            Threshold::Relative(1e-9),
        );
        assert_eq!(
            (constrained.rank(), constrained.basis().rows() - rank),
            (rank, expected_dof),
            "{name}"
        );
        assert_eq!(ours.cols(), expected_dof, "{name}");
        // The sines of the angles between our motions and MuJoCo's.
        let sines = &constrained.basis().transpose() * &ours;
        assert!(sines.frobenius_norm() < ANGLE, "{name}: {:e}", sines.frobenius_norm());
        // What MuJoCo has too many rows is hyperstatic; couplings, which are no rows here, are not.
        let mobility = Mobility::of(&chain.constraint);
        assert_eq!(mobility.dof.dimension(), expected_dof, "{name}");
        assert_eq!(mobility.hyperstatic.dimension(), rows.len() - rank);
    }
}

/// Hinges, slides, a ball, free bodies; connect, weld and couplings, by bodies and by sites.
#[test]
fn motions_are_those_of_mujoco() {
    against_mujoco("loops", &read_mjcf(LOOPS).unwrap(), 12);
}

/// Fixed tendons over two and three joints, and two tendons that pull one another.
#[test]
fn tendons_over_several_joints_are_those_of_mujoco() {
    let m = read_mjcf(TENDONS).unwrap();
    against_mujoco("tendons", &m, 6);
    let names = |joints: &mut dyn Iterator<Item = &Joint>| -> Vec<String> {
        joints.map(|j| j.name.clone()).collect()
    };
    // Joints without motors follow.
    let mut following = m.joints().iter().filter(|j| j.mimic.is_some());
    assert_eq!(names(&mut following), ["middle", "middle+last", "tilt", "tilt+drum", "right"]);
    assert_eq!(m.actuated().count(), 2);
}

#[test]
fn couplings_that_cannot_be_followed_are_noted() {
    let couple = |equality: &str| {
        let bodies = "<body name='a'><joint name='i'/></body><body name='b'><joint name='j'/></body>\
                      <body name='c'><joint name='k' type='ball'/></body>\
                      <body name='d'><joint name='l' range='-1 1' armature='2'/></body>";
        let joints = |names: &[&str]| -> String {
            names.iter().map(|name| format!("<joint joint='{name}' coef='2'/>")).collect()
        };
        let tendon =
            |name: &str, own: &[&str]| format!("<fixed name='{name}'>{}</fixed>", joints(own));
        let tendons = format!(
            "<tendon>{}{}{}{}</tendon>",
            tendon("t", &["i", "j"]),
            tendon("u", &["i"]),
            tendon("v", &["i", "j", "k"]),
            tendon("w", &["i", "j", "l"])
        );
        let equality = format!("{tendons}<equality>{equality}</equality></mujoco>");
        read(&world(bodies).replace("</mujoco>", &equality))
    };
    for (equality, says) in [
        ("<joint joint1='i'/>", "without joint2"),
        ("<joint joint1='i' joint2='k'/>", "one coordinate"),
        ("<joint joint1='i' joint2='i'/>", "follow one another"),
        ("<joint joint1='i' joint2='j'/><joint joint1='j' joint2='i'/>", "follow one another"),
        ("<joint joint1='i' joint2='j'/><joint joint1='i' joint2='j'/>", "follows another one"),
        ("<flex flex='f'/>", "<flex> in <equality>"),
        ("<tendon tendon1='t'/><tendon tendon1='t'/>", "follows another one"),
        ("<tendon tendon1='u'/>", "only a fixed tendon over two joints"),
        ("<tendon tendon1='t' tendon2='u' polycoef='0 1 1 0 0'/>", "only linear couplings"),
        ("<tendon tendon1='w' tendon2='w'/>", "only a fixed tendon over two joints"),
        ("<tendon tendon1='v'/>", "only joints of one coordinate"),
        ("<tendon tendon1='w'/><tendon tendon1='w'/>", "or is followed already"),
        ("<tendon tendon1='w'/><joint joint1='l' joint2='j'/>", "a joint that follows several"),
        ("<joint joint1='j' joint2='i'/><tendon tendon1='w'/>", "range (l)"),
        ("<joint joint1='j' joint2='i'/><tendon tendon1='w'/>", "armature (l)"),
    ] {
        let m = couple(equality);
        assert!(report(&m).contains(says), "{equality}: {}", report(&m));
    }
}

/// All files of robosuite with equality constraints: loops, joints and tendons that tie joints.
#[test]
fn motions_of_grippers_are_those_of_mujoco() {
    for (name, dof) in [
        ("jaco_three_finger_gripper", 3),
        ("robotiq_gripper_140", 2),
        ("robotiq_gripper_s", 4),
        ("xarm7_gripper", 1),
    ] {
        let m = cylindroid::load_file(&robosuite().join(format!("grippers/{name}.xml"))).unwrap();
        against_mujoco(name, &m, dof);
    }
    let mut with_equality = Vec::new();
    for entry in std::fs::read_dir(robosuite().join("grippers")).unwrap() {
        let path = entry.unwrap().path();
        let text = std::fs::read_to_string(&path).unwrap_or_default();
        if text.contains("<equality") {
            with_equality.push(path.file_stem().unwrap().to_string_lossy().into_owned());
        }
    }
    assert_eq!(with_equality.len(), 4, "{with_equality:?}");
}
