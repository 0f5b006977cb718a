//! The kernel of [`super::Batch`]: a serial chain at several configurations side by side.
//!
//! Formula  serial.rs
//! Shapes   q: N x n, poses: N x 4 x 4, Jacobians: N x 6 x n, row-major
//! Units    rad, m; m/s and rad/s for each unit of rate
//! Frame    [`Reference`]
//! Checked  tests/it/batch.rs: against [`super::Chain`]

use super::jacobian::Reference;
use super::serial::Serial;
use crate::scalar::{Array, MOST_LANES, Real, sines_cosines};
#[cfg(target_arch = "x86_64")]
use crate::scalar::{Lanes4, Lanes8, has_avx2, has_avx512};
use crate::spatial::Columns;

/// What there is, and what is asked for.
pub(super) struct Work<'a> {
    pub(super) serial: &'a Serial,
    /// The place in `q` of each coordinate of the chain.
    pub(super) coordinates: &'a [usize],
    /// Numbers of a configuration.
    pub(super) n: usize,
    pub(super) q: &'a [f64],
    pub(super) poses: Option<&'a mut [f64]>,
    pub(super) jacobians: Option<(Reference, &'a mut [f64])>,
}

/// As many configurations at once as the processor can.
pub(super) fn run(work: Work<'_>) {
    #[cfg(target_arch = "x86_64")]
    {
        #[allow(unsafe_code)] // the one way to call functions compiled for more than the baseline
        // SAFETY: the processor has these features, as just asked.
        unsafe {
            if has_avx512() {
                return run_avx512(work);
            }
            if has_avx2() {
                return run_avx2(work);
            }
        }
    }
    run_with::<Array<4>>(work);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx2,fma")]
fn run_avx512(work: Work<'_>) {
    run_with::<Lanes8>(work);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn run_avx2(work: Work<'_>) {
    run_with::<Lanes4>(work);
}

#[inline(always)]
fn run_with<R: Real>(mut work: Work<'_>) {
    let Work { serial, coordinates, n, .. } = work;
    let joints = serial.joints();
    let zero = R::splat(0.0);
    // The place in `q` of each joint's coordinate, and what each joint has.
    let places: Vec<usize> = joints.iter().map(|joint| coordinates[joint.coordinate]).collect();
    let mut x = vec![zero; joints.len()];
    let mut angles = vec![zero; joints.len()];
    let mut turns = vec![(zero, zero); joints.len()];
    let mut axes = vec![([zero; 3], [zero; 3]); joints.len()];
    let mut columns = vec![zero; 6 * n];
    for (block, q) in work.q.chunks(R::LANES * n).enumerate() {
        let rows = q.len() / n;
        gather(q, rows, &places, &mut x);
        for i in 0..joints.len() {
            angles[i] = joints[i].angle(x[i]);
        }
        sines_cosines(&angles, &mut turns);
        let tool = along(serial, &x, &turns, &mut axes);
        if let Some(poses) = &mut work.poses {
            put(&pose_rows(tool), &mut poses[block * R::LANES * 16..], rows);
        }
        if let Some((reference, jacobians)) = &mut work.jacobians {
            fill(serial, &places, *reference, tool, &axes, &mut columns);
            put(&columns, &mut jacobians[block * R::LANES * 6 * n..], rows);
        }
    }
}

/// The coordinates of the joints; lanes that are left over repeat the last configuration.
#[inline(always)]
fn gather<R: Real>(q: &[f64], rows: usize, places: &[usize], x: &mut [R]) {
    let n = q.len() / rows;
    let mut all = [&q[(rows - 1) * n..]; MOST_LANES];
    for (row, q) in all.iter_mut().zip(q.chunks_exact(n)) {
        *row = q;
    }
    for i in 0..places.len() {
        x[i] = R::from_fn(|l| all[l][places[i]]);
    }
}

/// Goes along the chain; axis and origin of each joint into `axes`. Gives the tool.
#[inline(always)]
pub(crate) fn along<R: Real>(
    serial: &Serial,
    x: &[R],
    turns: &[(R, R)],
    axes: &mut [([R; 3], [R; 3])],
) -> Columns<[R; 3]> {
    let joints = serial.joints();
    let (x, turns, axes) = (&x[..joints.len()], &turns[..joints.len()], &mut axes[..joints.len()]);
    let mut frame = serial.start();
    for i in 0..joints.len() {
        let (sin, cos) = turns[i];
        frame = joints[i].moved(frame, sin, cos, x[i]);
        axes[i] = (frame.z, frame.p);
        frame = joints[i].passed(frame);
    }
    serial.end(frame)
}

/// The Jacobian, row-major.
#[inline(always)]
fn fill<R: Real>(
    serial: &Serial,
    places: &[usize],
    reference: Reference,
    tool: Columns<[R; 3]>,
    axes: &[([R; 3], [R; 3])],
    out: &mut [R],
) {
    let zero = R::splat(0.0);
    let joints = serial.joints();
    let n = out.len() / 6;
    let p = if reference == Reference::World { [zero; 3] } else { tool.p };
    let one_each = serial.has_one_for_each(n);
    if !one_each {
        out.fill(zero);
    }
    // The rows: what is asked for one place in them is asked for all.
    let (a, rest) = out.split_at_mut(n);
    let (b, rest) = rest.split_at_mut(n);
    let (c, rest) = rest.split_at_mut(n);
    let (d, rest) = rest.split_at_mut(n);
    let (e, f) = rest.split_at_mut(n);
    let f = &mut f[..n];
    let (places, axes) = (&places[..joints.len()], &axes[..joints.len()]);
    for i in 0..joints.len() {
        let (k, (axis, origin)) = (places[i], axes[i]);
        let (mut linear, mut angular) = joints[i].column(axis, origin, p);
        if reference == Reference::Local {
            (linear, angular) = (tool.seen(linear), tool.seen(angular));
        }
        if !one_each {
            linear = [linear[0] + a[k], linear[1] + b[k], linear[2] + c[k]];
            angular = [angular[0] + d[k], angular[1] + e[k], angular[2] + f[k]];
        }
        [a[k], b[k], c[k]] = linear;
        [d[k], e[k], f[k]] = angular;
    }
}

/// The matrix of 4 x 4.
#[inline(always)]
fn pose_rows<R: Real>(pose: Columns<[R; 3]>) -> [R; 16] {
    let Columns { x, y, z, p } = pose;
    let (zero, one) = (R::splat(0.0), R::splat(1.0));
    [x[0], y[0], z[0], p[0], x[1], y[1], z[1], p[1], x[2], y[2], z[2], p[2], zero, zero, zero, one]
}

/// The first `rows` lanes as rows.
#[inline(always)]
fn put<R: Real>(numbers: &[R], out: &mut [f64], rows: usize) {
    let size = numbers.len();
    if rows == R::LANES {
        R::scatter(numbers, out, size);
    } else {
        let mut all = vec![0.0; R::LANES * size];
        R::scatter(numbers, &mut all, size);
        out[..rows * size].copy_from_slice(&all[..rows * size]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kinematics::Chain;
    use crate::model::catalogue;

    /// Poses and Jacobians in one list.
    fn of(chain: &Chain, q: &[f64], run: impl FnOnce(Work<'_>)) -> Vec<f64> {
        let (n, count) = (chain.n(), q.len() / chain.n());
        let (mut poses, mut jacobians) = (vec![0.0; count * 16], vec![0.0; count * 6 * n]);
        run(Work {
            serial: chain.serial().unwrap(),
            coordinates: chain.coordinates(),
            n,
            q,
            poses: Some(&mut poses),
            jacobians: Some((Reference::LocalWorldAligned, &mut jacobians)),
        });
        poses.extend(jacobians);
        poses
    }

    /// All forms of the kernel that the processor has agree with plain numbers to 16 units in the
    /// last place of 1 m and 1 rad; those with fused products agree with each other to the bit.
    #[test]
    #[allow(unsafe_code)]
    fn lanes_agree_with_plain_numbers() {
        for name in ["panda", "ur5e", "puma560", "youbot"] {
            let robot = catalogue::load(name).unwrap();
            let chain = Chain::new(&robot, robot.tool());
            let q: Vec<f64> = (0..chain.n() * 21)
                .map(|i| f64::from(i as u32 * 7919 % 6283) / 1e3 - 3.1)
                .collect();
            let plain = of(&chain, &q, run_with::<f64>);
            let near = |what: &str, other: &[f64]| {
                for (a, b) in plain.iter().zip(other) {
                    assert!((a - b).abs() <= 16.0 * f64::EPSILON, "{name} {what}: {a} and {b}");
                }
            };
            near("array", &of(&chain, &q, run_with::<Array<4>>));
            #[cfg(target_arch = "x86_64")]
            if has_avx2() {
                // SAFETY: the processor has these features.
                let four = of(&chain, &q, |work| unsafe { run_avx2(work) });
                near("four", &four);
                if has_avx512() {
                    // SAFETY: as above.
                    let eight = of(&chain, &q, |work| unsafe { run_avx512(work) });
                    assert_eq!(four, eight);
                }
            }
        }
    }
}
