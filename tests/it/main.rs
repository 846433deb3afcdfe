//! The whole system: the program is run as a user runs it, and what it says, how it ends and what
//! it leaves behind must hold. One module per thing that must hold.

mod recording;
mod run;
mod terminal;

mod bad_input;
mod choices;
mod contract;
mod disk;
mod dummy;
mod ending;
mod flicker;
mod keyboard;
mod output;
mod prior;
mod screen;
mod targets;
mod tour;
mod worlds;
