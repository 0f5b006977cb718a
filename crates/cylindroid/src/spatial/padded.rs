//! The pose as kernels hold it: four columns of four numbers, one register each.
//!
//! Shapes   x, y, z, p: the columns of the rotation and the translation; the fourth number is 0
//! Checked  kinematics/forward.rs::tests, tests/it/pinocchio.rs

use super::pose::Pose;
use super::rotation::Rotation;
use super::vec3::{Mat3, Vec3};

/// Four numbers that are computed with together. The plain array is the specification.
pub(crate) trait Column: Copy {
    /// True if products and sums are fused.
    const FUSED: bool;
    fn load(from: &[f64; 4]) -> Self;
    fn store(self) -> [f64; 4];
    /// `self * s`
    fn times(self, s: f64) -> Self;
    /// `self * s + b`
    fn times_plus(self, s: f64, b: Self) -> Self;
}

impl Column for [f64; 4] {
    const FUSED: bool = false;

    #[inline(always)]
    fn load(from: &[f64; 4]) -> Self {
        *from
    }

    #[inline(always)]
    fn store(self) -> [f64; 4] {
        self
    }

    #[inline(always)]
    fn times(self, s: f64) -> Self {
        [self[0] * s, self[1] * s, self[2] * s, self[3] * s]
    }

    #[inline(always)]
    fn times_plus(self, s: f64, b: Self) -> Self {
        [self[0] * s + b[0], self[1] * s + b[1], self[2] * s + b[2], self[3] * s + b[3]]
    }
}

#[cfg(target_arch = "x86_64")]
#[allow(unsafe_code)] // the compiler does not put four numbers into one register by itself here
mod avx2 {
    use std::arch::x86_64::{
        __m256d, _mm256_fmadd_pd, _mm256_loadu_pd, _mm256_mul_pd, _mm256_set1_pd, _mm256_storeu_pd,
    };

    /// One register. To be used only inside functions compiled for AVX2 and FMA.
    #[derive(Clone, Copy)]
    pub(crate) struct Register(__m256d);

    // SAFETY, for every call below: `Register` is named only by `forward_avx2`, which runs only
    // where the processor has AVX2 and FMA; loads and stores are of arrays of four numbers and
    // need no alignment.
    impl super::Column for Register {
        const FUSED: bool = true;

        #[inline(always)]
        fn load(from: &[f64; 4]) -> Self {
            // SAFETY: as above.
            Self(unsafe { _mm256_loadu_pd(from.as_ptr()) })
        }

        #[inline(always)]
        fn store(self) -> [f64; 4] {
            let mut to = [0.0; 4];
            // SAFETY: as above.
            unsafe { _mm256_storeu_pd(to.as_mut_ptr(), self.0) };
            to
        }

        #[inline(always)]
        fn times(self, s: f64) -> Self {
            // SAFETY: as above.
            Self(unsafe { _mm256_mul_pd(self.0, _mm256_set1_pd(s)) })
        }

        #[inline(always)]
        fn times_plus(self, s: f64, b: Self) -> Self {
            // SAFETY: as above.
            Self(unsafe { _mm256_fmadd_pd(self.0, _mm256_set1_pd(s), b.0) })
        }
    }
}

#[cfg(target_arch = "x86_64")]
pub(crate) use avx2::Register;

/// A pose `a_from_b`, padded.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C, align(32))]
pub(crate) struct Padded {
    x: [f64; 4],
    y: [f64; 4],
    z: [f64; 4],
    p: [f64; 4],
}

/// A padded pose while it is computed with.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Columns<C> {
    x: C,
    y: C,
    z: C,
    p: C,
}

impl<C: Column> Columns<C> {
    #[inline(always)]
    pub(crate) fn load(from: &Padded) -> Self {
        Self { x: C::load(&from.x), y: C::load(&from.y), z: C::load(&from.z), p: C::load(&from.p) }
    }

    #[inline(always)]
    pub(crate) fn store(self, to: &mut Padded) {
        to.x = self.x.store();
        to.y = self.y.store();
        to.z = self.z.store();
        to.p = self.p.store();
    }

    /// Turned about its own z axis.
    #[inline(always)]
    pub(crate) fn turned(self, sin: f64, cos: f64) -> Self {
        Self {
            x: self.y.times_plus(sin, self.x.times(cos)),
            y: self.x.times_plus(-sin, self.y.times(cos)),
            ..self
        }
    }

    /// Moved along its own z axis.
    #[inline(always)]
    pub(crate) fn slid(self, length: f64) -> Self {
        Self { p: self.z.times_plus(length, self.p), ..self }
    }

    /// `a_from_b.then(b_from_c) = a_from_c`
    #[inline(always)]
    pub(crate) fn then(self, o: &Padded) -> Self {
        let turn =
            |c: &[f64; 4]| self.y.times_plus(c[1], self.x.times_plus(c[0], self.z.times(c[2])));
        let from_z = self.z.times_plus(o.p[2], self.p);
        Self {
            x: turn(&o.x),
            y: turn(&o.y),
            z: turn(&o.z),
            p: self.y.times_plus(o.p[1], self.x.times_plus(o.p[0], from_z)),
        }
    }
}

impl Padded {
    /// Frame b is frame a.
    pub(crate) const IDENTITY: Self = Self {
        x: [1.0, 0.0, 0.0, 0.0],
        y: [0.0, 1.0, 0.0, 0.0],
        z: [0.0, 0.0, 1.0, 0.0],
        p: [0.0; 4],
    };

    /// The axes of b in a.
    #[inline]
    pub(crate) fn axes(&self) -> [Vec3; 3] {
        [unpadded(&self.x), unpadded(&self.y), unpadded(&self.z)]
    }

    /// Axis z of b in a.
    #[inline]
    pub(crate) fn z_axis(&self) -> Vec3 {
        unpadded(&self.z)
    }

    /// Origin of b in a.
    #[inline]
    pub(crate) fn translation(&self) -> Vec3 {
        unpadded(&self.p)
    }

    /// The same as a pose.
    #[inline]
    pub(crate) fn pose(&self) -> Pose {
        let [x, y, z] = self.axes();
        Pose {
            rotation: Rotation::assume(Mat3::from_cols(x, y, z)),
            translation: self.translation(),
        }
    }
}

impl From<Pose> for Padded {
    fn from(pose: Pose) -> Self {
        let pad = |v: Vec3| [v.x, v.y, v.z, 0.0];
        let [x, y, z] = pose.rotation.matrix().cols;
        Self { x: pad(x), y: pad(y), z: pad(z), p: pad(pose.translation) }
    }
}

#[inline(always)]
fn unpadded(c: &[f64; 4]) -> Vec3 {
    Vec3::new(c[0], c[1], c[2])
}
