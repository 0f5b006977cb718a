//! Shared control: the operator has what the robot does not keep, and nothing else.

use super::hybrid::split;
use super::*;
use cylindroid::control::{
    AuthorityTimes, OperatorAuthority, Saturation, SharedController, SharedInput,
};
use cylindroid::kinematics::Chain;
use cylindroid::screws::{Complement, Projector as Split};
use cylindroid::spatial::exp;

/// [1/s]
const GAIN: f64 = 10.0;

fn turn(angular: Vec3) -> Twist {
    Twist { linear: Vec3::ZERO, angular }
}

/// A tool that looks at the centre of a sphere from outside, the world's axes at its tip.
#[derive(Clone, Copy)]
struct Sphere {
    center: Vec3,
    radius: f64,
}

impl Sphere {
    /// Turning about the centre is left to the operator; the robot pulls the tool back along the
    /// normal and tilts it about its tip.
    fn split(&self, pose: Pose) -> (Split, Twist) {
        let out = (pose.translation - self.center).unit(0.0).unwrap();
        let lever = pose.translation - self.center;
        let about = |w: Vec3| Twist { linear: w.cross(lever), angular: w };
        let free = [about(Vec3::X), about(Vec3::Y), about(Vec3::Z)];
        let across = Rotation::z_to(out).unwrap();
        let kept = [
            Twist { linear: out, angular: Vec3::ZERO },
            turn(across.x_axis()),
            turn(across.y_axis()),
        ];
        let error = Twist {
            linear: out * (self.radius - lever.norm()),
            angular: pose.rotation.z_axis().cross(-out),
        };
        (split(&free, Complement::Twists(&kept)), error)
    }

    fn off(&self, pose: Pose) -> (f64, f64) {
        let lever = pose.translation - self.center;
        let out = lever.unit(0.0).unwrap();
        ((lever.norm() - self.radius).abs(), pose.rotation.z_axis().cross(-out).norm())
    }
}

/// Whatever the operator wants: nothing of it leaves the surface, all of it that does not is done.
#[test]
fn the_operator_cannot_leave_the_surface() {
    let mut random = Random(11);
    let law = SharedController::new(GAIN).unwrap();
    for _ in 0..300 {
        let sphere = Sphere { center: random.vec3(0.5), radius: random.within(0.1, 0.5) };
        let z = Rotation::exp(random.vec3(3.0));
        let pose = Pose { rotation: z, translation: sphere.center - z.z_axis() * sphere.radius };
        let (split, error) = sphere.split(pose);
        let operator = random.twist() * 1e3;
        let command = law.command(&split, &SharedInput { error, operator, ..Default::default() });
        let command = command.unwrap();
        // Held for as long as one likes: turning about the centre.
        let at_tip = Pose::from_translation(pose.translation);
        let moved = at_tip * exp(command.operator_part * 1e-3) * at_tip.inverse() * pose;
        let (distance, angle) = sphere.off(moved);
        assert!(distance < 1e-13 && angle < 1e-12, "{distance:e} {angle:e}");
        assert!(command.robot_part.linear.norm() < 1e-12, "{:?}", command.robot_part);
        // The tip moves across the normal as the operator wants; the spin about it as well.
        let out = pose.rotation.z_axis();
        let desired = operator.linear - out * out.dot(operator.linear);
        assert!((command.twist.linear - desired).norm() < 1e-9, "{desired:?}");
        let spin = (command.twist.angular - operator.angular).dot(out);
        assert!(spin.abs() < 1e-9, "{spin}");
    }
}

/// Neither part is seen by the other, with h-reciprocal and with merely complementary systems, in
/// any frame.
#[test]
fn robot_and_operator_do_not_interfere() {
    let mut random = Random(12);
    let law = SharedController::new(GAIN).unwrap();
    let close = |a: Twist, b: Twist| {
        let size = 1.0 + b.linear.norm() + b.angular.norm();
        crate::support::assert_close("twist", &a.to_array(), &b.to_array(), 1e-10 * size);
    };
    for round in 0..300 {
        let order = 1 + round % 5;
        let free: Vec<Twist> = (0..order).map(|_| random.twist()).collect();
        let kept: Vec<Twist> = (order..6).map(|_| random.twist()).collect();
        let along = |kept| match round % 3 {
            0 => Complement::Twists(kept),
            1 => Complement::Reciprocal { h: 0.4 },
            _ => Complement::Reciprocal { h: f64::INFINITY },
        };
        let options = cylindroid::screws::ScrewOptions::with_length(0.5);
        let Ok(p) = Split::of(&free, along(&kept), &options).unwrap() else { continue };
        if p.norm() > 30.0 {
            continue;
        }
        let input = SharedInput {
            error: random.twist(),
            feed_forward: random.twist(),
            operator: random.twist(),
        };
        let command = law.command(&p, &input).unwrap();
        assert_eq!(command.twist, command.robot_part + command.operator_part);
        close(p.motion(command.robot_part), Twist::ZERO);
        close(p.rest(command.operator_part), Twist::ZERO);
        let with = |change: SharedInput| law.command(&p, &change).unwrap();
        let nobody = with(SharedInput { operator: Twist::ZERO, ..input });
        assert_eq!(nobody.twist, command.robot_part);
        // An error that the operator may choose is none.
        let elsewhere = with(SharedInput { error: input.error + free[0] * 3.0, ..input });
        close(elsewhere.twist, command.twist);
        // The operator's own motions pass unchanged.
        close(with(SharedInput { operator: free[0], ..input }).operator_part, free[0]);
        if let Complement::Reciprocal { h } = along(&kept) {
            for s in &free {
                let form = s.pitch_form(command.robot_part, h);
                assert!(form.abs() < 1e-9, "{form}");
            }
        }
        // Another frame, the same motion.
        let g = random.pose();
        let seen = |t: &[Twist]| t.iter().map(|t| g.adjoint(*t)).collect::<Vec<_>>();
        let kept = seen(&kept);
        let p = Split::of(&seen(&free), along(&kept), &options).unwrap().unwrap();
        let moved = SharedInput {
            error: g.adjoint(input.error),
            feed_forward: g.adjoint(input.feed_forward),
            operator: g.adjoint(input.operator),
        };
        close(g.inverse().adjoint(law.command(&p, &moved).unwrap().twist), command.twist);
    }
}

/// An arm with limits, an operator who pushes far too hard: the tool comes to the surface as fast
/// as with nobody at it, and stays there to the rounding of the steps.
#[test]
fn an_arm_keeps_the_surface() {
    let robot = catalogue::load("panda").unwrap();
    let law = SharedController::new(GAIN).unwrap();
    for (pushes, yields) in [(0.0, true), (0.1, true), (10.0, true), (10.0, false)] {
        let mut servo = servo(&robot, |_| {});
        let mut share =
            OperatorAuthority::new(AuthorityTimes { dt: 1e-3, fall: 0.1, rise: 0.5 }).unwrap();
        let mut chain = Chain::new(&robot, robot.tool()).unwrap();
        let mut q = robot.home().to_vec();
        let start = chain.set(&q);
        // Half a centimetre off and tilted by 0.05 rad.
        let rotation = start.rotation * Rotation::exp(Vec3::X * 0.05);
        let sphere = Sphere { center: start.translation + rotation.z_axis() * 0.205, radius: 0.2 };
        let (mut way, mut at_limits, mut last, mut fastest) = (0.0, 0, start, 0.0_f64);
        let (mut most_distant, mut most_tilted) = (0.0_f64, 0.0_f64);
        for step in 0..3000 {
            let t = f64::from(step) * 1e-3;
            let pose = chain.set(&q);
            let moved = (pose.translation - last.translation).norm();
            way += moved;
            fastest = fastest.max(moved / 1e-3);
            last = pose;
            if t >= 1.5 {
                let (distance, angle) = sphere.off(pose);
                (most_distant, most_tilted) = (most_distant.max(distance), most_tilted.max(angle));
            }
            let (split, error) = sphere.split(pose);
            let operator = Twist {
                linear: Vec3::new((2.0 * t).cos(), (2.0 * t).sin(), -3.0) * pushes,
                angular: Vec3::new(1.0, -2.0, (3.0 * t).sin()) * pushes,
            };
            let operator = operator * if yields { share.get() } else { 1.0 };
            let input = SharedInput { error, operator, ..SharedInput::default() };
            let command = law.command(&split, &input).unwrap();
            let target = Target { pose, feed_forward: command.twist };
            let done = servo.step(&q, target).unwrap();
            assert_ne!(done.status, Status::Stalled);
            share.update(done.saturation);
            at_limits += usize::from(done.saturation.direction_lost);
            servo.advance(&mut q);
        }
        println!(
            "operator {pushes}, yields {yields}: {way:.3} m at up to {fastest:.2} m/s, {at_limits} steps at limits, \
            at most {most_distant:.1e} m and {most_tilted:.1e} rad off"
        );
        // A step goes along the tangent: v^2 dt^2 / 2 r off, of which gain * dt is taken back.
        let step = fastest * fastest * 1e-3 / (2.0 * sphere.radius * GAIN);
        if pushes < 1.0 {
            assert_eq!(at_limits, 0);
            assert!(most_distant < 1e-8 + 2.0 * step, "{most_distant:e} {step:e}");
            assert!(most_tilted < 1e-7 + 4.0 * step / sphere.radius, "{most_tilted:e} {step:e}");
            assert!(pushes == 0.0 || way > 0.5, "{way}");
        } else {
            // Into the joint limits at thirty metres a second.
            assert!(at_limits > 0);
            if yields {
                assert!(most_distant < 1e-2 && most_tilted < 3e-2, "{most_distant:e}");
            } else {
                assert!(most_distant > 0.1, "the share is not needed: {most_distant:e}");
            }
        }
    }
}

#[test]
fn the_authority_of_the_operator() {
    let free = Saturation { scale: 1.0, direction_lost: false };
    let mut share =
        OperatorAuthority::new(AuthorityTimes { dt: 0.01, fall: 0.02, rise: 0.1 }).unwrap();
    assert_eq!(share.get(), 0.0);
    for _ in 0..20 {
        share.update(free);
    }
    assert_eq!(share.get(), 1.0);
    share.update(Saturation { scale: 0.9, ..free });
    share.update(Saturation { direction_lost: true, ..free });
    assert!((share.get() - (-1.0_f64).exp()).abs() < 1e-15);
    let refused = |dt, fall, rise| {
        OperatorAuthority::new(AuthorityTimes { dt, fall, rise }).unwrap_err().to_string()
    };
    assert!(refused(0.0, 1.0, 1.0).contains("dt"));
    assert!(refused(1.0, -1.0, 1.0).contains("fall"));
    assert!(refused(1.0, 1.0, f64::NAN).contains("rise"));
}

#[test]
fn bad_input_is_refused() {
    for gain in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(SharedController::new(gain).unwrap_err().to_string().contains("gain"));
    }
    let law = SharedController::new(GAIN).unwrap();
    let p = split(&[turn(Vec3::X)], Complement::Reciprocal { h: 0.2 });
    let nan = turn(Vec3::Z * f64::NAN);
    let input = SharedInput::default();
    let refused = |input: SharedInput| law.command(&p, &input).unwrap_err().to_string();
    assert!(refused(SharedInput { error: nan, ..input }).contains("twist error"));
    assert!(refused(SharedInput { feed_forward: nan, ..input }).contains("feed-forward"));
    assert!(refused(SharedInput { operator: nan, ..input }).contains("operator's twist"));
    let huge = turn(Vec3::X * 1e308);
    assert!(refused(SharedInput { error: huge, ..input }).contains("commanded twist"));
}
