//! Keys that an object of JSON has twice, of which its readers take one without a word.

use std::collections::BTreeSet;
use std::fmt;

use serde::de::{Deserialize, Deserializer, Error, MapAccess, SeqAccess, Visitor};

/// The first key that an object of a JSON text has twice, at any depth; none of a faulty text.
pub(super) fn repeated(text: &str) -> Option<String> {
    serde_json::from_str::<Repeated>(text).ok()?.0
}

struct Repeated(Option<String>);

impl<'de> Deserialize<'de> for Repeated {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(Search)
    }
}

struct Search;

impl<'de> Visitor<'de> for Search {
    type Value = Repeated;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("JSON")
    }

    fn visit_bool<E: Error>(self, _: bool) -> Result<Repeated, E> {
        Ok(Repeated(None))
    }

    fn visit_i64<E: Error>(self, _: i64) -> Result<Repeated, E> {
        Ok(Repeated(None))
    }

    fn visit_u64<E: Error>(self, _: u64) -> Result<Repeated, E> {
        Ok(Repeated(None))
    }

    fn visit_f64<E: Error>(self, _: f64) -> Result<Repeated, E> {
        Ok(Repeated(None))
    }

    fn visit_str<E: Error>(self, _: &str) -> Result<Repeated, E> {
        Ok(Repeated(None))
    }

    fn visit_unit<E: Error>(self) -> Result<Repeated, E> {
        Ok(Repeated(None))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut entries: A) -> Result<Repeated, A::Error> {
        let mut first = None;
        while let Some(Repeated(inside)) = entries.next_element()? {
            first = first.or(inside);
        }
        Ok(Repeated(first))
    }

    fn visit_map<A: MapAccess<'de>>(self, mut entries: A) -> Result<Repeated, A::Error> {
        let (mut keys, mut first) = (BTreeSet::<String>::new(), None);
        while let Some((key, Repeated(inside))) = entries.next_entry()? {
            let own = keys.replace(key);
            first = first.or(own).or(inside);
        }
        Ok(Repeated(first))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_are_given_once() {
        for (text, key) in [
            (r#"{"a": 1, "b": [true, null, -1, 0.5, "a"], "c": {"a": {}}}"#, None),
            (r#"{"a": 1, "b": 2, "a": 1}"#, Some("a")),
            (r#"[1, {"b": {"c": 1, "\u0063": 2}}]"#, Some("c")),
            (r#"{"a": 1, "a": }"#, None),
        ] {
            assert_eq!(repeated(text).as_deref(), key, "{text}");
        }
    }
}
