//! Steps, and the arrays that go in and out of them: their shapes are checked before anything changes.

use super::Fleet;
use crate::convert::{Table, value_error};
use crate::threads::on_threads;
use numpy::ndarray::Ix2;
use numpy::{Element, PyReadwriteArrayDyn, PyUntypedArrayMethods};
use pyo3::prelude::*;
use sim::physics::Velocity;

/// The simulated time after which a signal of the user is noticed, s.
const SIGNALS_S: f64 = 10.0;

/// Up to this number of steps of robots, a call keeps the interpreter: it takes some microseconds, and to release the
/// interpreter and to get it back would be a part of them.
const SHORT_STEPS: f64 = 4.0;

impl Fleet {
    /// Simulates until a time, s. Ctrl-C ends it. Then, with memory for `scans`, all main lasers measure.
    pub(super) fn run_until(
        &mut self,
        py: Python<'_>,
        end_s: f64,
        mut scans: Option<&mut [f32]>,
    ) -> PyResult<()> {
        let Self { fleet, contacts, threads, .. } = self;
        let spec = fleet.spec();
        let steps = (end_s - fleet.time_s()) / spec.step_s * spec.robots.len() as f64;
        contacts.clear();
        loop {
            let next_s = end_s.min(fleet.time_s() + SIGNALS_S);
            let is_end = next_s >= end_s;
            let mut run = || {
                fleet.run_until(next_s, &mut ());
                match scans.take_if(|_| is_end) {
                    Some(ranges_m) => look_all(fleet, ranges_m),
                    None => Ok(()),
                }
            };
            if steps <= SHORT_STEPS && *threads == 1 { run() } else { on_threads(py, *threads, run)? }?;
            contacts.extend_from_slice(fleet.contacts());
            if is_end {
                return Ok(());
            }
            py.check_signals()?;
        }
    }

    /// The shape of scans of all robots: a row per robot, if all have the same number of beams.
    pub(super) fn scans_shape(&self) -> Vec<usize> {
        self.beams.map_or(vec![self.fleet.beams()], |beams| vec![self.fleet.spec().robots.len(), beams])
    }

    /// The memory of an array for scans of all robots.
    pub(super) fn scans_of<'a>(&self, out: &'a mut PyReadwriteArrayDyn<'_, f32>) -> PyResult<&'a mut [f32]> {
        let shape = self.scans_shape();
        if out.shape() != shape {
            let expected = match shape[..] {
                [robots, beams] => format!("({robots}, {beams}): one row per robot, one column per beam"),
                _ => format!(
                    "({},): the robots have different numbers of beams, one after the other",
                    shape[0]
                ),
            };
            return Err(value_error(format!(
                "the array for scans has the shape {:?}, and must have {expected}",
                out.shape()
            )));
        }
        contiguous(out, "scans")
    }

    /// The memory of an array for poses of all robots.
    pub(super) fn poses_of<'a>(
        &self,
        out: &'a mut PyReadwriteArrayDyn<'_, f64>,
    ) -> PyResult<&'a mut [[f64; 3]]> {
        let robots = self.fleet.spec().robots.len();
        if out.shape() != [robots, 3] {
            return Err(value_error(format!(
                "the array for poses has the shape {:?}, and must have ({robots}, 3): x (m), y (m), heading (rad)",
                out.shape()
            )));
        }
        Ok(contiguous(out, "poses")?.as_chunks_mut().0)
    }

    pub(super) fn set_commands(&mut self, commands: &Table<'_>) -> PyResult<()> {
        let (commands, driven) = (commands.0.as_array(), self.driven.len());
        let is_right = matches!(commands.shape(), [rows, 2..=3] if *rows == driven);
        let Some(commands) = commands.view().into_dimensionality::<Ix2>().ok().filter(|_| is_right) else {
            return Err(value_error(format!(
                "the commands have the shape {:?}, and must have ({driven}, 2): one row per driven robot, linear (m/s) \
                 and angular (rad/s) velocity; or 3 columns: linear, left, angular",
                commands.shape()
            )));
        };
        let columns = commands.ncols();
        if let Some((robot, value)) = commands.indexed_iter().find(|(_, value)| !value.is_finite()) {
            return Err(value_error(format!("command {value} of driven robot {} is not finite", robot.0)));
        }
        for (&robot, row) in self.driven.iter().zip(commands.rows()) {
            let left_mps = if columns == 3 { row[1] } else { 0.0 };
            self.fleet
                .command(robot, Velocity { forward_mps: row[0], left_mps, turn_radps: row[columns - 1] });
        }
        Ok(())
    }
}

/// Measures with the main lasers of all robots.
pub(super) fn look_all(fleet: &mut sim::physics::Fleet, ranges_m: &mut [f32]) -> PyResult<()> {
    fleet.look_all();
    fleet.copy_scans(ranges_m).map_err(value_error)
}

/// The memory of an array that has the right shape.
fn contiguous<'a, T: Element>(out: &'a mut PyReadwriteArrayDyn<'_, T>, what: &str) -> PyResult<&'a mut [T]> {
    if !out.is_c_contiguous() {
        return Err(value_error(format!("the array for {what} must be contiguous, in C order")));
    }
    out.as_slice_mut().map_err(value_error)
}
