//! The natural order of names, in which numbers count by their value: q2 before q10.
//!
//! Why so   it decides between joints that are alike, where the order of the file must not
//! Checked  tests in this file, tests/formats/order.rs

use std::cmp::Ordering;

/// A name in natural order. Equal only to itself: q01 comes before q1.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Natural<'a>(pub(super) &'a str);

impl Ord for Natural<'_> {
    fn cmp(&self, other: &Self) -> Ordering {
        let (mut a, mut b) = (self.0, other.0);
        while let (Some(x), Some(y)) = (a.chars().next(), b.chars().next()) {
            let order = if x.is_ascii_digit() && y.is_ascii_digit() {
                let ((m, rest_a), (n, rest_b)) = (number(a), number(b));
                (a, b) = (rest_a, rest_b);
                m.len().cmp(&n.len()).then(m.cmp(n))
            } else {
                (a, b) = (&a[x.len_utf8()..], &b[y.len_utf8()..]);
                x.cmp(&y)
            };
            if order != Ordering::Equal {
                return order;
            }
        }
        a.len().cmp(&b.len()).then(self.0.cmp(other.0))
    }
}

impl PartialOrd for Natural<'_> {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

/// The number that a text starts with, without leading zeros, and what follows it.
fn number(text: &str) -> (&str, &str) {
    let end = text.find(|c: char| !c.is_ascii_digit()).unwrap_or(text.len());
    let (digits, rest) = text.split_at(end);
    (digits.trim_start_matches('0'), rest)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_count_by_their_value() {
        let sorted = ["", "3", "a", "a0", "a1b", "a2", "a2b01", "a2b1", "a10", "b", "é", "é5"];
        for (i, a) in sorted.iter().enumerate() {
            for (j, b) in sorted.iter().enumerate() {
                assert_eq!(Natural(a).cmp(&Natural(b)), i.cmp(&j), "{a} and {b}");
            }
        }
    }
}
