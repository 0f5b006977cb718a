//! The flags of inverse methods, one for each parameter of the library's tables.

use std::collections::BTreeMap;
use std::sync::LazyLock;

use clap::{Arg, ArgAction, ArgMatches, Args, Command, Error, FromArgMatches, value_parser};
use cylindroid::Method;
use cylindroid::control::NamedInverse;
use cylindroid::inverse::Parameter;

use crate::values::Motion;

/// A flag, and whose it is.
#[derive(Debug)]
pub(crate) struct Flag {
    /// Name of the parameter.
    pub(crate) name: &'static str,
    /// Without dashes.
    flag: &'static str,
    /// With them, as messages name it.
    pub(crate) option: &'static str,
    parameter: Parameter,
    /// Descriptions, each with the inverses that it belongs to.
    texts: Vec<(&'static str, Vec<&'static str>)>,
}

/// Every parameter once, in the order of the tables; clap keeps the texts for the whole run.
static FLAGS: LazyLock<Vec<Flag>> = LazyLock::new(|| {
    let mut all: Vec<Flag> = Vec::new();
    let pairs = NamedInverse::all().flat_map(|i| i.parameters.iter().map(move |p| (i.name, p)));
    for (owner, parameter) in pairs {
        let at = all.iter().position(|f| f.name == parameter.name).unwrap_or_else(|| {
            let option: &'static str =
                Box::leak(format!("--{}", parameter.name.replace('_', "-")).into_boxed_str());
            let flag = option.trim_start_matches("--");
            let name = parameter.name;
            all.push(Flag { name, flag, option, parameter: *parameter, texts: Vec::new() });
            all.len() - 1
        });
        let texts = &mut all[at].texts;
        match texts.iter_mut().find(|(text, _)| *text == parameter.description) {
            Some((_, owners)) => owners.push(owner),
            None => texts.push((parameter.description, vec![owner])),
        }
    }
    all
});

/// The option of a parameter, as it is typed: `--max-joint-velocity`.
pub(crate) fn option(parameter: &str) -> Option<&'static str> {
    FLAGS.iter().find(|f| f.name == parameter).map(|f| f.option)
}

/// The help of `--inverse`.
fn help() -> String {
    let names = |partial: bool| {
        let all = NamedInverse::all().filter(|i| i.is_partial == partial);
        let named = all.map(|i| {
            let flags = i.parameters.iter().filter_map(|p| option(p.name));
            let own: Vec<&str> = flags.chain(i.takes_complement.then_some("--give-up")).collect();
            format!("{} ({})", i.name, own.join(", "))
        });
        named.collect::<Vec<String>>().join(", ")
    };
    format!(
        "Inverse of the Jacobian: {}; for arms with fewer than six joints, frame- and \
         unit-invariant: {} [default: {}]",
        names(false),
        names(true),
        Method::default().name()
    )
}

/// An inverse with its parameters.
#[derive(Debug, Args)]
pub(crate) struct NamedInverseArgs {
    #[arg(long, value_name = "NAME", help = help())]
    pub(crate) inverse: Option<String>,

    #[command(flatten)]
    pub(crate) parameters: Parameters,

    /// A motion of the tool, in its axes, that may be given up: x, y, z, rx, ry, rz, or a twist
    /// `vx,vy,vz,wx,wy,wz`; as often as the arm lacks joints to six (oblique)
    #[arg(long, value_name = "MOTION", allow_hyphen_values = true)]
    pub(crate) give_up: Vec<Motion>,
}

impl NamedInverseArgs {
    /// Its name.
    pub(crate) fn name(&self) -> &str {
        self.inverse.as_deref().unwrap_or(Method::default().name())
    }

    /// True if any of the options was given.
    pub(crate) fn is_given(&self) -> bool {
        self.inverse.is_some() || !self.parameters.0.is_empty() || !self.give_up.is_empty()
    }
}

/// Values of parameters by name, those that were given.
#[derive(Debug, Clone, Default)]
pub(crate) struct Parameters(pub(crate) BTreeMap<&'static str, f64>);

impl FromArgMatches for Parameters {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, Error> {
        let given = |f: &Flag| Some((f.name, *matches.get_one::<f64>(f.flag)?));
        Ok(Self(FLAGS.iter().filter_map(given).collect()))
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), Error> {
        self.0.extend(Self::from_arg_matches(matches)?.0);
        Ok(())
    }
}

impl Args for Parameters {
    fn augment_args(command: Command) -> Command {
        command.args(FLAGS.iter().map(argument))
    }

    fn augment_args_for_update(command: Command) -> Command {
        Self::augment_args(command)
    }
}

fn argument(flag: &Flag) -> Arg {
    let unit = flag.parameter.unit;
    let text = flag.texts.iter().map(|(text, owners)| {
        format!("{} [{unit}] ({})", text.trim_end_matches('.'), owners.join(", "))
    });
    let default = match flag.parameter.required {
        true => String::new(),
        false if flag.texts.len() + flag.texts[0].1.len() == 2 => {
            format!(" [default: {}]", crate::output::number(flag.parameter.default))
        }
        // Methods that share the flag may differ in its default.
        false => String::new(),
    };
    Arg::new(flag.flag)
        .long(flag.flag)
        .value_name("VALUE")
        .allow_hyphen_values(true)
        .action(ArgAction::Set)
        .value_parser(value_parser!(f64))
        .help(format!("{}{default}", text.collect::<Vec<String>>().join("; ")))
}
