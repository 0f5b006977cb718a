//! The exit codes of the command line.

use std::process::ExitCode;

/// The exit code of a command.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Exit(u8);

impl Exit {
    /// Done, or a positive answer.
    pub const SUCCESS: Self = Self(0);
    /// A negative answer.
    pub const NO: Self = Self(1);
    /// An error, which was printed to stderr.
    pub const ERROR: Self = Self(2);
    /// After Ctrl-C, as of a shell: 128 and the number of the signal.
    pub const INTERRUPTED: Self = Self(130);

    /// That of another program.
    #[cfg(not(unix))]
    pub(crate) const fn of(code: u8) -> Self {
        Self(code)
    }

    /// Success or a negative answer.
    pub(crate) const fn answer(yes: bool) -> Self {
        if yes { Self::SUCCESS } else { Self::NO }
    }

    /// The number that the operating system is given.
    #[must_use]
    pub const fn code(self) -> u8 {
        self.0
    }
}

impl From<Exit> for ExitCode {
    fn from(exit: Exit) -> Self {
        Self::from(exit.0)
    }
}
