//! Where a part of a mesh file is placed: nodes of glTF and COLLADA may scale and shear.

use cranny_exact::{DMat3, DVec3};

/// An affine map: linear part, then translation.
#[derive(Clone, Copy, PartialEq)]
pub(super) struct Affine {
    pub(super) linear: DMat3,
    pub(super) translation: DVec3,
}

impl Affine {
    pub(super) const IDENTITY: Self = Self { linear: DMat3::IDENTITY, translation: DVec3::ZERO };

    pub(super) fn scale(factors: DVec3) -> Self {
        Self { linear: DMat3::from_diagonal(factors), translation: DVec3::ZERO }
    }

    /// The linear map that takes the axes to these vectors.
    pub(super) fn columns(x: DVec3, y: DVec3, z: DVec3) -> Self {
        Self { linear: DMat3::from_cols(x, y, z), translation: DVec3::ZERO }
    }

    pub(super) fn compose(&self, inner: &Self) -> Self {
        Self {
            linear: self.linear * inner.linear,
            translation: self.linear * inner.translation + self.translation,
        }
    }

    pub(super) fn apply(&self, p: DVec3) -> DVec3 {
        self.linear * p + self.translation
    }

    /// Whether it turns a surface inside out.
    pub(super) fn mirrors(&self) -> bool {
        self.linear.determinant() < 0.0
    }
}
