//! Expressions in numbers and parameters: `"width / 2 + 0.1"`.
//!
//! Formula  numbers, names, pi, + - * / ^, parentheses and [`FUNCTIONS`]. ^ groups to the right and
//!          before a sign on its left: -2^2 = -4, 2^3^2 = 512
//! Units    angles in rad
//! Valid    up to [`DEEPEST`] operators and parentheses, one inside the other
//! Fails    unknown names, and every intermediate result that is not finite, with its place
//! Why so   exmex, the maintained crate for this with a free licence, has errors without a place,
//!          recursion without a bound, and regex among its dependencies
//! Checked  tests/formats/parameters.rs::expressions_*

use std::f64::consts::PI;
use std::ops::Range;

/// Levels of nesting.
const DEEPEST: usize = 64;

/// A function, its number of arguments and its value.
type Function = (&'static str, usize, fn(&[f64]) -> f64);

/// The functions.
const FUNCTIONS: [Function; 14] = [
    ("sqrt", 1, |x| x[0].sqrt()),
    ("abs", 1, |x| x[0].abs()),
    ("sin", 1, |x| x[0].sin()),
    ("cos", 1, |x| x[0].cos()),
    ("tan", 1, |x| x[0].tan()),
    ("asin", 1, |x| x[0].asin()),
    ("acos", 1, |x| x[0].acos()),
    ("atan", 1, |x| x[0].atan()),
    ("atan2", 2, |x| x[0].atan2(x[1])),
    ("hypot", 2, |x| x[0].hypot(x[1])),
    ("exp", 1, |x| x[0].exp()),
    ("min", 2, |x| x[0].min(x[1])),
    ("max", 2, |x| x[0].max(x[1])),
    ("radians", 1, |x| x[0].to_radians()),
];

/// The number that has a name.
const CONSTANT: &str = "pi";

/// True for names of functions and constants, which parameters cannot have.
pub(super) fn is_reserved(name: &str) -> bool {
    name == CONSTANT || FUNCTIONS.iter().any(|f| f.0 == name)
}

/// True for a letter or underscore, followed by letters, digits and underscores.
pub(super) fn is_name(name: &str) -> bool {
    let mut letters = name.chars();
    letters.next().is_some_and(begins_name) && letters.all(continues_name)
}

fn begins_name(letter: char) -> bool {
    letter.is_alphabetic() || letter == '_'
}

fn continues_name(letter: char) -> bool {
    letter.is_alphanumeric() || letter == '_'
}

/// The help of errors.
pub(super) fn help() -> String {
    let functions = FUNCTIONS.map(|f| f.0).join(", ");
    format!("expressions have numbers, parameters, {CONSTANT}, + - * / ^, ( ), and {functions}")
}

/// An error at a range of the expression.
#[derive(Debug)]
pub(super) struct Fault {
    pub(super) span: Range<usize>,
    pub(super) message: String,
}

/// An expression, in the order of its computation.
#[derive(Debug)]
pub(super) struct Expression<'t> {
    text: &'t str,
    steps: Vec<Step<'t>>,
}

/// An operation on the last results, and the part of the text that it completes.
#[derive(Debug)]
struct Step<'t> {
    operation: Operation<'t>,
    span: Range<usize>,
}

#[derive(Debug)]
enum Operation<'t> {
    Number(f64),
    Name(&'t str),
    Negative,
    Binary(char),
    Function(Function),
}

impl<'t> Expression<'t> {
    /// Parses a text.
    pub(super) fn parse(text: &'t str) -> Result<Self, Fault> {
        let mut parser = Parser { text, at: 0, depth: 0, steps: Vec::new() };
        parser.sum()?;
        match parser.peek() {
            None => Ok(Self { text, steps: parser.steps }),
            Some(_) => Err(parser.unexpected("an operator")),
        }
    }

    /// The text that was parsed.
    pub(super) fn text(&self) -> &'t str {
        self.text
    }

    /// The names of parameters in it.
    pub(super) fn names(&self) -> impl Iterator<Item = &'t str> {
        self.steps.iter().filter_map(|step| match step.operation {
            Operation::Name(name) => Some(name),
            _ => None,
        })
    }

    /// Its value; `unknown` explains a name without a value.
    pub(super) fn value(
        &self,
        of: impl Fn(&str) -> Option<f64>,
        unknown: impl Fn(&str) -> String,
    ) -> Result<f64, Fault> {
        let mut stack: Vec<f64> = Vec::new();
        for Step { operation, span } in &self.steps {
            let count = match operation {
                Operation::Number(_) | Operation::Name(_) => 0,
                Operation::Negative => 1,
                Operation::Binary(_) => 2,
                Operation::Function((_, count, _)) => *count,
            };
            let arguments = stack.split_off(stack.len().saturating_sub(count));
            let x = match (operation, &arguments[..]) {
                (Operation::Number(x), _) => *x,
                (Operation::Name(name), _) => {
                    of(name).ok_or_else(|| Fault { span: span.clone(), message: unknown(name) })?
                }
                (Operation::Negative, [x]) => -x,
                (Operation::Binary('+'), [x, y]) => x + y,
                (Operation::Binary('-'), [x, y]) => x - y,
                (Operation::Binary('*'), [x, y]) => x * y,
                (Operation::Binary('/'), [x, y]) => x / y,
                (Operation::Binary(_), [x, y]) => x.powf(*y),
                (Operation::Function((_, _, f)), _) => f(&arguments),
                _ => f64::NAN,
            };
            if !x.is_finite() {
                let kind = if x.is_nan() { "not a number" } else { "infinite" };
                let message = format!("{} is {kind}", &self.text[span.clone()]);
                return Err(Fault { span: span.clone(), message });
            }
            stack.push(x);
        }
        Ok(stack.pop().unwrap_or(f64::NAN))
    }
}

/// Recursive descent; each method appends the steps of what it reads and returns its place.
struct Parser<'t> {
    text: &'t str,
    at: usize,
    depth: usize,
    steps: Vec<Step<'t>>,
}

type Place = Result<Range<usize>, Fault>;

impl<'t> Parser<'t> {
    fn rest(&self) -> &'t str {
        &self.text[self.at..]
    }

    /// The next character that is no space.
    fn peek(&mut self) -> Option<char> {
        let rest = self.rest();
        self.at += rest.len() - rest.trim_start().len();
        self.rest().chars().next()
    }

    /// Skips the next character if it is one of these.
    fn take(&mut self, any: &[char]) -> Option<char> {
        let next = self.peek().filter(|c| any.contains(c))?;
        self.at += next.len_utf8();
        Some(next)
    }

    fn step(&mut self, operation: Operation<'t>, span: Range<usize>) -> Range<usize> {
        self.steps.push(Step { operation, span: span.clone() });
        span
    }

    fn unexpected(&mut self, expected: &str) -> Fault {
        match self.peek() {
            None => {
                let message = format!("the expression ends where {expected} is expected");
                Fault { span: self.at..self.at, message }
            }
            Some(found) => {
                let message = format!("'{found}' stands where {expected} is expected");
                Fault { span: self.at..self.at + found.len_utf8(), message }
            }
        }
    }

    fn sum(&mut self) -> Place {
        self.left_to_right(&['+', '-'], Self::product)
    }

    fn product(&mut self) -> Place {
        self.left_to_right(&['*', '/'], Self::signed)
    }

    fn left_to_right(&mut self, operators: &[char], next: fn(&mut Self) -> Place) -> Place {
        let mut left = next(self)?;
        while let Some(operator) = self.take(operators) {
            let right = next(self)?;
            left = self.step(Operation::Binary(operator), left.start..right.end);
        }
        Ok(left)
    }

    /// Every level of nesting passes through here.
    fn signed(&mut self) -> Place {
        self.peek();
        let start = self.at;
        if self.depth == DEEPEST {
            let message = format!("the expression has more than {DEEPEST} levels");
            return Err(Fault { span: start..start, message });
        }
        self.depth += 1;
        let place = match self.take(&['+', '-']) {
            None => self.power(),
            Some('+') => self.signed(),
            Some(_) => self.signed().map(|own| self.step(Operation::Negative, start..own.end)),
        };
        self.depth -= 1;
        place
    }

    fn power(&mut self) -> Place {
        let base = self.atom()?;
        if self.take(&['^']).is_none() {
            return Ok(base);
        }
        let exponent = self.signed()?;
        Ok(self.step(Operation::Binary('^'), base.start..exponent.end))
    }

    fn atom(&mut self) -> Place {
        let next = self.peek();
        let start = self.at;
        match next {
            Some('(') => {
                self.at += 1;
                self.sum()?;
                self.close()?;
                Ok(start..self.at)
            }
            Some(c) if c.is_ascii_digit() || c == '.' => self.number(),
            Some(c) if begins_name(c) => self.name(),
            _ => Err(self.unexpected("a number, a parameter or (")),
        }
    }

    fn close(&mut self) -> Result<(), Fault> {
        match self.take(&[')']) {
            Some(_) => Ok(()),
            None => Err(self.unexpected("an operator or )")),
        }
    }

    fn number(&mut self) -> Place {
        let bytes = self.text.as_bytes();
        let digits = |from: usize| {
            let more = bytes[from..].iter().take_while(|b| b.is_ascii_digit());
            from + more.count()
        };
        let mut end = digits(self.at);
        if bytes.get(end) == Some(&b'.') {
            end = digits(end + 1);
        }
        if matches!(bytes.get(end), Some(b'e' | b'E')) {
            let sign = usize::from(matches!(bytes.get(end + 1), Some(b'+' | b'-')));
            let exponent = digits(end + 1 + sign);
            if exponent > end + 1 + sign {
                end = exponent;
            }
        }
        let span = self.at..end;
        let text = &self.text[span.clone()];
        let Ok(x) = text.parse() else {
            return Err(Fault { span, message: format!("'{text}' is not a number") });
        };
        self.at = end;
        Ok(self.step(Operation::Number(x), span))
    }

    fn name(&mut self) -> Place {
        let start = self.at;
        let rest = self.rest();
        let name = &rest[..rest.find(|c| !continues_name(c)).unwrap_or(rest.len())];
        self.at += name.len();
        let own = start..self.at;
        if name == CONSTANT {
            return Ok(self.step(Operation::Number(PI), own));
        }
        let Some(function) = FUNCTIONS.into_iter().find(|f| f.0 == name) else {
            return Ok(self.step(Operation::Name(name), own));
        };
        if self.take(&['(']).is_none() {
            return Err(self.unexpected(&format!("the ( of {name}")));
        }
        for argument in 0..function.1 {
            if argument > 0 && self.take(&[',']).is_none() {
                return Err(self.unexpected(&format!("argument {} of {name}", argument + 1)));
            }
            self.sum()?;
        }
        self.close()?;
        Ok(self.step(Operation::Function(function), start..self.at))
    }
}
