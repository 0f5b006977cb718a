//! FNV-1a: a hash of bytes that is the same on every machine and in every version.
//!
//! Source   Fowler, Noll & Vo (64 bits)
//! Checked  tests/it/linkages/views.rs (results do not depend on the order of names), tests/it/model.rs

/// The hash of the bytes.
pub(crate) fn fnv1a(bytes: impl IntoIterator<Item = u8>) -> u64 {
    bytes.into_iter().fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3)
    })
}
