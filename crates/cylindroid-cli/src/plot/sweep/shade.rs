//! Colours of numbers, and the bar that explains them.

use plotters::prelude::*;

use super::super::fine::at;
use super::super::{Area, Drawn, FONT};
use super::plan::Name;
use crate::output::{number, without_rounding};

/// Colours that are told apart.
const LEVELS: usize = 64;
/// Characters of a unit that the bar names.
const UNIT: usize = 5;
/// The largest over the smallest number from which colours are those of logarithms.
const LOGARITHMIC: f64 = 300.0;
/// Viridis (van der Walt & Smith 2015): of even lightness, also for colour-blind readers.
const STOPS: [[f64; 3]; 9] = [
    [68.0, 1.0, 84.0],
    [71.0, 44.0, 122.0],
    [59.0, 81.0, 139.0],
    [44.0, 113.0, 142.0],
    [33.0, 144.0, 141.0],
    [39.0, 173.0, 129.0],
    [92.0, 200.0, 99.0],
    [170.0, 220.0, 50.0],
    [253.0, 231.0, 37.0],
];

/// The colours of the finite numbers of a column.
#[derive(Debug, Clone)]
pub(super) struct Shade {
    name: Name,
    low: f64,
    high: f64,
    is_logarithmic: bool,
}

impl Shade {
    pub(super) fn of(name: &Name, numbers: &[f64]) -> Self {
        let range = finite_range(numbers);
        let is_logarithmic = range.is_some_and(is_logarithmic);
        let own = |x: f64| if is_logarithmic { x.ln() } else { x };
        let [low, high] = range.map_or([0.0, 1.0], |ends| ends.map(own));
        Self { name: name.clone(), low, high, is_logarithmic }
    }

    /// The level of a number, from 0; `None` without one.
    pub(super) fn level(&self, x: f64) -> Option<usize> {
        let x = if self.is_logarithmic { x.ln() } else { x };
        if !x.is_finite() {
            return None;
        }
        let width = self.high - self.low;
        let share = if width > 0.0 { (x - self.low) / width } else { 1.0 };
        Some(((share * LEVELS as f64) as usize).min(LEVELS - 1))
    }

    /// The bar of colours with its numbers.
    pub(super) fn bar(&self, area: &Area<'_>, high: u32) -> Drawn {
        const TICKS: usize = 5;
        let (left, top, width) = (8, 24, 18);
        let high = i32::try_from(high)? - 60;
        let y = |share: f64| top + high - (share * f64::from(high)).round() as i32;
        for level in 0..LEVELS {
            let ends = [level, level + 1].map(|i| y(i as f64 / LEVELS as f64));
            let corners = [at(left, ends[1]), at(left + width, ends[0])];
            area.draw(&Rectangle::new(corners, colour(level).filled()))?;
        }
        for i in 0..TICKS {
            let share = i as f64 / (TICKS - 1) as f64;
            let x = self.low + share * (self.high - self.low);
            let x = if self.is_logarithmic { x.exp() } else { without_rounding(x) };
            let text = number(format!("{x:.2e}").parse().unwrap_or(x));
            area.draw(&Text::new(text, at(left + width + 6, y(share) - 6), (FONT, 12)))?;
        }
        let Name { name, unit } = &self.name;
        let unit =
            if unit.len() <= UNIT && unit != "1" { self.name.unit_label() } else { String::new() };
        area.draw(&Text::new(format!("{name}{unit}"), at(left, top - 20), (FONT, 12)))?;
        Ok(())
    }

    /// The colour of a number.
    pub(super) fn colour(&self, x: f64) -> Option<RGBColor> {
        self.level(x).map(colour)
    }
}

/// Smallest and largest finite number.
pub(super) fn finite_range(numbers: &[f64]) -> Option<[f64; 2]> {
    numbers.iter().copied().filter(|x| x.is_finite()).fold(None, |range, x| match range {
        None => Some([x, x]),
        Some([low, high]) => Some([f64::min(low, x), f64::max(high, x)]),
    })
}

/// True for positive numbers over several orders of magnitude.
pub(super) fn is_logarithmic([low, high]: [f64; 2]) -> bool {
    low > 0.0 && high.is_finite() && high > LOGARITHMIC * low
}

/// The colour of a level.
pub(super) fn colour(level: usize) -> RGBColor {
    let place = level as f64 / (LEVELS - 1) as f64 * (STOPS.len() - 1) as f64;
    let i = (place as usize).min(STOPS.len() - 2);
    let t = place - i as f64;
    let mix = |k: usize| (STOPS[i][k] + t * (STOPS[i + 1][k] - STOPS[i][k])).round() as u8;
    RGBColor(mix(0), mix(1), mix(2))
}
