//! The checksum of files and of what a recipe depends on: XXH3 of 128 bits, hexadecimal.
//!
//! Valid    against accidental changes; it is not collision-resistant
//! Why so   hashing is a small part of a written sweep, which it is not with SHA-256; `xxhsum -H128`
//!          verifies it
//! Source   Collet, xxHash, XXH3
//! Checked  tests::agrees_with_xxhash

use std::fmt;

use twox_hash::XxHash3_128;

/// A checksum of what is written to it.
pub(super) struct Checksum(XxHash3_128);

impl Checksum {
    pub(super) fn new() -> Self {
        Self(XxHash3_128::new())
    }

    /// That of these bytes.
    pub(super) fn of(bytes: &[u8]) -> String {
        format!("{:032x}", XxHash3_128::oneshot(bytes))
    }

    pub(super) fn update(&mut self, bytes: &[u8]) {
        self.0.write(bytes);
    }

    pub(super) fn finish(&self) -> String {
        format!("{:032x}", self.0.finish_128())
    }
}

impl fmt::Write for Checksum {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        self.update(text.as_bytes());
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `xxh3_128_hexdigest` of xxhash 4.1.0 (PyPI) for nothing, a short and a long text; in pieces of
    /// any size.
    #[test]
    fn agrees_with_xxhash() {
        let long = "cylindroid ".repeat(1000);
        for (text, expected) in [
            ("", "99aa06d3014798d86001c324468d497f"),
            ("cylindroid", "b1849f6b262e6e29d9d114a66b277317"),
            (long.as_str(), "3e01de17ed0a9c9842f75e7a7fedc27c"),
        ] {
            assert_eq!(Checksum::of(text.as_bytes()), expected);
            for size in [1, 7, 64, 1000] {
                let mut checksum = Checksum::new();
                text.as_bytes().chunks(size).for_each(|piece| checksum.update(piece));
                assert_eq!(checksum.finish(), expected, "{size}");
            }
        }
    }
}
