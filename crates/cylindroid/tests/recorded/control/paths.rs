//! Paths of frames, moves along them and through waypoints.

use std::f64::consts::PI;

use cylindroid::control::{
    AxisRotation, CartesianBounds, CartesianMove, CartesianPath, PathDeviation, WaypointMove,
};
use cylindroid::spatial::Rotation;
use cylindroid::{Pose, Result, Twist, Vec3};

use super::motion::{bounds, of_law};
use super::{fail, of_pose, of_twist, sum};
use crate::record::{Record, check};
use crate::robots::Random;

/// An axis of the frame, with either sign, or any direction.
fn direction(random: &mut Random<'_>) -> Vec3 {
    let any = random.vec3(1.0);
    let axis = [Vec3::X, Vec3::Y, Vec3::Z, any * (1.0 / any.norm())][random.below(4)];
    if random.once_in(2) { -axis } else { axis }
}

fn line(from: Pose, size: f64, random: &mut Random<'_>) -> Result<CartesianPath> {
    let mut to = random.pose(size);
    match random.below(5) {
        0 => to.rotation = from.rotation,
        1 => to.translation = from.translation,
        2 => to.rotation = Rotation::exp(direction(random) * PI) * from.rotation,
        3 => to = from,
        _ => {}
    }
    CartesianPath::line(from, to)
}

fn circle(from: Pose, size: f64, random: &mut Random<'_>) -> Result<CartesianPath> {
    let to = random.pose(size);
    let between = from.translation + (to.translation - from.translation) * random.within(-1.0, 2.0);
    let via = match random.below(6) {
        0 => between,
        1 => between + random.vec3(size) * random.power(-9.0, -5.0),
        2 => between + random.vec3(size) * random.power(-3.0, -1.0),
        3 => from.translation,
        _ => random.vec3(size),
    };
    CartesianPath::circle(from, via, to)
}

fn turn(from: Pose, size: f64, random: &mut Random<'_>) -> Result<CartesianPath> {
    let mut axis = direction(random) * random.power(-3.0, 3.0);
    let mut centre = random.vec3(size);
    match random.below(8) {
        0 => axis = axis * 1e-12,
        1 => axis = Vec3::ZERO,
        2 => centre = from.translation,
        _ => {}
    }
    let angle = [0.0, random.within(-10.0, 10.0), random.within(-2.0, 2.0)][random.below(3)];
    CartesianPath::rotation(from, AxisRotation { centre, axis, angle })
}

fn path(size: f64, random: &mut Random<'_>) -> Result<CartesianPath> {
    let mut from = random.pose(size);
    if random.once_in(40) {
        from.translation.y = f64::NAN;
    }
    match random.below(3) {
        0 => line(from, size, random),
        1 => circle(from, size, random),
        _ => turn(from, size, random),
    }
}

/// Poses beside a path, and at its ends.
fn deviations(path: &CartesianPath, size: f64, random: &mut Random<'_>, record: &mut Record) {
    for share in [-0.3, 0.0, 0.2, 0.5, 0.8, 1.0] {
        let on_path = path.pose(share);
        let off = [0.0, 0.05, 0.6][random.below(3)];
        let near = Pose {
            translation: on_path.translation + random.vec3(off * size),
            rotation: Rotation::exp(random.vec3(off)) * on_path.rotation,
        };
        let PathDeviation { position, orientation, s } = path.deviation(near);
        record.number(sum(&[position / size, orientation, s]));
    }
    let far = path.deviation(random.pose(3.0 * size));
    record.number(sum(&[far.position / size, far.orientation, far.s]));
}

fn of_move(motion: &CartesianMove, size: f64, dt: f64, record: &mut Record) {
    of_law(record, motion.law());
    for share in [-0.1, 0.1, 0.45, 0.8, 1.2] {
        let time = share * motion.law().duration();
        let state = motion.at(time);
        let Twist { linear, angular } = state.twist;
        let target = motion.target(time, dt);
        let ahead =
            Twist { linear: target.feed_forward.linear * (1.0 / size), ..target.feed_forward };
        let twist = Twist { linear: linear * (1.0 / size), angular };
        let twists = [of_twist(twist), of_twist(ahead), state.s.position];
        let poses = [of_pose(state.pose, size), of_pose(target.pose, size)];
        record.number(sum(&[sum(&poses), sum(&twists)]));
    }
}

#[test]
fn paths() {
    check("control_paths", 80, |random, record| {
        let size = random.power(-2.0, 2.0);
        let path = match path(size, random) {
            Ok(path) => path,
            Err(error) => return fail(record, &error),
        };
        let radius = path.radius() / size;
        let mut all = vec![path.length() / size, path.angle(), radius.min(1e3)];
        for s in [f64::NAN, -0.5, 0.0, 0.3, 0.5, 0.7, 1.0, 1.5] {
            let Twist { linear, angular } = path.derivative(s);
            let slope = Twist { linear: linear * (1.0 / size), angular };
            all.extend([of_pose(path.pose(s), size), of_twist(slope)]);
        }
        record.numbers(&[sum(&all[..3]), sum(&all[3..11]), sum(&all[11..])]);
        deviations(&path, size, random, record);
    });
}

#[test]
fn moves() {
    check("control_moves", 50, |random, record| {
        let size = random.power(-2.0, 2.0);
        let Ok(path) = path(size, random) else { return };
        let limits = CartesianBounds { linear: bounds(random), angular: bounds(random) };
        let motion = match CartesianMove::new(path, limits) {
            Ok(motion) => motion,
            Err(error) => return fail(record, &error),
        };
        of_move(&motion, size, random.power(-3.0, -1.0), record);
        match motion.scaled_to_duration(random.within(0.5, 3.0) * motion.law().duration()) {
            Ok(slower) => of_move(&slower, size, 0.01, record),
            Err(error) => fail(record, &error),
        }
    });
}

/// Poses some of which repeat the one before, in place or orientation or both.
fn waypoints(size: f64, random: &mut Random<'_>) -> Vec<Pose> {
    let count = [1, 2, 2, 3, 4, 5, 6, 7][random.below(8)];
    let mut poses: Vec<Pose> = Vec::new();
    for _ in 0..count {
        let mut pose = random.pose(size);
        if let Some(last) = poses.last() {
            match random.below(8) {
                0 => pose = *last,
                1 => pose.rotation = last.rotation,
                2 => pose.translation = last.translation,
                3 => pose.translation = last.translation + random.vec3(1e-3 * size),
                4 => pose.rotation = Rotation::exp(random.vec3(0.01)) * last.rotation,
                _ => {}
            }
        }
        poses.push(pose);
    }
    poses
}

fn bounds_of_waypoints(size: f64, random: &mut Random<'_>) -> CartesianBounds {
    let mut limits = CartesianBounds { linear: bounds(random), angular: bounds(random) };
    for part in [&mut limits.linear, &mut limits.angular] {
        let is_bounded = part.velocity.is_finite() && part.acceleration.is_finite();
        if !is_bounded {
            (part.velocity, part.acceleration) = (random.power(-1.0, 1.0), random.power(-1.0, 1.0));
        }
        if !random.once_in(40) {
            part.jerk = f64::INFINITY;
        }
    }
    (limits.linear.velocity, limits.linear.acceleration) =
        (limits.linear.velocity * size, limits.linear.acceleration * size);
    limits
}

fn of_waypoints(motion: &WaypointMove, size: f64, record: &mut Record) {
    let time = motion.duration();
    record.number(sum(&[time.ln(), motion.largest_deviation() / size]));
    let mut all = Vec::new();
    for k in -1..24 {
        let at = time * f64::from(k) / 22.3;
        let (pose, Twist { linear, angular }) = motion.at(at);
        let twist = Twist { linear: linear * (1.0 / size), angular };
        let ahead = motion.target(at, 0.01 * time);
        let way = ahead.feed_forward.linear * (1.0 / size);
        let target = of_pose(ahead.pose, size) + sum(&way.to_array());
        all.push(sum(&[of_pose(pose, size), of_twist(twist), target]));
    }
    all.chunks(5).for_each(|part| record.number(sum(part)));
}

#[test]
fn moves_through_waypoints() {
    check("control_waypoints", 50, |random, record| {
        let size = random.power(-2.0, 2.0);
        let poses = waypoints(size, random);
        match WaypointMove::new(&poses, bounds_of_waypoints(size, random)) {
            Ok(motion) => of_waypoints(&motion, size, record),
            Err(error) => fail(record, &error),
        }
    });
}

#[test]
fn waypoints_at_times() {
    check("control_timed_waypoints", 45, |random, record| {
        let size = random.power(-1.0, 1.0);
        let poses = waypoints(size, random);
        let longest = random.power(0.0, 2.0);
        let mut time = random.within(-1.0, 1.0);
        let mut times: Vec<f64> = Vec::new();
        for _ in &poses {
            times.push(time);
            time += longest * random.within(0.5, 1.0);
        }
        match random.below(12) {
            0 => times.swap(0, poses.len() - 1),
            1 => times.push(time),
            2 => times[0] = f64::NAN,
            _ => {}
        }
        match WaypointMove::timed(&poses, &times, bounds_of_waypoints(size, random)) {
            Ok(motion) => of_waypoints(&motion, size, record),
            Err(error) => fail(record, &error),
        }
    });
}
