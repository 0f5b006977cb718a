//! The columns of a file of waypoints: by the names of its header, otherwise by their count.

/// The names of columns; `t` is `time` too.
const NAMES: [&str; 12] =
    ["time", "x", "y", "z", "qw", "qx", "qy", "qz", "roll", "pitch", "yaw", "speed"];

/// The places of the numbers in a row, each of which is in one of them.
#[derive(Debug)]
pub(super) struct Columns {
    pub(super) time: Option<usize>,
    /// That of the translation on the way to the row.
    pub(super) speed: Option<usize>,
    pub(super) position: [usize; 3],
    pub(super) orientation: Orientation,
}

#[derive(Debug)]
pub(super) enum Orientation {
    /// That of the start.
    Kept,
    /// w, x, y, z
    Quaternion([usize; 4]),
    RollPitchYaw([usize; 3]),
}

impl Columns {
    /// Those of a header, in any order. Returns a message if one is unknown, missing or given twice.
    pub(super) fn named(header: &[String]) -> Result<Self, String> {
        let mut known: Vec<&str> = Vec::new();
        for (i, given) in header.iter().enumerate() {
            let small = given.to_lowercase();
            let name = if small == "t" { "time" } else { &small };
            let Some(name) = NAMES.iter().find(|known| **known == name) else {
                let speeds = if small.contains("speed") {
                    "; 'speed' is that on the way to a row [m/s]"
                } else {
                    ""
                };
                let names = NAMES.join(", ");
                return Err(format!(
                    "header, column {}: '{given}' is none of {names}{speeds}",
                    i + 1
                ));
            };
            if known.contains(name) {
                return Err(format!("header, column {}: '{name}' is given twice", i + 1));
            }
            known.push(name);
        }
        let position = group(&known, ["x", "y", "z"])?;
        let quaternion = group(&known, ["qw", "qx", "qy", "qz"])?;
        let angles = group(&known, ["roll", "pitch", "yaw"])?;
        let place = |wanted: &str| known.iter().position(|name| *name == wanted);
        let (time, speed) = (place("time"), place("speed"));
        if time.is_some() && speed.is_some() {
            return Err("header: give time or speed, not both: speeds follow from times".into());
        }
        Ok(Self {
            time,
            speed,
            position: position.ok_or("header: x, y and z are missing")?,
            orientation: match (quaternion, angles) {
                (None, None) => Orientation::Kept,
                (Some(columns), None) => Orientation::Quaternion(columns),
                (None, Some(columns)) => Orientation::RollPitchYaw(columns),
                (Some(_), Some(_)) => {
                    return Err("header: give qw, qx, qy, qz or roll, pitch, yaw, not both".into());
                }
            },
        })
    }

    /// Those of rows of so many numbers without a header: a time if there is one, a position, a
    /// quaternion if there is one.
    pub(super) fn of_count(count: usize) -> Option<Self> {
        let (time, first) = if count.is_multiple_of(4) { (Some(0), 1) } else { (None, 0) };
        let orientation = match count {
            3 | 4 => Orientation::Kept,
            7 | 8 => Orientation::Quaternion([3, 4, 5, 6].map(|i| first + i)),
            _ => return None,
        };
        Some(Self { time, speed: None, position: [0, 1, 2].map(|i| first + i), orientation })
    }

    /// How many there are.
    pub(super) fn count(&self) -> usize {
        let turn = match self.orientation {
            Orientation::Kept => 0,
            Orientation::Quaternion(_) => 4,
            Orientation::RollPitchYaw(_) => 3,
        };
        usize::from(self.time.or(self.speed).is_some()) + 3 + turn
    }

    /// The name of a column.
    pub(super) fn name(&self, column: usize) -> &'static str {
        let (turn, first): (&[usize], usize) = match &self.orientation {
            Orientation::Kept => (&[], 4),
            Orientation::Quaternion(columns) => (columns, 4),
            Orientation::RollPitchYaw(columns) => (columns, 8),
        };
        let of = |columns: &[usize], first: usize| {
            columns.iter().position(|c| *c == column).and_then(|i| NAMES.get(first + i).copied())
        };
        let other = if self.speed == Some(column) { "speed" } else { "time" };
        of(&self.position, 1).or(of(turn, first)).unwrap_or(other)
    }
}

/// The places of names of which all or none must be there.
fn group<const N: usize>(known: &[&str], wanted: [&str; N]) -> Result<Option<[usize; N]>, String> {
    let places = wanted.map(|name| known.iter().position(|known| *known == name));
    if places.iter().all(Option::is_none) {
        return Ok(None);
    }
    match places.iter().position(Option::is_none) {
        Some(missing) => Err(format!(
            "header: {} is missing beside others of {}",
            wanted[missing],
            wanted.join(", ")
        )),
        None => Ok(Some(places.map(Option::unwrap_or_default))),
    }
}
