//! Tests of the agent through its public interface.

mod contract;
mod drawing;
mod goals;
mod information_gain;
mod looking;
mod unseen;
