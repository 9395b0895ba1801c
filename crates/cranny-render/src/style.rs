//! How a body is drawn, and how much a picture does for the eye.

/// What of a body is drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Style {
    /// Its faces; translucent where its colour has an alpha below 255.
    #[default]
    Solid,
    /// Its faces as layers that take away light, densest where they are seen edge on: what is
    /// inside and behind shows through. Opaque bodies in front hide it, it hides nothing, and the
    /// order of layers changes nothing.
    XRay,
    /// Its edges.
    Wireframe,
}

/// What makes depth and form readable, beyond light on the faces.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Shading {
    /// Dark lines where faces meet at an angle of more than [`CREASE_DEGREES`], and where a body
    /// ends before what is behind it.
    pub outlines: bool,
    /// Darker where bodies stand close to one another (ambient occlusion). Under OpenGL it is left
    /// out: depths cannot be read there.
    pub occlusion: bool,
}

impl Shading {
    /// Light on the faces alone.
    pub const PLAIN: Self = Self { outlines: false, occlusion: false };
    /// All there is.
    pub const FULL: Self = Self { outlines: true, occlusion: true };
}

/// Smaller: facets of curved surfaces get lines, and the form drowns in them. Larger: bevels and
/// the flanks of threads have none. `outlines_are_creases_and_silhouettes` looks at both.
pub const CREASE_DEGREES: f64 = 35.0;
