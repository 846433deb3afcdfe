//! Snapshots as bytes of Python: what the state is of, the state, a checksum.
//!
//! Users keep snapshots in files and send them over networks. The values of a mapper refer to each other: with a
//! changed byte, a later call could fail.

use crate::convert::SnapshotError;
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use robot::BUILD;
use xxhash_rust::xxh3::xxh3_64;

/// The version of the format; count up when the layout of a state changes.
const VERSION: u32 = 5;
const KIND: usize = 8;
const CHECKSUM: usize = 8;

/// What a snapshot is of.
#[derive(Clone, Copy)]
pub(crate) struct Kind(pub(crate) &'static str);

impl Kind {
    fn header(self) -> [u8; KIND] {
        xxh3_64(format!("{} {VERSION}", self.0).as_bytes()).to_le_bytes()
    }

    /// The bytes of a snapshot with this state.
    pub(crate) fn seal<'py>(self, py: Python<'py>, state: &[u8]) -> Bound<'py, PyBytes> {
        let mut bytes = [&self.header(), BUILD.as_bytes(), state].concat();
        bytes.extend(xxh3_64(&bytes).to_le_bytes());
        PyBytes::new(py, &bytes)
    }

    /// The state in a snapshot. `SnapshotError`: it is of something else, or damaged, or was taken by another build, so that what
    /// follows from it can have other bits, and such a one is not allowed.
    pub(crate) fn open(self, snapshot: &[u8], allow_other_build: bool) -> PyResult<&[u8]> {
        if !snapshot.starts_with(&self.header()) {
            return Err(SnapshotError::new_err(format!(
                "these bytes are not a snapshot of this kind ({}), or they come from another version",
                self.0
            )));
        }
        let sealed = snapshot.split_last_chunk::<CHECKSUM>();
        let body = sealed.filter(|(body, checksum)| xxh3_64(body).to_le_bytes() == **checksum);
        let body = body.and_then(|(body, _)| body.get(KIND..));
        let parts = body.and_then(|body| body.split_at_checked(BUILD.len()));
        let (build, state) = parts.ok_or_else(|| SnapshotError::new_err("the snapshot is damaged"))?;
        if allow_other_build || build == BUILD.as_bytes() {
            return Ok(state);
        }
        Err(SnapshotError::new_err(format!(
            "the snapshot was taken by another build ({}, this one is {BUILD}), whose results can differ; \
             allow_other_build=True takes it",
            String::from_utf8_lossy(build)
        )))
    }
}
