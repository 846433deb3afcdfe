use mapper::Mapper;

/// The features by which choosers judge a situation (section 4).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Features {
    /// Expected number of cells that changed since they were last observed, p = Σ P(E > 0).
    pub p: f64,
    /// Longest time since a candidate was last observed, r = max (t_now − t_last).
    pub r: f64,
}

impl Features {
    /// The features after the last reading. Takes time in proportion to the cells that ever changed.
    pub fn of(mapper: &mut Mapper) -> Self {
        Self { p: mapper.sum_change_probability(), r: mapper.max_recency() }
    }
}
