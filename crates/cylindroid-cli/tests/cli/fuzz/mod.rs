//! Random input with fixed seeds: command lines here, messages of the viewer in `view::fuzz`.
//!
//! Without `CYLINDROID_FUZZ_SECONDS` a few rounds; with it as many as the time allows, from
//! `CYLINDROID_FUZZ_SEED` on. `cargo xtask fuzz` sets both.

mod command_lines;

use std::time::{Duration, Instant};

use serde_json::{Map, Value, json};

/// `SplitMix64`.
#[derive(Debug)]
pub(crate) struct Random(pub(crate) u64);

impl Random {
    pub(crate) fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Below `n`; 0 for 0.
    pub(crate) fn below(&mut self, n: usize) -> usize {
        (self.next() % n.max(1) as u64) as usize
    }

    /// Within -1 and 1.
    pub(crate) fn signed(&mut self) -> f64 {
        self.next() as f64 / (u64::MAX / 2) as f64 - 1.0
    }

    pub(crate) fn of<'a, T: ?Sized>(&mut self, list: &[&'a T]) -> &'a T {
        list[self.below(list.len())]
    }
}

/// The seeds of a test: `few`, or as many as the time of `CYLINDROID_FUZZ_SECONDS` allows.
pub(crate) fn seeds(few: u64) -> impl Iterator<Item = u64> {
    let number = |name: &str| std::env::var(name).ok().map(|text| text.parse::<u64>().unwrap());
    let seconds = number("CYLINDROID_FUZZ_SECONDS");
    let first = number("CYLINDROID_FUZZ_SEED").unwrap_or(0);
    let start = Instant::now();
    (first..).take_while(move |seed| match seconds {
        None => seed - first < few,
        Some(seconds) => start.elapsed() < Duration::from_secs(seconds),
    })
}

/// Texts that a reader may take for something.
pub(crate) const TEXTS: [&str; 28] = [
    "",
    " ",
    "nan",
    "inf",
    "-inf",
    "1e308",
    "-1e308",
    "1e-320",
    "1e400",
    "0",
    "-0",
    "-1",
    "1",
    "0.5",
    "18446744073709551616",
    "1,2,3",
    ",",
    "0,0,0,0,0,0,0",
    "=",
    "q1=1",
    "none",
    "x,y",
    "pose",
    "world",
    "\u{202e}\u{fffd}",
    "\u{0}",
    "--",
    "{}",
];

/// A value of any kind.
fn any(random: &mut Random, words: &[&str]) -> Value {
    match random.below(12) {
        0 => Value::Null,
        1 => json!(random.below(2) == 0),
        2 => json!(random.signed()),
        3 => json!(random.below(8) as i64 - 2),
        4 => json!([1e308, -1e308, 1e-320, 1e154, -1e12, u64::MAX as f64][random.below(6)]),
        5 => json!(u64::MAX - random.next() % 3),
        6 => json!((0..random.below(9)).map(|_| random.signed()).collect::<Vec<f64>>()),
        7 => Value::Object(Map::new()),
        8 => json!("x".repeat(random.below(5000))),
        9 => json!(TEXTS[random.below(TEXTS.len())]),
        _ => json!(random.of(words)),
    }
}

/// The number of values in a value.
fn size(value: &Value) -> usize {
    1 + match value {
        Value::Array(list) => list.iter().map(size).sum(),
        Value::Object(map) => map.values().map(size).sum(),
        _ => 0,
    }
}

/// The value of this number, in the order of [`size`].
fn nth<'a>(value: &'a mut Value, n: &mut usize) -> Option<&'a mut Value> {
    if *n == 0 {
        return Some(value);
    }
    *n -= 1;
    match value {
        Value::Array(list) => list.iter_mut().find_map(|inner| nth(inner, n)),
        Value::Object(map) => map.values_mut().find_map(|inner| nth(inner, n)),
        _ => None,
    }
}

/// Changes one value, or what it contains; `words` are names that mean something.
pub(crate) fn mutate(value: &mut Value, other: &Value, words: &[&str], random: &mut Random) {
    let mut n = random.below(size(value));
    let Some(place) = nth(value, &mut n) else { return };
    let removed = random.below(3) == 0;
    match place {
        Value::Number(x) if random.below(3) > 0 => {
            let x = x.as_f64().unwrap_or(0.0);
            let factor = [1.0, 1.0, -1.0, 10.0, 1e9, 0.0][random.below(6)];
            *place = json!(x * factor + 0.1 * random.signed());
        }
        Value::Array(list) if removed && !list.is_empty() => {
            list.remove(random.below(list.len()));
        }
        Value::Array(list) if !list.is_empty() && random.below(3) == 0 => {
            let copy = list[random.below(list.len())].clone();
            list.insert(random.below(list.len() + 1), copy);
        }
        Value::Object(map) if removed && !map.is_empty() => {
            let key = map.keys().nth(random.below(map.len())).cloned().unwrap();
            map.remove(&key);
        }
        Value::Object(map) if random.below(3) > 0 => {
            let from = other.as_object().filter(|o| !o.is_empty());
            let entry = from.and_then(|o| o.iter().nth(random.below(o.len())));
            let (key, inner) = entry
                .map_or_else(|| ("a".into(), any(random, words)), |(k, v)| (k.clone(), v.clone()));
            map.insert(key, inner);
        }
        place => *place = any(random, words),
    }
}

/// Changes bytes of a text; what is no UTF-8 any more is replaced.
pub(crate) fn mutate_text(text: &str, random: &mut Random) -> String {
    let mut bytes = text.as_bytes().to_vec();
    for _ in 0..=random.below(3) {
        let at = random.below(bytes.len() + 1);
        match random.below(4) {
            0 if at < bytes.len() => bytes[at] ^= 1 << random.below(8),
            1 if at < bytes.len() => drop(bytes.remove(at)),
            2 => drop(bytes.splice(at..at, TEXTS[random.below(TEXTS.len())].bytes())),
            _ => bytes.truncate(at),
        }
    }
    String::from_utf8_lossy(&bytes).into_owned()
}
