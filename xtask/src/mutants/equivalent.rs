//! Mutants that change nothing that a test could see, each with the reason.
//!
//! Format   lines of file, old expression, new one and reason, between them tabs; `#` begins a
//!          comment

use std::fs;

use anyhow::{Context, Result, bail};

use super::mutant::Mutant;
use crate::shell::root;

const LIST: &str = "xtask/equivalent-mutants.txt";

/// The list.
#[derive(Debug)]
pub(super) struct Equivalent(Vec<[String; 3]>);

impl Equivalent {
    /// # Errors
    /// A line without four parts.
    pub(super) fn load() -> Result<Self> {
        let text = fs::read_to_string(root().join(LIST)).context(LIST)?;
        Self::parse(&text)
    }

    fn parse(text: &str) -> Result<Self> {
        let mut entries = Vec::new();
        for line in text.lines().filter(|line| !line.is_empty() && !line.starts_with('#')) {
            let parts: Vec<&str> = line.split('\t').collect();
            match parts[..] {
                [file, old, new, reason] if !reason.trim().is_empty() => {
                    entries.push([file, old, new].map(str::to_owned));
                }
                _ => bail!("{LIST}: not FILE, OLD, NEW and REASON between tabs: {line}"),
            }
        }
        Ok(Self(entries))
    }

    pub(super) fn contains(&self, mutant: &Mutant) -> bool {
        self.0.iter().any(|entry| *entry == [&*mutant.file, &*mutant.old, &*mutant.new])
    }
}

#[cfg(test)]
mod tests {
    use super::{Equivalent, Mutant};

    #[test]
    fn lines_name_a_mutant_and_a_reason() {
        let list = Equivalent::parse("# why\n\na.rs\tx < y\tx > y\tonly slower\n").unwrap();
        let mutant = |new: &str| Mutant {
            file: "a.rs".to_owned(),
            line: 7,
            range: 0..1,
            old: "x < y".to_owned(),
            new: new.to_owned(),
        };
        assert!(list.contains(&mutant("x > y")) && !list.contains(&mutant("x == y")));
        assert!(Equivalent::parse("a.rs\tx < y\tx > y\t\n").is_err());
    }
}
