//! Imports among the page's TypeScript files.

use std::path::{Component, Path, PathBuf};

use anyhow::Result;

use super::graph::Import;
use super::source::{below, files, text_of};

/// Every relative import (`from "./x"`, `import "./x"`, `import("./x")`) of the files below a
/// folder, types included. File names are relative to `root`.
///
/// # Errors
/// A file that cannot be read.
pub(super) fn imports(root: &Path, folder: &Path) -> Result<Vec<Import>> {
    let all = files(&root.join(folder), &["ts"])?;
    let mut found = Vec::new();
    for file in &all {
        for (number, line) in text_of(file)?.lines().enumerate() {
            for name in relative_names(line) {
                let base = normal(&file.with_file_name("").join(name));
                let candidates = [with_ending(&base), base.join("index.ts"), base];
                if let Some(other) = candidates.iter().find(|other| all.contains(other)) {
                    found.push(Import {
                        from: below(root, file),
                        to: below(root, other),
                        line: number + 1,
                        text: line.to_owned(),
                    });
                }
            }
        }
    }
    Ok(found)
}

/// The quoted names after `from`, `import` and `import(` that begin with a dot.
fn relative_names(line: &str) -> Vec<&str> {
    let code = line.trim_start();
    if code.starts_with("//") || code.starts_with('*') || code.starts_with("/*") {
        return Vec::new();
    }
    let parts: Vec<&str> = line.split('"').collect();
    let named = parts.windows(2).step_by(2).filter(|pair| {
        let before = pair[0].trim_end().trim_end_matches('(').trim_end();
        (before.ends_with("from") || before.ends_with("import")) && pair[1].starts_with('.')
    });
    named.map(|pair| pair[1]).collect()
}

fn with_ending(base: &Path) -> PathBuf {
    let mut name = base.as_os_str().to_owned();
    name.push(".ts");
    PathBuf::from(name)
}

/// A path without `.` and `..`.
fn normal(path: &Path) -> PathBuf {
    let mut short = PathBuf::new();
    for part in path.components() {
        match part {
            Component::CurDir => {}
            Component::ParentDir => {
                short.pop();
            }
            other => short.push(other),
        }
    }
    short
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::path::Path;

    use super::imports;

    #[test]
    fn relative_imports_are_found() {
        let root = tempfile::tempdir().unwrap();
        let source = root.path().join("src/panels");
        fs::create_dir_all(&source).unwrap();
        fs::write(
            source.join("a.ts"),
            "// import \"./b\"\nimport { x } from \"three\";\nimport type {\n  Y,\n} from \"../c\";\n\
             const later = import(\"./b\");\nimport \"./a.css\";\n",
        )
        .unwrap();
        fs::write(source.join("b.ts"), "export const from = \"./a\";\n").unwrap();
        fs::write(root.path().join("src/c.ts"), "import { a } from \"./panels/a\";\n").unwrap();
        let found: Vec<(String, String, usize)> = imports(root.path(), Path::new("src"))
            .unwrap()
            .into_iter()
            .map(|i| (i.from, i.to, i.line))
            .collect();
        let expected = [
            ("src/c.ts", "src/panels/a.ts", 1),
            ("src/panels/a.ts", "src/c.ts", 5),
            ("src/panels/a.ts", "src/panels/b.ts", 6),
        ];
        assert_eq!(found, expected.map(|(a, b, line)| (a.into(), b.into(), line)));
    }
}
