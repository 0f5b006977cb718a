//! SplitMix64, a pseudo-random generator: reproducible samples and initial guesses.
//!
//! Valid    not for cryptography; equal seeds give equal sequences on all platforms
//! Source   Steele, Lea & Flood 2014
//! Checked  tests/it/ik.rs, tests/it/closure/modes.rs

/// The next number in [0, 1) of the sequence (SplitMix64); `state` is updated.
pub(crate) fn uniform(state: &mut u64) -> f64 {
    *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let mut z = *state;
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
}
