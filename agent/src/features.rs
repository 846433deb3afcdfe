use mapper::Mapper;

/// The features (p, r) by which the agent chooses a strategy (section 4).
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Deserialize, serde::Serialize)]
pub struct Features {
    /// The expected number of cells that changed since they were last seen, p = Σ P(E > 0).
    pub p: f64,
    /// The longest time since a candidate cell was last seen, r = max (t_now − t_last), in the time unit of the
    /// readings.
    pub r: f64,
}

impl Features {
    /// The features after the latest reading. The computing time is proportional to the number of cells that ever
    /// changed.
    pub fn of(mapper: &mut Mapper) -> Self {
        Self { p: mapper.sum_change_probability(), r: mapper.max_recency() }
    }
}
