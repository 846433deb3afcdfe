//! All constants of the crate that were chosen: each with its unit and its reason.

mod matching;
mod relocalization;
mod scan;
mod trajectory;

pub(crate) use matching::*;
pub(crate) use relocalization::*;
pub(crate) use scan::*;
pub(crate) use trajectory::*;
