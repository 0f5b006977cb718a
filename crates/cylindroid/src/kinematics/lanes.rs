//! The kernel of [`super::Batch`]: a serial chain at several configurations side by side.
//!
//! Formula  serial.rs
//! Shapes   q: N x n, poses: N x 4 x 4, Jacobians: N x 6 x n, row-major
//! Units    rad, m; m/s and rad/s for each unit of rate
//! Frame    [`Reference`]
//! Checked  tests/it/batch.rs: against [`super::Chain`]

use super::jacobian::Reference;
use super::serial::Serial;
use crate::scalar::{Array, Real, sin_cos};
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
    let zero = R::splat(0.0);
    let mut x = vec![zero; coordinates.len()];
    let mut turns = vec![(zero, zero); serial.joints().len()];
    let mut axes = vec![([zero; 3], [zero; 3]); serial.joints().len()];
    let mut columns = vec![zero; 6 * n];
    for (block, q) in work.q.chunks(R::LANES * n).enumerate() {
        let rows = q.len() / n;
        gather(q, rows, coordinates, &mut x);
        let tool = along(serial, &x, &mut turns, &mut axes);
        if let Some(poses) = &mut work.poses {
            put(&pose_rows(tool), &mut poses[block * R::LANES * 16..], rows);
        }
        if let Some((reference, jacobians)) = &mut work.jacobians {
            fill(serial, coordinates, *reference, tool, &axes, &mut columns);
            put(&columns, &mut jacobians[block * R::LANES * 6 * n..], rows);
        }
    }
}

/// The coordinates of the chain; lanes that are left over repeat the last configuration.
#[inline(always)]
fn gather<R: Real>(q: &[f64], rows: usize, coordinates: &[usize], x: &mut [R]) {
    let n = q.len() / rows;
    for (x, &c) in x.iter_mut().zip(coordinates) {
        *x = R::from_fn(|l| q[l.min(rows - 1) * n + c]);
    }
}

/// Goes along the chain; axis and origin of each joint into `axes`. Gives the tool.
#[inline(always)]
fn along<R: Real>(
    serial: &Serial,
    x: &[R],
    turns: &mut [(R, R)],
    axes: &mut [([R; 3], [R; 3])],
) -> Columns<[R; 3]> {
    // By themselves, so that neither loop needs more registers than there are.
    for (joint, turn) in serial.joints().iter().zip(&mut *turns) {
        *turn = sin_cos(joint.angle(x[joint.coordinate]));
    }
    let mut frame = serial.start();
    for ((joint, axis), &(sin, cos)) in serial.joints().iter().zip(axes).zip(&*turns) {
        frame = joint.moved(frame, sin, cos, x[joint.coordinate]);
        *axis = (frame.z, frame.p);
        frame = joint.passed(frame);
    }
    serial.end(frame)
}

/// The Jacobian, row-major.
#[inline(always)]
fn fill<R: Real>(
    serial: &Serial,
    coordinates: &[usize],
    reference: Reference,
    tool: Columns<[R; 3]>,
    axes: &[([R; 3], [R; 3])],
    out: &mut [R],
) {
    let zero = R::splat(0.0);
    let n = out.len() / 6;
    let p = if reference == Reference::World { [zero; 3] } else { tool.p };
    let one_each = serial.has_one_for_each(n);
    if !one_each {
        out.fill(zero);
    }
    for (joint, &(axis, origin)) in serial.joints().iter().zip(axes) {
        let (mut linear, mut angular) = joint.column(axis, origin, p);
        if reference == Reference::Local {
            (linear, angular) = (tool.seen(linear), tool.seen(angular));
        }
        let c = coordinates[joint.coordinate];
        let column = [linear[0], linear[1], linear[2], angular[0], angular[1], angular[2]];
        for i in 0..6 {
            let place = &mut out[i * n + c];
            *place = if one_each { column[i] } else { *place + column[i] };
        }
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
