mod bounds;
mod builder;
mod choices;
mod faults;
mod fuzz;
mod reading;
