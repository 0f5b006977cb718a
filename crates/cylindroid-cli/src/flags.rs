//! Flags in the errors of the library: an option by the flag that was typed, a name with the flag
//! whose value it is.

use anyhow::anyhow;
use cylindroid::Error;

/// Names in the library that differ from the flag, with a word where a flag has several values.
const NAMES: [(&str, &str, &str); 14] = [
    ("gain * dt", "--gain", ""),
    ("position gain", "--gain", " (position)"),
    ("orientation gain", "--gain", " (orientation)"),
    ("position tolerance", "--tolerance-position", ""),
    ("orientation tolerance", "--tolerance-orientation", ""),
    ("linear speed", "--speed", " (linear)"),
    ("angular speed", "--speed", " (angular)"),
    ("joint weight", "--joint-weights", ""),
    ("velocity limit", "--velocity-limits", ""),
    ("torque limit", "--torque-limits", ""),
    ("projection", "--inverse", ""),
    ("starts", "--modes", ""),
    ("reference", "--frame", ""),
    ("components", "--task", ""),
];

/// Flags of each kind of name whose word may be in others, as that of a parameter beside an index.
const KINDS: [(&str, &[&str]); 4] = [
    ("index", &["--minimise", "--maximise"]),
    ("statistic", &["--minimise", "--maximise"]),
    ("parameter", &["--parameter", "--vary", "--over"]),
    ("component of the platform", &["--components", "--over", "--at", "--free"]),
];

/// Names an error of the library after the flags of this command line.
pub(crate) fn named(error: anyhow::Error, words: &[String]) -> anyhow::Error {
    let flags = typed(words);
    let flag_of = |name: &str| find(name, &flags);
    match error.downcast_ref::<Error>() {
        Some(Error::InvalidOption { option, value, reason }) => {
            let parts = ["linear", "angular"];
            let part = parts.into_iter().find(|p| reason.contains(&format!("the {p} part")));
            let flag = part
                .and_then(|part| flag_of(&format!("{} {part}", option.trim_end_matches(" bound"))))
                .or_else(|| flag_of(option));
            let Some(flag) = flag else { return error };
            let (value, reason) = (value.clone(), reason.clone());
            // Once, before the program ends.
            Error::InvalidOption { option: flag.leak(), value, reason }.into()
        }
        Some(Error::NotFinite { what, value }) => {
            let (name, entry) = what.split_at(what.find('[').unwrap_or(what.len()));
            let Some(flag) = flag_of(name) else { return error };
            Error::NotFinite { what: flag + entry, value: *value }.into()
        }
        Some(Error::OutOfRange { what, value, range }) => {
            let (name, entry) = what.split_at(what.find('[').unwrap_or(what.len()));
            let Some(flag) = flag_of(name) else { return error };
            Error::OutOfRange { what: flag + entry, value: *value, range: *range }.into()
        }
        Some(Error::Dimension { what, expected, got, hint }) => {
            let Some(flag) = flag_of(what) else { return error };
            let (expected, got, hint) = (*expected, *got, hint.clone());
            Error::Dimension { what: flag, expected, got, hint }.into()
        }
        Some(unknown @ Error::UnknownName { what, name, .. }) => {
            match flag_with(what, name, &flags) {
                Some(flag) => anyhow!("{flag}: {unknown}"),
                None => error,
            }
        }
        _ => error,
    }
}

/// The flag whose value has this name: one that takes names of its kind, otherwise the only one.
fn flag_with<'a>(kind: &str, name: &str, flags: &[(&'a str, Option<&str>)]) -> Option<&'a str> {
    let is_name = |text: &str| text.trim() == name;
    let has_name = |value: &str| is_name(value) || value.split([',', '=', ':']).any(is_name);
    let mut found: Vec<&str> = flags
        .iter()
        .filter(|(_, value)| value.is_some_and(has_name))
        .map(|(flag, _)| *flag)
        .collect();
    let own = KINDS.iter().find(|(k, _)| *k == kind).map_or(&[][..], |(_, own)| own);
    if found.iter().any(|flag| own.contains(flag)) {
        found.retain(|flag| own.contains(flag));
    }
    found.sort_unstable();
    found.dedup();
    match found[..] {
        [flag] => Some(flag),
        _ => None,
    }
}

/// The flags of a command line, each with the word after it unless that is a flag too.
fn typed(words: &[String]) -> Vec<(&str, Option<&str>)> {
    let is_flag = |word: &str| word.strip_prefix("--").is_some_and(|name| !name.is_empty());
    let mut all = Vec::new();
    for (i, word) in words.iter().enumerate().filter(|(_, word)| is_flag(word)) {
        all.push(match word.split_once('=') {
            Some((flag, value)) => (flag, Some(value)),
            None => {
                let next = words.get(i + 1).map(String::as_str);
                (word.as_str(), next.filter(|next| !is_flag(next)))
            }
        });
    }
    all
}

/// The flag of an option of the library, if it was typed.
fn find(name: &str, flags: &[(&str, Option<&str>)]) -> Option<String> {
    let is_typed = |flag: &str| flags.iter().any(|(f, _)| *f == flag);
    if let Some((_, flag, part)) = NAMES.iter().find(|(n, ..)| *n == name)
        && is_typed(flag)
    {
        return Some(format!("{flag}{part}"));
    }
    let flag = format!("--{}", name.replace(['_', ' '], "-"));
    is_typed(&flag).then_some(flag)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn named_after(words: &[&str], error: Error) -> String {
        let words: Vec<String> = words.iter().map(|w| (*w).to_owned()).collect();
        named(error.into(), &words).to_string()
    }

    #[test]
    fn options_are_flags_if_they_were_typed() {
        let refused = || Error::check_positive("position tolerance", 0.0).unwrap_err();
        let words = ["ik", "ur5e", "--tolerance-position", "0"];
        assert!(named_after(&words, refused()).starts_with("--tolerance-position = 0 cannot"));
        assert!(named_after(&["ik", "ur5e"], refused()).starts_with("position tolerance = 0"));
        let infinite = Error::check_finite("wrench", &[0.0, f64::NAN]).unwrap_err();
        let words = ["statics", "stewart", "--wrench=0,nan"];
        assert_eq!(named_after(&words, infinite), "--wrench[1] is not finite: NaN");
    }

    #[test]
    fn names_come_with_the_flag_whose_value_they_are() {
        let unknown = || Error::unknown("component", "..", ["x", "y"]);
        let words = ["manipulability", "five-bar", "--task", ".., x"];
        assert!(named_after(&words, unknown()).starts_with("--task: no component named '..'"));
        assert!(named_after(&["info", ".."], unknown()).starts_with("no component"));
        let words = ["statics", "two-arm", "--compliance", "..=1", "--q", "..=1"];
        assert!(named_after(&words, unknown()).starts_with("no component"));
        let words = ["map", "panda", "--at", "..=1", "--at", "..=2"];
        assert!(named_after(&words, unknown()).starts_with("--at: no component"));
        let index = Error::unknown("index", "a", ["x", "y"]);
        let words = ["optimise", "f", "--vary", "a=0:1", "--minimise", "a"];
        assert!(named_after(&words, index).starts_with("--minimise: no index named 'a'"));
    }
}
