//! A mechanism file seen elsewhere: moved, turned, in other units, its tables in another order.

use cylindroid::spatial::{Rotation, Rpy, Vec3};
use toml::{Table, Value};

use crate::support::Random;

/// A view: x becomes `scale * (turn x) + shift`.
pub(crate) struct View {
    turn: Rotation,
    shift: Vec3,
    scale: f64,
    shuffled: bool,
}

fn vector(value: &Value) -> Vec<f64> {
    let number = |x: &Value| x.as_float().or(x.as_integer().map(|i| i as f64)).unwrap();
    value.as_array().unwrap().iter().map(number).collect()
}

fn tables<'a>(table: &'a mut Table, key: &str) -> impl Iterator<Item = &'a mut Table> {
    let rows = table.get_mut(key).and_then(Value::as_array_mut);
    rows.into_iter().flatten().filter_map(Value::as_table_mut)
}

impl View {
    pub(crate) fn random(
        random: &mut Random,
        planar: bool,
        [scale, far]: [f64; 2],
        shuffled: bool,
    ) -> Self {
        let flat = if planar { 0.0 } else { 1.0 };
        let mut any = |size: f64| {
            Vec3::new(
                flat * random.within(-size, size),
                flat * random.within(-size, size),
                random.within(-size, size),
            )
        };
        let turn = Rotation::exp(any(2.0));
        let shift = any(0.57 * far);
        let shift = if planar { Vec3::new(shift.z, -0.5 * shift.z, 0.0) } else { shift };
        Self { turn, shift, scale, shuffled }
    }

    fn apply(&self, value: &mut Value, place: bool) {
        let old = vector(value);
        let at = |i: usize| old.get(i).copied().unwrap_or(0.0);
        let mut new = self.turn * Vec3::new(at(0), at(1), at(2));
        if place {
            new = new * self.scale + self.shift;
        }
        let new = new.to_array().into_iter().take(old.len()).map(Value::Float);
        *value = Value::Array(new.collect());
    }

    fn scale_vector(&self, value: &mut Value) {
        let scaled = vector(value).into_iter().map(|x| Value::Float(x * self.scale));
        *value = Value::Array(scaled.collect());
    }

    /// The lengths of a table of Denavit and Hartenberg.
    fn scale_arm(&self, arm: &mut Table) {
        if let Some(xyz) = arm.get_mut("flange").and_then(|f| f.get_mut("xyz")) {
            self.scale_vector(xyz);
        }
        for row in tables(arm, "rows") {
            for key in ["a", "d"] {
                if let Some(value) = row.get_mut(key) {
                    *value = Value::Float(value.as_float().unwrap() * self.scale);
                }
            }
        }
    }

    /// The base of an arm, or of a robot of another file.
    fn place_base(&self, robot: &mut Table) {
        let place = |key: &str| {
            let value = robot.get("base").and_then(|base| base.get(key)).map(vector);
            value.map_or([0.0; 3], |v| [v[0], v[1], v[2]])
        };
        let [roll, pitch, yaw] = place("rpy");
        let mut xyz = Value::from(place("xyz").to_vec());
        self.apply(&mut xyz, true);
        let turned = Rpy::of(self.turn * Rpy { roll, pitch, yaw }.rotation());
        let rpy = Value::from(vec![turned.roll, turned.pitch, turned.yaw]);
        let base = Table::from_iter([("xyz".to_owned(), xyz), ("rpy".to_owned(), rpy)]);
        robot.insert("base".to_owned(), Value::Table(base));
    }

    /// The text of the mechanism in this view.
    pub(crate) fn of(&self, text: &str, random: &mut Random) -> String {
        let mut table: Table = text.parse().unwrap();
        if let Some(point) = table.get_mut("reference_point") {
            self.apply(point, true);
        }
        if let Some(arm) = table.get_mut("dh").and_then(Value::as_table_mut) {
            self.scale_arm(arm);
            self.place_base(arm);
        }
        for robot in tables(&mut table, "robot") {
            self.place_base(robot);
        }
        let arm = table.contains_key("dh");
        for kind in ["joint", "contact", "frame", "robot"] {
            let Some(rows) = table.get_mut(kind).and_then(Value::as_array_mut) else { continue };
            for row in rows.iter_mut().filter_map(Value::as_table_mut) {
                let slides = row.get("type").and_then(Value::as_str) == Some("prismatic");
                for (key, value) in row.iter_mut() {
                    match key.as_str() {
                        "origin" | "point" => self.apply(value, true),
                        "axis" | "axis2" | "normal" | "tangent" => self.apply(value, false),
                        "xyz" if arm => self.scale_vector(value),
                        // On a link, whose axes are those of the world at zero.
                        "xyz" => {
                            let still = Self { shift: Vec3::ZERO, ..*self };
                            still.apply(value, true);
                        }
                        "pitch" => *value = Value::Float(value.as_float().unwrap() * self.scale),
                        "limits" if slides => {
                            for (_, limit) in value.as_table_mut().unwrap().iter_mut() {
                                *limit = Value::Float(limit.as_float().unwrap() * self.scale);
                            }
                        }
                        _ => {}
                    }
                }
            }
            if self.shuffled {
                for i in (1..rows.len()).rev() {
                    rows.swap(i, (random.within(0.0, i as f64 + 1.0) as usize).min(i));
                }
            }
        }
        table.to_string()
    }
}
