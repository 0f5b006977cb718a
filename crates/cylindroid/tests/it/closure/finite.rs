//! Motions to first order and motions that exist.

use cylindroid::closure::{ClosedChain, FiniteMobility, Mobility, MobilityEvidence, assemble};
use cylindroid::model::{Dimension, JointKind, JointSpec, LoopJointSpec};
use cylindroid::screws::Line;
use cylindroid::spatial::{Pose, Vec3};
use cylindroid::{Matrix, Mechanism, catalogue};

use super::rings::{bennett, flat, ring};
use crate::support::assert_close;

fn at_home(m: &Mechanism) -> FiniteMobility {
    FiniteMobility::of(&m.state(m.home()).unwrap(), None).unwrap()
}

fn gruebler_kutzbach(m: &Mechanism) -> i64 {
    let chain = ClosedChain::of(&m.state(m.home()).unwrap(), None, None).unwrap();
    Mobility::of(&chain.constraint).gruebler_kutzbach
}

/// A motion scaled to 1 in its first entry.
fn by_the_first(motions: &Matrix) -> Vec<f64> {
    assert_eq!(motions.cols(), 1);
    motions.column(0).iter().map(|x| x / motions[(0, 0)]).collect()
}

#[test]
fn ordinary_mechanisms_move_as_they_say() {
    for (name, dof) in [
        ("four-bar", 1),
        ("five-bar", 2),
        ("3rrr", 3),
        ("stewart", 6),
        ("watt", 1),
        ("delta", 3),
        ("two-arm", 8),
        ("panda", 7),
    ] {
        let found = at_home(&catalogue::load(name).unwrap());
        assert_eq!((found.infinitesimal, found.finite), (dof, Some(dof)), "{name}");
        assert!(found.is_ordinary() && found.certain, "{name}: {found:?}");
        assert_eq!(found.evidence, MobilityEvidence::Independent, "{name}");
        assert_eq!((found.branches.len(), found.shaky.cols()), (1, 0), "{name}");
    }
}

/// Two links in line, pinned at both ends: the middle gives and does not move.
#[test]
fn a_stretched_pair_of_links_is_shaky() {
    let found = at_home(&ring("pair", &flat(&[0.0, 1.0, 2.0]), Dimension::Planar));
    assert_eq!((found.infinitesimal, found.finite), (1, Some(0)));
    assert!(
        found.certain && found.evidence == MobilityEvidence::Opens && found.branches.is_empty()
    );
    // The middle joint moves across: the second link turns back twice as fast.
    assert_close("shaky", &by_the_first(&found.shaky), &[1.0, -2.0], 1e-12);
    assert!(found.residual > 1e-6 && found.contact_order == Some(2), "{found:?}");
    // Folded back, it turns about the pins as one.
    let folded = at_home(&ring("folded", &flat(&[0.0, 1.0, 0.0]), Dimension::Planar));
    assert_eq!((folded.infinitesimal, folded.finite), (1, Some(1)));
    assert!(folded.certain && folded.evidence == MobilityEvidence::Tracked, "{folded:?}");
    // Bent, it is a triangle.
    let mut axes = flat(&[0.0, 1.0, 2.0]);
    axes[1].point.y = 0.2;
    let bent = at_home(&ring("triangle", &axes, Dimension::Planar));
    assert_eq!((bent.infinitesimal, bent.finite, bent.certain), (0, Some(0), true));
}

/// The stretched pair on a turntable: shaky in every configuration, and still one finite motion.
#[test]
fn a_shaky_part_on_a_turntable() {
    let mut b = Mechanism::builder("turntable");
    b.dimension(Dimension::Planar);
    let at = |x: f64| Pose::from_translation(Vec3::new(x, 0.0, 0.0));
    for (name, parent, child, x) in
        [("q1", "ground", "table", 0.3), ("q2", "table", "a", 0.5), ("q3", "a", "b", 1.0)]
    {
        b.joint(JointSpec {
            parent_from_joint: at(x),
            ..JointSpec::new(name, JointKind::Revolute, parent, child)
        });
    }
    b.loop_joint(LoopJointSpec {
        link_a_from_joint: at(1.0),
        link_b_from_joint: at(2.5),
        ..LoopJointSpec::new("q4", JointKind::Revolute, "b", "table")
    });
    let found = at_home(&b.build().unwrap());
    assert_eq!((found.infinitesimal, found.finite), (2, Some(1)), "{found:?}");
    assert!(!found.certain, "a search");
    assert_close("table", &by_the_first(&found.branches[0].motions), &[1.0, 0.0, 0.0], 1e-4);
    assert_eq!(found.shaky.cols(), 1);
}

/// A parallelogram in line: as a parallelogram and crossed, one motion each, and no sum of them.
#[test]
fn a_folded_parallelogram_goes_two_ways() {
    let found = at_home(&ring("folded", &flat(&[0.0, 1.0, 3.0, 2.0]), Dimension::Planar));
    assert_eq!((found.infinitesimal, found.finite), (2, Some(1)));
    assert!(found.certain && found.shaky.cols() == 0, "{found:?}");
    let mut ways: Vec<Vec<f64>> = found.branches.iter().map(|b| by_the_first(&b.motions)).collect();
    ways.sort_by(|a, b| a[1].total_cmp(&b[1]));
    assert_eq!(ways.len(), 2);
    // Crossed: the rocker turns back three times as fast as the crank.
    assert_close("crossed", &ways[0], &[1.0, -3.0, -1.0], 1e-6);
    assert_close("parallel", &ways[1], &[1.0, -1.0, 1.0], 1e-6);
    // The same linkage in space, where three more equations are superfluous.
    let found = at_home(&ring("folded", &flat(&[0.0, 1.0, 3.0, 2.0]), Dimension::Spatial));
    assert_eq!((found.infinitesimal, found.finite, found.branches.len()), (2, Some(1), 2));
    assert!(found.certain);
}

/// Five joints in line: stretched to the last nothing moves; folded the closed configurations form a
/// cone.
#[test]
fn quadrics_are_told_by_their_signs() {
    let stretched = at_home(&ring("five", &flat(&[0.0, 1.0, 2.0, 3.0, 4.0]), Dimension::Planar));
    assert_eq!((stretched.infinitesimal, stretched.finite), (3, Some(0)));
    assert!(stretched.certain && stretched.shaky.cols() == 3, "{stretched:?}");
    let folded = at_home(&ring("five", &flat(&[0.0, 2.0, 1.0, 2.5, 1.5]), Dimension::Planar));
    assert_eq!((folded.infinitesimal, folded.finite), (3, Some(2)), "{folded:?}");
    assert!(folded.certain && folded.shaky.cols() == 0);
}

/// Loops that Grubler's formula calls overconstrained three times, and that move.
#[test]
fn overconstrained_loops_move() {
    let mut axes = flat(&[0.0, 0.0, 2.0, 2.0]);
    axes[1].point.y = 1.0;
    axes[2].point.y = 1.5;
    let four_bar = ring("four-bar", &axes, Dimension::Spatial);
    let spatial = at_home(&four_bar);
    assert_eq!(gruebler_kutzbach(&four_bar), -2);
    assert_eq!((spatial.infinitesimal, spatial.finite), (1, Some(1)));
    assert_eq!(spatial.evidence, MobilityEvidence::Tracked);
    assert!(spatial.certain && spatial.residual < 1e-13, "{spatial:?}");
    // With one axis out of line it is a structure.
    axes[2].direction = Vec3::new(0.0, 0.01, 1.0).unit(0.0).unwrap();
    let tilted = at_home(&ring("tilted", &axes, Dimension::Spatial));
    assert_eq!((tilted.infinitesimal, tilted.finite, tilted.certain), (0, Some(0), true));

    let linkage = ring("bennett", &bennett(1.0), Dimension::Spatial);
    let found = at_home(&linkage);
    assert_eq!(gruebler_kutzbach(&linkage), -2);
    assert_eq!((found.infinitesimal, found.finite), (1, Some(1)));
    assert!(found.certain && found.evidence == MobilityEvidence::Tracked, "{found:?}");
    // A link a little longer, and it stands.
    let mut axes = bennett(1.0);
    axes[3].point = axes[3].point * 1.01;
    let broken = at_home(&ring("broken", &axes, Dimension::Spatial));
    assert_eq!((broken.infinitesimal, broken.finite), (0, Some(0)));
    // Far from home the same linkage closes again, to rounding and in Newton's few steps.
    for turn in [-0.8, -0.3, 0.4, 1.0] {
        let mut q = linkage.home().to_vec();
        q[0] = turn;
        let closed = assemble(&linkage, &q, &[0]).unwrap();
        assert!(closed.closed && closed.steps < 12, "{turn}: {closed:?}");
        let state = linkage.state(&closed.q).unwrap();
        let there = FiniteMobility::of(&state, None).unwrap();
        assert_eq!((there.infinitesimal, there.finite), (1, Some(1)), "{turn}");
    }
}

/// Two axes of three meet in a point of a sphere: shaky where all lie in one plane.
#[test]
fn a_spherical_triangle_in_a_plane_is_shaky() {
    let through = |angle: f64| Line {
        point: Vec3::ZERO,
        direction: Vec3::new(angle.cos(), angle.sin(), 0.0),
    };
    let axes = [through(0.0), through(0.5), through(1.2)];
    let found = at_home(&ring("spherical", &axes, Dimension::Spatial));
    assert_eq!((found.infinitesimal, found.finite), (1, Some(0)), "{found:?}");
    assert!(found.certain);
}

#[test]
fn open_loops_say_nothing() {
    let five_bar = catalogue::load("five-bar").unwrap();
    let found = FiniteMobility::of(&five_bar.state(&[0.3, 0.0, 0.0, 0.0]).unwrap(), None).unwrap();
    assert_eq!(
        (found.finite, found.evidence, found.certain),
        (None, MobilityEvidence::Unknown, false)
    );
    let state = five_bar.state(five_bar.home()).unwrap();
    assert!(FiniteMobility::of(&state, Some(0.0)).is_err());
    assert!(FiniteMobility::of(&state, Some(f64::NAN)).is_err());
}
