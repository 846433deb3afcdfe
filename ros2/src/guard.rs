//! What ends a node that the network has broken: a thread that has failed leaves the others running, deaf, and a few datagrams can ask the
//! library for gigabytes.

use std::panic::{set_hook, take_hook};
use std::process::exit;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, OnceLock};
use std::time::{Duration, Instant};

/// The time between two looks at the memory and the threads.
const PERIOD: Duration = Duration::from_millis(100);
/// A node that is to end saves its state within this time; the program ends then in any case.
const PATIENCE: Duration = Duration::from_secs(20);
/// The names of the threads of the library begin with this: one hears and sends, and one discovers others.
const NETWORK: &str = "RustDDS";
const NETWORK_THREADS: usize = 2;

/// Ends a node when one of its threads has failed, or when it takes too much memory.
#[derive(Clone)]
pub struct Guard {
    failure: Arc<OnceLock<String>>,
    stop: Arc<AtomicBool>,
}

impl Guard {
    /// Watches this program from now on, once its connection is open. `stop` ends the node, which saves its state; the memory is in MiB.
    ///
    /// # Errors
    ///
    /// When no thread can be started.
    pub fn start(stop: Arc<AtomicBool>, max_memory_mib: f64) -> std::io::Result<Self> {
        let guard = Self::new(stop);
        guard.clone().watch(max_memory_mib, |why| {
            crate::node_program::say(&format!("error: {why}"));
            exit(1);
        })?;
        Ok(guard)
    }

    fn new(stop: Arc<AtomicBool>) -> Self {
        let guard = Self { failure: Arc::default(), stop };
        let (hooked, say) = (guard.clone(), take_hook());
        set_hook(Box::new(move |panic| {
            say(panic);
            let thread = std::thread::current();
            hooked.fail(format!("the thread `{}` has failed", thread.name().unwrap_or("?")));
        }));
        guard
    }

    /// Watches in a thread of its own. `end` ends the program, if the node has not ended by itself.
    fn watch(self, max_memory_mib: f64, end: impl Fn(&str) + Send + 'static) -> std::io::Result<()> {
        let watch = move || {
            let why = loop {
                std::thread::sleep(PERIOD);
                let used_mib = memory_mib();
                if used_mib > max_memory_mib {
                    self.fail(format!(
                        "the node takes {used_mib:.0} MiB of memory, more than {max_memory_mib:.0} MiB"
                    ));
                }
                if network_threads().is_some_and(|threads| threads < NETWORK_THREADS) {
                    self.fail(
                        "a thread of the network has ended, as it does when the program is suspended"
                            .to_owned(),
                    );
                }
                if let Some(why) = self.failure.get() {
                    break why;
                }
            };
            let last = Instant::now() + PATIENCE;
            // What fills the memory does not wait.
            while Instant::now() < last && memory_mib() < 2.0 * max_memory_mib {
                std::thread::sleep(PERIOD);
            }
            end(why);
        };
        std::thread::Builder::new().name("guard".to_owned()).spawn(watch).map(drop)
    }

    fn fail(&self, why: String) {
        self.failure.set(why).ok(); // the first one is the cause
        self.stop.store(true, Ordering::Relaxed);
    }

    /// What the node returns when it has ended.
    ///
    /// # Errors
    ///
    /// When the guard has ended it: the reason.
    pub fn check(&self) -> anyhow::Result<()> {
        self.failure.get().map_or(Ok(()), |why| Err(anyhow::anyhow!("{why}")))
    }
}

/// The memory of this program, MiB; 0 where the system does not say it.
fn memory_mib() -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:"));
    let kib = line.and_then(|line| line.trim().trim_end_matches(" kB").parse::<f64>().ok());
    kib.unwrap_or(0.0) / 1024.0
}

/// The number of threads of the network; `None` where the system does not say it.
fn network_threads() -> Option<usize> {
    let tasks = std::fs::read_dir("/proc/self/task").ok()?.flatten();
    let names = tasks.filter_map(|task| std::fs::read_to_string(task.path().join("comm")).ok());
    Some(names.filter(|name| name.starts_with(NETWORK)).count())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::mpsc::{Sender, channel};

    fn is_set_soon(stop: &AtomicBool) -> bool {
        (0..100).any(|_| {
            std::thread::sleep(PERIOD);
            stop.load(Ordering::Relaxed)
        })
    }

    /// A thread that ends when this is dropped.
    fn thread(name: &str) -> Sender<()> {
        let (end, ends) = channel();
        std::thread::Builder::new().name(name.to_owned()).spawn(move || ends.recv().ok()).unwrap();
        end
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn a_node_ends_when_a_thread_fails_or_ends_and_when_memory_is_used_up() {
        for (cause, said) in [
            (0, "the thread `deaf` has failed"),
            (1, "a thread of the network has ended"),
            (2, "more than 0"),
        ] {
            let stop = Arc::new(AtomicBool::new(false));
            let mut network: Vec<_> =
                (0..NETWORK_THREADS).map(|number| thread(&format!("{NETWORK} {number}"))).collect();
            std::thread::sleep(PERIOD);
            let guard = Guard::new(stop.clone());
            guard.clone().watch(if cause == 2 { 0.0 } else { 1e6 }, |_| ()).unwrap();
            guard.check().unwrap();
            match cause {
                0 => {
                    let deaf = std::thread::Builder::new().name("deaf".to_owned());
                    deaf.spawn(|| panic!("on purpose")).unwrap().join().unwrap_err();
                }
                1 => drop(network.pop()),
                _ => {}
            }
            assert!(is_set_soon(&stop));
            assert!(guard.check().unwrap_err().to_string().contains(said));
        }
    }
}
