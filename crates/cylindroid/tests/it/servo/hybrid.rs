//! Hybrid control: the two parts leave each other alone, in any frame and unit.

use super::*;
use crate::support::assert_close;
use cylindroid::control::{
    Admittance, AdmittanceGain, HybridCommand, HybridController, HybridInput,
};
use cylindroid::linalg::{Matrix, Svd};
use cylindroid::screws::{Complement, NoInverse, Projector as Split, ScrewOptions, ScrewSystem};
use cylindroid::spatial::exp;
use cylindroid::{Result, Wrench};

pub(super) fn split(motions: &[Twist], along: Complement<'_>) -> Split {
    Split::of(motions, along, &ScrewOptions::with_length(0.5)).unwrap().unwrap()
}

fn close_twist(what: &str, got: Twist, expected: Twist, tolerance: f64) {
    let size = expected.to_array().iter().fold(1.0, |m: f64, x| m.max(x.abs()));
    assert_close(what, &got.to_array(), &expected.to_array(), tolerance * size);
}

fn wrench(random: &mut Random) -> Wrench {
    Wrench { force: random.vec3(10.0), moment: random.vec3(2.0) }
}

fn turn(angular: Vec3) -> Twist {
    Twist { linear: Vec3::ZERO, angular }
}

fn slide(linear: Vec3) -> Twist {
    Twist { linear, angular: Vec3::ZERO }
}

/// The motions of a pen that keeps its tip, the origin, on the plane across `normal`.
fn pen(normal: Vec3) -> [Twist; 5] {
    let (a, b) = {
        let r = Rotation::z_to(normal).unwrap();
        (r.x_axis(), r.y_axis())
    };
    [slide(a), slide(b), turn(Vec3::X), turn(Vec3::Y), turn(Vec3::Z)]
}

/// A random problem: motions, what is dropped, law and input, in one frame.
#[derive(Clone)]
struct Problem {
    motions: Vec<Twist>,
    dropped: Vec<Twist>,
    h: Option<f64>,
    law: HybridController,
    admittance: Admittance,
    input: HybridInput,
    length: f64,
}

impl Problem {
    fn random(random: &mut Random, order: usize, h: Option<f64>) -> Self {
        let point = random.vec3(0.3);
        let soft = Admittance::at(point, AdmittanceGain { force: 2e-3, moment: 0.05 }).unwrap();
        // Not diagonal in any frame: a sum of two, about different points.
        let rows = |a: Admittance, b: Admittance| -> [[f64; 6]; 6] {
            std::array::from_fn(|i| std::array::from_fn(|j| a.rows()[i][j] + b.rows()[i][j]))
        };
        let other =
            Admittance::at(random.vec3(1.0), AdmittanceGain { force: 1e-3, moment: 0.01 }).unwrap();
        let admittance = Admittance::from_rows(rows(soft, other)).unwrap();
        Self {
            motions: (0..order).map(|_| random.twist()).collect(),
            dropped: (order..6).map(|_| random.twist()).collect(),
            h,
            law: HybridController::new(5.0, admittance).unwrap(),
            admittance,
            input: HybridInput {
                error: random.twist() * 0.1,
                feed_forward: random.twist(),
                desired: wrench(random),
                measured: wrench(random),
            },
            length: 0.5,
        }
    }

    fn split(&self) -> Option<Split> {
        let along =
            self.h.map_or(Complement::Twists(&self.dropped), |h| Complement::Reciprocal { h });
        Split::of(&self.motions, along, &ScrewOptions::with_length(self.length)).unwrap().ok()
    }

    fn command(&self) -> HybridCommand {
        self.law.command(&self.split().unwrap(), &self.input).unwrap()
    }

    /// Seen from another frame.
    fn seen_from(&self, g: Pose) -> Self {
        let move_all = |t: &[Twist]| t.iter().map(|t| g.adjoint(*t)).collect();
        Self {
            motions: move_all(&self.motions),
            dropped: move_all(&self.dropped),
            law: self.law.seen_from(g),
            admittance: self.admittance.seen_from(g),
            input: HybridInput {
                error: g.adjoint(self.input.error),
                feed_forward: g.adjoint(self.input.feed_forward),
                desired: g.coadjoint(self.input.desired),
                measured: g.coadjoint(self.input.measured),
            },
            ..self.clone()
        }
    }

    /// In another unit of length, so many to the metre.
    fn in_unit(&self, s: f64) -> Self {
        let t = |t: Twist| Twist { linear: t.linear * s, angular: t.angular };
        let w = |w: Wrench| Wrench { force: w.force, moment: w.moment * s };
        let c = self.admittance.rows();
        let linear = |i: usize| if i < 3 { s } else { 1.0 };
        let angular = |j: usize| if j < 3 { 1.0 } else { 1.0 / s };
        let rows =
            std::array::from_fn(|i| std::array::from_fn(|j| c[i][j] * linear(i) * angular(j)));
        let admittance = Admittance::from_rows(rows).unwrap();
        Self {
            motions: self.motions.iter().map(|x| t(*x)).collect(),
            dropped: self.dropped.iter().map(|x| t(*x)).collect(),
            h: self.h.map(|h| h * s),
            law: HybridController::new(5.0, admittance).unwrap(),
            admittance,
            input: HybridInput {
                error: t(self.input.error),
                feed_forward: t(self.input.feed_forward),
                desired: w(self.input.desired),
                measured: w(self.input.measured),
            },
            length: self.length * s,
        }
    }
}

/// Problems of every order and every kind of projector.
fn for_each_problem(seed: u64, mut check: impl FnMut(&mut Random, &Problem, &Split)) {
    let mut random = Random(seed);
    let mut seen = 0;
    for order in 0..=6 {
        for h in [None, Some(0.3), Some(-1.5), Some(f64::INFINITY)] {
            for _ in 0..10 {
                let problem = Problem::random(&mut random, order, h);
                // Random systems near one without projector have no digits to compare.
                if let Some(split) = problem.split().filter(|s| s.norm() < 50.0) {
                    check(&mut random, &problem, &split);
                    seen += 1;
                }
            }
        }
    }
    assert!(seen > 200, "{seen}");
}

#[test]
fn the_parts_do_not_interfere() {
    for_each_problem(1, |random, problem, split| {
        let command = problem.command();
        let HybridCommand { position_part, force_part, wrench_error, twist } = command;
        assert_eq!(twist, position_part + force_part);
        // What is controlled in force does no work on any motion that is controlled in position.
        for s in &problem.motions {
            let power = s.power(wrench_error);
            assert!(power.abs() < 1e-11, "{power}");
        }
        let power = position_part.power(wrench_error);
        assert!(power.abs() < 1e-10, "{power}");
        // The position part has nothing of what is dropped, the force part nothing of the motions.
        close_twist("position", split.motion(position_part), position_part, 1e-11);
        close_twist("force", split.motion(force_part), Twist::ZERO, 1e-11);

        // A contact of springs along wrenches that do no work on the motions: the position part
        // changes no force, whatever the error is.
        let spring = split.constraint(wrench(random));
        let (by_position, by_both) = (position_part.power(spring), twist.power(spring));
        assert!(by_position.abs() < 1e-10, "{by_position}");
        // And the force part changes it by all of what the admittance asks for.
        let asked = problem.admittance.apply(wrench_error).power(spring);
        assert!((by_both - asked).abs() < 1e-10 * (1.0 + asked.abs()), "{by_both} {asked}");
        // The force error falls: a passive admittance does work on the error, none against it.
        assert!(force_part.power(wrench_error) >= -1e-12);

        // Each part listens to its own sensors alone.
        let mut other = problem.clone();
        other.input.measured = wrench(random);
        assert_eq!(other.command().position_part, position_part);
        other.input = HybridInput { error: random.twist(), ..problem.input };
        assert_eq!(other.command().force_part, force_part);
    });
}

/// Origin, axes and unit: the same motion of the tool.
#[test]
fn the_command_does_not_depend_on_the_frame() {
    let mut worst: f64 = 0.0;
    for_each_problem(2, |random, problem, _| {
        let command = problem.command();
        let far = Pose { translation: random.vec3(1.0) * 50.0, ..random.pose() };
        for (g, digits) in [(random.pose(), 1e-11), (far, 1e-9)] {
            let moved = problem.seen_from(g).command();
            let back = g.inverse().adjoint(moved.twist);
            close_twist("frame", back, command.twist, digits);
            worst = worst.max((back.linear - command.twist.linear).norm());
        }
        let mm = problem.in_unit(1e3).command().twist;
        let metres = Twist { linear: mm.linear * 1e-3, angular: mm.angular };
        close_twist("unit", metres, command.twist, 1e-11);
    });
    println!("frames 50 m apart: commands differ by {worst:.1e} m/s at most");
}

/// The tool point is only another origin, with the error taken as a screw motion.
#[test]
fn the_error_does_not_depend_on_the_tool_point() {
    let mut random = Random(3);
    for _ in 0..100 {
        let (pose, target, offset) = (random.pose(), random.pose(), random.pose());
        let here = pose.screw_to(target);
        let there = (pose * offset).screw_to(target * offset);
        let lever = (pose * offset).translation - pose.translation;
        close_twist("tool point", here.at_point(lever), there, 1e-12);
        let world = Pose { rotation: Rotation::IDENTITY, ..pose };
        let arrived = world * exp(here) * world.inverse() * pose;
        let gap = arrived.error_to(target);
        close_twist("arrives", gap, Twist::ZERO, 1e-12);
        let g = random.pose();
        let turned = Pose::from_rotation(g.rotation).adjoint(here);
        close_twist("world", (g * pose).screw_to(g * target), turned, 1e-12);
    }
}

/// The orthogonal projector of R^6 on the span: what selects motions in the first formulation.
fn moore_penrose(motions: &[Twist], t: Twist) -> Twist {
    let svd = Svd::of(&Matrix::from_fn(6, motions.len(), |i, j| motions[j].to_array()[i]));
    let x = t.to_array();
    let mut y = [0.0; 6];
    for i in 0..motions.len() {
        let along: f64 = svd.u(i).iter().zip(x).map(|(u, x)| u * x).sum();
        y.iter_mut().zip(svd.u(i)).for_each(|(y, u)| *y += along * u);
    }
    Twist::from_array(y)
}

/// Orthogonal complements in se(3), after Raibert and Craig. The depth of a pen, 10 mm here, is the
/// business of force control: seen from its tip, it is no error of position. Seen from 0.3 m beside,
/// orthogonal selection turns the pen for it; in millimetres fifteen times as much. Ours never does.
#[test]
fn orthogonal_selection_changes_with_the_origin_and_the_unit() {
    let normal = Vec3::new(0.3, -0.2, 0.9).unit(0.0).unwrap();
    let motions = pen(normal);
    let error = slide(normal * 0.01);
    let g = Pose::from_translation(Vec3::new(0.3, 0.0, 0.0));
    let moved = motions.map(|t| g.adjoint(t));
    let unit = |t: Twist, s: f64| Twist { linear: t.linear * s, angular: t.angular };
    let selected = |s: f64| {
        let x = moore_penrose(&moved.map(|t| unit(t, s)), unit(g.adjoint(error), s));
        g.inverse().adjoint(unit(x, 1.0 / s))
    };
    close_twist("at the tip", moore_penrose(&motions, error), Twist::ZERO, 1e-15);
    let (metres, millimetres) = (selected(1.0).angular.norm(), selected(1e3).angular.norm());
    println!("orthogonal selection turns the pen by {metres:.4} or {millimetres:.4} rad");
    assert!((0.002..0.004).contains(&metres), "{metres}");
    assert!(millimetres > 10.0 * metres, "{millimetres}");

    let along = Complement::Reciprocal { h: f64::INFINITY };
    let (ours, from_aside) = (split(&motions, along), split(&moved, along));
    close_twist("at the tip", ours.motion(error), Twist::ZERO, 1e-15);
    close_twist("from aside", from_aside.motion(g.adjoint(error)), Twist::ZERO, 1e-15);
    // For a pen the limit is what one would choose: give way along the normal, without turning.
    let normal = [slide(normal)];
    let chosen = split(&motions, Complement::Twists(&normal));
    let x = Random(6).twist();
    close_twist("limit", ours.motion(x), chosen.motion(x), 1e-14);
}

/// A tip on a spring, in the plane's frame tilted: force and path each take their own way.
#[test]
fn a_pen_writes_at_constant_force() {
    let normal = Vec3::new(0.5, 0.0, 0.75_f64.sqrt());
    let (stiffness, dt, desired) = (2000.0, 1e-3, -normal * 5.0);
    let law = HybridController::new(
        10.0,
        Admittance::at(Vec3::ZERO, AdmittanceGain { force: 0.01, moment: 0.0 }).unwrap(),
    )
    .unwrap();
    let along = Complement::Reciprocal { h: f64::INFINITY };
    let split = split(&pen(normal), along);
    let run = |drag: f64, desired: Vec3| {
        let across = Vec3::Y;
        let mut pose = Pose::from_translation(across * 0.01);
        let mut force = Vec3::ZERO;
        for i in 0..3000 {
            let target = Pose::from_translation(across * (0.05 * (f64::from(i) * dt)));
            let depth = (-pose.translation.dot(normal)).max(0.0);
            force = normal * (-stiffness * depth) + across * drag;
            let input = HybridInput {
                error: pose.screw_to(target),
                feed_forward: slide(across * 0.05),
                desired: Wrench { force: desired, moment: Vec3::ZERO },
                measured: Wrench { force, moment: Vec3::ZERO },
            };
            let command = law.command(&split, &input).unwrap();
            pose = Pose::from_translation(pose.translation + command.twist.linear * dt);
        }
        (pose, force)
    };
    let (pose, force) = run(0.0, desired);
    assert!((force - desired).norm() < 1e-9, "{force:?}");
    assert!((pose.translation.dot(Vec3::Y) - 0.15).abs() < 1e-9, "{pose:?}");
    // Friction is no error of force, and ten newtons more do not move the line.
    let (with_drag, _) = run(3.0, desired);
    assert_eq!(with_drag, pose);
    let (harder, _) = run(0.0, -normal * 15.0);
    let aside = harder.translation - pose.translation;
    assert!(aside.cross(normal).norm() < 1e-15 && aside.norm() > 4e-3, "{aside:?}");
}

/// In the loop without allocation: what screw systems, with their classes, give.
#[test]
fn projectors_of_twists() {
    let options = ScrewOptions::with_length(0.5);
    for_each_problem(4, |random, problem, split| {
        let system = ScrewSystem::of(&problem.motions, &options).unwrap();
        let other = ScrewSystem::of(&problem.dropped, &options).unwrap();
        let expected = match problem.h {
            Some(h) => system.projector(h).unwrap(),
            None => system.projector_along(&other).unwrap(),
        };
        let x = random.twist();
        close_twist("projector", split.motion(x), expected.motion(x), 1e-10);
        // Twists that depend on others, of any size and order, change nothing.
        let mut more = problem.motions.clone();
        if let [first, .., last] = problem.motions[..] {
            more.insert(0, first * 1e6 + last);
            more.push(Twist::ZERO);
            more.push(first * 1e-9);
        }
        let along = problem
            .h
            .map_or(Complement::Twists(&problem.dropped), |h| Complement::Reciprocal { h });
        let again = Split::of(&more, along, &options).unwrap().unwrap();
        close_twist("dependent", again.motion(x), split.motion(x), 1e-8);
    });
}

#[test]
fn no_projector_says_why() {
    let options = ScrewOptions::with_length(0.5);
    let none = |motions: &[Twist], along: Complement<'_>| {
        Split::of(motions, along, &options).unwrap().unwrap_err()
    };
    let free = pen(Vec3::Z);
    let reason = none(&free, Complement::Reciprocal { h: 0.0 });
    assert_eq!(reason, NoInverse::PrincipalPitch { pitch: 0.0 });
    // The plane itself: translations and the turn about its normal have no P_h at all.
    let plane = [slide(Vec3::X), slide(Vec3::Y), turn(Vec3::Z)];
    let reason = none(&plane, Complement::Reciprocal { h: 0.3 });
    assert!(matches!(reason, NoInverse::Class { order: 3, .. }), "{reason}");
    let reason = none(&free, Complement::Twists(&[turn(Vec3::Y)]));
    assert_eq!(reason, NoInverse::NotComplementary { order: 5, other: 1 });
    assert!(reason.to_string().contains("choose"), "{reason}");
    let reason = none(&free, Complement::Twists(&[]));
    assert!(reason.to_string().contains("must span six"), "{reason}");
    let grazing = [Twist { linear: Vec3::new(1.0, 0.0, 1e-5), angular: Vec3::ZERO }];
    let reason = none(&free, Complement::Twists(&grazing));
    assert!(matches!(reason, NoInverse::TooLarge { norm } if norm > 1e4), "{reason}");
}

#[test]
fn admittance_gives_way_and_never_pushes_back() {
    let refused = |r: Result<Admittance>| r.unwrap_err().to_string();
    let text = refused(Admittance::at(Vec3::ZERO, AdmittanceGain { force: -1e-3, moment: 0.0 }));
    assert!(text.contains("force admittance = -0.001"), "{text}");
    let text =
        refused(Admittance::at(Vec3::ZERO, AdmittanceGain { force: 1e-3, moment: f64::NAN }));
    assert!(text.contains("moment admittance"), "{text}");
    assert!(
        refused(Admittance::at(
            Vec3::X * f64::INFINITY,
            AdmittanceGain { force: 0.0, moment: 0.0 }
        ))
        .contains("point")
    );
    let diagonal = |d: [f64; 6]| {
        std::array::from_fn::<_, 6, _>(|i| std::array::from_fn(|j| if i == j { d[i] } else { 0.0 }))
    };
    assert!(Admittance::from_rows(diagonal([1.0, 1.0, 0.0, 0.0, 1e-9, 1e6])).is_ok());
    let mut rows = diagonal([1.0; 6]);
    (rows[0][1], rows[1][0]) = (1.1, 1.1);
    assert!(refused(Admittance::from_rows(rows)).contains("positive semidefinite"));
    // Turning a force aside is no pushing back.
    (rows[0][1], rows[1][0]) = (1.1, -1.1);
    assert!(Admittance::from_rows(rows).is_ok());
    assert!(refused(Admittance::from_rows(diagonal([1.0, 1.0, 1.0, 1.0, 1.0, -1e-12]))).len() > 9);
    rows[5][5] = f64::INFINITY;
    assert!(refused(Admittance::from_rows(rows)).contains("not finite"));

    let mut random = Random(5);
    for _ in 0..100 {
        let (point, g, w) = (random.vec3(1.0), random.pose(), wrench(&mut random));
        let c = Admittance::at(point, AdmittanceGain { force: 2e-3, moment: 0.05 }).unwrap();
        // At its point the gains act alone.
        let twist = c.apply(w).at_point(point);
        let expected = Twist { linear: w.force * 2e-3, angular: w.at_point(point).moment * 0.05 };
        close_twist("gains", twist, expected, 1e-14);
        // It moves like its point.
        let moved = c.seen_from(g).apply(g.coadjoint(w));
        close_twist("frame", moved, g.adjoint(c.apply(w)), 1e-13);
        // Given by its rows in a far frame, where the rounding of the lever is seen, it still is one.
        let far = Pose { translation: g.translation * 30.0, ..g };
        Admittance::from_rows(c.seen_from(far).rows()).unwrap();
    }
}

#[test]
fn bad_input_is_refused() {
    let soft = Admittance::at(Vec3::ZERO, AdmittanceGain { force: 1e-3, moment: 0.0 }).unwrap();
    for gain in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(HybridController::new(gain, soft).unwrap_err().to_string().contains("gain"));
    }
    let law = HybridController::new(5.0, soft).unwrap();
    let split = split(&pen(Vec3::Z), Complement::Reciprocal { h: 0.2 });
    let nan = Vec3::new(0.0, f64::NAN, 0.0);
    let refused = |input: HybridInput| law.command(&split, &input).unwrap_err().to_string();
    let input = HybridInput::default();
    assert_eq!(law.command(&split, &input).unwrap().twist, Twist::ZERO);
    assert!(refused(HybridInput { error: slide(nan), ..input }).contains("twist error[1]"));
    assert!(refused(HybridInput { feed_forward: turn(nan), ..input }).contains("feed-forward"));
    let bad = Wrench { force: nan, moment: Vec3::ZERO };
    assert!(refused(HybridInput { desired: bad, ..input }).contains("desired wrench"));
    assert!(refused(HybridInput { measured: bad, ..input }).contains("measured wrench"));
    let huge = slide(Vec3::X * 1e308);
    assert!(refused(HybridInput { error: huge, ..input }).contains("commanded twist"));

    let options = ScrewOptions::with_length(0.5);
    let text = |r: Result<std::result::Result<Split, NoInverse>>| r.unwrap_err().to_string();
    let h = Complement::Reciprocal { h: 0.1 };
    assert!(text(Split::of(&[huge, slide(nan)], h, &options)).contains("motion 2[1]"));
    let along = [slide(nan)];
    assert!(text(Split::of(&[], Complement::Twists(&along), &options)).contains("give up 1[1]"));
    assert!(
        text(Split::of(&[], Complement::Reciprocal { h: f64::NAN }, &options)).contains("pitch")
    );
    assert!(text(Split::of(&[], h, &ScrewOptions::with_length(0.0))).contains("length"));
    // Numbers at the end of the range give no panic.
    for size in [1e-320, 1e-300, 1e300, f64::MAX] {
        let motions = pen(Vec3::Z).map(|t| t * size);
        let _ = Split::of(&motions, h, &options).unwrap();
        let _ = Split::of(&motions[..2], Complement::Twists(&motions[1..]), &options).unwrap();
    }
}
