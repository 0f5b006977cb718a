//! Lines from arrays.

use cylindroid::screws::{Line, Screw};
use cylindroid::{Error, Twist, Vec3};

use crate::arrays::Numbers;
use crate::error::{Failure, Result};

/// Lines: twists of pitch zero as columns, or pairs of point and direction.
pub(super) fn lines_of(lines: &Numbers<'_>) -> Result<Vec<Line>> {
    let refuse = |i: usize, why: &str| Failure::option("lines", format!("number {i}"), why);
    match *lines.shape() {
        [6, _] => {
            let m = lines.matrix("lines")?;
            let one = |j: usize| {
                let entries: [f64; 6] = std::array::from_fn(|i| m[(i, j)]);
                Error::check_finite("line", &entries)?;
                let twist = Twist::from_array(entries);
                let not_a_line = "a line is a twist of pitch zero: direction d (entries 4 to 6) and \
                                  p x d for a point p (entries 1 to 3)";
                let screw = Screw::of(twist).filter(|s| !s.is_translation());
                let screw = screw.ok_or_else(|| refuse(j, not_a_line))?;
                let size = screw.axis.point.norm().max(1.0);
                if screw.pitch.abs() > 1e-6 * size {
                    return Err(refuse(j, not_a_line));
                }
                Ok(screw.axis)
            };
            (0..m.cols()).map(one).collect()
        }
        [count, 2, 3] => {
            let rows = lines.values().as_chunks::<6>().0;
            let one = |i: usize| {
                Error::check_finite("line", &rows[i])?;
                let [px, py, pz, dx, dy, dz] = rows[i];
                let line = Line::through(Vec3::new(px, py, pz), Vec3::new(dx, dy, dz));
                line.ok_or_else(|| refuse(i, "its direction has no length"))
            };
            (0..count).map(one).collect()
        }
        _ => Err(Failure::option(
            "lines",
            format!("{} numbers", lines.values().len()),
            "give (6, m) twists of pitch zero as columns, or (m, 2, 3) points and directions",
        )),
    }
}
