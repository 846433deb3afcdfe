use files::{OutputError, UnfinishedFile};
use pyo3::prelude::*;
use std::io;
use std::path::PathBuf;

/// A file that appears when it is complete: `with curious.Output("map.npz") as path: np.savez(path, ...)`
/// writes to a temporary name. After an exception there is no file. `FileExistsError`: it would replace a
/// file that was not written like this, or that was changed since.
#[pyclass(module = "curious")]
pub(crate) struct Output(Option<UnfinishedFile>);

#[pymethods]
impl Output {
    #[new]
    fn new(path: PathBuf) -> PyResult<Self> {
        UnfinishedFile::create(&path).map(Some).map(Self).map_err(os_error)
    }

    /// The path to write to.
    fn __enter__(&self) -> Option<PathBuf> {
        self.0.as_ref().map(UnfinishedFile::unfinished)
    }

    fn __exit__(
        &mut self,
        kind: Option<Bound<'_, PyAny>>,
        _value: Option<Bound<'_, PyAny>>,
        _traceback: Option<Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        let file = self.0.take().filter(|_| kind.is_none());
        file.map_or(Ok(()), |file| file.finish().map_err(os_error))
    }
}

fn os_error(error: OutputError) -> PyErr {
    io::Error::new(error.why.kind(), error.to_string()).into()
}
