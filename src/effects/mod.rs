//! The physics that the paper leaves out, and what sensors add: one effect per file.
//!
//! Every effect is declared with its parameters (unit, range, prior), its equation, the source of
//! that, and the assumption of the paper that it lifts. Where all are off the model is the
//! paper's, bit for bit. An effect that a file switches on, that a fit estimates, or that an FMU has
//! as parameters is the same code, generic over the scalar.

mod bulldozing;
mod catalogue;
mod com_shift;
mod declaration;
mod drag;
mod drawbar;
mod elastic_rebound;
mod grade;
mod heading_offset;
mod latency;
mod left_right_soil;
mod lever_arm;
mod multipass;
mod payload;
mod profile;
mod rate_dependent_soil;
mod residual_lateral;
mod residual_longitudinal;
mod residual_motion;
mod residual_yaw;
mod shear_anisotropy;
mod slip_sinkage;
mod soil;
mod stress_peak;
mod terrain_change;
mod transient_shear;
mod tyre_compliance;
mod wheel_radius;
mod window;
mod yaw_rate_bias;

pub use bulldozing::Bulldozing;
pub use catalogue::{ActiveEffects, CATALOGUE, Effects, PARAMETER_COUNT, ParameterName};
pub use com_shift::ComShift;
pub use declaration::{
    Acts, Axis, Class, Declaration, EffectKind, FirstStep, ParameterDeclaration, Prior,
    StandingWheel,
};
pub use drag::Drag;
pub use drawbar::Drawbar;
pub use elastic_rebound::ElasticRebound;
pub use grade::{Grade, SlopeGravity};
pub use heading_offset::HeadingOffset;
pub use latency::Latency;
pub use left_right_soil::LeftRightSoil;
pub use lever_arm::LeverArm;
pub use multipass::{Multipass, Rut};
pub use payload::Payload;
pub use profile::{Grid, Points, ProfileError, SlopeProfile};
pub use rate_dependent_soil::RateDependentSoil;
pub use residual_lateral::ResidualLateral;
pub use residual_longitudinal::ResidualLongitudinal;
pub use residual_motion::{ResidualMotion, Unscaled};
pub use residual_yaw::ResidualYaw;
pub use shear_anisotropy::ShearAnisotropy;
pub use slip_sinkage::{SlipSinkage, absolute_slip, whole_slip};
pub use soil::Soil;
pub use stress_peak::StressPeak;
pub use terrain_change::{Boundary, TerrainChange};
pub use transient_shear::{Displacement, TransientShear};
pub use tyre_compliance::TyreCompliance;
pub use wheel_radius::WheelRadius;
pub use window::{Extent, Window, WindowError};
pub use yaw_rate_bias::YawRateBias;
