//! Tests of the mapper through its public interface.

#[path = "../house/mod.rs"]
mod house;

mod bad_readings;
mod bodies;
mod bookkeeping;
mod chains;
mod doors;
mod estimators;
mod fast;
mod furniture;
mod observed;
mod prior;
mod saved;
mod scan_filter;
mod skipped;
mod things;
mod tiles;
mod walls;
