//! The commands `diagnose`, `fit` and `score`, with progress, and interruptible.

use crate::cli::{self, Answer, Caller, Failure};
use crate::effects::CATALOGUE;
use crate::terrain::Terrain;
use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use std::collections::HashMap;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::thread;
use std::time::Duration;

/// How often the work asks whether it is interrupted.
const PATIENCE: Duration = Duration::from_millis(100);

/// Names of the paper's terrains.
#[pyfunction]
pub fn terrain_presets() -> Vec<&'static str> {
    Terrain::PRESETS.to_vec()
}

/// Names of the effects, and what each is.
#[pyfunction]
pub fn effects() -> Vec<(&'static str, &'static str)> {
    let all = CATALOGUE.iter();
    all.map(|effect| (effect.name, effect.phrase)).collect()
}

/// The texts of a command's files by name, and notes.
///
/// # Algorithm
/// 1. The work runs in a thread of its own, without the interpreter's lock, and sends its steps.
/// 2. Meanwhile this thread passes the steps to `progress`, and asks for signals every 0.1 s.
/// 3. An exception of `progress`, or a signal such as Ctrl-C, ends the work soon and is raised.
#[pyfunction]
#[pyo3(signature = (arguments, progress = None))]
pub fn answer(
    py: Python<'_>,
    arguments: Vec<String>,
    progress: Option<Py<PyAny>>,
) -> PyResult<(HashMap<&'static str, String>, Vec<String>)> {
    let stop = AtomicBool::new(false);
    let result = py.detach(|| {
        let (sender, steps) = channel::<String>();
        let (arguments, stop) = (&arguments, &stop);
        thread::scope(|scope| {
            let work = scope.spawn(move || {
                // Nobody listens where the caller has stopped.
                let step = |name: &str| drop(sender.send(name.into()));
                let caller = Caller { step: &step, stop };
                cli::answer(arguments, &caller)
            });
            let heard = listen(&steps, progress.as_ref());
            if heard.is_err() {
                stop.store(true, Ordering::Relaxed);
            }
            let result = work.join();
            heard.map(|()| result)
        })
    })?;
    match result {
        Ok(Ok(Answer { texts, notes })) => Ok((texts.into_iter().collect(), notes)),
        Ok(Err(failure)) => Err(raised(&failure)),
        Err(_) => Err(PyRuntimeError::new_err(
            "ugv_terrain failed; please report it with the recording",
        )),
    }
}

/// Passes steps on until the work ends.
fn listen(steps: &Receiver<String>, progress: Option<&Py<PyAny>>) -> PyResult<()> {
    loop {
        let step = match steps.recv_timeout(PATIENCE) {
            Ok(step) => Some(step),
            Err(RecvTimeoutError::Timeout) => None,
            Err(RecvTimeoutError::Disconnected) => return Ok(()),
        };
        Python::attach(|py| -> PyResult<()> {
            py.check_signals()?;
            if let (Some(step), Some(progress)) = (step, progress) {
                progress.call1(py, (step,))?;
            }
            Ok(())
        })?;
    }
}

/// A failure as an exception: wrong input is a `ValueError`.
fn raised(failure: &Failure) -> PyErr {
    let report = failure.report();
    let message = report
        .replace("ugv: error: ", "")
        .replace("ugv: hint: ", "");
    let message = message.trim_end().to_owned();
    if failure.is_bad_input() {
        PyValueError::new_err(message)
    } else {
        PyRuntimeError::new_err(message)
    }
}
