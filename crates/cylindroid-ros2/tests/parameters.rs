//! Parameters: files, the command line above them, defaults, refusals; the network of a node.

#![allow(clippy::unwrap_used)] // a test that fails

use std::path::Path;

use clap::Parser;
use cylindroid::Method;
use cylindroid_ros2::controller::Controller;
use cylindroid_ros2::network::Network;
use cylindroid_ros2::parameters::{CommandKind, Parameters};
use ros2_client::ParameterValue;

#[derive(Parser)]
struct Cli {
    #[command(flatten)]
    parameters: Parameters,
}

fn typed(words: &[&str]) -> Parameters {
    Cli::parse_from([&["node"][..], words].concat()).parameters
}

fn file(name: &str, text: &str) -> std::path::PathBuf {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    std::fs::write(&path, text).unwrap();
    path
}

#[test]
fn the_command_line_overrides_the_file() {
    let path = file(
        "servo.toml",
        "robot = \"panda\"\nrate = 500.0\ncommand = \"velocities\"\nsecondary = [\"none\"]\n\
         joints = [\"a\", \"b\"]\ndomain = 7\n",
    );
    let words = ["--rate", "100", "--gain", "2", "--interface", "lo,eth0"];
    let config = typed(&words).over_file(Some(&path)).unwrap().config().unwrap();
    assert_eq!((config.rate, config.gain, config.domain), (100.0, 2.0, Some(7)));
    assert_eq!(config.robot.as_deref(), Some("panda"));
    assert_eq!(config.command, CommandKind::Velocities);
    assert_eq!(config.commands, "forward_velocity_controller/commands");
    assert_eq!(config.interface, Some(vec!["lo".to_owned(), "eth0".to_owned()]));
    assert_eq!(config.joints, Some(vec!["a".to_owned(), "b".to_owned()]));
    assert!(config.tf);
    let none = typed(&[]).over_file(None).unwrap().config().unwrap();
    assert!(!none.tf && none.robot.is_none(), "robot_state_publisher publishes the frames");
    assert_eq!(
        (none.twists.as_str(), none.poses.as_str()),
        ("~/delta_twist_cmds", "~/target_pose")
    );
}

#[test]
fn the_file_of_the_book_is_one() {
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/guide/ros2.md");
    let page = std::fs::read_to_string(page).unwrap();
    let text = page.split("```toml\n").nth(1).and_then(|rest| rest.split("```").next()).unwrap();
    let config = typed(&[]).over_file(Some(&file("book.toml", text))).unwrap().config().unwrap();
    let robot = cylindroid::load(config.robot.as_deref().unwrap()).unwrap();
    let controller = Controller::new(&config, &robot).unwrap();
    assert_eq!(controller.servo().options().dt, 1.0 / 500.0);
    assert_eq!(controller.servo().options().method, Method::Damped { damping: 0.02 });
}

#[test]
fn a_wrong_file_names_the_line() {
    for (text, reasons) in [
        ("rate = 100\ngian = 2.0\n", ["line 2", "gian"]),
        ("rate = \"fast\"\n", ["line 1", "invalid type"]),
        ("command = \"efforts\"\n", ["line 1", "efforts"]),
    ] {
        let path = file("wrong.toml", text);
        let error = format!("{:#}", typed(&[]).over_file(Some(&path)).unwrap_err());
        for reason in reasons {
            assert!(error.contains(reason), "{error}");
        }
    }
    let error = typed(&[]).over_file(Some(Path::new("nowhere.toml"))).unwrap_err();
    assert!(format!("{error:#}").contains("nowhere.toml"));
    if cfg!(unix) {
        let error = typed(&[]).over_file(Some(Path::new("/dev/zero"))).unwrap_err();
        assert!(format!("{error:#}").contains("not a regular file"), "{error:#}");
    }
}

#[test]
fn values_outside_their_domain_are_refused() {
    for (words, reason) in [
        (&["--rate=0"][..], "rate = 0"),
        (&["--rate=inf"], "rate = inf"),
        (&["--command-timeout=-1"], "command_timeout = -1"),
        (&["--delay=0.01"], "--command velocities"),
    ] {
        let error = typed(words).config().unwrap_err().to_string();
        assert!(error.contains(reason), "{error}");
    }
}

#[test]
fn parameters_are_declared_with_their_types() {
    let config = typed(&["panda", "--secondary", "none"]).config().unwrap();
    let declared = config.declared().unwrap();
    let value = |name: &str| declared.iter().find(|(n, _)| n == name).map(|(_, v)| v.clone());
    assert_eq!(value("rate"), Some(ParameterValue::Double(250.0)));
    assert_eq!(value("robot"), Some(ParameterValue::String("panda".to_owned())));
    assert_eq!(value("tf"), Some(ParameterValue::Boolean(true)));
    assert_eq!(value("command"), Some(ParameterValue::String("trajectory".to_owned())));
    assert_eq!(value("secondary"), Some(ParameterValue::StringArray(vec!["none".to_owned()])));
    assert_eq!(value("frame"), None);
}

#[test]
fn the_network_is_that_of_the_user() {
    let network = |words: &[&str], variables: &[(&str, &str)]| {
        let value = |name: &str| variables.iter().find(|v| v.0 == name).map(|v| v.1.to_owned());
        Network::new(&typed(words).config().unwrap(), value)
    };
    let loopback = Some(vec!["127.0.0.1".parse().unwrap()]);
    let plain = network(&[], &[]).unwrap();
    assert_eq!((plain.domain, plain.addresses), (0, None));
    let by_variable =
        network(&[], &[("ROS_DOMAIN_ID", "12"), ("ROS_LOCALHOST_ONLY", "1")]).unwrap();
    assert_eq!((by_variable.domain, &by_variable.addresses), (12, &loopback));
    let range = [("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")];
    assert_eq!(network(&[], &range).unwrap().addresses, loopback);
    let words = ["--domain", "3", "--interface", "127.0.0.1"];
    let typed = network(&words, &[("ROS_DOMAIN_ID", "12")]).unwrap();
    assert_eq!((typed.domain, &typed.addresses), (3, &loopback));
    assert_eq!(typed.described(), "domain 3, 127.0.0.1");
    for (words, variables, reason) in [
        (&["--domain", "233"][..], &[][..], "at most 232"),
        (&["--interface", "eth77"], &[], "no interface 'eth77'"),
        (&[], &[("ROS_DOMAIN_ID", "home")], "it must be a number"),
        (&[], &[("ROS_AUTOMATIC_DISCOVERY_RANGE", "OFF")], "OFF"),
    ] {
        let error = format!("{:#}", network(words, variables).unwrap_err());
        assert!(error.contains(reason), "{error}");
    }
}
