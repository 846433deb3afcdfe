//! The agent as its users see it.

mod contract;
mod drawing;
mod goals;
mod information_gain;
mod looking;
