//! Three-component vectors of kernels, and the frames that they make.
//!
//! A kernel is written once over [`Vector3Like`]: for three scalars or three registers of lanes (an
//! array, the specification), and for one configuration with its three components in one register.
//!
//! Checked  src/kinematics/forward.rs::fused_and_plain_agree,
//!          src/kinematics/serial_batched.rs::lanes_agree_with_plain_numbers

use super::aligned_pose::AlignedPose;
use crate::scalar::Simd;

/// A vector of three components.
pub(crate) trait Vector3Like: Copy {
    /// Its scalars.
    type Scalar: Simd;
    /// The same in all lanes; the fourth number is 0.
    fn load(from: &[f64; 4]) -> Self;
    /// `self * s`
    fn times(self, s: Self::Scalar) -> Self;
    /// `self * s + b`
    fn mul_add(self, s: Self::Scalar, b: Self) -> Self;
    /// `self + b`
    fn plus(self, b: Self) -> Self;
    /// `self - b`
    fn minus(self, b: Self) -> Self;
    /// `-self`
    fn negative(self) -> Self;
    /// `self x b`
    fn cross(self, b: Self) -> Self;
}

/// A vector of a single configuration.
pub(crate) trait SingleVector3: Vector3Like<Scalar = f64> {
    /// Proof that the processor has the required features; `()` where there are none.
    type Cpu: Copy;
    /// Lanes for the sines and cosines of several angles.
    type Wide: Simd;
    /// The numbers, the fourth one 0.
    fn store(self, to: &mut [f64; 4]);
    /// Three numbers and three more.
    fn store_pair(first: Self, second: Self, to: &mut [f64; 6]);
}

impl<R: Simd> Vector3Like for [R; 3] {
    type Scalar = R;

    #[inline(always)]
    fn load(from: &[f64; 4]) -> Self {
        [R::splat(from[0]), R::splat(from[1]), R::splat(from[2])]
    }

    #[inline(always)]
    fn times(self, s: R) -> Self {
        [self[0] * s, self[1] * s, self[2] * s]
    }

    #[inline(always)]
    fn mul_add(self, s: R, b: Self) -> Self {
        [self[0].mul_add(s, b[0]), self[1].mul_add(s, b[1]), self[2].mul_add(s, b[2])]
    }

    #[inline(always)]
    fn plus(self, b: Self) -> Self {
        [self[0] + b[0], self[1] + b[1], self[2] + b[2]]
    }

    #[inline(always)]
    fn minus(self, b: Self) -> Self {
        [self[0] - b[0], self[1] - b[1], self[2] - b[2]]
    }

    #[inline(always)]
    fn negative(self) -> Self {
        [-self[0], -self[1], -self[2]]
    }

    #[inline(always)]
    fn cross(self, b: Self) -> Self {
        [
            self[1].mul_add(b[2], -(self[2] * b[1])),
            self[2].mul_add(b[0], -(self[0] * b[2])),
            self[0].mul_add(b[1], -(self[1] * b[0])),
        ]
    }
}

impl SingleVector3 for [f64; 3] {
    type Cpu = ();
    type Wide = f64;

    #[inline(always)]
    fn store(self, to: &mut [f64; 4]) {
        *to = [self[0], self[1], self[2], 0.0];
    }

    #[inline(always)]
    fn store_pair(first: Self, second: Self, to: &mut [f64; 6]) {
        *to = [first[0], first[1], first[2], second[0], second[1], second[2]];
    }
}

#[cfg(target_arch = "x86_64")]
#[allow(unsafe_code)] // the compiler does not put three numbers into one register by itself
mod avx2 {
    use std::arch::x86_64::{
        __m256d, _mm_storeu_pd, _mm256_add_pd, _mm256_blend_pd, _mm256_castpd256_pd128,
        _mm256_fmadd_pd, _mm256_fmsub_pd, _mm256_loadu_pd, _mm256_mul_pd, _mm256_permute4x64_pd,
        _mm256_set1_pd, _mm256_setzero_pd, _mm256_storeu_pd, _mm256_sub_pd,
    };

    /// One register: three numbers and a 0. Values exist only inside functions that are compiled
    /// for AVX2 and FMA and take [`Avx2`](crate::scalar::Avx2), the proof that the processor has
    /// them.
    #[derive(Debug, Clone, Copy)]
    pub(crate) struct PackedVec3(__m256d);

    // SAFETY, for every call below: as said above; loads are of arrays of four numbers and need no
    // alignment.
    impl super::Vector3Like for PackedVec3 {
        type Scalar = f64;

        #[inline(always)]
        fn load(from: &[f64; 4]) -> Self {
            // SAFETY: as above.
            Self(unsafe { _mm256_loadu_pd(from.as_ptr()) })
        }

        #[inline(always)]
        fn times(self, s: f64) -> Self {
            // SAFETY: as above.
            Self(unsafe { _mm256_mul_pd(self.0, _mm256_set1_pd(s)) })
        }

        #[inline(always)]
        fn mul_add(self, s: f64, b: Self) -> Self {
            // SAFETY: as above.
            Self(unsafe { _mm256_fmadd_pd(self.0, _mm256_set1_pd(s), b.0) })
        }

        #[inline(always)]
        fn plus(self, b: Self) -> Self {
            // SAFETY: as above.
            Self(unsafe { _mm256_add_pd(self.0, b.0) })
        }

        #[inline(always)]
        fn minus(self, b: Self) -> Self {
            // SAFETY: as above.
            Self(unsafe { _mm256_sub_pd(self.0, b.0) })
        }

        #[inline(always)]
        fn negative(self) -> Self {
            // SAFETY: as above.
            Self(unsafe { _mm256_sub_pd(_mm256_setzero_pd(), self.0) })
        }

        #[inline(always)]
        fn cross(self, b: Self) -> Self {
            // y, z, x of each; a x b turned by one place is a b' - a' b
            const NEXT: i32 = 0b11_00_10_01;
            // SAFETY: as above.
            unsafe {
                let (a_next, b_next) =
                    (_mm256_permute4x64_pd::<NEXT>(self.0), _mm256_permute4x64_pd::<NEXT>(b.0));
                let turned = _mm256_fmsub_pd(self.0, b_next, _mm256_mul_pd(a_next, b.0));
                Self(_mm256_permute4x64_pd::<NEXT>(turned))
            }
        }
    }

    impl super::SingleVector3 for PackedVec3 {
        type Cpu = crate::scalar::Avx2;
        type Wide = crate::scalar::Lanes4;

        #[inline(always)]
        fn store(self, to: &mut [f64; 4]) {
            // SAFETY: as above.
            unsafe { _mm256_storeu_pd(to.as_mut_ptr(), self.0) }
        }

        #[inline(always)]
        fn store_pair(first: Self, second: Self, to: &mut [f64; 6]) {
            // x y z x' and y' z'
            const TURNED: i32 = 0b00_10_01_00;
            // SAFETY: as above; six places are there.
            unsafe {
                let turned = _mm256_permute4x64_pd::<TURNED>(second.0);
                let four = _mm256_blend_pd::<0b1000>(first.0, turned);
                let last = _mm256_permute4x64_pd::<0b11_11_10_01>(second.0);
                _mm256_storeu_pd(to.as_mut_ptr(), four);
                _mm_storeu_pd(to.as_mut_ptr().add(4), _mm256_castpd256_pd128(last));
            }
        }
    }
}

#[cfg(target_arch = "x86_64")]
pub(crate) use avx2::PackedVec3;

/// A pose `a_from_b` in a kernel: axes and origin of b in a.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Columns<T> {
    pub(crate) x: T,
    pub(crate) y: T,
    pub(crate) z: T,
    pub(crate) p: T,
}

impl<T: Vector3Like> Columns<T> {
    #[inline(always)]
    pub(crate) fn load(from: &AlignedPose) -> Self {
        Self { x: T::load(&from.x), y: T::load(&from.y), z: T::load(&from.z), p: T::load(&from.p) }
    }

    /// Rotated about its own z axis.
    #[inline(always)]
    pub(crate) fn rotated_z(self, sin: T::Scalar, cos: T::Scalar) -> Self {
        Self {
            x: self.y.mul_add(sin, self.x.times(cos)),
            y: self.x.mul_add(-sin, self.y.times(cos)),
            ..self
        }
    }

    /// Rotated about its own x axis.
    #[inline(always)]
    pub(crate) fn rotated_x(self, sin: T::Scalar, cos: T::Scalar) -> Self {
        Self {
            y: self.z.mul_add(sin, self.y.times(cos)),
            z: self.y.mul_add(-sin, self.z.times(cos)),
            ..self
        }
    }

    /// Rotated about its own x axis by a right angle.
    #[inline(always)]
    pub(crate) fn rotated_x_90(self) -> Self {
        Self { y: self.z, z: self.y.negative(), ..self }
    }

    /// Translated along its own z axis.
    #[inline(always)]
    pub(crate) fn translated_z(self, length: T::Scalar) -> Self {
        Self { p: self.z.mul_add(length, self.p), ..self }
    }

    /// Translated by a vector in its own axes.
    #[inline(always)]
    pub(crate) fn translated(self, by: &[f64; 4]) -> Self {
        let k = T::Scalar::splat;
        let from_z = self.z.mul_add(k(by[2]), self.p);
        Self { p: self.y.mul_add(k(by[1]), self.x.mul_add(k(by[0]), from_z)), ..self }
    }

    /// The same without a component along y.
    #[inline(always)]
    pub(crate) fn translated_xz(self, by: &[f64; 4]) -> Self {
        let k = T::Scalar::splat;
        Self { p: self.x.mul_add(k(by[0]), self.z.mul_add(k(by[2]), self.p)), ..self }
    }

    /// `a_from_b.then(b_from_c) = a_from_c`
    #[inline(always)]
    pub(crate) fn then(self, o: &AlignedPose) -> Self {
        Self {
            x: self.rotated(&o.x),
            y: self.rotated(&o.y),
            z: self.rotated(&o.z),
            p: self.translated(&o.p).p,
        }
    }

    /// A vector from the axes of b to those of a.
    // No closures here and in other kernels: only functions can be forced inline, and code that is
    // not inlined is compiled for the baseline.
    #[inline(always)]
    fn rotated(self, v: &[f64; 4]) -> T {
        let k = T::Scalar::splat;
        self.y.mul_add(k(v[1]), self.x.mul_add(k(v[0]), self.z.times(k(v[2]))))
    }
}

impl<R: Simd> Columns<[R; 3]> {
    /// A vector from the axes of a to those of b.
    #[inline(always)]
    pub(crate) fn inverse_transform_vector(&self, v: [R; 3]) -> [R; 3] {
        [dot(self.x, v), dot(self.y, v), dot(self.z, v)]
    }

    /// A vector from the axes of b to those of a.
    #[inline(always)]
    pub(crate) fn transform_vector(&self, v: [R; 3]) -> [R; 3] {
        let Self { x, y, z, .. } = self;
        [
            x[0].mul_add(v[0], y[0].mul_add(v[1], z[0] * v[2])),
            x[1].mul_add(v[0], y[1].mul_add(v[1], z[1] * v[2])),
            x[2].mul_add(v[0], y[2].mul_add(v[1], z[2] * v[2])),
        ]
    }
}

/// Scalar product.
#[inline(always)]
pub(crate) fn dot<R: Simd>(a: [R; 3], b: [R; 3]) -> R {
    a[0].mul_add(b[0], a[1].mul_add(b[1], a[2] * b[2]))
}

impl<T: SingleVector3> Columns<T> {
    #[inline(always)]
    pub(crate) fn store(self, to: &mut AlignedPose) {
        self.x.store(&mut to.x);
        self.y.store(&mut to.y);
        self.z.store(&mut to.z);
        self.p.store(&mut to.p);
    }

    /// Only axis z and origin.
    #[inline(always)]
    pub(crate) fn store_axis(self, to: &mut AlignedPose) {
        self.z.store(&mut to.z);
        self.p.store(&mut to.p);
    }
}
