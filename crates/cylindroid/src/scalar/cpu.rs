//! Proof that the processor has AVX2 or AVX-512, obtained by detection at run time.
//!
//! Valid    a token exists only if the features were detected. Each kernel takes the token of the
//!          lanes that it is compiled for ([`super::Simd::Cpu`]), so it cannot be called with
//!          lanes that the processor lacks.
//! Why so   a token has no size: it costs no instruction, where a flag passed along would be tested
//!          again. A check at each call alone leaves the proof to a comment.
//! Checked  src/kinematics/serial_batched.rs::lanes_agree_with_plain_numbers

/// Proof of AVX2 and fused multiply-add: what four lanes need.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Avx2(());

impl Avx2 {
    /// The token, if the processor has both features.
    #[inline]
    pub(crate) fn detect() -> Option<Self> {
        let detected = std::arch::is_x86_feature_detected!("avx2")
            && std::arch::is_x86_feature_detected!("fma");
        if detected { Some(Self(())) } else { None }
    }
}

/// Proof of AVX-512F, AVX2 and fused multiply-add: what eight lanes need.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Avx512(());

impl Avx512 {
    /// The token, if the processor has all three features.
    pub(crate) fn detect() -> Option<Self> {
        let detected = std::arch::is_x86_feature_detected!("avx512f") && Avx2::detect().is_some();
        if detected { Some(Self(())) } else { None }
    }
}
