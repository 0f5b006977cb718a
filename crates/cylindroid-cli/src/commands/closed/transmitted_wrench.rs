//! The wrenches that loop joints and contacts transmit: JSON and table.

use std::io::Write;

use cylindroid::closure::TransmittedWrench;
use serde::Serialize;

use crate::output::{self, Align};

#[derive(Debug, Serialize)]
pub(super) struct TransmittedWrenchJson {
    /// Loop joint or contact.
    name: String,
    /// Where it is [m].
    point: [f64; 3],
    /// Of its first link on its second [N], world axes.
    force: [f64; 3],
    /// About the point [N m].
    moment: [f64; 3],
    /// Of contacts: the force along the normal, positive where it pushes, and across it [N].
    normal: Option<f64>,
    tangential: Option<f64>,
}

impl From<TransmittedWrench> for TransmittedWrenchJson {
    fn from(t: TransmittedWrench) -> Self {
        Self {
            point: t.point.to_array(),
            force: t.wrench.force.to_array(),
            moment: t.wrench.moment.to_array(),
            normal: t.normal,
            tangential: t.tangential(),
            name: t.name,
        }
    }
}

/// The table of these wrenches.
pub(super) fn forces(
    out: &mut dyn Write,
    title: &str,
    all: &[TransmittedWrenchJson],
) -> anyhow::Result<()> {
    writeln!(out)?;
    let right = ["fx", "fy", "fz", "mx", "my", "mz", "normal", "tangential"];
    let mut columns = vec![(title, Align::Left)];
    columns.extend(right.map(|n| (n, Align::Right)));
    let rows = all.iter().map(|t| {
        let numbers = t.force.iter().chain(&t.moment).map(|x| output::entries(&[*x]));
        let contact = [t.normal, t.tangential]
            .map(|x| x.map_or_else(|| "-".to_owned(), |x| output::entries(&[x])));
        std::iter::once(t.name.clone()).chain(numbers).chain(contact).collect()
    });
    Ok(output::table(out, &columns, rows)?)
}
