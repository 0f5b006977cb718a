//! `manipulability`: efficiencies of motion and force.

use std::io::Write;
use std::process::ExitCode;

use cylindroid::closure::Motions;
use cylindroid::manipulability::{Manipulability, Metrics, Spectrum};
use cylindroid::{Error, Matrix};
use serde::Serialize;

use super::{HeadJson, Posed};
use crate::args::{ManipulabilityArgs, MetricName};
use crate::commands::Style;
use crate::output::{self, Align, number};

#[derive(Debug, Serialize)]
struct ManipulabilityJson<'a> {
    #[serde(flatten)]
    head: HeadJson<'a>,
    metric: &'static str,
    /// Components of the reference frame's twist and wrench.
    components: &'static [&'static str],
    kinematic: SpectrumJson,
    active_force: SpectrumJson,
    passive_force: SpectrumJson,
}

#[derive(Debug, Serialize)]
struct SpectrumJson {
    /// Largest first.
    finite: Vec<f64>,
    zeros: usize,
    infinite: usize,
    /// Of the finite ones: rates or torques of the driven joints, twist or wrench.
    directions: Vec<DirectionJson>,
    /// Rates or torques that do nothing.
    zero_directions: Vec<Vec<f64>>,
    /// Twists or wrenches without input.
    infinite_directions: Vec<Vec<f64>>,
}

#[derive(Debug, Serialize)]
struct DirectionJson {
    joint: Vec<f64>,
    object: Vec<f64>,
}

impl From<&Spectrum> for SpectrumJson {
    fn from(s: &Spectrum) -> Self {
        let columns = |m: &Matrix| (0..m.cols()).map(|j| m.column(j).to_vec()).collect::<Vec<_>>();
        let direction = |d: &cylindroid::manipulability::Direction| DirectionJson {
            joint: d.joint.clone(),
            object: d.object.clone(),
        };
        Self {
            finite: s.values(),
            zeros: s.zeros.cols(),
            infinite: s.infinite.cols(),
            directions: s.finite.iter().map(direction).collect(),
            zero_directions: columns(&s.zeros),
            infinite_directions: columns(&s.infinite),
        }
    }
}

pub(crate) fn run(
    args: &ManipulabilityArgs,
    style: Style,
    out: &mut dyn Write,
) -> anyhow::Result<ExitCode> {
    let posed = Posed::new(&args.closed)?;
    let chain = &posed.chain;
    let length = chain.constraint.length();
    let metrics = match args.metric {
        MetricName::Unit => Metrics::UNIT,
        MetricName::Length => Metrics::characteristic_length(&chain.units, length)?,
        MetricName::Limits => Metrics::characteristic_length(&chain.units, length)?
            .with_rate_limits(&rate_limits(&posed)?)?,
    };
    let metric = match args.metric {
        MetricName::Unit => "unit",
        MetricName::Length => "length",
        MetricName::Limits => "limits",
    };
    let relation = Motions::of(&chain.constraint).relation();
    let m = Manipulability::of(&relation, &metrics)?;
    let spectra = [&m.kinematic, &m.active_force(), &m.passive_force()];
    match style {
        Style::Json => output::json(
            out,
            &ManipulabilityJson {
                head: (&posed).into(),
                metric,
                components: posed.components(),
                kinematic: spectra[0].into(),
                active_force: spectra[1].into(),
                passive_force: spectra[2].into(),
            },
        )?,
        Style::Table => print(out, &posed, metric, spectra)?,
    }
    Ok(ExitCode::SUCCESS)
}

/// The rate limits of the driven joints, all finite.
fn rate_limits(posed: &Posed) -> cylindroid::Result<Vec<f64>> {
    let mechanism = &posed.mechanism;
    let limit = |name: &String| {
        let tree = mechanism.coordinates().iter().find(|c| c.name == *name);
        let closing = mechanism.loops().iter().find(|l| l.name == *name);
        let limit = tree.map(|c| c.limits).or(closing.map(|l| l.limits)).map(|l| l.velocity);
        limit.filter(|v| v.is_finite() && *v > 0.0).ok_or_else(|| Error::InvalidOption {
            option: "--metric",
            value: "limits".to_owned(),
            reason: format!("joint '{name}' has no velocity limit; give it one, or use 'length'"),
        })
    };
    posed.chain.actuated.iter().map(limit).collect()
}

fn print(
    out: &mut dyn Write,
    posed: &Posed,
    metric: &str,
    spectra: [&Spectrum; 3],
) -> anyhow::Result<()> {
    let mut lines = posed.heading();
    lines.push((
        "metric",
        match metric {
            "unit" => "unit (m beside rad, N beside N m)".to_owned(),
            _ => format!("{metric} (lengths over {} m)", number(posed.chain.constraint.length())),
        },
    ));
    output::pairs(out, lines)?;
    let names = ["motion", "force exerted", "force resisted"];
    for (name, spectrum) in names.into_iter().zip(spectra) {
        writeln!(out)?;
        let mut columns = vec![(name, Align::Left)];
        columns.extend(posed.chain.actuated.iter().map(|n| (n.as_str(), Align::Right)));
        columns.extend(posed.components().iter().map(|n| (*n, Align::Right)));
        let (joints, object) = (posed.chain.actuated.len(), posed.components().len());
        let row = |what: String, joint: &[f64], twist: &[f64]| {
            let mut cells = vec![what];
            let cell = |x: &f64| output::entries(&[*x]);
            cells.extend((0..joints).map(|i| joint.get(i).map_or_else(|| "0".to_owned(), cell)));
            cells.extend((0..object).map(|i| twist.get(i).map_or_else(|| "0".to_owned(), cell)));
            cells
        };
        let columns_of =
            |m: &Matrix| (0..m.cols()).map(|j| m.column(j).to_vec()).collect::<Vec<_>>();
        let infinite =
            columns_of(&spectrum.infinite).into_iter().map(|u| row("infinite".to_owned(), &[], &u));
        let finite = spectrum
            .values()
            .into_iter()
            .zip(&spectrum.finite)
            .map(|(value, d)| row(number(value), &d.joint, &d.object));
        let zeros =
            columns_of(&spectrum.zeros).into_iter().map(|q| row("zero".to_owned(), &q, &[]));
        output::table(out, &columns, infinite.chain(finite).chain(zeros).collect::<Vec<_>>())?;
    }
    Ok(())
}
