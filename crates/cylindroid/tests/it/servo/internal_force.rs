//! Squeezing an object between arms.

use cylindroid::catalogue;
use cylindroid::closure::{ActuationMap, ClosedChain, MotionSpace, assemble};
use cylindroid::control::InternalForceController;

/// Two arms with springs in their joints hold a box: commanded positions theta, true ones where the
/// energy of the springs is least with all loops closed. The internal torques go to their
/// set-point as exp(-gain t), and the box stays where it is.
#[test]
fn two_arms_squeeze_a_box_that_rests() {
    let two_arm = catalogue::load("two-arm").unwrap();
    let n = two_arm.n();
    let stiffness: Vec<f64> =
        (0..n).map(|i| if i < 14 { 5e3 + 700.0 * i as f64 } else { 1.0 }).collect();
    let drives: Vec<usize> = (0..n).filter(|&i| two_arm.coordinates()[i].actuated).collect();
    assert_eq!(drives.len(), 14);
    let mut q = assemble(&two_arm, two_arm.home(), &[]).unwrap().q;
    let mut theta = q.clone();
    let of_drives = |x: &[f64]| drives.iter().map(|&i| x[i]).collect::<Vec<f64>>();
    let law = InternalForceController::new(10.0, &of_drives(&stiffness)).unwrap();
    let desired: Vec<f64> = (0..14).map(|i| 8.0 * f64::from(i).sin()).collect();
    let before = two_arm.state(&q).unwrap().pose(two_arm.reference()).unwrap();
    let (dt, mut first) = (0.01_f64, None);
    for step in 0..150 {
        let chain = ClosedChain::of(&two_arm.state(&q).unwrap(), None, None).unwrap();
        let relation = MotionSpace::of(&chain.constraint).relation();
        assert_eq!(relation.dimensions().internal, 6);
        let torques: Vec<f64> = drives.iter().map(|&i| stiffness[i] * (theta[i] - q[i])).collect();
        let command = law.command(&relation, &desired, &torques).unwrap();
        let error = command.error.iter().map(|e| e * e).sum::<f64>().sqrt();
        let start = *first.get_or_insert(error);
        let ideal = (1.0 - 10.0 * dt).powi(step);
        // The springs give way by milliradians, and the set-point turns with the box by as much.
        assert!((error / start - ideal).abs() < 1e-2, "step {step}: {error} of {start}, {ideal}");
        for (&i, rate) in drives.iter().zip(&command.joint_velocities) {
            theta[i] += rate * dt;
        }
        // Equilibrium: least energy on the loops.
        for _ in 0..10 {
            let state = two_arm.state(&q).unwrap();
            let steering = ActuationMap::of(&state, &stiffness, &[]).unwrap();
            let way: Vec<f64> = theta.iter().zip(&q).map(|(t, q)| t - q).collect();
            let moved = steering.joint_velocities(&steering.project(&way));
            let change: Vec<f64> =
                moved.iter().zip(&steering.correction).map(|(m, c)| m + c).collect();
            q = two_arm.integrate(&q, &change, 1.0).unwrap();
        }
        // The balance of a box without a load: the torques do no work on any motion.
        let exerted: Vec<f64> = drives.iter().map(|&i| stiffness[i] * (theta[i] - q[i])).collect();
        let motions = relation.motions();
        let attained = [&motions.joint, &motions.zero];
        for m in attained {
            for j in 0..m.cols() {
                let work: f64 = m.column(j).iter().zip(&exerted).map(|(x, t)| x * t).sum();
                assert!(work.abs() < 0.05, "{work}");
            }
        }
    }
    let after = two_arm.state(&q).unwrap().pose(two_arm.reference()).unwrap();
    let moved = (after.translation - before.translation).norm();
    let most = drives.iter().map(|&i| (theta[i] - q[i]).abs()).fold(0.0, f64::max);
    println!("squeezed by up to {most:.1e} rad, the box moved by {moved:.1e} m");
    assert!(most > 5e-4 && moved < 1e-2 * most, "{moved:e} of {most:e}");
}

/// A mechanism that cannot be squeezed gets no rates; wrong sizes and numbers are refused.
#[test]
fn no_internal_torques_no_rates() {
    let five_bar = catalogue::load("five-bar").unwrap();
    let state = five_bar.state(five_bar.home()).unwrap();
    let relation =
        MotionSpace::of(&ClosedChain::of(&state, None, None).unwrap().constraint).relation();
    let law = InternalForceController::new(1.0, &[100.0, 200.0]).unwrap();
    let command = law.command(&relation, &[1.0, 2.0], &[0.0, 0.0]).unwrap();
    assert_eq!(command.joint_velocities, [0.0, 0.0]);
    assert!(law.command(&relation, &[1.0], &[0.0, 0.0]).is_err());
    assert!(law.command(&relation, &[1.0, f64::NAN], &[0.0, 0.0]).is_err());
    assert!(InternalForceController::new(0.0, &[1.0]).is_err());
    assert!(InternalForceController::new(1.0, &[-1.0]).is_err());
}
