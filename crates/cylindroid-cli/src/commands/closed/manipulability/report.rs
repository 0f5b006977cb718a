//! What `manipulability` prints.

use std::io::Write;

use cylindroid::closure::TransmittedWrench;
use cylindroid::linalg::Interval;
use cylindroid::manipulability::{Direction, Gradient, Index, Spectrum};
use serde::Serialize;
use serde_json::value::{RawValue, to_raw_value};

use super::super::HeadJson;
use super::super::transmitted_wrench::TransmittedWrenchJson;
use super::drawn::{self, DrawnJson};
use super::find::{Bounded, Found, InternalForces, Reached};
use crate::commands::shared::Style;
use crate::output::{self, Align, number};

#[derive(Debug, Serialize)]
struct ManipulabilityJson<'a> {
    #[serde(flatten)]
    head: HeadJson<'a>,
    metric: &'static str,
    /// Metrics given in place of a part of it: wu, wq, ww, wtau.
    own_metrics: &'a [&'static str],
    /// The components of the reference frame's twist and wrench, or of the task.
    components: &'a [String],
    kinematic: SpectrumJson,
    active_force: SpectrumJson,
    passive_force: SpectrumJson,
    /// Forces in loops and contacts without a wrench on the frame, for torques of the actuators.
    internal_force: InternalForceJson,
    indices: IndicesJson,
    measures: MeasuresJson,
    #[serde(skip_serializing_if = "Option::is_none")]
    polytope: Option<PolytopesJson>,
    #[serde(skip_serializing_if = "Option::is_none")]
    gradient: Option<GradientJson>,
    /// With --plot.
    #[serde(skip_serializing_if = "Option::is_none")]
    drawn: Option<DrawnJson>,
}

/// The values of the six indices, largest first; null is infinite.
#[derive(Debug, Serialize)]
struct IndicesJson {
    kinematic: Vec<f64>,
    active_kinematic: Vec<f64>,
    passive_kinematic: Vec<f64>,
    force: Vec<f64>,
    active_force: Vec<f64>,
    passive_force: Vec<f64>,
}

#[derive(Debug, Serialize)]
struct MeasuresJson {
    kinematic: MeasureJson,
    force: MeasureJson,
}

#[derive(Debug, Serialize)]
struct MeasureJson {
    volume: f64,
    largest: Option<f64>,
    smallest: Option<f64>,
    anisotropy: Option<f64>,
}

impl From<&Spectrum> for MeasureJson {
    fn from(s: &Spectrum) -> Self {
        Self {
            volume: s.volume(),
            largest: s.largest(),
            smallest: s.smallest(),
            anisotropy: s.anisotropy(),
        }
    }
}

#[derive(Debug, Serialize)]
struct PolytopesJson {
    velocity: Option<BoundedJson>,
    force: Option<BoundedJson>,
    /// What is missing for one of them.
    notes: Vec<String>,
}

#[derive(Debug, Serialize)]
struct BoundedJson {
    /// Lower and upper limit of each actuated joint.
    limits: Vec<[f64; 2]>,
    /// Smallest and largest value of each component; null is infinite.
    range: Vec<[f64; 2]>,
    /// Corners, in the order of the rim where the polytope is flat; null for more than three
    /// components.
    vertices: Option<Vec<Vec<f64>>>,
    /// Directions without limit.
    unbounded: Vec<Vec<f64>>,
    complete: bool,
}

impl From<&Bounded> for BoundedJson {
    fn from(b: &Bounded) -> Self {
        let ends = |list: &[Interval]| list.iter().map(|i| [i.lower, i.upper]).collect();
        let polytope = b.polytope.as_ref();
        Self {
            limits: ends(&b.limits),
            range: ends(&b.range),
            vertices: polytope.map(|p| p.hull.polygon().iter().map(|v| v.to_vec()).collect()),
            unbounded: polytope.map_or_else(Vec::new, |p| output::columns(&p.unbounded)),
            complete: polytope.is_none_or(|p| p.hull.complete),
        }
    }
}

#[derive(Debug, Serialize)]
struct GradientJson {
    measure: &'static str,
    /// False where the measure has a kink, or nothing to measure.
    exists: bool,
    value: Option<f64>,
    /// For each coordinate of q.
    gradient: Option<Vec<f64>>,
    error: Option<f64>,
    /// How many efficiencies meet where there is a kink.
    multiplicity: Option<usize>,
}

#[derive(Debug, Serialize)]
struct SpectrumJson {
    /// Largest first.
    finite: Vec<f64>,
    zeros: usize,
    infinite: usize,
    /// Of the finite ones: velocities or torques of the actuated joints, twist or wrench.
    directions: Vec<DirectionJson>,
    /// Rates or torques that do nothing.
    zero_directions: Vec<Vec<f64>>,
    /// Twists or wrenches without input.
    infinite_directions: Vec<Vec<f64>>,
}

#[derive(Debug, Serialize)]
struct InternalForceJson {
    /// Largest first: squared forces over squared torques.
    finite: Vec<f64>,
    infinite: usize,
    directions: Vec<InternalDirectionJson>,
    /// Forces that need no torque (hyperstatic), as transmitted wrenches.
    infinite_directions: Vec<Vec<TransmittedWrenchJson>>,
}

#[derive(Debug, Serialize)]
struct InternalDirectionJson {
    /// Torques of the actuated joints.
    joint: Vec<f64>,
    forces: Vec<TransmittedWrenchJson>,
}

impl From<&InternalForces> for InternalForceJson {
    fn from(found: &InternalForces) -> Self {
        let all = |w: &Vec<TransmittedWrench>| w.iter().cloned().map(Into::into).collect();
        let finite = found.spectrum.finite.iter().zip(&found.forces);
        Self {
            finite: found.spectrum.values(),
            infinite: found.spectrum.infinite.cols(),
            directions: finite
                .map(|(d, w)| InternalDirectionJson { joint: d.joint.clone(), forces: all(w) })
                .collect(),
            infinite_directions: found.hyperstatic.iter().map(all).collect(),
        }
    }
}

#[derive(Debug, Serialize)]
struct DirectionJson {
    joint: Vec<f64>,
    object: Vec<f64>,
}

impl From<&Spectrum> for SpectrumJson {
    fn from(s: &Spectrum) -> Self {
        let direction =
            |d: &Direction| DirectionJson { joint: d.joint.clone(), object: d.object.clone() };
        Self {
            finite: s.values(),
            zeros: s.zeros.cols(),
            infinite: s.infinite.cols(),
            directions: s.finite.iter().map(direction).collect(),
            zero_directions: output::columns(&s.zeros),
            infinite_directions: output::columns(&s.infinite),
        }
    }
}

pub(super) fn write(found: &Found, style: Style, out: &mut dyn Write) -> anyhow::Result<()> {
    match style {
        Style::Json => output::json(out, &describe(found)),
        Style::Table => print(found, out),
    }
}

/// The JSON object.
pub(super) fn raw(found: &Found) -> anyhow::Result<Box<RawValue>> {
    Ok(to_raw_value(&describe(found))?)
}

fn describe(found: &Found) -> ManipulabilityJson<'_> {
    let m = &found.efficiencies;
    let values = |index: Index| index.values(m);
    let polytope = found.polytopes.as_ref().map(|[velocity, force]| PolytopesJson {
        velocity: velocity.as_ref().ok().map(BoundedJson::from),
        force: force.as_ref().ok().map(BoundedJson::from),
        notes: [velocity, force].into_iter().filter_map(|r| r.as_ref().err().cloned()).collect(),
    });
    let gradient = found.gradient.as_ref().map(|(measure, gradient)| {
        let empty = GradientJson {
            measure: measure.name(),
            exists: false,
            value: None,
            gradient: None,
            error: None,
            multiplicity: None,
        };
        match gradient {
            Gradient::Exists { value, gradient, error } => GradientJson {
                exists: true,
                value: Some(*value),
                gradient: Some(gradient.clone()),
                error: Some(*error),
                ..empty
            },
            Gradient::Repeated { value, multiplicity } => {
                GradientJson { value: Some(*value), multiplicity: Some(*multiplicity), ..empty }
            }
            Gradient::Nothing => empty,
        }
    });
    ManipulabilityJson {
        head: (&found.posed).into(),
        metric: found.metric,
        own_metrics: &found.own,
        components: &found.components,
        kinematic: (&m.kinematic).into(),
        active_force: (&m.active_force()).into(),
        passive_force: (&m.passive_force()).into(),
        internal_force: (&found.internal).into(),
        indices: IndicesJson {
            kinematic: values(Index::Kinematic),
            active_kinematic: values(Index::ActiveKinematic),
            passive_kinematic: values(Index::PassiveKinematic),
            force: values(Index::Force),
            active_force: values(Index::ActiveForce),
            passive_force: values(Index::PassiveForce),
        },
        measures: MeasuresJson { kinematic: (&m.kinematic).into(), force: (&m.force).into() },
        polytope,
        gradient,
        drawn: DrawnJson::of(found),
    }
}

fn print(found: &Found, out: &mut dyn Write) -> anyhow::Result<()> {
    let posed = &found.posed;
    let mut lines = posed.heading();
    let length = number(posed.chain.constraint.length());
    let metric = match found.metric {
        "unit" => "unit (m and rad, N and N m, unscaled)".to_owned(),
        "inertia" => "inertia (twists by twice their kinetic energy)".to_owned(),
        name => format!("{name} (lengths over {length} m)"),
    };
    lines.push(("metric", metric));
    lines.push(("metrics given", found.own.join(", ")));
    output::pairs(out, lines)?;
    let m = &found.efficiencies;
    let names = ["motion", "force exerted", "force resisted"];
    for (name, spectrum) in
        names.into_iter().zip([&m.kinematic, &m.active_force(), &m.passive_force()])
    {
        writeln!(out)?;
        efficiencies(found, name, spectrum, out)?;
    }
    internal_forces(found, out)?;
    writeln!(out)?;
    indices(found, out)?;
    if let Some([velocity, force]) = &found.polytopes {
        bounded(found, ("velocity within the limits", "twist [m/s, rad/s]"), velocity, out)?;
        bounded(found, ("force within the limits", "wrench [N, N m]"), force, out)?;
    }
    if let Some((measure, gradient)) = &found.gradient {
        writeln!(out)?;
        slope(found, measure.name(), gradient, out)?;
    }
    if found.drawn.is_some() {
        writeln!(out)?;
        drawn::print(found, out)?;
    }
    Ok(())
}

fn efficiencies(
    found: &Found,
    name: &str,
    spectrum: &Spectrum,
    out: &mut dyn Write,
) -> anyhow::Result<()> {
    let actuated = &found.posed.chain.actuated;
    let mut columns = vec![(name, Align::Left)];
    let names = actuated.iter().chain(&found.components);
    columns.extend(names.map(|n| (n.as_str(), Align::Right)));
    let (joints, object) = (actuated.len(), found.components.len());
    let row = |what: String, joint: &[f64], twist: &[f64]| {
        let mut cells = vec![what];
        let cell = |x: &f64| output::entries(&[*x]);
        cells.extend((0..joints).map(|i| joint.get(i).map_or_else(|| "0".to_owned(), cell)));
        cells.extend((0..object).map(|i| twist.get(i).map_or_else(|| "0".to_owned(), cell)));
        cells
    };
    let infinite = output::columns(&spectrum.infinite);
    let infinite = infinite.into_iter().map(|u| row("infinite".to_owned(), &[], &u));
    let values = spectrum.values().into_iter().zip(&spectrum.finite);
    let finite = values.map(|(value, d)| row(number(value), &d.joint, &d.object));
    let zeros =
        output::columns(&spectrum.zeros).into_iter().map(|q| row("zero".to_owned(), &q, &[]));
    output::table(out, &columns, infinite.chain(finite).chain(zeros).collect::<Vec<_>>())?;
    Ok(())
}

/// Torques and the normal forces (or forces) that they cause, where something can be squeezed.
fn internal_forces(found: &Found, out: &mut dyn Write) -> anyhow::Result<()> {
    let InternalForces { spectrum, forces, hyperstatic } = &found.internal;
    if spectrum.finite.is_empty() && hyperstatic.is_empty() {
        return Ok(());
    }
    writeln!(out)?;
    let actuated = &found.posed.chain.actuated;
    let closings = found.posed.closings();
    let titles: Vec<String> = closings.iter().map(|c| format!("|f|, |m| at {c}")).collect();
    let mut columns = vec![("internal force", Align::Left)];
    columns.extend(actuated.iter().chain(&titles).map(|n| (n.as_str(), Align::Right)));
    let row = |what: String, torques: Option<&[f64]>, forces: &[TransmittedWrench]| {
        let mut cells = vec![what];
        let torque = |i: usize| output::entries(&[torques.map_or(0.0, |t| t[i])]);
        cells.extend((0..actuated.len()).map(torque));
        let size = |w: &TransmittedWrench| {
            output::entries(&[w.wrench.force.norm(), w.wrench.moment.norm()])
        };
        cells.extend(forces.iter().map(size));
        cells
    };
    let infinite = hyperstatic.iter().map(|w| row("infinite".to_owned(), None, w));
    let finite = spectrum.values().into_iter().zip(&spectrum.finite).zip(forces);
    let finite = finite.map(|((value, d), w)| row(number(value), Some(&d.joint), w));
    Ok(output::table(out, &columns, infinite.chain(finite).collect::<Vec<_>>())?)
}

fn indices(found: &Found, out: &mut dyn Write) -> anyhow::Result<()> {
    let word = |x: &f64| match x {
        x if x.is_infinite() => "infinite".to_owned(),
        x => number(*x),
    };
    let rows = Index::ALL.iter().map(|index| {
        let values = index.values(&found.efficiencies);
        let values = values.iter().map(word).collect::<Vec<_>>().join(", ");
        vec![index.name().to_owned(), values, index.description().to_owned()]
    });
    let columns =
        [("index", Align::Left), ("efficiencies", Align::Left), ("definition", Align::Left)];
    output::table(out, &columns, rows)?;
    writeln!(out)?;
    let value = |x: Option<f64>| x.map_or_else(|| "none".to_owned(), number);
    let m = &found.efficiencies;
    let rows = [("motion", &m.kinematic), ("force", &m.force)].map(|(name, s)| {
        vec![
            name.to_owned(),
            number(s.volume()),
            value(s.smallest()),
            value(s.largest()),
            value(s.anisotropy()),
        ]
    });
    let columns = [
        ("of the finite ones", Align::Left),
        ("volume (Yoshikawa)", Align::Right),
        ("smallest", Align::Right),
        ("largest", Align::Right),
        ("anisotropy", Align::Right),
    ];
    Ok(output::table(out, &columns, rows)?)
}

fn bounded(
    found: &Found,
    (title, unit): (&str, &str),
    reached: &Reached,
    out: &mut dyn Write,
) -> anyhow::Result<()> {
    /// Most corners that a table lists.
    const MOST: usize = 24;
    writeln!(out)?;
    let b = match reached {
        Ok(b) => b,
        Err(missing) => return Ok(writeln!(out, "{title}: {missing}")?),
    };
    let word = |x: f64| if x.is_infinite() { "no limit".to_owned() } else { output::entries(&[x]) };
    let rows = found
        .components
        .iter()
        .zip(&b.range)
        .map(|(name, r)| vec![name.clone(), word(r.lower), word(r.upper)]);
    let columns = [(title, Align::Left), ("smallest", Align::Right), ("largest", Align::Right)];
    output::table(out, &columns, rows)?;
    let Some(polytope) = &b.polytope else {
        writeln!(out, "corners: for three components at most, as of --task x,y,z")?;
        return Ok(());
    };
    let corners = polytope.hull.polygon();
    if corners.len() > MOST {
        writeln!(out, "{} corners (--json lists them)", corners.len())?;
        return Ok(());
    }
    writeln!(out)?;
    let name = format!("corner, {unit}");
    let columns: Vec<(&str, Align)> = std::iter::once((name.as_str(), Align::Left))
        .chain(found.components.iter().map(|c| (c.as_str(), Align::Right)))
        .collect();
    let rows = corners.iter().enumerate().map(|(i, v)| {
        std::iter::once((i + 1).to_string())
            .chain(v.iter().map(|x| output::entries(&[*x])))
            .collect()
    });
    Ok(output::table(out, &columns, rows)?)
}

fn slope(
    found: &Found,
    measure: &str,
    gradient: &Gradient,
    out: &mut dyn Write,
) -> anyhow::Result<()> {
    match gradient {
        Gradient::Exists { value, gradient, error } => {
            let columns = [("coordinate", Align::Left), ("gradient", Align::Right)];
            let title = format!("gradient of the {measure} of motion, {}", number(*value));
            let loops = if found.posed.mechanism.is_closed() {
                format!(" (along motions that keep the loops; error about {})", number(*error))
            } else {
                String::new()
            };
            writeln!(out, "{title}{loops}")?;
            let names = output::joint_names(&found.posed.mechanism);
            let rows = names
                .iter()
                .zip(gradient)
                .map(|(name, g)| vec![(*name).to_owned(), output::entries(&[*g])]);
            output::table(out, &columns, rows)?;
        }
        Gradient::Repeated { value, multiplicity } => writeln!(
            out,
            "the {measure} of motion, {}, has a kink here: {multiplicity} efficiencies are equal",
            number(*value)
        )?,
        Gradient::Nothing => {
            writeln!(out, "no gradient: there is no finite efficiency to measure")?;
        }
    }
    Ok(())
}
