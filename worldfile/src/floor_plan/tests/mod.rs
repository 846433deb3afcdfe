mod geometry;
mod pictures;
mod ros;
