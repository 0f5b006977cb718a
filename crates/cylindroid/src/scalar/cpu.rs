//! Proof that the processor has AVX2 or AVX-512, obtained by detection at run time.
//!
//! Valid    a token exists only if the features were detected. Each kernel takes the token of the
//!          lanes that it is compiled for ([`super::Simd::Cpu`]), so it cannot be called with
//!          lanes that the processor lacks. The environment variable CYLINDROID_SIMD leaves features
//!          unused: "scalar" both, "avx2" AVX-512; it is read once, and other values change nothing
//! Why so   a token has no size: it costs no instruction, where a flag passed along would be tested
//!          again. A check at each call alone leaves the proof to a comment. The variable makes one
//!          machine run all forms that it has.
//! Checked  src/kinematics/serial_batched.rs::lanes_agree_with_plain_numbers,
//!          tests/it/simd.rs

use std::sync::atomic::{AtomicU8, Ordering};

/// Neither detected nor limited yet.
const UNKNOWN: u8 = 0;
const SCALAR: u8 = 1;
const AVX2: u8 = 2;
const AVX512: u8 = 3;

/// The features in use.
static LEVEL: AtomicU8 = AtomicU8::new(UNKNOWN);

/// The features in use; each level includes those before it.
#[inline]
fn level() -> u8 {
    // Threads that come first find the same.
    match LEVEL.load(Ordering::Relaxed) {
        UNKNOWN => find_level(),
        level => level,
    }
}

#[cold]
#[inline(never)]
fn find_level() -> u8 {
    let avx2 =
        std::arch::is_x86_feature_detected!("avx2") && std::arch::is_x86_feature_detected!("fma");
    let avx512 = avx2 && std::arch::is_x86_feature_detected!("avx512f");
    let detected = if avx512 {
        AVX512
    } else if avx2 {
        AVX2
    } else {
        SCALAR
    };
    let most = match std::env::var("CYLINDROID_SIMD").as_deref() {
        Ok("scalar") => SCALAR,
        Ok("avx2") => AVX2,
        _ => AVX512,
    };
    let level = detected.min(most);
    LEVEL.store(level, Ordering::Relaxed);
    level
}

/// Proof of AVX2 and fused multiply-add: what four lanes need.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Avx2(());

impl Avx2 {
    /// The token, if the processor has both features and they are in use.
    #[inline]
    pub(crate) fn detect() -> Option<Self> {
        if level() >= AVX2 { Some(Self(())) } else { None }
    }
}

/// Proof of AVX-512F, AVX2 and fused multiply-add: what eight lanes need.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Avx512(());

impl Avx512 {
    /// The token, if the processor has all three features and they are in use.
    #[inline]
    pub(crate) fn detect() -> Option<Self> {
        if level() >= AVX512 { Some(Self(())) } else { None }
    }
}
