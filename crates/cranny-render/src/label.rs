//! Words at a place in space.

use cranny_exact::DVec3;

use crate::camera::Camera;
use crate::color::Color;
use crate::image::{Image, ImageSize};
use crate::palette::PAPER;
use crate::text::{text_height, text_width};

/// A line of text beside a point, in front of everything.
#[derive(Clone, Debug, PartialEq)]
pub struct Label {
    /// The point.
    pub at: DVec3,
    /// What is written; ASCII and a few signs.
    pub text: String,
    /// Height of the letters in pixels.
    pub size: f32,
    /// Colour of the letters.
    pub color: Color,
    /// Where the text stands.
    pub anchor: Anchor,
}

/// Where text stands, seen from its point.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Anchor {
    /// To the right, some pixels away.
    #[default]
    Right,
    /// To the left.
    Left,
    /// Above it.
    Above,
    /// Below it.
    Below,
}

/// Pixels between a point and its text.
const AWAY: f32 = 9.0;

/// Pixels between a text and the edge of the picture.
const EDGE: f32 = 4.0;

impl Label {
    /// Text of the usual size and colour, to the right of a point.
    #[must_use]
    pub fn new(at: DVec3, text: impl Into<String>) -> Self {
        let (size, color) = (15.0, crate::palette::INK);
        Self { at, text: text.into(), size, color, anchor: Anchor::Right }
    }

    /// Where the text stands in a picture of this size: its left, top, right and bottom edge in
    /// pixels. Text that would leave the picture is moved inside. `None` where the point is behind
    /// the camera or outside the picture: nothing is written.
    #[must_use]
    pub fn room(&self, camera: &Camera, size: ImageSize) -> Option<[f32; 4]> {
        let [x, y] = camera.project(self.at, size)?.map(|c| c as f32);
        let [width, height] = [size.width(), size.height()].map(|s| s as f32);
        if !(0.0..=width).contains(&x) || !(0.0..=height).contains(&y) {
            return None;
        }
        let (w, h) = (text_width(&self.text, self.size), text_height(self.size));
        let [left, top] = match self.anchor {
            Anchor::Right => [x + AWAY, y - 0.5 * h],
            Anchor::Left => [x - AWAY - w, y - 0.5 * h],
            Anchor::Above => [x - 0.5 * w, y - AWAY - h],
            Anchor::Below => [x - 0.5 * w, y + AWAY],
        };
        let within = |at: f32, room: f32| at.min(room - EDGE).max(EDGE).round();
        let [left, top] = [within(left, width - w), within(top, height - h)];
        Some([left, top, left + w, top + h])
    }

    /// Writes the text where it has [room](Self::room).
    pub(crate) fn write(&self, image: &mut Image, camera: &Camera) {
        if let Some([left, top, ..]) = self.room(camera, image.size()) {
            let at = [left, top].map(|c| c as i32);
            image.write(at, &self.text, self.size, self.color, Some(PAPER));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn written(at: DVec3, anchor: Anchor) -> Vec<(u32, u32)> {
        let size = ImageSize::new(120, 80).unwrap();
        let camera = Camera::look_at(DVec3::new(0.0, -10.0, 0.0), DVec3::ZERO).unwrap();
        let mut image = Image::filled(size, Color::WHITE);
        let label = Label { anchor, ..Label::new(at, "gap") };
        label.write(&mut image, &camera);
        let dark = |&(x, y): &(u32, u32)| image.pixel(x, y).is_some_and(|c| c.r < 128);
        (0..80).flat_map(|y| (0..120).map(move |x| (x, y))).filter(dark).collect()
    }

    #[test]
    fn text_stands_on_its_side_of_the_point_and_within_the_picture() {
        let middle = |anchor| {
            let pixels = written(DVec3::ZERO, anchor);
            let n = pixels.len() as f64;
            let sum = pixels
                .iter()
                .fold([0.0; 2], |[a, b], &(x, y)| [a + f64::from(x), b + f64::from(y)]);
            [sum[0] / n - 60.0, sum[1] / n - 40.0]
        };
        assert!(middle(Anchor::Right)[0] > 10.0 && middle(Anchor::Left)[0] < -10.0);
        assert!(middle(Anchor::Above)[1] < -8.0 && middle(Anchor::Below)[1] > 8.0);
        let at_the_edge = written(DVec3::new(3.9, 0.0, 2.5), Anchor::Right);
        assert!(at_the_edge.len() > 20, "{}", at_the_edge.len());
    }

    #[test]
    fn points_that_are_not_seen_have_no_text() {
        for at in [DVec3::new(0.0, -20.0, 0.0), DVec3::new(90.0, 0.0, 0.0)] {
            assert!(written(at, Anchor::Right).is_empty());
        }
    }
}
