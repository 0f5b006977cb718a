//! Progress on stderr, if stderr is a terminal: rate and time left; and the end of a run that Ctrl-C
//! stopped.

use std::cell::Cell;
use std::io::Write;

use cylindroid::sweep::Progress;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use crate::exit::Exit;

/// A line with what is counted, which disappears at the end.
pub(crate) struct Bar {
    bar: ProgressBar,
    /// The unit, and how many there are.
    counted: Cell<(&'static str, u64)>,
    computed: Cell<u64>,
}

impl Bar {
    pub(crate) fn new() -> Self {
        let bar = ProgressBar::with_draw_target(Some(0), ProgressDrawTarget::stderr());
        Self { bar, counted: Cell::new(("", 0)), computed: Cell::new(0) }
    }

    pub(crate) fn show(&self, progress: &Progress) {
        let counted = (progress.unit, progress.rows);
        let last = self.counted.replace(counted);
        if last.0 != progress.unit {
            let most = if progress.at_most { "at most " } else { "" };
            let counts = format!("{{human_pos}} of {most}{{human_len}} {}", progress.unit);
            let template = format!("{{wide_bar}} {counts}, {{per_sec}}, {most}{{eta}} left");
            if let Ok(style) = ProgressStyle::with_template(&template) {
                self.bar.set_style(style);
            }
        }
        self.bar.set_length(progress.rows);
        self.bar.set_position(progress.done);
        // Neither rows of earlier runs nor what was counted before belong to the rate.
        let is_idle = self.computed.replace(progress.computed) == 0 && progress.computed == 0;
        if is_idle || last != counted {
            self.bar.reset_eta();
        }
    }
}

impl Drop for Bar {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}

/// What a command ends with that Ctrl-C stopped before it had anything to show.
pub(crate) fn interrupted() -> anyhow::Result<Exit> {
    writeln!(std::io::stderr(), "interrupted")?;
    Ok(Exit::INTERRUPTED)
}
