//! Tests of the whole system: the programs are run as a user runs them, and their output, exit codes and files are
//! checked. One module per topic; those of `grid_world` are in `grid`.

mod recording;
mod run;
mod terminal;

mod bad_input;
mod check_world;
mod choices;
mod contract;
mod disk;
mod dummy;
mod ending;
mod flags;
mod flicker;
mod folder;
mod grid;
mod houses;
mod map_log;
mod map_log_poses;
mod map_log_refusals;
mod map_log_report;
mod map_log_state;
mod memory;
mod output;
mod pages;
mod pose;
mod predict;
mod prior;
mod programs;
mod schemas;
mod screen;
mod shards;
mod state;
mod state_examples;
mod targets;
mod tour;
mod worlds;
