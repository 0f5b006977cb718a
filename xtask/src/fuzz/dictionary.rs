//! A dictionary for libFuzzer: the short texts in the sources of a reader, which are the names that
//! it knows.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use anyhow::{Context, Result};
use syn::visit::Visit;

use crate::layers::source::files;

/// Longer texts are sentences [bytes].
const LONGEST: usize = 24;

/// Words that mean something to every reader.
const MUTATIONS: &str = "crates/cylindroid/tests/formats/mutation.rs";

/// Writes the texts of the sources in these folders or files.
///
/// # Errors
/// Sources that cannot be read or parsed.
pub(super) fn write(root: &Path, sources: &[&str], to: &Path) -> Result<()> {
    let mut words = Words::default();
    for source in sources.iter().chain([&MUTATIONS]) {
        let path = root.join(source);
        let all = if path.is_dir() { files(&path, &["rs"])? } else { vec![path] };
        for file in all {
            let text = fs::read_to_string(&file).with_context(|| file.display().to_string())?;
            words.visit_file(&syn::parse_file(&text)?);
        }
    }
    let lines = words.0.iter().map(|word| format!("\"{}\"\n", escaped(word)));
    // libFuzzer refuses an empty file.
    fs::write(to, format!("# words\n{}", lines.collect::<String>()))?;
    Ok(())
}

/// As libFuzzer reads it.
fn escaped(word: &str) -> String {
    let one = |b: u8| match b {
        b'"' | b'\\' => format!("\\{}", char::from(b)),
        b' '..=b'~' => char::from(b).to_string(),
        _ => format!("\\x{b:02X}"),
    };
    word.bytes().map(one).collect()
}

#[derive(Default)]
struct Words(BTreeSet<String>);

impl<'ast> Visit<'ast> for Words {
    fn visit_lit_str(&mut self, text: &'ast syn::LitStr) {
        let text = text.value();
        let is_word = !text.is_empty() && text.len() <= LONGEST && !text.contains(['{', ' ']);
        if is_word {
            self.0.insert(text);
        }
    }
}

#[cfg(test)]
mod tests {
    use syn::visit::Visit;

    use super::{Words, escaped};

    #[test]
    fn short_texts_are_words() {
        let mut words = Words::default();
        let text = r#"fn f() { g("axis", "a sentence", "{x}", ["lower"]); }"#;
        words.visit_file(&syn::parse_file(text).unwrap());
        assert_eq!(words.0.into_iter().collect::<Vec<_>>(), ["axis", "lower"]);
        assert_eq!(escaped("a\"\\\n"), "a\\\"\\\\\\x0A");
    }
}
