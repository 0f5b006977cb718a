//! The reason why a frame is the default frame of a mechanism.
//!
//! Checked  tests/formats/tool.rs

use std::fmt;

/// The reason why a frame is the tool of a mechanism.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum ToolChoice {
    /// The file names it, or [`Builder::tool`](super::Builder::tool).
    Named,
    /// Its name contains this word.
    Word(&'static str),
    /// It is at the end of the only chain of moving joints, of this many.
    OnlyChain(usize),
    /// It is at the end of the longest chain of moving joints, of this many.
    LongestChain(usize),
}

impl fmt::Display for ToolChoice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let joints = |n: usize| if n == 1 { "joint" } else { "joints" };
        match *self {
            Self::Named => f.write_str("named by the model"),
            Self::Word(word) => write!(f, "its name contains '{word}'"),
            Self::OnlyChain(0) => f.write_str("no joint moves"),
            Self::OnlyChain(n) => write!(f, "end of the only chain, {n} {}", joints(n)),
            Self::LongestChain(n) => write!(f, "end of the longest chain, {n} {}", joints(n)),
        }
    }
}
