//! What is summed over a contact patch.

use crate::scalar::Packed;
use fearless_simd::Simd;

/// Sums over the patch, per metre of radius and width (dA = r b dtheta d(y/b)).
#[derive(Debug, Clone, Copy)]
pub(super) struct PatchSums<S> {
    /// Shear along X, Y, Z.
    pub shear: [S; 3],
    /// Normal stress against X, and along Z.
    pub normal: [S; 2],
    /// y tau_X.
    pub width_moment: S,
    /// sin theta tau_Y.
    pub arc_moment: S,
    /// Shear along (cos theta, sin theta), the tangent of the rim.
    pub tangential: S,
}

impl<P: Copy> PatchSums<P> {
    /// Nothing summed yet.
    #[inline(always)]
    pub fn new(zero: P) -> Self {
        Self {
            shear: [zero; 3],
            normal: [zero; 2],
            width_moment: zero,
            arc_moment: zero,
            tangential: zero,
        }
    }

    /// The sums of eight lanes each.
    #[inline(always)]
    pub fn sum<V: Simd>(self) -> PatchSums<<P as Packed<V>>::Lane>
    where
        P: Packed<V>,
    {
        PatchSums {
            // Not `array::map`: a closure that is not inlined loses the vector registers.
            shear: [
                self.shear[0].sum(),
                self.shear[1].sum(),
                self.shear[2].sum(),
            ],
            normal: [self.normal[0].sum(), self.normal[1].sum()],
            width_moment: self.width_moment.sum(),
            arc_moment: self.arc_moment.sum(),
            tangential: self.tangential.sum(),
        }
    }
}
