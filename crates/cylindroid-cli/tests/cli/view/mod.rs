//! `view`: the protocol of docs/viewer.md, spoken to the binary.

#![allow(clippy::panic)] // helpers say what they found

mod choices;
mod fuzz;
mod load;
mod motion;
mod obstacles;
mod opened;
mod refused;
mod reload;
mod served;
mod shared;

use std::io::{BufRead, BufReader, ErrorKind, Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use serde_json::{Value, json};
use tungstenite::client::IntoClientRequest;
use tungstenite::{Error, Message, WebSocket, client};

/// Longest wait for anything.
const WAIT: Duration = Duration::from_secs(60);

/// A running `cylindroid view`, stopped when it is dropped.
pub(crate) struct Server {
    child: Child,
    port: u16,
    /// Of the URL; empty without `--token`.
    token: String,
}

impl Server {
    /// At a free port.
    pub(crate) fn new(arguments: &[&str]) -> Self {
        Self::of(
            Command::new(env!("CARGO_BIN_EXE_cylindroid")).args(["view", "--port", "0"]),
            arguments,
        )
    }

    fn new_at_usual_port(arguments: &[&str]) -> Self {
        Self::of(Command::new(env!("CARGO_BIN_EXE_cylindroid")).arg("view"), arguments)
    }

    /// In an environment with this browser.
    fn with_browser(arguments: &[&str], browser: &Path) -> Self {
        let mut command = Command::new(env!("CARGO_BIN_EXE_cylindroid"));
        Self::of(command.args(["view", "--port", "0"]).env("BROWSER", browser), arguments)
    }

    fn of(command: &mut Command, arguments: &[&str]) -> Self {
        let mut child =
            command.args(arguments).stdout(Stdio::piped()).stderr(Stdio::null()).spawn().unwrap();
        let mut line = String::new();
        BufReader::new(child.stdout.as_mut().unwrap()).read_line(&mut line).unwrap();
        let rest = line.trim().trim_end_matches('/').rsplit(':').next().unwrap();
        let (port, token) = rest.split_once('/').unwrap_or((rest, ""));
        let port = port.parse().unwrap_or_else(|_| panic!("no URL: {line:?}"));
        Self { child, port, token: token.to_owned() }
    }

    fn address(&self) -> String {
        format!("127.0.0.1:{}", self.port)
    }

    /// Status and the whole answer to a request of these header lines.
    fn ask(&self, request: &str) -> (u16, String) {
        let mut stream = TcpStream::connect(self.address()).unwrap();
        stream.set_read_timeout(Some(WAIT)).unwrap();
        write!(stream, "{request}\r\nConnection: close\r\n\r\n").unwrap();
        let mut answer = Vec::new();
        stream.read_to_end(&mut answer).unwrap();
        let answer = String::from_utf8_lossy(&answer).into_owned();
        let status = answer.split(' ').nth(1).and_then(|s| s.parse().ok());
        (status.unwrap_or_else(|| panic!("no status: {answer}")), answer)
    }

    fn get(&self, path: &str) -> (u16, String) {
        self.ask(&format!("GET {path} HTTP/1.1\r\nHost: {}", self.address()))
    }

    pub(crate) fn client(&self) -> Client {
        self.client_of("")
    }

    /// With this query in its address.
    fn client_of(&self, query: &str) -> Client {
        let stream = TcpStream::connect(self.address()).unwrap();
        stream.set_read_timeout(Some(WAIT)).unwrap();
        let token = if self.token.is_empty() { String::new() } else { format!("/{}", self.token) };
        let url = format!("ws://{}{token}/ws{query}", self.address());
        let request = url.into_client_request().unwrap();
        let (socket, _) = client(request, stream).unwrap();
        Client { socket }
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

pub(crate) struct Client {
    socket: WebSocket<TcpStream>,
}

impl Client {
    pub(crate) fn say(&mut self, message: &Value) {
        self.text(&message.to_string());
    }

    fn text(&mut self, message: &str) {
        self.socket.send(Message::text(message)).unwrap();
    }

    /// The next message.
    pub(crate) fn hear(&mut self) -> Value {
        let begin = Instant::now();
        loop {
            // Pings come however long nothing else does.
            assert!(begin.elapsed() < WAIT, "no message came");
            match self.socket.read() {
                Ok(Message::Text(text)) => return serde_json::from_str(&text).unwrap(),
                // A signal came, as it may in any system call: what was read is kept.
                Err(Error::Io(e)) if e.kind() == ErrorKind::Interrupted => {}
                other => drop(other.unwrap()),
            }
        }
    }

    /// The next message of this type.
    pub(crate) fn next(&mut self, kind: &str) -> Value {
        self.until(|m| m["type"] == kind)
    }

    /// The next message that is so.
    pub(crate) fn until(&mut self, mut is_so: impl FnMut(&Value) -> bool) -> Value {
        let begin = Instant::now();
        let mut last = Value::Null;
        while begin.elapsed() < WAIT {
            last = self.hear();
            if is_so(&last) {
                return last;
            }
        }
        panic!("it did not come; the last was {last}");
    }

    /// Says something with a mark, and waits for the state that it is in.
    fn done(&mut self, mut message: Value) -> Value {
        let mark = format!("mark {}", message["type"]);
        message["id"] = json!(mark);
        self.say(&message);
        self.until(|m| m["type"] == "state" && m["ack"] == mark.as_str())
    }

    /// The complaint about a message.
    fn complaint(&mut self, message: &Value) -> Value {
        self.say(message);
        self.next("error")
    }

    /// The state in which the servo is at rest.
    fn ended(&mut self) -> Value {
        self.until(|m| {
            m["type"] == "state"
                && ["reached", "stalled"].contains(&m["servo"]["status"].as_str().unwrap())
        })
    }
}

/// A configuration as `--q` takes it.
fn configuration(state: &Value) -> String {
    crate::numbers(&state["q"]).iter().map(f64::to_string).collect::<Vec<_>>().join(",")
}
