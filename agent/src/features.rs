use mapper::Mapper;

/// The features by which the agent judges its situation (section 4).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Features {
    /// The expected number of cells that changed since they were last seen, p = Σ P(E > 0).
    pub p: f64,
    /// The longest time since a candidate cell was last seen, r = max (t_now − t_last), in the unit of the
    /// readings' times.
    pub r: f64,
}

impl Features {
    /// The features after the last reading. The cost is proportional to the number of cells that ever
    /// changed.
    pub fn of(mapper: &mut Mapper) -> Self {
        Self { p: mapper.sum_change_probability(), r: mapper.max_recency() }
    }
}
