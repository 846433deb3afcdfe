use interfaces::{SettingsCheck, SettingsError};

/// Settings of the occupancy model `steady`.
#[derive(Clone, Debug, PartialEq, serde::Deserialize, serde::Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct SurfaceGridSettings {
    /// The standard deviation of the range noise of the laser, m. Surfaces that are at least four standard
    /// deviations apart are distinct.
    pub range_noise_std_m: f64,
    /// The distance behind the surface, along its normal, at which a hit counts, m: a surface on the border of two
    /// cells belongs to the solid cell.
    pub surface_depth_m: f64,
    /// Hits nearer to each other than this, m, belong to one surface: no beam passes the cells between them.
    pub join_m: f64,
    /// Where neighboring beams are farther apart than this, m, the space between them counts as not observed, and hits
    /// of new obstacles as hits on different bodies.
    pub max_gap_m: f64,
    /// The number of scans with a hit after which a free or unknown cell becomes blocked.
    pub hits_to_block: u8,
    /// The number of scans with a hit after which a cell far from every standing surface becomes blocked. 1 is
    /// enough for a laser without spurious returns.
    pub hits_to_block_in_open: u8,
    /// The number of scans that must pass an unknown cell until the cell becomes free.
    pub misses_to_discover: u8,
    /// The number of scans that must pass an unknown cell beside a surface until the cell becomes free. Such a cell
    /// can still be part of the surface.
    pub misses_to_discover_beside: u8,
    /// The number of scans that must pass a blocked cell until the cell becomes free, if the cell became blocked
    /// only recently.
    pub misses_to_free_fresh: u8,
    /// The number of scans that must pass a blocked cell until the cell becomes free, if the cell was hit in at least four scans.
    pub misses_to_free: u8,
    /// The number of hits after which a surface counts as permanent: noise around it is then not a new obstacle. The surface
    /// of a cell that was never free needs at most the hits of 4 s, at least `hits_to_block`.
    pub hits_to_stand: u16,
    /// The confirmation time, s: a first observation that is contradicted after less than this time in view was
    /// wrong. The state is corrected, which does not count as a change. It is at least the time of five readings.
    pub confirm_s: f64,
}

impl Default for SurfaceGridSettings {
    fn default() -> Self {
        Self {
            range_noise_std_m: 0.01,
            surface_depth_m: 0.02,
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

impl SurfaceGridSettings {
    /// The number of consecutive misses that free a blocked cell after this number of hits.
    pub(crate) fn misses_to_free_after(&self, hits: u16) -> i8 {
        let fresh = u16::from(self.misses_to_free_fresh);
        fresh.saturating_add(hits).min(u16::from(self.misses_to_free)) as i8
    }

    pub(crate) fn check(&self, check: SettingsCheck) -> Result<(), SettingsError> {
        // Every hit searches as far as the range noise reaches.
        check.within("steady.range_noise_std_m", self.range_noise_std_m, 0.0..=0.5, "from 0 to 0.5 m")?;
        check.within("steady.surface_depth_m", self.surface_depth_m, 0.0..=0.5, "from 0 to 0.5 m")?;
        check.within("steady.join_m", self.join_m, 0.0..=10.0, "from 0 to 10 m")?;
        check.within("steady.max_gap_m", self.max_gap_m, 0.0..=10.0, "from 0 to 10 m")?;
        check.within("steady.confirm_s", self.confirm_s, 0.0..=3600.0, "from 0 to 3600 s")?;
        let count = |key, count: u8| check.within(key, count, 1.0..=100.0, "from 1 to 100");
        count("steady.hits_to_block", self.hits_to_block)?;
        count("steady.hits_to_block_in_open", self.hits_to_block_in_open)?;
        count("steady.misses_to_discover", self.misses_to_discover)?;
        count("steady.misses_to_discover_beside", self.misses_to_discover_beside)?;
        count("steady.misses_to_free_fresh", self.misses_to_free_fresh)?;
        count("steady.misses_to_free", self.misses_to_free)?;
        let (fresh, most) = (self.misses_to_free_fresh, f64::from(self.misses_to_free));
        check.within("steady.misses_to_free_fresh", fresh, 1.0..=most, "at most steady.misses_to_free")
    }
}
