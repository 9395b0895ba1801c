//! Where a picture is taken from, and how a scene is fitted into the frame.

use cranny_exact::{Aabb, DVec3};
use thiserror::Error;

use crate::draw_list::{DrawList, box_corners};
use crate::image::ImageSize;

/// A perspective camera. Right-handed world, z up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    eye: DVec3,
    target: DVec3,
    /// Unit vectors to the right, up and backward (from the target to the eye).
    axes: [DVec3; 3],
    field_of_view: f64,
}

/// From which side a fitted camera looks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Preset {
    /// From (1, −1, 1): right, front and top are seen alike.
    #[default]
    Isometric,
    /// From −y: x to the right, z up.
    Front,
    /// From +x: y to the right, z up.
    Side,
    /// From +z: x to the right, y up.
    Top,
}

impl Preset {
    /// All of them, in the order in which they are declared.
    pub const ALL: [Self; 4] = [Self::Isometric, Self::Front, Self::Side, Self::Top];

    /// From the scene towards the camera; not of unit length.
    #[must_use]
    pub fn direction(self) -> DVec3 {
        match self {
            Self::Isometric => DVec3::new(1.0, -1.0, 1.0),
            Self::Front => DVec3::NEG_Y,
            Self::Side => DVec3::X,
            Self::Top => DVec3::Z,
        }
    }
}

/// A camera that cannot see.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum CameraError {
    /// Eye and target coincide, or a viewing direction of length 0, or one of them is not finite.
    #[error("a camera at {eye} cannot look at {target}: the two must be finite and some way apart")]
    NoDirection {
        /// Where the camera is.
        eye: DVec3,
        /// What it looks at.
        target: DVec3,
    },
    /// The vertical field of view is out of range.
    #[error(
        "the vertical field of view is {degrees} degrees: it must lie between {} and {}",
        Camera::FIELD_OF_VIEW_RANGE[0],
        Camera::FIELD_OF_VIEW_RANGE[1]
    )]
    FieldOfView {
        /// The angle found.
        degrees: f64,
    },
    /// The bounds to fit into the frame hold `NaN` or infinite numbers.
    #[error(
        "the bounds to fit into the frame run from {} to {}: they must be finite",
        bounds.min,
        bounds.max
    )]
    Bounds {
        /// The bounds found.
        bounds: Aabb,
    },
}

impl Camera {
    /// The default vertical field of view in degrees: narrow enough for parallel edges to look it.
    pub const FIELD_OF_VIEW: f64 = 30.0;

    /// The accepted vertical fields of view in degrees.
    pub const FIELD_OF_VIEW_RANGE: [f64; 2] = [1.0, 150.0];

    /// How much of the frame fitted bounds fill, in the direction in which they fill more.
    pub const FILL: f64 = 0.85;

    /// A camera at `eye` that looks at `target`, z up in the picture (y, when looking straight up
    /// or down), with the default field of view.
    ///
    /// # Errors
    ///
    /// [`CameraError::NoDirection`] where the two coincide or are not finite.
    pub fn look_at(eye: DVec3, target: DVec3) -> Result<Self, CameraError> {
        let axes = view_axes(eye - target).ok_or(CameraError::NoDirection { eye, target })?;
        Ok(Self { eye, target, axes, field_of_view: Self::FIELD_OF_VIEW.to_radians() })
    }

    /// The same camera with another vertical field of view, in degrees.
    ///
    /// # Errors
    ///
    /// [`CameraError::FieldOfView`] outside [`FIELD_OF_VIEW_RANGE`](Self::FIELD_OF_VIEW_RANGE).
    pub fn with_field_of_view(self, degrees: f64) -> Result<Self, CameraError> {
        let [least, greatest] = Self::FIELD_OF_VIEW_RANGE;
        if (least..=greatest).contains(&degrees) {
            Ok(Self { field_of_view: degrees.to_radians(), ..self })
        } else {
            Err(CameraError::FieldOfView { degrees })
        }
    }

    /// A camera that sees all of `bounds`, filling [`FILL`](Self::FILL) of the frame.
    ///
    /// # Errors
    ///
    /// [`CameraError::Bounds`] where the bounds are not finite.
    pub fn fitted(preset: Preset, bounds: &Aabb, size: ImageSize) -> Result<Self, CameraError> {
        Self::fitted_from(preset.direction(), bounds, size)
    }

    /// As [`fitted`](Self::fitted), looking from any direction (`direction` points from the scene
    /// to the camera). An empty box is taken for the unit cube about the origin, and a point for a
    /// cube of size 1 about it (larger where rounding would swallow that), so that an empty scene
    /// has a picture too.
    ///
    /// # Errors
    ///
    /// [`CameraError::Bounds`] where the bounds are not finite, [`CameraError::NoDirection`] where
    /// the direction is not, or is zero.
    pub fn fitted_from(
        direction: DVec3,
        bounds: &Aabb,
        size: ImageSize,
    ) -> Result<Self, CameraError> {
        let bounds = visible_bounds(bounds)?;
        Self::fit(direction, bounds.center(), box_corners(&bounds), size)
    }

    /// A camera that sees all that the list holds (but the ground). Fits closer than the list's
    /// bounds would, since it looks at each vertex: for a picture, or for a camera that stays while
    /// things move within what the list shows. An empty list is treated as an empty box.
    ///
    /// # Errors
    ///
    /// [`CameraError::Bounds`] where something in the list is not finite.
    pub fn fitted_to(
        preset: Preset,
        list: &DrawList,
        size: ImageSize,
    ) -> Result<Self, CameraError> {
        let bounds = list.bounds();
        if visible_bounds(&bounds)? != bounds {
            return Self::fitted(preset, &bounds, size);
        }
        Self::fit(preset.direction(), bounds.center(), list.vertices(), size)
    }

    fn fit(
        direction: DVec3,
        center: DVec3,
        points: impl Iterator<Item = DVec3>,
        size: ImageSize,
    ) -> Result<Self, CameraError> {
        let no_direction = CameraError::NoDirection { eye: center + direction, target: center };
        let axes = view_axes(direction).ok_or(no_direction)?;
        let field_of_view = Self::FIELD_OF_VIEW.to_radians();

        // A point at (x, y, z), seen from (ex, ey, d) looking along −z, stays within the wanted
        // part of the frame if |x − ex| <= sx (d − z) and |y − ey| <= sy (d − z). For each axis
        // that bounds ex from both sides, and d from below by where the two bounds meet.
        let sy = Self::FILL * (0.5 * field_of_view).tan();
        let slopes = [sy * size.aspect(), sy];
        let mut reaches = [[f64::NEG_INFINITY; 2]; 2];
        for point in points {
            let [x, y, z] = axes.map(|axis| (point - center).dot(axis));
            for (axis, along) in [x, y].into_iter().enumerate() {
                for (reach, side) in reaches[axis].iter_mut().zip([1.0, -1.0]) {
                    *reach = reach.max(side * along + slopes[axis] * z);
                }
            }
        }
        let needed = |axis: usize| (reaches[axis][0] + reaches[axis][1]) / (2.0 * slopes[axis]);
        let distance = needed(0).max(needed(1));
        // The middle of what is left to choose.
        let [ex, ey] = reaches.map(|[right, left]| 0.5 * (right - left));

        let target = center + ex * axes[0] + ey * axes[1];
        Ok(Self { eye: target + distance * axes[2], target, axes, field_of_view })
    }

    /// Where the camera is.
    #[must_use]
    pub fn eye(&self) -> DVec3 {
        self.eye
    }

    /// What it looks at.
    #[must_use]
    pub fn target(&self) -> DVec3 {
        self.target
    }

    /// Vertical field of view in radians.
    #[must_use]
    pub fn field_of_view(&self) -> f64 {
        self.field_of_view
    }

    /// Unit vectors to the right, up and backward.
    #[must_use]
    pub fn axes(&self) -> [DVec3; 3] {
        self.axes
    }

    /// Distance of eye and target; above 0.
    #[must_use]
    pub fn distance(&self) -> f64 {
        (self.eye - self.target).length()
    }

    /// Where a point appears in a picture of this size, in pixels from its top left corner (x to
    /// the right, y down; the first pixel's centre is at 0.5); `None` for points that are not in
    /// front of the camera. The result may lie outside the picture.
    #[must_use]
    pub fn project(&self, point: DVec3, size: ImageSize) -> Option<[f64; 2]> {
        let [x, y, z] = self.axes.map(|axis| (point - self.eye).dot(axis));
        if z >= 0.0 {
            return None;
        }
        let focal = 1.0 / (0.5 * self.field_of_view).tan();
        let (ndc_x, ndc_y) = (focal / size.aspect() * x / -z, focal * y / -z);
        let (width, height) = (f64::from(size.width()), f64::from(size.height()));
        Some([0.5 * width * (1.0 + ndc_x), 0.5 * height * (1.0 - ndc_y)])
    }
}

/// A view counts as straight up or down when the sine of its angle to z is at most this. Smaller:
/// rounding would choose which way is right. Larger: steep views would turn about their own axis.
/// `presets_see_the_axes_where_they_say`
/// looks straight down.
const VERTICAL_SINE: f64 = 1e-9;

/// Bounds with a diagonal of at most this part of their distance from the origin are a point, to
/// rounding. Smaller: a camera would be fitted to rounding errors. Larger: a small body far away
/// would be shown as a dot. `a_fitted_camera_fills_the_frame_and_cuts_nothing` has a small one.
const POINT_RATIO: f64 = 1e-12;

/// How far around a point a picture reaches, as part of the point's distance from the origin (half
/// a unit near the origin). Smaller: the eye could not be distinguished from its target. Larger:
/// bodies beside the point would be lost in the picture.
/// `empty_and_point_like_bounds_have_a_camera` looks at both.
const POINT_REACH: f64 = 1e-9;

/// Right, up, backward; `None` where `backward` has no direction.
fn view_axes(backward: DVec3) -> Option<[DVec3; 3]> {
    let backward = backward.try_normalize()?;
    // Looking straight up or down, z has no direction in the picture: y takes its place.
    let right = DVec3::Z.cross(backward);
    let right = if right.length() > VERTICAL_SINE { right } else { DVec3::Y.cross(backward) };
    let right = right.try_normalize()?;
    Some([right, backward.cross(right), backward])
}

fn visible_bounds(bounds: &Aabb) -> Result<Aabb, CameraError> {
    if bounds.is_empty() && !bounds.min.is_nan() && !bounds.max.is_nan() {
        return Ok(Aabb { min: DVec3::splat(-0.5), max: DVec3::splat(0.5) });
    }
    if !(bounds.min.is_finite() && bounds.max.is_finite()) {
        return Err(CameraError::Bounds { bounds: *bounds });
    }
    let largest = bounds.min.abs().max(bounds.max.abs()).max_element();
    if bounds.diagonal() <= largest * POINT_RATIO {
        Ok(bounds.grown(f64::max(0.5, largest * POINT_REACH)))
    } else {
        Ok(*bounds)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn size() -> ImageSize {
        ImageSize::new(960, 540).unwrap()
    }

    #[test]
    fn a_fitted_camera_fills_the_frame_and_cuts_nothing() {
        let boxes = [
            Aabb { min: DVec3::ZERO, max: DVec3::ONE },
            Aabb { min: DVec3::new(-50.0, 3.0, 0.0), max: DVec3::new(60.0, 4.0, 0.1) },
            Aabb { min: DVec3::new(1e6, 0.0, 0.0), max: DVec3::new(1e6 + 0.01, 0.02, 5.0) },
            Aabb { min: DVec3::splat(-1e-30), max: DVec3::splat(2e-30) },
            Aabb { min: DVec3::splat(-1e30), max: DVec3::splat(2e30) },
        ];
        for size in [size(), ImageSize::new(200, 800).unwrap()] {
            for (bounds, preset) in boxes.iter().flat_map(|b| Preset::ALL.map(|p| (b, p))) {
                let camera = Camera::fitted(preset, bounds, size).unwrap();
                let mut reached = 0.0f64;
                for corner in box_corners(bounds) {
                    let [x, y] = camera.project(corner, size).unwrap();
                    let from_center =
                        |v: f64, extent: u32| (2.0 * v / f64::from(extent) - 1.0).abs();
                    let far = from_center(x, size.width()).max(from_center(y, size.height()));
                    assert!(far < Camera::FILL + 1e-6, "{bounds:?} {preset:?}: {far}");
                    reached = reached.max(far);
                }
                assert!(reached > Camera::FILL - 1e-6, "{bounds:?} {preset:?}: {reached}");
            }
        }
    }

    #[test]
    fn presets_see_the_axes_where_they_say() {
        let bounds = Aabb { min: DVec3::splat(-1.0), max: DVec3::splat(1.0) };
        let on_screen = |preset, point| {
            let camera = Camera::fitted(preset, &bounds, size()).unwrap();
            let [x, y] = camera.project(point, size()).unwrap();
            [x - 480.0, 270.0 - y]
        };
        let near = |[x, y]: [f64; 2], [sx, sy]: [f64; 2]| {
            (x.abs() < 1e-9) == (sx == 0.0)
                && (y.abs() < 1e-9) == (sy == 0.0)
                && x * sx >= 0.0
                && y * sy >= 0.0
        };
        assert!(near(on_screen(Preset::Front, DVec3::X), [1.0, 0.0]));
        assert!(near(on_screen(Preset::Front, DVec3::Z), [0.0, 1.0]));
        assert!(near(on_screen(Preset::Side, DVec3::Y), [1.0, 0.0]));
        assert!(near(on_screen(Preset::Side, DVec3::Z), [0.0, 1.0]));
        assert!(near(on_screen(Preset::Top, DVec3::X), [1.0, 0.0]));
        assert!(near(on_screen(Preset::Top, DVec3::Y), [0.0, 1.0]));
        let up = on_screen(Preset::Isometric, DVec3::Z);
        assert!(up[1] > 0.0);
    }

    #[test]
    fn empty_and_point_like_bounds_have_a_camera() {
        let at = DVec3::new(7.0, 8.0, 9.0);
        for bounds in [Aabb::EMPTY, Aabb::of_points([DVec3::ZERO]), Aabb::of_points([at])] {
            let camera = Camera::fitted(Preset::Isometric, &bounds, size()).unwrap();
            assert!(camera.distance() > 0.5 && camera.distance() < 20.0);
        }
        let far = Aabb::of_points([DVec3::splat(1e30)]);
        assert!(Camera::fitted(Preset::Side, &far, size()).unwrap().distance() > 1e20);
    }

    #[test]
    fn cameras_that_cannot_see_are_refused() {
        let error = Camera::look_at(DVec3::X, DVec3::X).unwrap_err();
        assert!(matches!(error, CameraError::NoDirection { .. }));
        assert!(Camera::look_at(DVec3::NAN, DVec3::X).is_err());
        let camera = Camera::look_at(DVec3::X, DVec3::ZERO).unwrap();
        for degrees in [0.0, f64::NAN, 180.0] {
            let error = camera.with_field_of_view(degrees).unwrap_err();
            assert!(error.to_string().contains("between 1 and 150"), "{error}");
        }
        let endless = Aabb { min: DVec3::ZERO, max: DVec3::INFINITY };
        assert!(Camera::fitted(Preset::Top, &endless, size()).is_err());
        let unknown = Aabb { min: DVec3::NAN, max: DVec3::ONE };
        assert!(Camera::fitted(Preset::Top, &unknown, size()).is_err());
        assert_eq!(camera.project(DVec3::new(2.0, 0.0, 0.0), size()), None);
    }
}
