//! Places for labels where they touch neither one another nor lines.

use std::f64::consts::TAU;

/// A point of the drawing [px].
pub(crate) type Pixel = (f64, f64);

/// Height of a label, and width of one of its characters, over the font size.
const HEIGHT: f64 = 1.1;
const CHARACTER: f64 = 0.56;
/// Distances of a label from its point [px].
const AWAY: [f64; 5] = [4.0, 9.0, 16.0, 26.0, 40.0];
const DIRECTIONS: u32 = 24;

/// A box [px]: smallest and largest x, smallest and largest y.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Area {
    pub(crate) x: (f64, f64),
    pub(crate) y: (f64, f64),
}

impl Area {
    /// Around a point, with these half widths.
    pub(crate) fn around(p: Pixel, half: Pixel) -> Self {
        Self { x: (p.0 - half.0, p.0 + half.0), y: (p.1 - half.1, p.1 + half.1) }
    }

    fn overlap(&self, other: &Self) -> f64 {
        let common = |a: (f64, f64), b: (f64, f64)| (a.1.min(b.1) - a.0.max(b.0)).max(0.0);
        common(self.x, other.x) * common(self.y, other.y)
    }

    /// The part of the box outside another, in each direction.
    fn outside(&self, of: &Self) -> f64 {
        let beyond = |a: (f64, f64), b: (f64, f64)| (b.0 - a.0).max(0.0) + (a.1 - b.1).max(0.0);
        beyond(self.x, of.x) + beyond(self.y, of.y)
    }

    /// True if a segment passes through the box.
    fn is_crossed(&self, [p, q]: [Pixel; 2]) -> bool {
        let (mut from, mut to) = (0.0_f64, 1.0_f64);
        for (a, b, (low, high)) in [(p.0, q.0, self.x), (p.1, q.1, self.y)] {
            let step = b - a;
            if step.abs() < 1e-9 {
                if a < low || a > high {
                    return false;
                }
                continue;
            }
            let ends = [(low - a) / step, (high - a) / step];
            from = from.max(ends[0].min(ends[1]));
            to = to.min(ends[0].max(ends[1]));
        }
        from < to
    }
}

/// What labels must not touch; labels that are placed are added.
#[derive(Debug)]
pub(crate) struct Labels {
    inside: Area,
    boxes: Vec<Area>,
    segments: Vec<[Pixel; 2]>,
}

impl Labels {
    pub(crate) fn new(inside: Area) -> Self {
        Self { inside, boxes: Vec::new(), segments: Vec::new() }
    }

    pub(crate) fn avoid_box(&mut self, area: Area) {
        self.boxes.push(area);
    }

    pub(crate) fn avoid_line(&mut self, line: &[Pixel]) {
        self.segments.extend(line.windows(2).map(|pair| [pair[0], pair[1]]));
    }

    /// The centre of a label for a point: near it, and free of everything as far as there is room.
    pub(crate) fn place(&mut self, text: &str, point: Pixel, font: f64) -> Pixel {
        let width = CHARACTER * font * text.chars().count() as f64;
        let half = (0.5 * width + 2.0, 0.5 * HEIGHT * font);
        let mut best = (f64::INFINITY, point);
        for (ring, away) in AWAY.into_iter().enumerate() {
            for k in 0..DIRECTIONS {
                // Above first, then to the sides.
                let turn = f64::from(k.div_ceil(2)) * if k % 2 == 0 { -1.0 } else { 1.0 };
                let (s, c) = (TAU * turn / f64::from(DIRECTIONS)).sin_cos();
                let out = |x: f64| x.signum() * x.abs().min(0.5) * 2.0;
                let centre =
                    (point.0 + s * away + out(s) * half.0, point.1 - c * away - out(c) * half.1);
                let area = Area::around(centre, half);
                let crossed = self.segments.iter().filter(|s| area.is_crossed(**s)).count();
                let covered: f64 = self.boxes.iter().map(|b| area.overlap(b)).sum();
                let cost = 20.0 * area.outside(&self.inside)
                    + 60.0 * crossed.min(5) as f64
                    + 3.0 * covered
                    + 8.0 * ring as f64
                    + 0.1 * f64::from(k);
                if cost < best.0 {
                    best = (cost, centre);
                }
            }
        }
        self.boxes.push(Area::around(best.1, half));
        best.1
    }
}
