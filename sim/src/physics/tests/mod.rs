//! The rays of this crate compared with two references. Tests of whole worlds are in the crate `worldfile`, where
//! worlds are texts.

mod caster;
mod energy;
mod free_space;
mod grip;
mod mixed;
mod moved;
mod oracle;
mod sliding;
mod specs;

use super::*;
use specs::{busy, crowd, four_rooms, heap, reckless, rooms};
