//! Closing loops from a guess.

use cylindroid::catalogue;
use cylindroid::closure::{
    ClosedChain, Mode, ModeOptions, assemble, assembly_modes, recover_passive,
};

use super::linkage::{circles, linkage, place};
use crate::support::{Random, assert_close};

/// Near its home every closed chain of the catalogue closes to rounding, in a few steps.
#[test]
fn the_catalogue_closes_near_home() {
    let mut random = Random(91);
    for name in catalogue::names() {
        let mechanism = catalogue::load(name).unwrap();
        if !mechanism.is_closed() {
            continue;
        }
        for _ in 0..20 {
            let guess: Vec<f64> =
                mechanism.home().iter().map(|x| x + random.within(-0.1, 0.1)).collect();
            let found = assemble(&mechanism, &guess, &[]).unwrap();
            assert!(found.closed && found.steps < 30, "{name}: {found:?}");
            let chain = ClosedChain::of(&mechanism.state(&found.q).unwrap(), None, None).unwrap();
            assert!(
                chain.closure_error.distance < 1e-10 * mechanism.reach()
                    && chain.closure_error.angle < 1e-10
            );
        }
    }
}

/// The five-bar with both cranks given: circles about the ends of the cranks meet at the coupler.
#[test]
fn five_bar_as_circles_meet() {
    let five_bar = catalogue::load("five-bar").unwrap();
    let coupler = five_bar.frame("rod").unwrap();
    for turn in [0.0, 0.1, 0.25] {
        let found = assemble(&five_bar, &[turn, 0.0, 0.0, 0.0], &[0]).unwrap();
        assert!(found.closed, "{found:?}");
        assert_eq!(found.q[0], turn);
        // Joint q3 is one link of length 1 from q2 and one of sqrt 2 from q4.
        let state = five_bar.state(&found.q).unwrap();
        let q3 = state.pose(coupler).unwrap().translation;
        let q2 = state.pose(five_bar.frame("coupler").unwrap()).unwrap().translation;
        assert!(((q3 - q2).norm() - 1.0).abs() < 1e-9);
        assert!((q2.norm() - 2.0).abs() < 1e-9);
    }
}

/// Cranks turned apart so far that the links cannot meet: said, with the gap that remains.
#[test]
fn what_cannot_be_assembled_is_not() {
    let five_bar = catalogue::load("five-bar").unwrap();
    // The first crank points away from the other ground joint: 4 m apart, 1 + sqrt 2 + 1 m long.
    let found = assemble(&five_bar, &[std::f64::consts::FRAC_PI_2, 0.0, 0.0, 0.0], &[0]).unwrap();
    assert!(!found.closed && found.closure_error.distance > 0.1, "{found:?}");
    assert_eq!(found.q[0], std::f64::consts::FRAC_PI_2);
    // All prescribed: nothing to do but to say how far it is open.
    let stuck = assemble(&five_bar, &[0.3, 0.0, 0.0, 0.0], &[0, 1, 2, 3]).unwrap();
    assert!(!stuck.closed && stuck.q == [0.3, 0.0, 0.0, 0.0]);
    assert!(assemble(&five_bar, &[0.0; 4], &[4]).is_err());
    assert!(assemble(&five_bar, &[0.0; 3], &[]).is_err());
    // A tree is closed as it is.
    let panda = catalogue::load("panda").unwrap();
    let same = assemble(&panda, panda.home(), &[]).unwrap();
    assert!(same.closed && same.steps == 0 && same.q == panda.home());
}

/// Limits in all legs, arms or joints, guesses anywhere within them: coordinates that push against
/// theirs do not hold up the others. (Cut to the limits alone, 1, 35 and 29 of 60 closed. Of 1000
/// starts of the two arms 93 to 94 % close, with every draw that was tried.)
#[test]
fn limits_do_not_hold_up_the_search() {
    for (name, least) in [("stewart", 200), ("delta", 198), ("two-arm", 180)] {
        let mechanism = catalogue::load(name).unwrap();
        let options = ModeOptions { starts: 200, seed: 0 };
        let found = assembly_modes(&mechanism, mechanism.home(), &[], options).unwrap();
        assert!(found.closed >= least, "{name}: {}", found.closed);
        let within = |m: &Mode| mechanism.outside_limits(&m.assembly.q).next().is_none();
        assert!(found.modes.iter().all(within));
    }
}

/// Where a guess is beyond a limit and closed, it is not torn open: the limit is named.
#[test]
fn a_closed_guess_beyond_a_limit_is_said() {
    let five_bar = linkage(
        "",
        &[
            ("q1", ["ground", "crank"], [0.0, 0.0], "actuated = true"),
            ("q2", ["crank", "coupler"], [0.0, 2.0], ""),
            ("q3", ["coupler", "rod"], [1.0, 2.0], "limits = { lower = 0.2, upper = 2.0 }"),
            ("q4", ["rod", "rocker"], [2.0, 1.0], ""),
            ("q5", ["rocker", "ground"], [2.0, 0.0], ""),
        ],
    );
    let place = place(&five_bar, "q3");
    let found = assemble(&five_bar, &[0.0; 4], &[]).unwrap();
    assert!(found.closed && found.at_limit == [place] && found.q[place].abs() < 1e-9, "{found:?}");
    // From a guess that is open they are kept.
    let found = assemble(&five_bar, &[-0.1, 0.0, 0.0, 0.0], &[]).unwrap();
    assert!(found.closed && found.q[place] >= 0.2, "{found:?}");
}

/// A part of a ball joint cannot be prescribed: its numbers mean nothing one by one.
#[test]
fn balls_are_held_as_a_whole() {
    let stewart = catalogue::load("stewart").unwrap();
    let ball = stewart.coordinates().iter().position(|c| c.name.starts_with("s1")).unwrap();
    let refused = assemble(&stewart, stewart.home(), &[ball]).unwrap_err().to_string();
    assert!(refused.contains("prescribe all"), "{refused}");
    let whole = assemble(&stewart, stewart.home(), &[ball, ball + 1, ball + 2]).unwrap();
    assert_close("platform at home", &whole.q, stewart.home(), 1e-12);
    assert_eq!(whole.q[ball..ball + 3], [0.0; 3]);
}

/// Passive joints for given actuators.
#[test]
fn passive_joints_follow_the_drives() {
    let four_bar = catalogue::load("four-bar").unwrap();
    let found = recover_passive(&four_bar, &[0.2, 0.0, 0.0]).unwrap();
    assert!(found.closed && found.q[0] == 0.2);
    let rocker = four_bar.state(&found.q).unwrap().pose(four_bar.frame("rocker").unwrap()).unwrap();
    let angle = 70_f64.to_radians() + 0.2;
    let [up, _] = circles([angle.cos(), angle.sin()], 1.8, [2.0, 0.0], 1.3).unwrap();
    assert_close("elbow", &rocker.translation.to_array()[..2], &up, 1e-9);
    // Three actuators on two degrees of freedom: what they leave open is said.
    let over = catalogue::load("five-bar").unwrap().with_actuated(&["q1", "q2", "q3"]).unwrap();
    let torn = recover_passive(&over, &[0.1, 0.0, 0.1, 0.0]).unwrap();
    assert!(!torn.closed && torn.closure_error.distance > 1e-3, "{torn:?}");
    assert_eq!(torn.q[..3], [0.1, 0.0, 0.1]);
    let home = recover_passive(&over, &[0.0; 4]).unwrap();
    assert!(home.closed && home.q == [0.0; 4]);
    // A drive that closes the loop has no coordinate: it prescribes nothing.
    let closing = catalogue::load("five-bar").unwrap().with_actuated(&["q5"]).unwrap();
    assert!(recover_passive(&closing, &[0.1, 0.1, 0.0, 0.0]).unwrap().closed);
}
