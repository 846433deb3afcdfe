mod bounds;
mod builder;
mod choices;
mod corrected;
mod faults;
mod fuzz;
mod order;
mod reading;
