//! What one wheel's forces depend on: its soil and shape after effects, its motion, and what it remembers.

use crate::effects::{Bulldozing, Displacement, Multipass, SlipSinkage, Soil, StressPeak};
use crate::scalar::{Elementary, Scalar};

/// One wheel and its soil with everything that effects change, generic over the scalar so that
/// every parameter can be differentiated by.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WheelLaw<S> {
    /// Soil under the wheel.
    pub soil: Soil<S>,
    /// Radius r at which the rim rolls \[m\].
    pub radius: S,
    /// Sinkage at which a tyre is flat \[m\]: it sinks no deeper.
    pub flat: Option<S>,
    /// Wheel width b \[m\].
    pub width: f64,
    /// Exit angle behind the lowest point as a share of the entry angle.
    pub rebound: S,
    /// K_Y / K_X.
    pub modulus_ratio: S,
    /// Shear strength across the wheel over that along it.
    pub strength_ratio: S,
    /// Viscous coefficients of this wheel along X and Y \[N s/m\].
    pub viscosity: [S; 2],
    /// Where the greatest stress lies, if not in the middle.
    pub peak: Option<StressPeak<S>>,
    /// Sinkage that grows with slip.
    pub slip_sinkage: Option<SlipSinkage<S>>,
    /// Soil pushed ahead.
    pub bulldozing: Option<Bulldozing<S>>,
    /// Soil that remembers the rows ahead.
    pub multipass: Option<Multipass<S>>,
    /// Whether the shear displacement is the wheel's own state.
    pub transient: bool,
}

/// What a wheel and its soil remember.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WheelMemory<S> {
    /// What the shear displacement is made of, where it is a state.
    pub displacement: Displacement<S>,
    /// Depth to which the soil was pressed by the rows ahead \[m\].
    pub pressed: S,
}

impl WheelMemory<f64> {
    /// Nothing sheared, nothing pressed.
    pub const NONE: Self = Self {
        displacement: Displacement {
            forward: 0.0,
            lateral: 0.0,
            yaw: 0.0,
            rim: 0.0,
        },
        pressed: 0.0,
    };
    /// Number of its values.
    pub const COUNT: usize = 5;

    /// From the values in the order of the fields.
    #[must_use]
    pub fn from_array([forward, lateral, yaw, rim, pressed]: [f64; Self::COUNT]) -> Self {
        Self {
            displacement: Displacement {
                forward,
                lateral,
                yaw,
                rim,
            },
            pressed,
        }
    }
}

/// How one wheel moves over the ground.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WheelMotion<S> {
    /// Velocity of the wheel's centre along X, V_X - Omega Y_i \[m/s\] (10).
    pub forward: S,
    /// Velocity of the wheel's centre along Y, V_Y + Omega X_i \[m/s\] (10).
    pub lateral: S,
    /// Yaw rate of the vehicle Omega \[rad/s\].
    pub yaw_rate: S,
    /// Angular speed of the wheel omega \[rad/s\], positive rolls forward.
    pub angular_speed: S,
}

/// A wheel in contact with the ground: everything that its forces depend on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wheel<S> {
    /// How it moves.
    pub motion: WheelMotion<S>,
    /// Entry angle theta_1 \[rad\] that it would have if it were rigid ([`WheelLaw::arc`]).
    pub reach: S,
    /// What it and its soil remember.
    pub memory: WheelMemory<S>,
    /// Soil and shape.
    pub law: WheelLaw<S>,
}

/// Most numbers of a [`Wheel`].
pub(crate) const MOST_INPUTS: usize = 32;
/// Place of the reach among them.
pub(crate) const REACH: usize = 4;

impl<S: Copy> Wheel<S> {
    /// The same wheel with every number replaced, in the order of motion, reach, memory, law.
    #[inline(always)]
    pub(crate) fn map<T>(&self, mut f: impl FnMut(S) -> T) -> Wheel<T> {
        let WheelMotion {
            forward,
            lateral,
            yaw_rate,
            angular_speed,
        } = self.motion;
        let motion = WheelMotion {
            forward: f(forward),
            lateral: f(lateral),
            yaw_rate: f(yaw_rate),
            angular_speed: f(angular_speed),
        };
        let reach = f(self.reach);
        let Displacement {
            forward,
            lateral,
            yaw,
            rim,
        } = self.memory.displacement;
        let memory = WheelMemory {
            displacement: Displacement {
                forward: f(forward),
                lateral: f(lateral),
                yaw: f(yaw),
                rim: f(rim),
            },
            pressed: f(self.memory.pressed),
        };
        let law = &self.law;
        let [viscosity_x, viscosity_y] = law.viscosity;
        let law = WheelLaw {
            soil: Soil {
                cohesion: f(law.soil.cohesion),
                friction: f(law.soil.friction),
                modulus: f(law.soil.modulus),
                exponent: f(law.soil.exponent),
                shear_modulus: f(law.soil.shear_modulus),
            },
            radius: f(law.radius),
            flat: law.flat.map(&mut f),
            width: law.width,
            rebound: f(law.rebound),
            modulus_ratio: f(law.modulus_ratio),
            strength_ratio: f(law.strength_ratio),
            viscosity: [f(viscosity_x), f(viscosity_y)],
            peak: law.peak.map(|p| StressPeak {
                a0: f(p.a0),
                a1: f(p.a1),
            }),
            slip_sinkage: law.slip_sinkage.map(|s| SlipSinkage {
                exponent_growth: f(s.exponent_growth),
                sinkage_growth: f(s.sinkage_growth),
            }),
            bulldozing: law.bulldozing.map(|b| Bulldozing {
                lateral: f(b.lateral),
                frontal: f(b.frontal),
                unit_weight: f(b.unit_weight),
            }),
            multipass: law.multipass.map(|m| Multipass {
                memory: f(m.memory),
                stiffness_ratio: f(m.stiffness_ratio),
            }),
            transient: law.transient,
        };
        Wheel {
            motion,
            reach,
            memory,
            law,
        }
    }
}

impl<S: Scalar> WheelLaw<S> {
    /// A rigid wheel of this radius and width \[m\] on a soil, by the paper's equations alone.
    pub fn paper(soil: Soil<S>, radius: S, width: f64) -> Self {
        let (zero, one) = (S::constant(0.0), S::constant(1.0));
        Self {
            soil,
            radius,
            flat: None,
            width,
            rebound: zero,
            modulus_ratio: one,
            strength_ratio: one,
            viscosity: [zero; 2],
            peak: None,
            slip_sinkage: None,
            bulldozing: None,
            multipass: None,
            transient: false,
        }
    }
}

/// The circle on which a wheel meets the ground.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactArc<S> {
    /// Its radius \[m\], larger than the wheel's where a tyre is flat.
    pub circle: S,
    /// Its entry angle theta_1 \[rad\].
    pub entry: S,
}

impl<S: Scalar> ContactArc<S> {
    /// Depth of its lowest point below the ground that it meets \[m\].
    pub fn sinkage(&self) -> S {
        let (sine, _) = self.entry.scale(0.5).sin_cos_small();
        self.circle * (sine * sine).scale(2.0)
    }
}

impl<S: Scalar> WheelLaw<S> {
    /// The arc on which a wheel stands that reaches so far into the ground: `reach` is theta_1 \[rad\] of a rigid
    /// wheel. Beyond the reach at which a tyre is flat the sinkage stays, and the contact grows with the square
    /// of (sin reach/2)^2: a tyre may be flat over a thousand times the length at which it starts to be, and the
    /// reach stays an angle.
    #[inline(always)]
    pub fn arc(&self, reach: S) -> ContactArc<S> {
        let rigid = ContactArc {
            circle: self.radius,
            entry: reach,
        };
        let Some(flat) = self.flat else { return rigid };
        let (sine, _) = reach.scale(0.5).sin_cos_small();
        let deepest = (flat / self.radius).scale(0.5);
        let over = sine * sine / deepest;
        if over.value() <= 1.0 {
            return rigid;
        }
        let longer = over * over;
        ContactArc {
            circle: self.radius * longer * longer,
            entry: twice_arc_sine(deepest.sqrt() / longer),
        }
    }

    /// The reach at which a wheel carries a load, where it would be `rigid` without a tyre; for a guess.
    pub(crate) fn reach(&self, rigid: f64) -> f64 {
        let Some(flat) = self.flat else { return rigid };
        let (flat, radius) = (flat.value(), self.radius.value());
        let begins = (0.5 * flat / radius).sqrt();
        let over = (0.5 * rigid).sin() / begins;
        if over <= 1.0 {
            return rigid;
        }
        // The contact of a flat tyre is as long as its load is large, that of a rigid wheel its root of order 2n+1.
        let longer = over.powf(2.0 * self.soil.exponent.value() + 1.0);
        2.0 * (begins * longer.powf(0.25)).min(HIGHEST_SINE).asin()
    }
}

/// Of a guess for the reach.
const HIGHEST_SINE: f64 = 0.7;

/// An angle by the sine of its half.
#[inline(always)]
pub(super) fn twice_arc_sine<S: Scalar>(sine: S) -> S {
    let value = sine.value();
    let slope = 2.0 / (1.0 - value * value).sqrt();
    S::chain(2.0 * value.asin(), &[slope], &[sine])
}
