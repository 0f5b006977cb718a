//! Ctrl-C, noticed without ending the process.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::exit::Exit;

/// True from the first Ctrl-C on; the second one ends the process.
pub(crate) struct Interrupt(Arc<AtomicBool>);

impl Interrupt {
    /// Where signals cannot be waited for, Ctrl-C ends the process: finished parts are kept too.
    pub(crate) fn new() -> Self {
        let came = Arc::new(AtomicBool::new(false));
        let own = Arc::clone(&came);
        let (sender, receiver) = std::sync::mpsc::channel();
        std::thread::spawn(move || {
            let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build();
            let Ok(runtime) = runtime else { return };
            runtime.block_on(async {
                let signal = tokio::signal::ctrl_c();
                // The handler is installed when the future is first polled.
                tokio::pin!(signal);
                tokio::select! {
                    biased;
                    _ = &mut signal => {}
                    () = std::future::ready(()) => {
                        let _ = sender.send(());
                        if signal.await.is_err() {
                            return;
                        }
                    }
                }
                own.store(true, Ordering::Relaxed);
                // Who presses it again does not want to wait.
                if tokio::signal::ctrl_c().await.is_ok() {
                    std::process::exit(i32::from(Exit::INTERRUPTED.code()));
                }
            });
        });
        let _ = receiver.recv();
        Self(came)
    }

    pub(crate) fn came(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}
