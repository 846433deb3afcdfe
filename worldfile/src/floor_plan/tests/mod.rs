mod geometry;
mod pictures;
