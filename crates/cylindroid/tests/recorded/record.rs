//! Numbers and words of random cases, beside those in a file.

use std::fmt::{Debug, Write as _};
use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};

use crate::robots::Random;

/// The largest difference from a number x of the file, over max(1, |x|).
const TOLERANCE: f64 = 1e-7;

/// Drawn numbers are changed by these shares when records are written, for what rounding decides.
const NUDGES: [f64; 4] = [-1e-11, -1e-12, 1e-12, 1e-11];

/// Ends a line of a file whose further words are not compared.
const CUT: &str = "~";

/// The results of a case, in words.
#[derive(Debug, Default, PartialEq)]
pub(crate) struct Record {
    words: Vec<String>,
}

impl Record {
    pub(crate) fn numbers(&mut self, numbers: &[f64]) {
        self.words.extend(numbers.iter().map(|x| format!("{:.9e}", x + 0.0)));
    }

    pub(crate) fn number(&mut self, x: f64) {
        self.numbers(&[x]);
    }

    /// Names, counts, truth values; blanks become underscores.
    pub(crate) fn word(&mut self, word: &impl Debug) {
        self.words.push(format!("{word:?}").replace(char::is_whitespace, "_"));
    }

    /// The first words, and whether there are more.
    fn line(&self, count: usize) -> String {
        let cut = (count < self.words.len()).then_some(CUT);
        let words = self.words[..count].iter().map(String::as_str);
        words.chain(cut).collect::<Vec<_>>().join(" ")
    }

    /// How many of the first words agree.
    fn agreeing(&self, other: &Self, tolerance: f64) -> usize {
        let pairs = self.words.iter().zip(&other.words);
        pairs.take_while(|(a, b)| agree(a, b, tolerance)).count()
    }
}

/// Words are the same; numbers, which have a point and an exponent, within the tolerance.
fn agree(a: &str, b: &str, tolerance: f64) -> bool {
    if a == b {
        return true;
    }
    let number = |word: &str| word.contains('e').then(|| word.parse::<f64>().ok()).flatten();
    match (number(a), number(b)) {
        (Some(a), Some(b)) => (a - b).abs() <= tolerance * b.abs().max(1.0),
        _ => false,
    }
}

/// Runs the first cases of a kind and compares them with `tests/data/recorded/NAME.txt`, which has a
/// line for each. What comes after the first word that rounding decides is `~` there and is not
/// compared.
///
/// With `CYLINDROID_RECORD=write` it writes the file; with `shorten` it cuts the lines before what
/// differs, as in another form of the kernels (`cargo xtask record`).
///
/// # Panics
/// If one of them differs, or the file has other cases.
pub(crate) fn check(name: &str, cases: u64, run: impl Fn(&mut Random<'_>, &mut Record)) {
    let path = format!("{}/tests/data/recorded/{name}.txt", env!("CARGO_MANIFEST_DIR"));
    let result = |case: u64, nudge: f64| {
        let mut record = Record::default();
        let mut random = Random::seeded(case.wrapping_mul(0xd134_2543_de82_ef95));
        random.nudge = nudge;
        catch_unwind(AssertUnwindSafe(|| run(&mut random, &mut record)))
            .unwrap_or_else(|_| panic!("{name}: case {case} panics"));
        record
    };
    let purpose = std::env::var("CYLINDROID_RECORD").ok();
    if purpose.as_deref() == Some("write") {
        let mut text = String::new();
        for case in 0..cases {
            let record = result(case, 0.0);
            let nudged = NUDGES.map(|nudge| result(case, nudge));
            let steady = nudged.iter().map(|r| r.agreeing(&record, 0.01 * TOLERANCE)).min();
            writeln!(text, "{}", record.line(steady.unwrap_or_default())).unwrap();
        }
        fs::write(&path, text).unwrap();
        return;
    }
    let text = fs::read_to_string(&path).unwrap();
    assert_eq!(text.lines().count() as u64, cases, "{path}");
    let mut shortened = String::new();
    for (case, line) in text.lines().enumerate() {
        let steady = line.strip_suffix(CUT);
        let words = steady.unwrap_or(line).split_whitespace().map(str::to_owned);
        let expected = Record { words: words.collect() };
        let count = expected.words.len();
        let found = result(case as u64, 0.0);
        let agreeing = found.agreeing(&expected, TOLERANCE);
        if agreeing == count && (steady.is_some() || found.words.len() == count) {
            writeln!(shortened, "{line}").unwrap();
        } else if purpose.as_deref() == Some("shorten") {
            writeln!(shortened, "{}", expected.line(agreeing)).unwrap();
        } else {
            panic!(
                "{name}, case {case}, word {agreeing}: {:?} instead of {:?} (if that is meant, write \
                 it down: cargo xtask record)",
                found.words.get(agreeing),
                expected.words.get(agreeing)
            );
        }
    }
    if purpose.is_some() {
        fs::write(&path, shortened).unwrap();
    }
}
