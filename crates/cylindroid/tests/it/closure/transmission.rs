//! Transmission indices.

use cylindroid::closure::{Diagnosis, LimbScrews, Transmission};
use cylindroid::{Mechanism, catalogue};

use crate::support::assert_close;

fn linkage(name: &str) -> Mechanism {
    let file = format!("{}/tests/data/linkages/{name}.toml", env!("CARGO_MANIFEST_DIR"));
    cylindroid::load(&file).unwrap()
}

fn transmission(m: &Mechanism, q: &[f64]) -> Option<Transmission> {
    let state = m.state(q).unwrap();
    let found = Diagnosis::of(&state, None, None).unwrap();
    let limbs = LimbScrews::of(&state, None, None).unwrap();
    Transmission::of(&limbs, &found.generic)
}

/// Of a planar limb of three revolute joints, the input index is the sine of the angle between
/// crank and coupler.
#[test]
fn planar_cranks_transmit_the_sine_of_their_angle() {
    let m = linkage("rrr_regular");
    let found = transmission(&m, m.home()).unwrap();
    let state = m.state(m.home()).unwrap();
    for actuator in &found.actuators {
        let at = |name: &str| {
            m.joints().iter().find(|j| j.name == name).map_or_else(
                || {
                    let l = m.loops().iter().find(|l| l.name == name).unwrap();
                    let pose = state.pose(m.frame(&m.links()[l.a].name).unwrap()).unwrap();
                    (pose * l.link_a_from_joint).translation
                },
                |j| {
                    let pose = state.pose(m.frame(&m.links()[j.parent].name).unwrap()).unwrap();
                    (pose * j.parent_from_joint).translation
                },
            )
        };
        let limbs = LimbScrews::of(&state, None, None).unwrap();
        let joints = &limbs.limbs[actuator.limb].joints;
        let [a, b, c] = [0, 1, 2].map(|i| at(&joints[i]));
        let (crank, coupler) = (b - a, c - b);
        let sine = crank.cross(coupler).norm() / (crank.norm() * coupler.norm());
        assert_close(&actuator.name, &[actuator.input.unwrap()], &[sine], 1e-9);
    }
}

#[test]
fn zeros_are_the_singularities() {
    // Three concurrent coupler lines, a platform turned by 90 degrees, a flat rocker.
    for name in ["rrr_RO_concurrent", "fichter_1.571", "fb_dead_rocker", "arch_similar"] {
        let m = linkage(name);
        let found = transmission(&m, m.home()).unwrap();
        assert!(found.actuators.iter().all(|a| a.output == Some(0.0)), "{name}: {found:?}");
        assert_eq!(found.local, Some(0.0), "{name}");
    }
    let m = linkage("fb_dead_crank");
    let found = transmission(&m, m.home()).unwrap();
    assert_eq!((found.actuators[0].input, found.local), (Some(0.0), Some(0.0)));
    for name in ["rrr_regular", "fichter_1.200", "agile_eye_home", "tricept", "upu_tsai"] {
        let m = linkage(name);
        let found = transmission(&m, m.home()).unwrap();
        assert!(found.local.is_some_and(|x| x > 0.01 && x <= 1.0), "{name}: {found:?}");
        assert!(found.constraint.is_none_or(|x| x > 0.0), "{name}: {found:?}");
    }
    // The platform of the 3-UPU at its constraint singularity rotates with locked legs.
    let m = linkage("upu_snu");
    assert_eq!(transmission(&m, m.home()).unwrap().constraint, Some(0.0));
    // Chablat & Wenger 2003: at its isotropic home each slide pushes along itself.
    let m = linkage("orthoglide");
    let found = transmission(&m, m.home()).unwrap();
    for actuator in &found.actuators {
        assert_close("orthoglide", &[actuator.input.unwrap()], &[1.0], 1e-9);
        assert_close("orthoglide", &[actuator.output.unwrap()], &[1.0], 1e-9);
    }
    assert_close("orthoglide", &[found.local.unwrap()], &[1.0], 1e-9);
    // The distance and the index vanish together: a delta in its catalogue pose is regular.
    let m = catalogue::load("delta").unwrap();
    let found = transmission(&m, m.home()).unwrap();
    assert!(found.local.is_none_or(|x| x > 0.1), "{found:?}");
}

#[test]
fn where_there_is_none() {
    for name in ["ur5e", "two-arm"] {
        let m = catalogue::load(name).unwrap();
        assert_eq!(transmission(&m, m.home()), None, "{name}");
    }
}
