//! The whole system: the programs are run as a user runs them, and what they say, how they end and
//! what they leave behind must hold. One module per thing that must hold; those of `grid_world` are in
//! `grid`.

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
mod flicker;
mod grid;
mod keyboard;
mod output;
mod prior;
mod screen;
mod targets;
mod tour;
mod worlds;
