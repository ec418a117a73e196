//! Families of cases.

/// What a case is about.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Family {
    /// Nothing but a wrong soil.
    Nothing,
    /// One effect of the vehicle or the ground.
    Single,
    /// One fault of the sensors.
    Sensor,
    /// Something for some seconds, or on a patch.
    Local,
    /// Something in one of two drives.
    OneDrive,
    /// Two effects.
    Pair,
    /// One effect that another one resembles.
    Lookalike,
    /// Something outside of the catalogue.
    Out,
    /// Another soil beyond a line.
    TerrainChange,
    /// A drive that tells little.
    Poor,
}

impl Family {
    /// Every family, with how many of 50 cases are its.
    pub const ALL: [(Self, usize); 10] = [
        (Self::Nothing, 7),
        (Self::Single, 16),
        (Self::Sensor, 5),
        (Self::Local, 5),
        (Self::OneDrive, 1),
        (Self::Pair, 4),
        (Self::Lookalike, 5),
        (Self::Out, 3),
        (Self::TerrainChange, 2),
        (Self::Poor, 2),
    ];

    pub fn name(self) -> &'static str {
        match self {
            Self::Nothing => "nothing",
            Self::Single => "single",
            Self::Sensor => "sensor",
            Self::Local => "local",
            Self::OneDrive => "one_drive",
            Self::Pair => "pair",
            Self::Lookalike => "lookalike",
            Self::Out => "out",
            Self::TerrainChange => "terrain_change",
            Self::Poor => "poor",
        }
    }

    pub fn find(name: &str) -> Option<Self> {
        let mut all = Self::ALL.into_iter().map(|(family, _)| family);
        all.find(|family| family.name() == name)
    }

    /// The families of a set of all, and each case's number in its family: any stretch holds
    /// every family by about its share.
    pub fn sequence(count: usize) -> Vec<(Self, usize)> {
        let mut counts = [0; Self::ALL.len()];
        let next = |_| {
            // The one that would be least far beyond its share.
            let beyond = |f: &usize| (counts[*f] + 1) as f64 / Self::ALL[*f].1 as f64;
            let families = 0..Self::ALL.len();
            let least = families.min_by(|a, b| beyond(a).total_cmp(&beyond(b)));
            let family = least.expect("there are families");
            counts[family] += 1;
            (Self::ALL[family].0, counts[family] - 1)
        };
        (0..count).map(next).collect()
    }
}
