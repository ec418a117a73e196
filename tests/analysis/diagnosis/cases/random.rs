//! Draws from a seed.

use fastrand::Rng;

/// A stream of random numbers.
#[derive(Debug, Clone)]
pub struct Random(Rng);

impl Random {
    /// A stream of its own for each pair of a seed and a purpose.
    pub fn new(seed: u64, purpose: &str) -> Self {
        // FNV-1a over the purpose; fastrand mixes the rest.
        let word = purpose.bytes().fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
            (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3_u64)
        });
        let mut rng = Rng::with_seed(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ word);
        rng.u64(..);
        Self(rng)
    }

    pub fn seed(&mut self) -> u64 {
        self.0.u64(..)
    }

    pub fn normal(&mut self) -> f64 {
        let radius = (-2.0 * (1.0 - self.0.f64()).ln()).sqrt();
        radius * (std::f64::consts::TAU * self.0.f64()).cos()
    }

    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + self.0.f64() * (high - low)
    }

    /// Evenly in the logarithm.
    pub fn scaled(&mut self, low: f64, high: f64) -> f64 {
        self.between(low.ln(), high.ln()).exp()
    }

    pub fn chance(&mut self, probability: f64) -> bool {
        self.0.f64() < probability
    }

    pub fn sign(&mut self) -> f64 {
        if self.0.bool() { 1.0 } else { -1.0 }
    }

    pub fn pick<T: Copy>(&mut self, from: &[T]) -> T {
        from[self.0.usize(..from.len())]
    }

    pub fn shuffle<T>(&mut self, things: &mut [T]) {
        self.0.shuffle(things);
    }

    /// One of the things, each as often as its weight says.
    pub fn weighted<T: Copy>(&mut self, from: &[(T, f64)]) -> T {
        let total: f64 = from.iter().map(|(_, weight)| weight).sum();
        let mut rest = self.0.f64() * total;
        for (thing, weight) in from {
            rest -= weight;
            if rest < 0.0 {
                return *thing;
            }
        }
        from[from.len() - 1].0
    }

    /// Noise whose correlation falls by e within `time`, of unit variance, one value per step.
    pub fn coloured(&mut self, count: usize, step: f64, time: f64) -> Vec<f64> {
        let decay = (-step / time).exp();
        let fresh = (1.0 - decay * decay).sqrt();
        let mut value = self.normal();
        (0..count)
            .map(|_| {
                value = decay * value + fresh * self.normal();
                value
            })
            .collect()
    }
}
