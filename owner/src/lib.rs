//! The programs for the owner of a robot, and the code that they share: what is usual in a week, and how often something
//! happens, in words. It must not know the simulator.

pub mod week;
pub mod words;
