//! The rays of this crate compared with two references. Tests of whole worlds are in the crate `worldfile`, where
//! worlds are texts.

mod caster;
mod energy;
mod grip;
mod mixed;
mod moved;
mod oracle;
mod sliding;
mod specs;
mod visible;

use super::*;
use specs::{busy, crowd, four_rooms, heap, reckless, rooms};
