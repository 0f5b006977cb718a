//! The domain and the interfaces: the parameters, otherwise ROS's variables.

use std::net::IpAddr;

use anyhow::{Context, Result, bail, ensure};
use ros2_client::dds::rustdds::DomainParticipantBuilder;
use ros2_client::{Context as RosContext, dds};

use crate::parameters::Config;

/// The largest domain whose ports exist.
const MAX_DOMAIN: u16 = 232;

/// Where the node may be found.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Network {
    /// The DDS domain.
    pub domain: u16,
    /// The addresses of the interfaces; `None` for all.
    pub addresses: Option<Vec<IpAddr>>,
}

impl Network {
    /// From the parameters, and the environment where they name neither domain nor interface.
    ///
    /// # Errors
    /// A domain without ports, an interface that is not there, variables that ask for more than
    /// this node can do.
    pub fn new(config: &Config, variable: impl Fn(&str) -> Option<String>) -> Result<Self> {
        let domain = match (config.domain, variable("ROS_DOMAIN_ID")) {
            (Some(domain), _) => domain,
            (None, Some(text)) if !text.is_empty() => text
                .parse()
                .with_context(|| format!("ROS_DOMAIN_ID = {text}: it must be a number"))?,
            (None, _) => 0,
        };
        ensure!(domain <= MAX_DOMAIN, "domain {domain}: at most {MAX_DOMAIN}");
        let names = match &config.interface {
            Some(names) => Some(names.clone()),
            None => by_environment(variable)?,
        };
        let addresses = names.map(|names| addresses_of(&names)).transpose()?;
        Ok(Self { domain, addresses })
    }

    /// Joins the domain.
    ///
    /// # Errors
    /// Ports or sockets that cannot be had.
    pub fn join(&self) -> Result<RosContext> {
        let mut builder = DomainParticipantBuilder::new(self.domain);
        if let Some(addresses) = &self.addresses {
            builder = builder.with_only_networks(addresses.iter().copied());
        }
        let participant = builder.build().with_context(|| format!("domain {}", self.domain))?;
        Ok(dds::Context::from_domain_participant(participant)?)
    }

    /// For a person.
    #[must_use]
    pub fn described(&self) -> String {
        let on = match &self.addresses {
            None => "all interfaces".to_owned(),
            Some(list) => list.iter().map(ToString::to_string).collect::<Vec<_>>().join(", "),
        };
        format!("domain {}, {on}", self.domain)
    }
}

/// The interfaces that ROS's variables permit; `None` for all.
fn by_environment(variable: impl Fn(&str) -> Option<String>) -> Result<Option<Vec<String>>> {
    let range = variable("ROS_AUTOMATIC_DISCOVERY_RANGE").unwrap_or_default();
    Ok(match range.as_str() {
        "LOCALHOST" => Some(vec!["lo".to_owned()]),
        "" if variable("ROS_LOCALHOST_ONLY").as_deref() == Some("1") => Some(vec!["lo".to_owned()]),
        "" | "SUBNET" | "SYSTEM_DEFAULT" => None,
        other => bail!(
            "ROS_AUTOMATIC_DISCOVERY_RANGE = {other}: this node knows LOCALHOST, SUBNET and \
             SYSTEM_DEFAULT; name its interfaces with --interface instead"
        ),
    })
}

/// The IPv4 addresses of interfaces given by name or address. `lo` is the loopback interface, also
/// where it has another name.
fn addresses_of(names: &[String]) -> Result<Vec<IpAddr>> {
    let all = netdev::get_interfaces();
    let mut found = Vec::new();
    for name in names {
        let own = |i: &netdev::Interface| {
            i.name == *name
                || (name == "lo" && i.is_loopback())
                || i.ipv4.iter().any(|net| net.addr().to_string() == *name)
        };
        let chosen = all.iter().filter(|i| own(i)).flat_map(|i| i.ipv4.iter().map(|n| n.addr()));
        let by_address = name.parse::<IpAddr>().ok();
        let addresses: Vec<IpAddr> =
            chosen.map(IpAddr::V4).filter(|a| by_address.is_none_or(|b| b == *a)).collect();
        if addresses.is_empty() {
            let known: Vec<&str> = all.iter().map(|i| i.name.as_str()).collect();
            bail!("no interface '{name}' with an IPv4 address; there are {}", known.join(", "));
        }
        found.extend(addresses);
    }
    Ok(found)
}
