//! The actuation map of closed chains, against the constraint matrices and positions.

use cylindroid::catalogue;
use cylindroid::closure::{ActuationMap, ClosedChain, MotionSpace, assemble};
use cylindroid::model::Mechanism;

use crate::support::Random;

fn assembled(mechanism: &Mechanism, random: &mut Random) -> Vec<f64> {
    let guess: Vec<f64> = mechanism.home().iter().map(|x| x + random.within(-0.1, 0.1)).collect();
    let found = assemble(mechanism, &guess, &[]).unwrap();
    assert!(found.closed);
    found.q
}

/// Counts are those of the constraint with the object: steered and left motions make up its
/// degrees of freedom. Unit y gives actuated rates of weighted length one, and projecting gives y
/// back.
#[test]
fn steering_agrees_with_the_constraint() {
    let mut random = Random(41);
    for name in catalogue::names() {
        let mechanism = catalogue::load(name).unwrap();
        let q = if mechanism.is_closed() {
            assembled(&mechanism, &mut random)
        } else {
            mechanism.home().to_vec()
        };
        let state = mechanism.state(&q).unwrap();
        let weights: Vec<f64> = (0..mechanism.n()).map(|_| random.within(0.2, 3.0)).collect();
        let steering = ActuationMap::of(&state, &weights, &[]).unwrap();
        let motions = MotionSpace::of(&ClosedChain::of(&state, None, None).unwrap().constraint);
        let (steered, left) = (steering.motions.cols(), steering.uncontrolled.cols());
        assert_eq!(steered + left, motions.dof(), "{name}");
        assert_eq!(steering.shares.len(), steered);
        let dimensions = motions.relation().dimensions();
        assert_eq!(steered, dimensions.coordinate + dimensions.redundancy, "{name}");
        for j in 0..steered {
            let y: Vec<f64> = (0..steered).map(|i| f64::from(u8::from(i == j))).collect();
            let rates = steering.joint_velocities(&y);
            let back = steering.project(&rates);
            for (a, b) in back.iter().zip(&y) {
                assert!((a - b).abs() < 1e-9, "{name}: {back:?}");
            }
        }
    }
}

/// Both parts keep the loops closed to second order, and a correction closes what is open.
#[test]
fn motions_keep_loops_and_corrections_close_them() {
    let mut random = Random(42);
    for name in ["four-bar", "five-bar", "3rrr", "stewart", "delta", "watt", "two-arm"] {
        let mechanism = catalogue::load(name).unwrap();
        let n = mechanism.n();
        let q = assembled(&mechanism, &mut random);
        let gap = |q: &[f64]| {
            let gap =
                ActuationMap::of(&mechanism.state(q).unwrap(), &[], &[]).unwrap().closure_error;
            gap.distance / mechanism.reach() + gap.angle
        };
        let steering = ActuationMap::of(&mechanism.state(&q).unwrap(), &[], &[]).unwrap();
        for m in [&steering.motions, &steering.uncontrolled] {
            for j in 0..m.cols() {
                let size = m.column(j).iter().map(|x| x * x).sum::<f64>().sqrt();
                let h = 1e-5 / size;
                let moved = mechanism.integrate(&q, &m.column(j)[..n], h).unwrap();
                assert!(gap(&moved) < 1e-8, "{name} {j}: {:e}", gap(&moved));
            }
        }
        let open: Vec<f64> = q.iter().map(|x| x + random.within(-1e-4, 1e-4)).collect();
        let steering = ActuationMap::of(&mechanism.state(&open).unwrap(), &[], &[]).unwrap();
        let closer = mechanism.integrate(&open, &steering.correction[..n], 1.0).unwrap();
        assert!(gap(&closer) < 1e-3 * gap(&open), "{name}: {:e}", gap(&closer));
    }
}

/// Locked coordinates stand still, and bad input is named.
#[test]
fn locks_and_bad_input() {
    let five_bar = catalogue::load("five-bar").unwrap();
    let state = five_bar.state(five_bar.home()).unwrap();
    let locked = ActuationMap::of(&state, &[], &[0]).unwrap();
    assert_eq!((locked.motions.cols(), locked.uncontrolled.cols()), (1, 0));
    assert!(locked.motions.column(0)[0].abs() < 1e-12);
    assert!(ActuationMap::of(&state, &[], &[4]).is_err());
    assert!(ActuationMap::of(&state, &[1.0], &[]).is_err());
    assert!(ActuationMap::of(&state, &[1.0, -1.0, 1.0, 1.0], &[]).is_err());
}
