//! A change of sign, narrowed to a root: regula falsi (Illinois) with occasional bisection.
//!
//! Formula  t = b - f(b) (b - a) / (f(b) - f(a)), b the last place; f(a) counts half each time that a
//!          stays twice in a row; each fourth place is the middle
//! Valid    continuous functions; elsewhere it narrows to a jump of the sign
//! Why so   ten places for a smooth function, and no derivative; bisection narrows the bracket where
//!          the function is flat
//! Source   Dowell & Jarratt 1971, A modified regula falsi method for computing the root of an equation
//! Checked  tests::evaluations_are_few

/// Two places between which a function changes its sign, and what it counts there.
#[derive(Debug, Clone)]
pub(crate) struct Bracket {
    /// The place that is kept.
    kept: f64,
    at_kept: f64,
    /// The last place.
    last: f64,
    at_last: f64,
    steps: u32,
}

impl Bracket {
    /// Between two places with these values, if their signs differ or one is zero.
    pub(crate) fn new([low, high]: [f64; 2], [at_low, at_high]: [f64; 2]) -> Option<Self> {
        let changes = at_low <= 0.0 && at_high >= 0.0 || at_low >= 0.0 && at_high <= 0.0;
        let own = Self { kept: low, at_kept: at_low, last: high, at_last: at_high, steps: 0 };
        changes.then_some(own)
    }

    /// Where to evaluate next; `None` at a root.
    pub(crate) fn place(&self) -> Option<f64> {
        if self.at_kept == 0.0 || self.at_last == 0.0 {
            return None;
        }
        let (width, rise) = (self.last - self.kept, self.at_last - self.at_kept);
        let secant = self.last - self.at_last * width / rise;
        let is_middle = self.steps % 4 == 3 || !secant.is_finite();
        Some(if is_middle { 0.5 * (self.kept + self.last) } else { secant })
    }

    /// With the value at that place; true if the last place before it is kept from now on.
    pub(crate) fn narrow(&mut self, place: f64, value: f64) -> bool {
        let changes = (value < 0.0) != (self.at_last < 0.0);
        if changes {
            (self.kept, self.at_kept) = (self.last, self.at_last);
        } else {
            self.at_kept *= 0.5;
        }
        (self.last, self.at_last) = (place, value);
        self.steps += 1;
        changes
    }

    /// The kept place if it is a root, the last one otherwise.
    pub(crate) fn root(&self) -> f64 {
        if self.at_kept == 0.0 { self.kept } else { self.last }
    }

    pub(crate) fn last(&self) -> f64 {
        self.last
    }

    /// The distance of the two places.
    #[cfg(any(test, feature = "sweep"))]
    pub(crate) fn width(&self) -> f64 {
        (self.last - self.kept).abs()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The root to `met`, and how often the function was called.
    fn solve(f: impl Fn(f64) -> f64, [low, high]: [f64; 2], met: f64) -> (f64, u32) {
        let mut bracket = Bracket::new([low, high], [f(low), f(high)]).unwrap();
        for calls in 2..200 {
            let Some(place) = bracket.place() else { return (bracket.root(), calls) };
            bracket.narrow(place, f(place));
            if f(place).abs() <= met {
                return (place, calls + 1);
            }
        }
        panic!("no root");
    }

    /// Steps that halve both ends in turn are as slow as bisection: forty for twelve digits.
    #[test]
    fn evaluations_are_few() {
        let of_square = |x: f64| x * x - 0.3;
        let of_exp = |x: f64| x.exp() - 1.7;
        let of_sin = |x: f64| x.sin() - 0.2;
        type Case<'a> = (&'a dyn Fn(f64) -> f64, [f64; 2], f64);
        let cases: [Case<'_>; 3] = [
            (&of_square, [0.0, 1.0], 0.3_f64.sqrt()),
            (&of_exp, [0.0, 1.0], 1.7_f64.ln()),
            (&of_sin, [-1.0, 1.5], 0.2_f64.asin()),
        ];
        for (f, ends, root) in cases {
            for factor in [1.0, -1.0, 1e-3] {
                let own = |x: f64| factor * f(x);
                for ends in [ends, [ends[1], ends[0]]] {
                    let (found, calls) = solve(own, ends, factor.abs() * 1e-12);
                    assert!((found - root).abs() < 1e-11 && calls <= 15, "{found}, {calls}");
                }
            }
        }
    }

    /// Flat at the root: each fourth step halves.
    #[test]
    fn flat_functions_and_jumps() {
        let (found, calls) = solve(|x| (x - 0.3).powi(3), [0.0, 1.0], 1e-12);
        assert!((found - 0.3).abs() < 1.1e-4 && calls < 50, "{found} {calls}");
        let sign = |x: f64| if x < 0.3 { -1.0 } else { 1.0 };
        let mut bracket = Bracket::new([0.0, 1.0], [-1.0, 1.0]).unwrap();
        for _ in 0..80 {
            let place = bracket.place().unwrap();
            bracket.narrow(place, sign(place));
        }
        assert!(bracket.width() < 1e-6 && (bracket.root() - 0.3).abs() < 1e-6);
        assert!(Bracket::new([0.0, 1.0], [1.0, 2.0]).is_none());
        assert!(Bracket::new([0.0, 1.0], [f64::NAN, 2.0]).is_none());
        assert_eq!(Bracket::new([0.5, 1.0], [0.0, 2.0]).unwrap().place(), None);
    }
}
