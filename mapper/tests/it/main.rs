//! What must hold of the mapper as its users see it.

#[path = "../house/mod.rs"]
mod house;

mod bad_readings;
mod bookkeeping;
mod chains;
mod estimators;
mod observed;
mod prior;
mod things;
mod walls;
