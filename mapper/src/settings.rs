use crate::Estimator;

/// How evidence becomes a map.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Deserialize, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum OccupancyModel {
    /// Surfaces are remembered to a fraction of a cell, and a cell is cleared only by beams that
    /// pass through the surface it holds: static walls never change.
    #[default]
    Steady,
    /// Every beam counts on every cell it crosses, and a cell flips at even odds. Walls flicker, as
    /// in the paper's figure 5.
    Naive,
}

impl OccupancyModel {
    /// Every model.
    pub const ALL: [Self; 2] = [Self::Steady, Self::Naive];

    /// The name on the command line and in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Steady => "steady",
            Self::Naive => "naive",
        }
    }
}

/// Settings of a [`Mapper`](crate::Mapper).
#[derive(Clone, Debug, Default, PartialEq, serde::Deserialize, serde::Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct MapperSettings {
    /// How rates are estimated.
    pub estimator: Estimator,
    /// How evidence becomes a map.
    pub occupancy: OccupancyModel,
    /// A time without a sighting up to this does not interrupt the view of a cell, s (steps in a
    /// grid world). What moves hides the cells that it is about to enter: where a sensor has to look
    /// past things, a gap as long as a thing takes to pass is part of watching. By default a cell is
    /// in view only between consecutive readings, as in the paper.
    pub max_gap: f64,
    /// Settings of the steady occupancy model.
    pub steady: SteadySettings,
}

impl MapperSettings {
    pub(crate) fn check(&self) -> Result<(), SettingsError> {
        if !(self.max_gap >= 0.0 && self.max_gap.is_finite()) {
            let (key, expected) = ("max_gap", "0 or more");
            return Err(SettingsError { key, expected, found: self.max_gap.to_string() });
        }
        self.steady.check()
    }
}

/// Settings of the steady occupancy model.
#[derive(Clone, Debug, PartialEq, serde::Deserialize, serde::Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct SteadySettings {
    /// The standard deviation of the laser's range noise, m. Surfaces are told apart at four of
    /// these.
    pub range_noise_std_m: f64,
    /// A hit counts for the cell this far behind the surface, along its normal, m: a surface on
    /// the border of two cells belongs to the solid one.
    pub surface_depth_m: f64,
    /// Things that come are at least this thick, m: so far behind a hit on them cells are blocked. 0
    /// marks surfaces only.
    pub body_m: f64,
    /// Hits nearer than this to each other, m, are one surface: what lies on it is not seen through.
    pub join_m: f64,
    /// Where neighbouring beams are farther apart than this, m, the space between them is not
    /// taken for seen.
    pub max_gap_m: f64,
    /// Scans with a hit until a free or unknown cell is blocked.
    pub hits_to_block: u8,
    /// The same in the open, away from every standing surface. One hit is enough for a laser without
    /// spurious returns, and sees things that pass.
    pub hits_to_block_in_open: u8,
    /// Scans that see through an unknown cell until it is free.
    pub misses_to_discover: u8,
    /// The same for an unknown cell beside a surface, which can still turn out to be part of it.
    pub misses_to_discover_beside: u8,
    /// Scans that see through a blocked cell until it is free, when it was just blocked.
    pub misses_to_free_fresh: u8,
    /// The same for a cell that was hit often.
    pub misses_to_free: u8,
    /// Hits after which a surface counts as standing: noise around it is taken for the surface
    /// itself, not for something new.
    pub hits_to_stand: u16,
    /// A first sighting that is overturned after less than this time in view, s, was wrong: it is
    /// corrected, and does not count as a change.
    pub confirm_s: f64,
}

impl Default for SteadySettings {
    fn default() -> Self {
        Self {
            range_noise_std_m: 0.01,
            surface_depth_m: 0.02,
            body_m: 0.2,
            join_m: 1.0,
            max_gap_m: 0.15,
            hits_to_block: 2,
            hits_to_block_in_open: 1,
            misses_to_discover: 3,
            misses_to_discover_beside: 20,
            misses_to_free_fresh: 4,
            misses_to_free: 8,
            hits_to_stand: 20,
            confirm_s: 2.0,
        }
    }
}

/// A setting that contradicts itself or another.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("mapper setting `{key}` must be {expected}, not {found}")]
pub struct SettingsError {
    /// The key.
    pub key: &'static str,
    /// What would be right.
    pub expected: &'static str,
    /// What was found.
    pub found: String,
}

impl SteadySettings {
    /// The misses in a row that a blocked cell takes after this many hits.
    pub(crate) fn misses_to_free_after(&self, hits: u16) -> i8 {
        let fresh = u16::from(self.misses_to_free_fresh);
        fresh.saturating_add(hits).min(u16::from(self.misses_to_free)) as i8
    }

    pub(crate) fn check(&self) -> Result<(), SettingsError> {
        let error = |key, expected, found: String| Err(SettingsError { key, expected, found });
        // Every hit looks around as far as the noise reaches.
        let lengths = [
            ("steady.range_noise_std_m", self.range_noise_std_m, 0.5, "from 0 to 0.5 m"),
            ("steady.surface_depth_m", self.surface_depth_m, 0.5, "from 0 to 0.5 m"),
            ("steady.body_m", self.body_m, 10.0, "from 0 to 10 m"),
            ("steady.join_m", self.join_m, 10.0, "from 0 to 10 m"),
            ("steady.max_gap_m", self.max_gap_m, 10.0, "from 0 to 10 m"),
        ];
        for (key, length_m, most_m, expected) in lengths {
            if !(0.0..=most_m).contains(&length_m) {
                return error(key, expected, length_m.to_string());
            }
        }
        if !(0.0..=3600.0).contains(&self.confirm_s) {
            return error("steady.confirm_s", "from 0 to 3600 s", self.confirm_s.to_string());
        }
        let counts = [
            ("steady.hits_to_block", self.hits_to_block),
            ("steady.hits_to_block_in_open", self.hits_to_block_in_open),
            ("steady.misses_to_discover", self.misses_to_discover),
            ("steady.misses_to_discover_beside", self.misses_to_discover_beside),
            ("steady.misses_to_free_fresh", self.misses_to_free_fresh),
            ("steady.misses_to_free", self.misses_to_free),
        ];
        for (key, count) in counts {
            if !(1..=100).contains(&count) {
                return error(key, "from 1 to 100", count.to_string());
            }
        }
        if self.misses_to_free_fresh > self.misses_to_free {
            return error(
                "steady.misses_to_free_fresh",
                "at most steady.misses_to_free",
                self.misses_to_free_fresh.to_string(),
            );
        }
        Ok(())
    }
}
