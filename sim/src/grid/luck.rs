use rand::Rng;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;

/// Whose luck it is. One more draw of one never changes that of another.
#[derive(Clone, Copy, Debug)]
pub(super) enum Whose {
    Robot,
    /// By its place in the file.
    Block(usize),
}

/// Whether things happen that happen with a given chance.
#[derive(Clone, Debug)]
pub(super) struct Luck {
    chance: f64,
    stream: ChaCha8Rng,
}

impl Luck {
    pub(super) fn new(seed: u64, whose: Whose, chance: f64) -> Self {
        let mut stream = ChaCha8Rng::seed_from_u64(seed);
        // Far from the streams that whoever lives in the world may take from the same seed.
        stream.set_stream(match whose {
            Whose::Robot => 1 << 60,
            Whose::Block(index) => (1 << 60) + 1 + index as u64,
        });
        Self { chance, stream }
    }

    /// Whether it happens this time. Nothing is drawn for what is certain.
    pub(super) fn happens(&mut self) -> bool {
        self.chance >= 1.0 || ((self.stream.next_u64() >> 11) as f64 * 2.0_f64.powi(-53)) < self.chance
    }
}
