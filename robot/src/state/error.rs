use interfaces::ValueError;
use std::io;

/// The version of the format.
pub(super) const VERSION: u32 = 1;
/// The largest body, bytes: what a mapper with the largest map can take.
pub(super) const MAX_BODY: usize = 2 << 30;

/// The error for a state that cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum StateError {
    /// The file cannot be read.
    #[error("cannot read it: {0}")]
    Read(#[from] io::Error),
    /// The bytes do not begin like a state.
    #[error("this is not a state file")]
    OtherKind,
    /// The state was written by another version.
    #[error("this state file has version {0} of the format, and this program reads version {VERSION}")]
    OtherVersion(u32),
    /// The types in the file have changed since it was written.
    #[error(
        "this state file has another layout: until version 0.1.0, only builds with the same layout read it; map the place again"
    )]
    OtherLayout,
    /// Bytes are missing, or were changed.
    #[error("the state file is damaged: its checksum does not fit")]
    Damaged,
    /// The state has no such part.
    #[error("the state was saved by another program: it has no part `{0}`")]
    NoPart(&'static str),
    /// The state is too large for a file.
    #[error(
        "the state has {0} bytes, and a state file holds {MAX_BODY} at most; a map of fewer cells is smaller"
    )]
    TooLarge(usize),
    /// The state was saved by another build, whose results can differ.
    #[error("the state {0}")]
    OtherBuild(String),
    /// The state was saved with other settings.
    #[error("the state is of another run: `{name}` is {saved} there, and {expected} here")]
    OtherSettings {
        /// What differs.
        name: String,
        /// The value of the run that saved the state.
        saved: String,
        /// The value of this run.
        expected: String,
    },
    /// The state was saved by a run in a world of the same name.
    #[error("the state is of another run: its world had another content")]
    OtherWorld,
    /// A run was interrupted or refused before it learned anything.
    #[error(
        "nothing is learned in this state yet: its run ended in the first pass; run map_log again, with logs of this place"
    )]
    NothingLearned,
    /// The bytes of a part are not those of this program.
    #[error("a part of the state does not fit this program: {0}")]
    OtherContent(#[from] ValueError),
}
