//! Forward kinematics and the Jacobian of a serial chain, one configuration at a time.
//!
//! Formula  serial.rs
//! Shapes   `slots[1..]`: of each joint the axis z and the origin (x and y are not written), then
//!          the tool; the Jacobian 6 x n
//! Units    rad, m; m/s and rad/s for each unit of joint velocity
//! Frame    world axes; the point is the tool's origin or any other
//! Why so   written once over [`SingleVector3`]: three numbers, or one register of them
//! Checked  tests/it/batch.rs::chains_agree_with_trees, tests/it/pinocchio.rs

use super::forward::{CHUNK, sines};
use super::serial::Serial;
use crate::linalg::Matrix;
#[cfg(target_arch = "x86_64")]
use crate::scalar::Avx2;
#[cfg(target_arch = "x86_64")]
use crate::spatial::PackedVec3;
use crate::spatial::{AlignedPose, SingleVector3};

/// Forward kinematics along the chain.
#[inline]
pub(super) fn forward(serial: &Serial, q: &[f64], slots: &mut [AlignedPose]) {
    #[cfg(target_arch = "x86_64")]
    if let Some(cpu) = Avx2::detect() {
        #[allow(unsafe_code)] // the one way to call a function compiled for more than the baseline
        // SAFETY: the token proves that the processor has both features.
        unsafe {
            forward_avx2(cpu, serial, q, slots);
        }
        return;
    }
    forward_with::<[f64; 3]>((), serial, q, slots);
}

/// The columns of the Jacobian in world axes at the point p, from the slots of [`forward`]; two
/// joints must not share a coordinate.
#[inline]
pub(super) fn jacobian(serial: &Serial, slots: &[AlignedPose], p: &[f64; 4], out: &mut Matrix) {
    #[cfg(target_arch = "x86_64")]
    if let Some(cpu) = Avx2::detect() {
        #[allow(unsafe_code)] // as above
        // SAFETY: the token proves that the processor has both features.
        unsafe {
            jacobian_avx2(cpu, serial, slots, p, out);
        }
        return;
    }
    jacobian_with::<[f64; 3]>((), serial, slots, p, out);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn forward_avx2(cpu: Avx2, serial: &Serial, q: &[f64], slots: &mut [AlignedPose]) {
    forward_with::<PackedVec3>(cpu, serial, q, slots);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn jacobian_avx2(
    cpu: Avx2,
    serial: &Serial,
    slots: &[AlignedPose],
    p: &[f64; 4],
    out: &mut Matrix,
) {
    jacobian_with::<PackedVec3>(cpu, serial, slots, p, out);
}

#[inline(always)]
fn forward_with<T: SingleVector3>(
    _: T::Cpu,
    serial: &Serial,
    q: &[f64],
    slots: &mut [AlignedPose],
) {
    let mut frame = serial.start::<T>();
    for (chunk, (joints, angles)) in serial.chunks().enumerate() {
        // All angles first: they are independent, four to a register.
        let (sin, cos) = sines::<T::Wide>(|k| angles.at(k, q));
        let slots = &mut slots[chunk * CHUNK + 1..][..joints.len()];
        for (k, (joint, slot)) in joints.iter().zip(slots).enumerate() {
            frame = joint.after_joint(frame, sin[k], cos[k], q[joint.coordinate]);
            frame.store_axis(slot);
            frame = joint.next_joint_frame(frame);
        }
    }
    serial.end(frame).store(&mut slots[serial.joints().len() + 1]);
}

#[inline(always)]
fn jacobian_with<T: SingleVector3>(
    _: T::Cpu,
    serial: &Serial,
    slots: &[AlignedPose],
    p: &[f64; 4],
    out: &mut Matrix,
) {
    let p = T::load(p);
    let (columns, _) = out.as_mut_slice().as_chunks_mut::<6>();
    for (joint, slot) in serial.joints().iter().zip(&slots[1..]) {
        let (linear, angular) = joint.column(T::load(&slot.z), p.minus(T::load(&slot.p)));
        T::store_pair(linear, angular, &mut columns[joint.coordinate]);
    }
}
