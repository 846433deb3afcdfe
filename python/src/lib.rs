//! `curious._native`: the worlds, the mapper and the learning task as classes of Python. It converts values
//! and errors; it must not know a rule of the domain, which are in the other crates.
//!
//! Every file has one class. Arrays go in and out as NumPy arrays; long calls release the interpreter (`detach`).

mod convert;
mod fleet;
mod localizer;
mod logs;
mod mapper;
mod output;
mod reading;
mod settings;
mod snapshots;
mod spec;
mod tasks;
mod threads;
mod trials;
mod world;

use pyo3::prelude::*;

#[pymodule]
mod _native {
    #[pymodule_export]
    use crate::convert::{SnapshotError, WorldError};
    #[pymodule_export]
    use crate::fleet::Fleet;
    #[pymodule_export]
    use crate::localizer::{Estimate, Localizer};
    #[pymodule_export]
    use crate::logs::{Log, Readings};
    #[pymodule_export]
    use crate::mapper::Mapper;
    #[pymodule_export]
    use crate::output::Output;
    #[pymodule_export]
    use crate::reading::Reading;
    #[pymodule_export]
    use crate::spec::Spec;
    #[pymodule_export]
    use crate::tasks::Batch;
    #[pymodule_export]
    use crate::trials::{Situation, strategies, trial};
    #[pymodule_export]
    use crate::world::World;
    use pyo3::prelude::*;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
