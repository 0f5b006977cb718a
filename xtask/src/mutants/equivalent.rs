//! Mutants that change nothing that a test could see, each with the reason.
//!
//! Format   lines of file, text of the line, old expression, new one and reason, between them tabs;
//!          `#` begins a comment

use std::fs;

use anyhow::{Context, Result, bail};

use super::mutant::Mutant;
use crate::shell::root;

const LIST: &str = "xtask/equivalent-mutants.txt";

/// The list.
#[derive(Debug)]
pub(super) struct Equivalent(Vec<[String; 4]>);

impl Equivalent {
    /// # Errors
    /// A line without five parts.
    pub(super) fn load() -> Result<Self> {
        let text = fs::read_to_string(root().join(LIST)).context(LIST)?;
        Self::parse(&text)
    }

    fn parse(text: &str) -> Result<Self> {
        let mut entries = Vec::new();
        for line in text.lines().filter(|line| !line.is_empty() && !line.starts_with('#')) {
            let parts: Vec<&str> = line.split('\t').collect();
            match parts[..] {
                [file, text, old, new, reason] if !reason.trim().is_empty() => {
                    entries.push([file, text, old, new].map(str::to_owned));
                }
                _ => bail!("{LIST}: not FILE, LINE, OLD, NEW and REASON between tabs: {line}"),
            }
        }
        Ok(Self(entries))
    }

    pub(super) fn contains(&self, mutant: &Mutant) -> bool {
        let Mutant { file, text, old, new, .. } = mutant;
        self.0.iter().any(|entry| entry.each_ref() == [file, text, old, new])
    }
}

#[cfg(test)]
mod tests {
    use super::{Equivalent, Mutant};

    #[test]
    fn lines_name_a_mutant_and_a_reason() {
        let list =
            Equivalent::parse("# why\n\na.rs\tif x < y {\tx < y\tx > y\tonly slower\n").unwrap();
        let mutant = |new: &str| Mutant {
            file: "a.rs".to_owned(),
            line: 7,
            text: "if x < y {".to_owned(),
            range: 0..1,
            old: "x < y".to_owned(),
            new: new.to_owned(),
        };
        assert!(list.contains(&mutant("x > y")) && !list.contains(&mutant("x == y")));
        let elsewhere = Mutant { text: "while x < y {".to_owned(), ..mutant("x > y") };
        assert!(!list.contains(&elsewhere));
        assert!(Equivalent::parse("a.rs\tif x < y {\tx < y\tx > y\t\n").is_err());
    }
}
