//! Parsing of argument values: lists of numbers, configurations, names with a number.

use std::path::{Path, PathBuf};
use std::str::FromStr;

use cylindroid::ik::Task;
use cylindroid::linalg::Interval;
use cylindroid::model::formats::srdf;
use cylindroid::{Error, Mechanism};

/// A list of `N` numbers: `0.1,-2e-3,4`; spaces after commas and square brackets are allowed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Numbers<const N: usize>(pub(crate) [f64; N]);

impl<const N: usize> FromStr for Numbers<N> {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let list = numbers(text)?;
        list.try_into().map(Self).map_err(|list: Vec<f64>| {
            let given = list.len();
            format!("{given} number{} given, {N} expected", if given == 1 { "" } else { "s" })
        })
    }
}

/// One number, or two for the linear and the angular part.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Pair {
    pub(crate) linear: f64,
    /// `None` if one number was given.
    pub(crate) angular: Option<f64>,
}

impl FromStr for Pair {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match numbers(text)?[..] {
            [linear] => Ok(Self { linear, angular: None }),
            [linear, angular] => Ok(Self { linear, angular: Some(angular) }),
            ref list => Err(format!("{} numbers given, one or two expected", list.len())),
        }
    }
}

/// A list of numbers of any length.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct List(pub(crate) Vec<f64>);

impl FromStr for List {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        numbers(text).map(Self)
    }
}

/// A matrix: numbers on its diagonal, the name of a file of rows (.csv, .json), or `inertia`.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Weights {
    /// That of the mechanism at the configuration.
    Inertia,
    Diagonal(Vec<f64>),
    File(PathBuf),
}

impl FromStr for Weights {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if text.trim() == "inertia" {
            return Ok(Self::Inertia);
        }
        let path = Path::new(text.trim());
        if path.extension().is_some_and(|e| e == "csv" || e == "json") {
            return Ok(Self::File(path.to_owned()));
        }
        let file =
            |why: String| format!("{why}; a metric is a list of weights or a .csv or .json file");
        numbers(text).map(Self::Diagonal).map_err(file)
    }
}

/// Intervals `1.5,-2:3,...`; a single number is a symmetric bound.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Intervals(pub(crate) Vec<Interval>);

impl FromStr for Intervals {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let interval = |text: &str| match text.split_once(':') {
            Some((lower, upper)) => Ok(Interval { lower: number(lower)?, upper: number(upper)? }),
            None => number(text).map(Interval::symmetric),
        };
        text.split(',').map(interval).collect::<Result<_, _>>().map(Self)
    }
}

/// A name and a number: `link_a=0.4`.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Assignment(String, f64);

impl Assignment {
    pub(crate) fn pair(&self) -> (&str, f64) {
        (&self.0, self.1)
    }
}

impl FromStr for Assignment {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (name, value) = text.split_once('=').ok_or("a name, = and a number are expected")?;
        Ok(Self(name.trim().to_owned(), number(value)?))
    }
}

/// A number for all (`0.5`), for some by name (`left=0.4`), or both, separated by commas.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct ByName {
    all: Option<f64>,
    named: Vec<(String, f64)>,
}

impl FromStr for ByName {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let mut read = Self::default();
        for entry in text.split(',') {
            if entry.contains('=') {
                read.named.push(assignment(entry)?);
            } else if read.all.replace(number(entry)?).is_some() {
                return Err("two numbers without a name; write name=number for one of them".into());
            }
        }
        Ok(read)
    }
}

impl ByName {
    /// The number for a name, if there is one.
    pub(crate) fn of(&self, name: &str) -> Option<f64> {
        self.named.iter().rev().find(|(n, _)| n == name).map(|(_, x)| *x).or(self.all)
    }

    /// All numbers, of names or of all.
    pub(crate) fn numbers(&self) -> impl Iterator<Item = f64> {
        self.all.into_iter().chain(self.named.iter().map(|(_, x)| *x))
    }

    /// The names with a number of their own.
    pub(crate) fn named(&self) -> impl Iterator<Item = &(String, f64)> {
        self.named.iter()
    }

    /// Rejects names that are not among `known`.
    pub(crate) fn check(&self, what: &'static str, known: &[&str]) -> cylindroid::Result<()> {
        match self.named.iter().find(|(name, _)| !known.contains(&name.as_str())) {
            Some((name, _)) => Err(Error::unknown(what, name, known)),
            None => Ok(()),
        }
    }
}

/// A configuration or joint velocities, one number per coordinate.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Joints {
    /// `home`
    Home,
    /// `zero`
    Zero,
    /// All numbers, in the order of `info`.
    All(Vec<f64>),
    /// `name=value,...`; the other coordinates as at home.
    Some(Vec<(String, f64)>),
    /// A state of the SRDF.
    State(String),
}

impl FromStr for Joints {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text.trim() {
            "home" => Ok(Self::Home),
            "zero" => Ok(Self::Zero),
            named if named.contains('=') => {
                named.split(',').map(assignment).collect::<Result<_, _>>().map(Self::Some)
            }
            list => match numbers(list) {
                Err(_) if is_name(list) => Ok(Self::State(list.to_owned())),
                numbers => numbers.map(Self::All),
            },
        }
    }
}

/// True for one word that begins with a letter.
fn is_name(text: &str) -> bool {
    text.starts_with(char::is_alphabetic) && !text.contains([',', ' ', '\t'])
}

impl Joints {
    /// The configuration; angles are in degrees if `degrees` is set, except in the states of an SRDF.
    pub(crate) fn configuration(
        &self,
        robot: &Mechanism,
        srdf_file: Option<&Path>,
        degrees: bool,
    ) -> cylindroid::Result<Vec<f64>> {
        match (self, srdf_file) {
            (Self::State(name), Some(file)) => {
                srdf::load(file)?.configuration(name, robot, robot.home())
            }
            _ => self.resolve(robot, degrees, robot.home()),
        }
    }

    /// The joint velocities; those not named are zero.
    pub(crate) fn velocities(
        &self,
        robot: &Mechanism,
        degrees: bool,
    ) -> cylindroid::Result<Vec<f64>> {
        self.resolve(robot, degrees, &vec![0.0; robot.n()])
    }

    fn resolve(
        &self,
        robot: &Mechanism,
        degrees: bool,
        rest: &[f64],
    ) -> cylindroid::Result<Vec<f64>> {
        let coordinates = robot.coordinates();
        let si = |i: usize, value: f64| match coordinates.get(i) {
            Some(c) if degrees && !c.kind.is_length() => value.to_radians(),
            _ => value,
        };
        match self {
            Self::Home => Ok(rest.to_vec()),
            Self::State(name) => Err(Error::InvalidOption {
                option: "joints",
                value: name.clone(),
                reason: "it is no number; give numbers with commas, `name=value`, `home` or \
                         `zero`; a configuration may also be a state of --srdf"
                    .to_owned(),
            }),
            Self::Zero => Ok(vec![0.0; robot.n()]),
            Self::All(list) => Ok(list.iter().enumerate().map(|(i, v)| si(i, *v)).collect()),
            Self::Some(pairs) => {
                let mut q = rest.to_vec();
                for (place, (name, value)) in pairs.iter().enumerate() {
                    if pairs[..place].iter().any(|(other, _)| other == name) {
                        return Err(Error::InvalidOption {
                            option: "joints",
                            value: name.clone(),
                            reason: "it is given twice".to_owned(),
                        });
                    }
                    let i = coordinates.iter().position(|c| c.name == *name).ok_or_else(|| {
                        Error::unknown("joint", name, coordinates.iter().map(|c| &c.name))
                    })?;
                    q[i] = si(i, *value);
                }
                Ok(q)
            }
        }
    }
}

/// `NAME`, `NAME=GAIN` or either with `,PARAMETER=VALUE,...`: a secondary task.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Named {
    pub(crate) name: String,
    pub(crate) parameters: Vec<(String, f64)>,
}

impl FromStr for Named {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let mut parts = text.split(',');
        let first = parts.next().unwrap_or_default();
        let (name, gain) = match first.split_once('=') {
            Some(_) => assignment(first).map(|(name, gain)| (name, Some(gain)))?,
            None => (first.trim().to_owned(), None),
        };
        let gain = gain.map(|gain| Ok(("gain".to_owned(), gain)));
        let parameters = gain.into_iter().chain(parts.map(assignment));
        Ok(Self { name, parameters: parameters.collect::<Result<_, String>>()? })
    }
}

/// A motion of a body: a component, or a twist, linear part first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Motion(pub(crate) [f64; 6]);

/// The names of the components of a twist or wrench in space (6) or in the plane (3).
pub(crate) const fn components(dimension: usize) -> &'static [&'static str] {
    if dimension == 3 { &["x", "y", "rz"] } else { &Task::COMPONENTS }
}

impl FromStr for Motion {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if let Some(i) = Task::COMPONENTS.iter().position(|c| *c == text.trim()) {
            return Ok(Self(std::array::from_fn(|j| f64::from(u8::from(i == j)))));
        }
        let all = || format!("one of {} or six numbers", Task::COMPONENTS.join(", "));
        text.parse::<Numbers<6>>()
            .map(|n| Self(n.0))
            .map_err(|why| format!("{why}; a motion is {}", all()))
    }
}

fn assignment(text: &str) -> Result<(String, f64), String> {
    let Some((name, value)) = text.split_once('=') else {
        return Err(format!("'{}' is not of the form name=number", text.trim()));
    };
    Ok((name.trim().to_owned(), number(value)?))
}

fn numbers(text: &str) -> Result<Vec<f64>, String> {
    let text = text.trim();
    let inner = text.strip_prefix('[').and_then(|t| t.strip_suffix(']')).unwrap_or(text);
    if inner.contains(',') {
        inner.split(',').map(number).collect()
    } else {
        inner.split_whitespace().map(number).collect()
    }
}

fn number(text: &str) -> Result<f64, String> {
    let text = text.trim();
    text.parse().map_err(|_| {
        if text.is_empty() {
            "a number is missing between two commas".to_owned()
        } else {
            format!("'{text}' is not a number")
        }
    })
}

/// Joins arguments split after a comma: `--to 0.4, 0.1, 0.2` is one list.
pub(crate) fn join_after_commas(words: impl IntoIterator<Item = String>) -> Vec<String> {
    let mut joined: Vec<String> = Vec::new();
    for word in words {
        match joined.last_mut() {
            Some(last) if last.ends_with(',') => last.push_str(&word),
            _ => joined.push(word),
        }
    }
    joined
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_take_signs_exponents_spaces_and_brackets() {
        assert_eq!("-0.3, 1e-3,+2".parse(), Ok(Numbers([-0.3, 1e-3, 2.0])));
        assert_eq!("[1, 2 ,3]".parse(), Ok(Numbers([1.0, 2.0, 3.0])));
        assert_eq!("1 2 3".parse(), Ok(Numbers([1.0, 2.0, 3.0])));
    }

    #[test]
    fn numbers_say_what_is_wrong() {
        let refused = |text: &str| text.parse::<Numbers<3>>().unwrap_err();
        assert_eq!(refused("1,2"), "2 numbers given, 3 expected");
        assert_eq!(refused("1,,3"), "a number is missing between two commas");
        assert_eq!(refused("1,x,3"), "'x' is not a number");
    }

    #[test]
    fn intervals_and_numbers_by_name() {
        let read: Intervals = "2,-1:3,0:1".parse().unwrap();
        let pairs: Vec<(f64, f64)> = read.0.iter().map(|i| (i.lower, i.upper)).collect();
        assert_eq!(pairs, [(-2.0, 2.0), (-1.0, 3.0), (0.0, 1.0)]);
        assert!("1:".parse::<Intervals>().is_err());
        let read: ByName = "0.5, left=0.4".parse().unwrap();
        assert_eq!((read.of("left"), read.of("right")), (Some(0.4), Some(0.5)));
        assert!(read.check("contact", &["right"]).is_err());
        assert!("0.5,0.4".parse::<ByName>().is_err());
        assert_eq!("w.csv".parse(), Ok(Weights::File("w.csv".into())));
        assert!("one,two".parse::<Weights>().is_err());
    }

    #[test]
    fn lists_split_by_the_shell_are_joined() {
        let words = ["--to", "0.4,", "0.1,", "0.2", "--json"].map(str::to_owned);
        assert_eq!(join_after_commas(words), ["--to", "0.4,0.1,0.2", "--json"]);
    }
}
