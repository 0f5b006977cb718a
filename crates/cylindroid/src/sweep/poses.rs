//! Poses into columns of positions and unit quaternions, batched.
//!
//! Formula  Shepperd's method as in `spatial/quaternion.rs`: of four squares the largest first
//! Shapes   poses: N x 16, rows of 4 x 4 matrices; seven columns
//! Units    m, 1
//! Valid    any pose; the same to the bit as [`Quaternion::of_matrix`](crate::spatial::Quaternion)
//! Why so   which square is the largest is random: branches on it cost twice the
//!          time of the kinematics
//! Checked  tests::columns_are_those_of_single_poses

use crate::scalar::{Array, SimdFloat};
#[cfg(target_arch = "x86_64")]
use crate::scalar::{Avx2, Avx512, Lanes4, Lanes8};

/// Numbers of a pose.
pub(super) const POSE: usize = 16;

/// Appends the positions and quaternions of poses to seven columns.
pub(super) fn append(poses: &[f64], columns: &mut [&mut Vec<f64>]) {
    #[cfg(target_arch = "x86_64")]
    {
        #[allow(unsafe_code)] // the one way to call functions compiled for more
        // SAFETY: the tokens prove that the processor has these features.
        unsafe {
            if let Some(cpu) = Avx512::detect() {
                return append_avx512(cpu, poses, columns);
            }
            if let Some(cpu) = Avx2::detect() {
                return append_avx2(cpu, poses, columns);
            }
        }
    }
    append_with::<Array<4>>((), poses, columns);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx2,fma")]
fn append_avx512(cpu: Avx512, poses: &[f64], columns: &mut [&mut Vec<f64>]) {
    append_with::<Lanes8>(cpu, poses, columns);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn append_avx2(cpu: Avx2, poses: &[f64], columns: &mut [&mut Vec<f64>]) {
    append_with::<Lanes4>(cpu, poses, columns);
}

#[inline(always)]
fn append_with<R: SimdFloat>(_: R::Cpu, poses: &[f64], columns: &mut [&mut Vec<f64>]) {
    let mut entries = [R::splat(0.0); POSE];
    let mut rest = vec![0.0; R::LANES * POSE];
    let mut lanes = vec![0.0; R::LANES];
    for from in poses.chunks(R::LANES * POSE) {
        let count = from.len() / POSE;
        if count == R::LANES {
            R::gather(from, POSE, &mut entries);
        } else {
            // Lanes that are left over have no rotation, which is as good as any.
            rest[..from.len()].copy_from_slice(from);
            R::gather(&rest, POSE, &mut entries);
        }
        for (column, own) in columns.iter_mut().zip(position_and_quaternion(&entries)) {
            own.store(&mut lanes);
            column.extend_from_slice(&lanes[..count]);
        }
    }
}

/// x, y, z, then w, x, y, z of the quaternion.
#[inline(always)]
fn position_and_quaternion<R: SimdFloat>(m: &[R; POSE]) -> [R; 7] {
    let (zero, one) = (R::splat(0.0), R::splat(1.0));
    // Four times the squared components; the largest is at least 1.
    let squares = [
        one + m[0] + m[5] + m[10],
        one + m[0] - m[5] - m[10],
        one - m[0] + m[5] - m[10],
        one - m[0] - m[5] + m[10],
    ];
    let (yz, zx, xy) = (m[9] - m[6], m[2] - m[8], m[4] - m[1]); // 4 w (x, y, z)
    let (pyz, pzx, pxy) = (m[9] + m[6], m[2] + m[8], m[4] + m[1]); // 4 (yz, zx, xy)
    let others =
        [[yz, squares[1], pxy, pzx], [zx, pxy, squares[2], pyz], [xy, pzx, pyz, squares[3]]];
    let (mut largest, mut q) = (squares[0], [squares[0], yz, zx, xy]);
    for (square, other) in squares[1..].iter().zip(others) {
        for (own, other) in q.iter_mut().zip(other) {
            *own = R::select_lt(largest, *square, other, *own);
        }
        largest = R::select_lt(largest, *square, *square, largest);
    }
    let mut first = one;
    for own in q.iter().rev() {
        first = R::select_lt(zero, own.abs(), *own, first);
    }
    let sign = one.copysign(first);
    let q = q.map(|own| own * sign);
    let scale = one / (q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]).sqrt();
    [m[3], m[7], m[11], q[0] * scale, q[1] * scale, q[2] * scale, q[3] * scale]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scalar::uniform;
    use crate::spatial::{Pose, Quaternion, Rotation, Vec3};

    #[test]
    fn columns_are_those_of_single_poses() {
        let mut random = 3;
        let mut draw = || Vec3::from_array([0; 3].map(|_| 6.0 * uniform(&mut random) - 3.0));
        let mut poses: Vec<Pose> = (0..43)
            .map(|_| Pose { rotation: Rotation::exp(draw()), translation: draw() })
            .collect();
        // Half turns, of which two quaternions are possible, and none.
        for axis in [Vec3::X, Vec3::Y, Vec3::Z, Vec3::new(1.0, -1.0, 0.0)] {
            let rotation = Rotation::about(axis, std::f64::consts::PI).unwrap();
            poses.push(Pose::from_rotation(rotation));
        }
        poses.push(Pose::IDENTITY);
        let numbers: Vec<f64> =
            poses.iter().flat_map(|pose| pose.to_matrix().into_iter().flatten()).collect();
        let check = |append: fn(&[f64], &mut [&mut Vec<f64>])| {
            for count in [0, 1, 7, 8, poses.len()] {
                let mut columns = vec![Vec::new(); 7];
                let own = &numbers[..POSE * count];
                append(own, &mut columns.iter_mut().collect::<Vec<_>>());
                assert!(columns.iter().all(|column| column.len() == count));
                for (i, pose) in poses[..count].iter().enumerate() {
                    let Quaternion { w, x, y, z } = Quaternion::of_matrix(pose.rotation.matrix());
                    let p = pose.translation;
                    for (column, expected) in columns.iter().zip([p.x, p.y, p.z, w, x, y, z]) {
                        assert_eq!(column[i].to_bits(), expected.to_bits(), "{pose:?}");
                    }
                }
            }
        };
        check(append);
        check(|poses, columns| append_with::<Array<4>>((), poses, columns));
    }
}
