//! Maps as the two files of the ROS `map_server`, a picture and a YAML file. The crate `worldfile` reads them.

mod map;
mod mask;

pub use map::{pgm, yaml};
pub use mask::{mask_pgm, mask_yaml};
