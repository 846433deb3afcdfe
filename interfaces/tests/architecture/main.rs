//! Tests of the structure of the workspace: which crate may depend on which, and no circles between the modules of
//! a crate. They read `cargo metadata`, `cargo tree` and the sources; they build nothing.
//!
//! A *circle* is a set of sibling modules each of which uses each other one, directly or through others.
//! What counts is the module that defines an item, not the one that re-exports it. Uses between a module
//! and one that contains it are left out, and so is everything under `#[cfg(test)]`.

mod circle;
mod crates;
mod modules;
mod outputs;
mod references;
mod resolve;
mod synthetic;
mod workspace;
