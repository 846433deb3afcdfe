//! Trials in simulated worlds: sensors, sessions and schedules. One binary, because linking takes longer than compiling.

#[path = "../../examples/log_trajectory/alignment.rs"]
mod alignment;
mod exploring;
mod glass;
mod known_things;
mod messages;
mod scan_filter;
mod scheduled_things;
mod sessions;
mod sweep;
