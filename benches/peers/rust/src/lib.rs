//! What the programs share: the configurations, and the commands of `compare.py`
//! (`common.hpp` lists them).

use std::collections::HashMap;
use std::hint::black_box;
use std::io::{BufRead, Write};
use std::time::Instant;

use cpu_time::ProcessTime;

/// Whatever went wrong: it becomes a row of the table.
pub type Result<T> = std::result::Result<T, Box<dyn std::error::Error>>;

/// Calls that are timed together.
pub const BLOCK: usize = 256;

/// A robot: configurations, targets (rotation by rows, position), targets that nothing reaches.
pub struct Robot {
    pub urdf: String,
    pub names: Vec<String>,
    pub limits: Vec<(f64, f64)>,
    pub q: Vec<f64>,
    pub targets: Vec<f64>,
    pub far: Vec<f64>,
}

fn doubles(path: &str) -> Vec<f64> {
    let bytes = std::fs::read(path).unwrap_or_default();
    bytes.chunks_exact(8).map(|b| f64::from_le_bytes(b.try_into().unwrap_or_default())).collect()
}

impl Robot {
    fn load(folder: &str, name: &str) -> Result<Self> {
        let path = |suffix: &str| format!("{folder}/{name}.{suffix}");
        let text = std::fs::read_to_string(path("chain"))?;
        let mut lines = text.lines();
        let n: usize =
            lines.next().and_then(|l| l.split(' ').next()).ok_or("no joints")?.parse()?;
        let (mut names, mut limits) = (Vec::new(), Vec::new());
        for line in lines.take(n) {
            let words: Vec<&str> = line.split(' ').collect();
            names.push(words[0].to_owned());
            limits.push((words[17].parse()?, words[18].parse()?));
        }
        Ok(Self {
            urdf: path("urdf"),
            names,
            limits,
            q: doubles(&path("q")),
            targets: doubles(&path("targets")),
            far: doubles(&path("far")),
        })
    }

    pub fn n(&self) -> usize {
        self.names.len()
    }

    pub fn configuration(&self, i: usize) -> &[f64] {
        &self.q[i * self.n()..(i + 1) * self.n()]
    }

    pub fn middle(&self) -> Vec<f64> {
        self.limits.iter().map(|(lower, upper)| 0.5 * (lower + upper)).collect()
    }
}

/// ns of a call, least and median over blocks, until the time is over.
pub fn single(robot: &Robot, ms: f64, mut call: impl FnMut(&[f64])) -> String {
    let mut blocks = Vec::new();
    let end = Instant::now();
    while end.elapsed().as_secs_f64() < ms * 1e-3 {
        let begin = Instant::now();
        for i in 0..BLOCK {
            call(black_box(robot.configuration(i)));
        }
        blocks.push(begin.elapsed().as_nanos() as f64 / BLOCK as f64);
    }
    blocks.sort_by(f64::total_cmp);
    format!("{} {}", blocks[0], blocks[blocks.len() / 2])
}

pub fn write(path: &str, numbers: &[f64]) -> Result<String> {
    let mut file = std::io::BufWriter::new(std::fs::File::create(path)?);
    numbers.iter().try_for_each(|x| file.write_all(&x.to_le_bytes()))?;
    file.flush()?;
    Ok("ok".to_owned())
}

/// ns of processor time, success and q of each target; `solve(target, q)` answers true if q reaches it.
pub fn ik(
    robot: &Robot,
    targets: &[f64],
    path: &str,
    mut solve: impl FnMut(&[f64], &mut Vec<f64>) -> bool,
) -> Result<String> {
    let mut out = Vec::new();
    for target in targets.chunks_exact(12) {
        let mut q = robot.middle();
        let begin = ProcessTime::now();
        let success = solve(target, &mut q);
        out.push(begin.elapsed().as_nanos() as f64);
        out.push(f64::from(u8::from(success)));
        out.extend(q);
    }
    write(path, &out)
}

/// A command: the file for what it makes, the task and its words.
pub struct Command<'a> {
    pub path: &'a str,
    pub task: &'a str,
    pub words: Vec<&'a str>,
}

impl Command<'_> {
    pub fn number<T: std::str::FromStr>(&self, i: usize) -> Result<T> {
        let word = self.words.get(i).ok_or("a number is missing")?;
        word.parse().map_err(|_| format!("'{word}' is no number").into())
    }
}

/// Reads commands until the end; each robot is made once by `make`.
pub fn serve<T>(
    make: impl Fn(&Robot) -> Result<T>,
    mut answer: impl FnMut(&Command<'_>, &Robot, &mut T) -> Result<String>,
) -> Result<()> {
    let folder = std::env::args().nth(1).ok_or("which folder?")?;
    let mut known: HashMap<String, (Robot, T)> = HashMap::new();
    for line in std::io::stdin().lock().lines() {
        let line = line?;
        let words: Vec<&str> = line.split_whitespace().collect();
        let [path, task, name, rest @ ..] = &words[..] else { continue };
        let mut run = || -> Result<String> {
            if !known.contains_key(*name) {
                let robot = Robot::load(&folder, name)?;
                let made = make(&robot)?;
                known.insert((*name).to_owned(), (robot, made));
            }
            let (robot, made) = known.get_mut(*name).ok_or("unknown")?;
            answer(&Command { path, task, words: rest.to_vec() }, robot, made)
        };
        let text = run().unwrap_or_else(|e| format!("error {e}").replace('\n', " "));
        println!("{text}");
    }
    Ok(())
}
