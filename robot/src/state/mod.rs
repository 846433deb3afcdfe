//! State files: what was learned of a place, in one file that every program reads and writes.
//!
//! A [`State`] has the map, the surfaces in which poses are found, what the scan filter has learned, and the sessions: logs and
//! runs of robots. Beside this, it has what only one run or one program goes on with. [`learned`] and [`restore`] are all that
//! the program of a robot needs.
//!
//! A file is written under a temporary name, brought to the disk, and renamed: at any time, there is a complete file
//! under the name. It holds a checksum, so that a damaged file is refused. [`StateFile`] writes in a thread of its own.

mod file;
mod format;
mod learned;
mod settings;

pub use file::{StateFile, earlier_name, read_state};
pub use format::{Part, SavedMap, Session, State};
pub use learned::{Sessions, StateCopy, learned, restore};
pub use settings::{SavedSettings, StateError};
