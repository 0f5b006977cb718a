//! The graph beyond the tree: loop joints, contacts, their constraint wrenches, who is actuated.

use cylindroid::model::{
    ContactKind, ContactSpec, Dimension, Inclusion, JointKind, JointSpec, LoopJointSpec, Mimic,
};
use cylindroid::{Error, Mechanism, Pose, Twist, Vec3, Wrench};

use crate::support::Random;

fn kinds(random: &mut Random) -> Vec<JointKind> {
    vec![
        JointKind::Fixed,
        JointKind::Revolute,
        JointKind::Continuous,
        JointKind::Prismatic,
        JointKind::Helical { pitch: 0.3 },
        JointKind::Cylindrical,
        JointKind::Universal { second: random.vec3(1.0) },
        JointKind::Spherical,
        JointKind::Planar,
        JointKind::Free,
    ]
}

/// The twist of the motion of one coordinate at zero, by central differences (error 1e-10).
fn velocity(kind: JointKind, axis: Vec3, coordinate: usize) -> Twist {
    let h = 1e-5;
    let at = |x: f64| {
        let mut q = vec![0.0; kind.dof()];
        q[coordinate] = x;
        kind.transform(axis, &q)
    };
    let (a, b) = (at(-h), at(h));
    Twist {
        linear: (b.translation - a.translation) * (0.5 / h),
        angular: (b.rotation * a.rotation.inverse()).log() * (0.5 / h),
    }
}

fn independent(rows: &[Wrench]) -> bool {
    let columns: Vec<[f64; 6]> = rows.iter().map(|w| w.to_array()).collect();
    let mut m = cylindroid::Matrix::zeros(6, columns.len().max(1));
    for (j, c) in columns.iter().enumerate() {
        for i in 0..6 {
            m[(i, j)] = c[i];
        }
    }
    let svd = cylindroid::linalg::Svd::of(&m);
    rows.is_empty() || svd.rank(1e-9).rank == rows.len()
}

#[test]
fn held_rows_do_no_work_in_the_motion_and_fill_the_rest() {
    let mut random = Random(7);
    for _ in 0..20 {
        let axis = random.vec3(1.0);
        for kind in kinds(&mut random) {
            let wrenches = kind.constraint_wrenches(axis, Dimension::Spatial);
            assert_eq!(wrenches.len(), 6 - kind.dof(), "{kind:?}");
            assert!(independent(&wrenches), "{kind:?}");
            for c in 0..kind.dof() {
                let twist = velocity(kind, axis, c);
                for row in &wrenches {
                    assert!(twist.power(*row).abs() < 1e-8, "{kind:?} {c}: {row:?}");
                }
            }
        }
    }
}

#[test]
fn held_rows_in_the_plane_are_those_of_the_plane() {
    let mut random = Random(8);
    let mut slide = random.vec3(1.0);
    slide.z = 0.0;
    for (kind, axis, count) in [
        (JointKind::Revolute, Vec3::Z, 2),
        (JointKind::Prismatic, slide, 2),
        (JointKind::Fixed, Vec3::Z, 3),
        (JointKind::Planar, Vec3::Z, 0),
    ] {
        let wrenches = kind.constraint_wrenches(axis, Dimension::Planar);
        assert_eq!(wrenches.len(), count, "{kind:?}");
        assert!(independent(&wrenches));
        for row in &wrenches {
            assert_eq!([row.force.z, row.moment.x, row.moment.y], [0.0; 3], "{kind:?}");
            for c in 0..kind.dof() {
                assert!(velocity(kind, axis, c).power(*row).abs() < 1e-9, "{kind:?}");
            }
        }
    }
}

/// The counts of table 1, in space and in the plane.
#[test]
fn held_by_contacts() {
    let counts = [(1, 1), (3, 2), (4, 2), (2, 2), (5, 3), (3, 2), (6, 3)];
    for (kind, (spatial, planar)) in ContactKind::ALL.into_iter().zip(counts) {
        assert_eq!(kind.constraint_wrenches(Dimension::Spatial).len(), spatial, "{}", kind.name());
        assert_eq!(kind.constraint_wrenches(Dimension::Planar).len(), planar, "{}", kind.name());
        assert_eq!(ContactKind::parse(kind.name()).unwrap(), kind);
    }
    // A line along x with friction rolls about x and does nothing else.
    let roll = Twist { linear: Vec3::ZERO, angular: Vec3::X };
    let line = ContactKind::LineFriction.constraint_wrenches(Dimension::Spatial);
    assert!(line.iter().all(|w| roll.power(*w) == 0.0));
    let error = ContactKind::parse("soft").unwrap_err().to_string();
    assert!(error.contains("nearest: soft_finger"), "{error}");
}

/// `motion` is what the kinematics does with a joint, at any configuration.
#[test]
fn motion_is_that_of_the_kinematics() {
    let mut random = Random(9);
    for (kind, reversed) in kinds(&mut random).into_iter().flat_map(|k| [(k, false), (k, true)]) {
        let (axis, parent_from_joint, joint_from_child) =
            (random.vec3(1.0), random.pose(), random.pose());
        let mut b = Mechanism::builder("one");
        b.joint(JointSpec {
            axis,
            parent_from_joint,
            joint_from_child,
            reversed,
            ..JointSpec::new("j", kind, "base", "link")
        });
        let m = b.build().unwrap();
        let q: Vec<f64> = (0..m.n()).map(|_| random.vec3(1.0).x).collect();
        let state = m.state(&q).unwrap();
        let link = state.pose(m.frame("link").unwrap()).unwrap();
        let motion = kind.transform(axis, &q);
        let motion = if reversed { motion.inverse() } else { motion };
        let expected = parent_from_joint * motion * joint_from_child;
        let error = expected.error_to(link);
        assert!(error.linear.norm() < 1e-14 && error.angular.norm() < 1e-14, "{kind:?}");
    }
}

/// Five bars: four joints of the tree and one that closes it.
fn five_bar() -> Mechanism {
    let mut b = Mechanism::builder("five-bar");
    let links = ["ground", "a", "b", "c", "d"];
    for (i, pair) in links.windows(2).enumerate() {
        b.joint(JointSpec {
            parent_from_joint: Pose::from_translation(Vec3::X * f64::from(u8::from(i > 0))),
            actuated: i < 2,
            ..JointSpec::new(&format!("q{}", i + 1), JointKind::Revolute, pair[0], pair[1])
        });
    }
    b.dimension(Dimension::Planar);
    b.loop_joint(LoopJointSpec {
        link_a_from_joint: Pose::from_translation(Vec3::X),
        link_b_from_joint: Pose::from_translation(Vec3::X * 4.0),
        ..LoopJointSpec::new("q5", JointKind::Revolute, "d", "ground")
    });
    b.contact(ContactSpec {
        friction: Some(0.5),
        ..ContactSpec::new("touch", ContactKind::HardFinger, "b", "d")
    });
    b.build().unwrap()
}

#[test]
fn loops_and_contacts_stand_beside_the_tree() {
    let m = five_bar();
    assert_eq!((m.n(), m.loops().len(), m.contacts().len()), (4, 1, 1));
    assert!(m.is_closed());
    let closing = &m.loops()[0];
    let names = [closing.a, closing.b].map(|i| m.links()[i].name.clone());
    assert_eq!(names, ["d", "ground"]);
    assert_eq!(m.contacts()[0].friction, Some(0.5));
    assert_eq!(m.dimension().number(), 2);
    assert_eq!(m.actuated().collect::<Vec<_>>(), [0, 1]);
}

#[test]
fn actuation_may_be_chosen_anew() {
    let m = five_bar().with_actuated(&["q1", "q5"]).unwrap();
    assert_eq!(m.actuated().collect::<Vec<_>>(), [0]);
    assert!(m.loops()[0].actuated && m.joints()[0].actuated && !m.joints()[1].actuated);
    let none = m.with_actuated::<&str>(&[]).unwrap();
    assert!(none.actuated().next().is_none() && !none.loops()[0].actuated);
    let error = m.with_actuated(&["q6"]).unwrap_err().to_string();
    assert!(error.contains("no joint named 'q6'; nearest: q"), "{error}");
    for twice in [["q1", "q1"], ["q5", "q5"]] {
        let error = m.with_actuated(&twice).unwrap_err().to_string();
        assert!(error.contains(twice[0]) && error.contains("named twice"), "{error}");
    }

    let mut b = Mechanism::builder("mimic");
    b.joint(JointSpec::new("lead", JointKind::Universal { second: Vec3::X }, "base", "a"));
    b.joint(JointSpec::new("slide", JointKind::Prismatic, "a", "b"));
    let mimic = Some(Mimic { joint: "slide".into(), multiplier: 1.0, offset: 0.0 });
    b.joint(JointSpec { mimic, ..JointSpec::new("follow", JointKind::Prismatic, "b", "c") });
    b.joint(JointSpec::new("weld", JointKind::Fixed, "c", "d"));
    let m = b.build().unwrap();
    assert_eq!(m.actuated().count(), 3);
    assert_eq!(m.with_actuated(&["lead"]).unwrap().actuated().collect::<Vec<_>>(), [0, 1]);
    assert_eq!(m.with_actuated(&["lead.second"]).unwrap().actuated().collect::<Vec<_>>(), [1]);
    assert!(m.with_actuated(&["follow"]).unwrap_err().to_string().contains("follows 'slide'"));
    assert!(m.with_actuated(&["weld"]).unwrap_err().to_string().contains("it is fixed"));
}

#[test]
fn what_does_not_fit_is_refused_with_a_reason() {
    let refused = |add: &dyn Fn(&mut cylindroid::model::Builder), says: &str| {
        let mut b = Mechanism::builder("m");
        b.joint(JointSpec::new("j", JointKind::Revolute, "base", "arm"));
        add(&mut b);
        let error = b.build().unwrap_err();
        assert!(matches!(error, Error::Model { .. }), "{error:?}");
        assert!(error.to_string().contains(says), "{error}");
    };
    let spherical =
        |name: &str, a: &str, b: &str| LoopJointSpec::new(name, JointKind::Spherical, a, b);
    refused(
        &|b| _ = b.loop_joint(spherical("l", "amr", "base")),
        "no link named 'amr'; nearest: arm",
    );
    refused(&|b| _ = b.loop_joint(spherical("l", "arm", "arm")), "link 'arm' with itself");
    refused(&|b| _ = b.loop_joint(spherical("j", "arm", "base")), "named 'j'");
    refused(&|b| _ = b.loop_joint(spherical("", "arm", "base")), "no name");
    let touch = |kind| ContactSpec::new("c", kind, "arm", "base");
    refused(
        &|b| _ = b.contact(ContactSpec { b: "box".into(), ..touch(ContactKind::Complete) }),
        "contact 'c': no link named 'box'",
    );
    refused(
        &|b| {
            b.contact(ContactSpec { friction: Some(-1.0), ..touch(ContactKind::Complete) });
        },
        "friction of contact 'c'",
    );
    refused(
        &|b| _ = b.dimension(Dimension::Planar).contact(touch(ContactKind::PlaneFrictionless)),
        "line_frictionless",
    );
    refused(
        &|b| _ = b.dimension(Dimension::Planar).loop_joint(spherical("l", "arm", "base")),
        "leaves the plane",
    );
    refused(&|b| _ = b.start("j", &[1.0, 2.0]), "start of joint 'j' has 2 entries");
    refused(&|b| _ = b.reference("amr"), "the reference: no frame named 'amr'; nearest: arm");
}

/// An included mechanism moves as it does alone, from its start.
#[test]
fn an_included_mechanism_keeps_its_kinematics() {
    let alone = cylindroid::load("ur5e").unwrap();
    let mut random = Random(11);
    let q: Vec<f64> = (0..6).map(|_| random.vec3(1.0).x).collect();
    let parent_from_root = random.pose();
    let mut b = Mechanism::builder("cell");
    b.joint(JointSpec::new("track", JointKind::Prismatic, "ground", "cart"));
    let how = Inclusion { name: "arm", parent: "cart", parent_from_root, free: false, start: &q };
    b.include(&alone, how).unwrap();
    let m = b.build().unwrap();
    assert_eq!(m.home()[1..], q);
    let mut at = q.clone();
    at.insert(0, 0.25);
    let tool = m.state(&at).unwrap().pose(m.frame("arm/tool0").unwrap()).unwrap();
    let expected = Pose::from_translation(Vec3::Z * 0.25)
        * parent_from_root
        * alone.state(&q).unwrap().pose(alone.tool()).unwrap();
    let error = expected.error_to(tool);
    assert!(error.linear.norm() < 1e-14 && error.angular.norm() < 1e-14);
    let wrong = Inclusion { start: &[0.0], ..how };
    assert!(Mechanism::builder("x").include(&alone, wrong).is_err());
}
