//! Batched forward kinematics and Jacobians of a serial chain: the kernel of
//! [`super::KinematicsBatch`], with one configuration in each SIMD lane.
//!
//! Formula  axes as in serial.rs, from the first joint to the tool; then back, l the lever from a
//!          joint to the tool, 0 at the tool: l += link offset, column [turn z x l + slide z; turn
//!          z]
//! Shapes   q: N x n, poses: N x 4 x 4, Jacobians: N x 6 x n, row-major
//! Units    rad, m; m/s and rad/s for each unit of joint velocity
//! Frame    [`ReferenceFrame`]
//! Why so   a single configuration is latency-bound, since each joint depends on the previous one;
//!          several joints or configurations at once are throughput-bound
//! Checked  tests/it/batch.rs (against [`super::Chain`] and [`super::State`]),
//!          tests::lanes_agree_with_plain_numbers

use super::jacobian::ReferenceFrame;
use super::serial::Serial;
use crate::scalar::{Array, MAX_LANES, Simd};
#[cfg(target_arch = "x86_64")]
use crate::scalar::{Avx2, Avx512, Lanes4, Lanes8};
use crate::spatial::{Columns, Vector3Like};

/// Input and requested output.
pub(super) struct Work<'a> {
    pub(super) serial: &'a Serial,
    /// The place in `q` of each coordinate of the chain.
    pub(super) coordinates: &'a [usize],
    /// Numbers of a configuration.
    pub(super) n: usize,
    pub(super) q: &'a [f64],
    pub(super) poses: Option<&'a mut [f64]>,
    pub(super) jacobians: Option<(ReferenceFrame, &'a mut [f64])>,
    /// True if the results of the whole call exceed the caches.
    pub(super) large: bool,
}

/// Numbers for each joint: coordinate, cosine, sine, rows.
const VALUES_PER_JOINT: usize = 9;
/// Numbers on the stack: those of 12 joints, or of a robot of 10 of which 7 move the end effector.
/// Calls for larger robots allocate once.
const STACK_LIMIT: usize = 12 * VALUES_PER_JOINT + 20;

/// Runs the widest form that the processor has.
pub(super) fn run(work: Work<'_>) {
    #[cfg(target_arch = "x86_64")]
    {
        #[allow(unsafe_code)] // the one way to call functions compiled for more than the baseline
        // SAFETY: the tokens prove that the processor has these features.
        unsafe {
            if let Some(cpu) = Avx512::detect() {
                return run_avx512(cpu, work);
            }
            if let Some(cpu) = Avx2::detect() {
                return run_avx2(cpu, work);
            }
        }
    }
    run_with::<Array<4>>((), work, forward);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx2,fma")]
fn run_avx512(cpu: Avx512, work: Work<'_>) {
    run_with::<Lanes8>(cpu, work, move |serial, turns, rows| {
        forward_avx512(cpu, serial, turns, rows)
    });
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn run_avx2(cpu: Avx2, work: Work<'_>) {
    run_with::<Lanes4>(cpu, work, move |serial, turns, rows| {
        forward_avx2(cpu, serial, turns, rows)
    });
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx2,fma")]
#[inline(never)] // as `forward_avx2`
fn forward_avx512(
    _: Avx512,
    serial: &Serial,
    turns: SinCos<'_, Lanes8>,
    rows: &mut [Lanes8],
) -> FrameAtTip<Lanes8> {
    forward(serial, turns, rows)
}

/// [`forward`], kept out of line: the frame occupies all vector registers, and inlining it next to
/// other live values would cause spills on the critical path.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
#[inline(never)]
pub(crate) fn forward_avx2(
    _: Avx2,
    serial: &Serial,
    turns: SinCos<'_, Lanes4>,
    rows: &mut [Lanes4],
) -> FrameAtTip<Lanes4> {
    forward(serial, turns, rows)
}

/// `forward` is [`forward`], inlined or out of line.
#[inline(always)]
fn run_with<R: Simd>(
    _: R::Cpu,
    mut work: Work<'_>,
    forward: impl Fn(&Serial, SinCos<'_, R>, &mut [R]) -> FrameAtTip<R>,
) {
    let Work { serial, coordinates, n, .. } = work;
    let joints = serial.joints();
    let m = joints.len();
    let zero = R::splat(0.0);
    let in_order = (0..m).all(|i| coordinates[joints[i].coordinate] == i);
    let in_place = work.jacobians.is_none() || (in_order && m == n);
    let size = m * VALUES_PER_JOINT + if in_place { 0 } else { 6 * n };
    let mut few = [zero; STACK_LIMIT];
    let mut many = vec![zero; if size <= STACK_LIMIT { 0 } else { size }];
    let memory = if size <= STACK_LIMIT { &mut few[..size] } else { &mut many[..] };
    let (x, memory) = memory.split_at_mut(m);
    let (cosines, memory) = memory.split_at_mut(m);
    let (sines, memory) = memory.split_at_mut(m);
    let (rows, columns) = memory.split_at_mut(6 * m);
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
        let turned = forward(serial, (sines, cosines), rows);
        let way = if let Some((reference, jacobians)) = &mut work.jacobians {
            let way = jacobian(serial, *reference, x, &turned, rows);
            let jacobians = &mut jacobians[done * 6 * n..];
            if in_place {
                put(rows, jacobians, count);
            } else {
                by_coordinates(rows, serial, coordinates, columns);
                put(columns, jacobians, count);
            }
            way
        } else {
            tool_offset(serial, x, rows)
        };
        if let Some(poses) = &mut work.poses {
            put(&turned.pose_rows(way), &mut poses[done * 16..], count);
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

/// Prefetches cache lines about to be written; otherwise the stores serialise on cache misses.
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
fn gather<R: Simd>(q: &[f64], n: usize, serial: &Serial, coordinates: &[usize], x: &mut [R]) {
    let last = q.len() / n - 1;
    let mut all = [&q[last * n..]; MAX_LANES];
    for (row, q) in all.iter_mut().zip(q.chunks_exact(n)) {
        *row = q;
    }
    for (x, joint) in x.iter_mut().zip(serial.joints()) {
        let place = coordinates[joint.coordinate];
        *x = R::from_fn(|l| all[l][place]);
    }
}

/// Sines and cosines of the angles of the joints.
pub(crate) type SinCos<'a, R> = (&'a [R], &'a [R]);

/// The result of [`forward`]: the axes of the tool, and the origin of the first joint.
pub(crate) struct FrameAtTip<R>(Columns<[R; 3]>);

impl<R: Simd> FrameAtTip<R> {
    /// The tool, for its offset from the origin of the first joint.
    #[inline(always)]
    pub(crate) fn tool(&self, way: [R; 3]) -> Columns<[R; 3]> {
        Columns { p: self.0.p.plus(way), ..self.0 }
    }

    /// The matrix of 4 x 4 of it.
    #[inline(always)]
    fn pose_rows(&self, way: [R; 3]) -> [R; 16] {
        let (Columns { x, y, z, .. }, p) = (&self.0, self.0.p.plus(way));
        let (o, one) = (R::splat(0.0), R::splat(1.0));
        [x[0], y[0], z[0], p[0], x[1], y[1], z[1], p[1], x[2], y[2], z[2], p[2], o, o, o, one]
    }
}

/// Forward kinematics along the chain: `rows` receive the axes x and z, one number for each joint.
///
/// Origins follow from them, on the way back, in [`jacobian`] or [`tool_offset`].
#[inline(always)]
pub(crate) fn forward<R: Simd>(
    serial: &Serial,
    (sines, cosines): SinCos<'_, R>,
    rows: &mut [R],
) -> FrameAtTip<R> {
    let joints = serial.joints();
    let m = joints.len();
    let (sines, cosines) = (&sines[..m], &cosines[..m]);
    let [a, b, c, d, e, f] = split(rows, m);
    let mut frame = serial.start::<[R; 3]>();
    for i in 0..m {
        frame = frame.rotated_z(sines[i], cosines[i]);
        [a[i], b[i], c[i]] = frame.x;
        [d[i], e[i], f[i]] = frame.z;
        frame = joints[i].next_axis_frame(frame);
    }
    FrameAtTip(serial.end(frame))
}

/// From the origin of the first joint to that of the tool, from the rows of [`forward`].
#[inline(always)]
pub(crate) fn tool_offset<R: Simd>(serial: &Serial, q: &[R], rows: &mut [R]) -> [R; 3] {
    let joints = serial.joints();
    let (q, [a, b, c, d, e, f]) = (&q[..joints.len()], split(rows, joints.len()));
    let mut way = [R::splat(0.0); 3];
    for i in (0..joints.len()).rev() {
        way = way.plus(joints[i].link_offset([a[i], b[i], c[i]], [d[i], e[i], f[i]], q[i]));
    }
    way
}

/// The Jacobian of the joints from the rows of [`forward`], in their place. Gives [`tool_offset`].
#[inline(always)]
pub(crate) fn jacobian<R: Simd>(
    serial: &Serial,
    reference: ReferenceFrame,
    q: &[R],
    turned: &FrameAtTip<R>,
    rows: &mut [R],
) -> [R; 3] {
    let joints = serial.joints();
    // From a joint, at first the tool, to the point whose velocity is requested.
    let mut lever = [R::splat(0.0); 3];
    let mut way = lever;
    if reference == ReferenceFrame::World {
        way = tool_offset(serial, q, rows);
        lever = turned.tool(way).p.negative();
    }
    let (q, [a, b, c, d, e, f]) = (&q[..joints.len()], split(rows, joints.len()));
    for i in (0..joints.len()).rev() {
        let axis = [d[i], e[i], f[i]];
        lever = lever.plus(joints[i].link_offset([a[i], b[i], c[i]], axis, q[i]));
        let (linear, angular) = joints[i].column(axis, lever);
        [a[i], b[i], c[i]] = linear;
        [d[i], e[i], f[i]] = angular;
    }
    if reference == ReferenceFrame::Local {
        for i in 0..joints.len() {
            [a[i], b[i], c[i]] = turned.0.inverse_transform_vector([a[i], b[i], c[i]]);
            [d[i], e[i], f[i]] = turned.0.inverse_transform_vector([d[i], e[i], f[i]]);
        }
    }
    if reference == ReferenceFrame::World { way } else { lever }
}

/// Six rows of m numbers, so that one bounds check serves all.
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
fn by_coordinates<R: Simd>(rows: &[R], serial: &Serial, coordinates: &[usize], columns: &mut [R]) {
    columns.fill(R::splat(0.0));
    let (m, n) = (serial.joints().len(), columns.len() / 6);
    for (row, out) in rows.chunks_exact(m).zip(columns.chunks_exact_mut(n)) {
        for (x, joint) in row.iter().zip(serial.joints()) {
            let place = coordinates[joint.coordinate];
            out[place] = out[place] + *x;
        }
    }
}

/// The first `count` lanes as rows.
// An allocation for the incomplete group, once a call, costs less than a branch in the path of
// complete ones.
#[inline(always)]
fn put<R: Simd>(numbers: &[R], out: &mut [f64], count: usize) {
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
    use crate::model::{JointKind, JointSpec, Mechanism, Mimic, catalogue};
    use crate::spatial::{Pose, Vec3};

    /// Three joints of two coordinates, one of which slides; and one that no chain reads.
    fn coupled() -> Mechanism {
        let mut b = Mechanism::builder("coupled");
        let there = Pose { translation: Vec3::new(0.2, -0.3, 0.4), ..Pose::IDENTITY };
        b.joint(JointSpec::new("aside", JointKind::Revolute, "base", "other"));
        b.joint(JointSpec::new("leader", JointKind::Revolute, "base", "a"));
        b.joint(JointSpec {
            parent_from_joint: there,
            ..JointSpec::new("slide", JointKind::Prismatic, "a", "b")
        });
        b.joint(JointSpec {
            parent_from_joint: there,
            axis: Vec3::new(0.1, 0.7, 0.2),
            mimic: Some(Mimic { joint: "leader".into(), multiplier: -1.7, offset: 0.2 }),
            ..JointSpec::new("follower", JointKind::Revolute, "b", "tip")
        });
        b.build().unwrap()
    }

    /// Poses and Jacobians in one list.
    fn of(
        chain: &Chain,
        (n, q): (usize, &[f64]),
        reference: ReferenceFrame,
        run: impl FnOnce(Work<'_>),
    ) -> Vec<f64> {
        let count = q.len() / n;
        let (mut poses, mut jacobians) = (vec![0.0; count * 16], vec![0.0; count * 6 * n]);
        run(Work {
            serial: chain.serial().unwrap(),
            coordinates: chain.coordinates(),
            n,
            q,
            poses: Some(&mut poses),
            jacobians: Some((reference, &mut jacobians)),
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
        let mut robots = vec![coupled()];
        let names = ["panda", "ur5e", "puma560", "youbot", "3r"];
        robots.extend(names.map(|name| catalogue::load(name).unwrap()));
        let references =
            [ReferenceFrame::LocalWorldAligned, ReferenceFrame::Local, ReferenceFrame::World];
        for (robot, reference) in robots.iter().flat_map(|robot| references.map(|r| (robot, r))) {
            let (name, n, tip) = (robot.name(), robot.n(), robot.tool());
            let chain = match name {
                "coupled" => Chain::of(robot, robot.frame("tip").unwrap()),
                _ => Chain::of(robot, tip),
            };
            let q: Vec<f64> =
                (0..n * 21).map(|i| f64::from(i as u32 * 7919 % 6283) / 1e3 - 3.1).collect();
            let of = |run: &dyn Fn(Work<'_>)| of(&chain, (n, &q), reference, run);
            let plain = of(&|work| run_with::<f64>((), work, forward));
            let near = |what: &str, other: &[f64]| {
                for (a, b) in plain.iter().zip(other) {
                    assert!((a - b).abs() <= 16.0 * f64::EPSILON, "{name} {what}: {a} and {b}");
                }
            };
            near("array", &of(&|work| run_with::<Array<4>>((), work, forward)));
            #[cfg(target_arch = "x86_64")]
            if let Some(cpu) = Avx2::detect() {
                // SAFETY: the token proves that the processor has these features.
                let four = of(&|work| unsafe { run_avx2(cpu, work) });
                near("four", &four);
                if let Some(cpu) = Avx512::detect() {
                    // SAFETY: as above.
                    let eight = of(&|work| unsafe { run_avx512(cpu, work) });
                    assert_eq!(four, eight);
                }
            }
        }
    }
}
