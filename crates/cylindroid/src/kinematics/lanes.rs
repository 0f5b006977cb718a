//! The kernel of [`super::Batch`]: a serial chain at several configurations side by side.
//!
//! Formula  axes as in serial.rs, from the first joint to the tool; then back, l the lever from a
//!          joint to the tool, 0 at the tool: l += way, column [turn z x l + slide z; turn z]
//! Shapes   q: N x n, poses: N x 4 x 4, Jacobians: N x 6 x n, row-major
//! Units    rad, m; m/s and rad/s for each unit of rate
//! Frame    [`Reference`]
//! Why so   one configuration waits for itself, from joint to joint; what is done for several
//!          joints or configurations waits for nothing, and memory is not asked for
//! Checked  tests/it/batch.rs: against [`super::Chain`]; `tests` below: all forms alike

use super::jacobian::Reference;
use super::serial::Serial;
use crate::scalar::{Array, MOST_LANES, Real};
#[cfg(target_arch = "x86_64")]
use crate::scalar::{Lanes4, Lanes8, has_avx2, has_avx512};
use crate::spatial::{Columns, Triple};

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
    /// True if the results of the whole call are more than caches hold.
    pub(super) large: bool,
}

/// Joints of chains of usual length.
const FEW: usize = 12;
/// Numbers of a joint in memory: coordinate, cosine, sine, rows.
const EACH: usize = 9;

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

/// Numbers that go along a chain in a function of their own: frames fill the registers, and beside
/// other code some would be put aside in every step, which the next one waits for.
pub(crate) trait Apart: Real {
    /// [`along`]
    #[inline(always)]
    fn along(serial: &Serial, turns: (&[Self], &[Self]), rows: &mut [Self]) -> Columns<[Self; 3]> {
        along(serial, turns, rows)
    }
}

impl Apart for f64 {}

impl<const N: usize> Apart for Array<N> {}

#[cfg(target_arch = "x86_64")]
macro_rules! apart {
    ($lanes:ident, $features:literal) => {
        impl Apart for $lanes {
            #[inline(always)]
            fn along(
                serial: &Serial,
                turns: (&[Self], &[Self]),
                rows: &mut [Self],
            ) -> Columns<[Self; 3]> {
                #[target_feature(enable = $features)]
                #[inline(never)]
                fn apart(
                    serial: &Serial,
                    turns: (&[$lanes], &[$lanes]),
                    rows: &mut [$lanes],
                ) -> Columns<[$lanes; 3]> {
                    along(serial, turns, rows)
                }
                #[allow(unsafe_code)] // as in `run`
                // SAFETY: these numbers are named only where the processor has the features.
                unsafe {
                    apart(serial, turns, rows)
                }
            }
        }
    };
}

#[cfg(target_arch = "x86_64")]
apart!(Lanes4, "avx2,fma");
#[cfg(target_arch = "x86_64")]
apart!(Lanes8, "avx512f,avx2,fma");

#[inline(always)]
fn run_with<R: Apart>(mut work: Work<'_>) {
    let Work { serial, coordinates, n, .. } = work;
    let joints = serial.joints();
    let m = joints.len();
    let zero = R::splat(0.0);
    let in_order = (0..m).all(|i| coordinates[joints[i].coordinate] == i);
    let in_place = in_order && m == n;
    // What chains of usual length need is on the stack.
    let mut few = [zero; FEW * EACH];
    let mut many = vec![zero; if m <= FEW { 0 } else { m * EACH }];
    let memory = if m <= FEW { &mut few[..m * EACH] } else { &mut many[..] };
    let (x, memory) = memory.split_at_mut(m);
    let (cosines, memory) = memory.split_at_mut(m);
    let (sines, rows) = memory.split_at_mut(m);
    let mut columns = vec![zero; if in_place { 0 } else { 6 * n }];
    let mut done = 0;
    while done * n < work.q.len() {
        let q = &work.q[done * n..];
        let count = R::LANES.min(q.len() / n);
        if in_order && count == R::LANES {
            R::gather(q, n, x);
        } else {
            gather(&q[..count * n], n, serial, coordinates, x);
        }
        for i in 0..m {
            cosines[i] = joints[i].angle(x[i]);
        }
        R::sines_cosines(cosines, sines, &mut rows[..m]);
        let mut tool = R::along(serial, (sines, cosines), rows);
        if let Some((reference, jacobians)) = &mut work.jacobians {
            jacobian(serial, *reference, x, &mut tool, rows);
            let jacobians = &mut jacobians[done * 6 * n..];
            if in_place {
                put(rows, jacobians, count);
            } else {
                sort(rows, serial, coordinates, &mut columns);
                put(&columns, jacobians, count);
            }
        } else {
            tool.p = tool.p.plus(whole_way(serial, x, rows));
        }
        if let Some(poses) = &mut work.poses {
            put(&pose_rows(tool), &mut poses[done * 16..], count);
        }
        done += count;
        if work.large {
            let poses = work.poses.as_deref().map(|out| (out, 16));
            let jacobians = work.jacobians.as_ref().map(|(_, out)| (&**out, 6 * n));
            for (out, size) in poses.into_iter().chain(jacobians) {
                let end = out.len().min((done + R::LANES) * size);
                fetch(&out[done * size..end]);
            }
        }
    }
}

/// Has memory brought near that is written soon: stores wait for it, one for the other.
#[inline(always)]
fn fetch(places: &[f64]) {
    #[cfg(target_arch = "x86_64")]
    for line in places.chunks(8) {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        #[allow(unsafe_code)] // the one way to say it
        // SAFETY: nothing is read or written; every processor of x86-64 has it.
        unsafe {
            _mm_prefetch::<_MM_HINT_T0>(line.as_ptr().cast());
        }
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = places;
}

/// The coordinates of the joints, at any places; lanes that are left over repeat the last
/// configuration.
#[inline(always)]
fn gather<R: Real>(q: &[f64], n: usize, serial: &Serial, coordinates: &[usize], x: &mut [R]) {
    let last = q.len() / n - 1;
    let mut all = [&q[last * n..]; MOST_LANES];
    for (row, q) in all.iter_mut().zip(q.chunks_exact(n)) {
        *row = q;
    }
    for (x, joint) in x.iter_mut().zip(serial.joints()) {
        let place = coordinates[joint.coordinate];
        *x = R::from_fn(|l| all[l][place]);
    }
}

/// Goes along the chain: the axes of the tool, the origin of the first joint, and `rows` of one
/// number for each joint: axes x and z.
///
/// Origins follow from them, on the way back, in [`jacobian`] or [`whole_way`].
#[inline(always)]
fn along<R: Real>(
    serial: &Serial,
    (sines, cosines): (&[R], &[R]),
    rows: &mut [R],
) -> Columns<[R; 3]> {
    let joints = serial.joints();
    let m = joints.len();
    let (sines, cosines) = (&sines[..m], &cosines[..m]);
    let [a, b, c, d, e, f] = split(rows, m);
    let mut frame = serial.start::<[R; 3]>();
    for i in 0..m {
        frame = frame.turned(sines[i], cosines[i]);
        [a[i], b[i], c[i]] = frame.x;
        [d[i], e[i], f[i]] = frame.z;
        frame = joints[i].tilted(frame);
    }
    serial.end(frame)
}

/// From the origin of the first joint to that of the tool, from the rows of [`along`].
#[inline(always)]
pub(crate) fn whole_way<R: Real>(serial: &Serial, q: &[R], rows: &mut [R]) -> [R; 3] {
    let joints = serial.joints();
    let (q, [a, b, c, d, e, f]) = (&q[..joints.len()], split(rows, joints.len()));
    let mut way = [R::splat(0.0); 3];
    for i in (0..joints.len()).rev() {
        way = way.plus(joints[i].way([a[i], b[i], c[i]], [d[i], e[i], f[i]], q[i]));
    }
    way
}

/// The Jacobian of the joints from the rows of [`along`], in their place; the origin of the tool.
#[inline(always)]
pub(crate) fn jacobian<R: Real>(
    serial: &Serial,
    reference: Reference,
    q: &[R],
    tool: &mut Columns<[R; 3]>,
    rows: &mut [R],
) {
    let joints = serial.joints();
    let first = tool.p;
    // From where a joint is to the point whose velocity is asked for.
    let mut lever = [R::splat(0.0); 3];
    if reference == Reference::World {
        tool.p = first.plus(whole_way(serial, q, rows));
        lever = tool.p.negative();
    }
    let (q, [a, b, c, d, e, f]) = (&q[..joints.len()], split(rows, joints.len()));
    for i in (0..joints.len()).rev() {
        let axis = [d[i], e[i], f[i]];
        lever = lever.plus(joints[i].way([a[i], b[i], c[i]], axis, q[i]));
        let (mut linear, mut angular) = joints[i].column(axis, lever);
        if reference == Reference::Local {
            (linear, angular) = (tool.seen(linear), tool.seen(angular));
        }
        [a[i], b[i], c[i]] = linear;
        [d[i], e[i], f[i]] = angular;
    }
    if reference != Reference::World {
        tool.p = first.plus(lever);
    }
}

/// The six rows of m numbers: what is asked for one place in them is asked for all.
#[inline(always)]
fn split<R>(rows: &mut [R], m: usize) -> [&mut [R]; 6] {
    let (a, rest) = rows.split_at_mut(m);
    let (b, rest) = rest.split_at_mut(m);
    let (c, rest) = rest.split_at_mut(m);
    let (d, rest) = rest.split_at_mut(m);
    let (e, f) = rest.split_at_mut(m);
    [a, b, c, d, e, &mut f[..m]]
}

/// The columns of joints as those of coordinates: at any places, zero, or the sum of several.
#[inline(always)]
fn sort<R: Real>(rows: &[R], serial: &Serial, coordinates: &[usize], columns: &mut [R]) {
    columns.fill(R::splat(0.0));
    let (m, n) = (serial.joints().len(), columns.len() / 6);
    for (row, out) in rows.chunks_exact(m).zip(columns.chunks_exact_mut(n)) {
        for (x, joint) in row.iter().zip(serial.joints()) {
            let place = coordinates[joint.coordinate];
            out[place] = out[place] + *x;
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

/// The first `count` lanes as rows.
#[inline(always)]
fn put<R: Real>(numbers: &[R], out: &mut [f64], count: usize) {
    let size = numbers.len();
    if count == R::LANES {
        R::scatter(numbers, out, size);
    } else {
        let mut all = vec![0.0; R::LANES * size];
        R::scatter(numbers, &mut all, size);
        out[..count * size].copy_from_slice(&all[..count * size]);
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
            large: true,
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
