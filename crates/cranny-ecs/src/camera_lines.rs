//! Cameras as text: what a recording's metadata holds of them.
//!
//! A line a camera: a preset's name, or `look_at` and seven numbers (eye, target, field of view in
//! radians), then the camera's own name.

use cranny_exact::DVec3;
use cranny_world::description::{CameraDescription, CameraView};

/// One line a camera, in their order.
pub(crate) fn to_text(cameras: &[CameraDescription]) -> String {
    let lines = cameras.iter().map(|camera| format!("{} {}", view_text(camera.view), camera.name));
    lines.collect::<Vec<_>>().join("\n")
}

/// The cameras of a text; lines that hold none are left out.
pub(crate) fn from_text(text: &str) -> Vec<CameraDescription> {
    text.lines().filter_map(camera).collect()
}

fn view_text(view: CameraView) -> String {
    match view {
        CameraView::Isometric => "isometric".to_owned(),
        CameraView::Front => "front".to_owned(),
        CameraView::Side => "side".to_owned(),
        CameraView::Top => "top".to_owned(),
        CameraView::LookAt { eye, target, field_of_view } => {
            let numbers = [eye.x, eye.y, eye.z, target.x, target.y, target.z, field_of_view];
            format!("look_at {}", numbers.map(|number| number.to_string()).join(" "))
        }
    }
}

fn camera(line: &str) -> Option<CameraDescription> {
    let (kind, rest) = line.split_once(' ')?;
    let (view, name) = match kind {
        "isometric" => (CameraView::Isometric, rest),
        "front" => (CameraView::Front, rest),
        "side" => (CameraView::Side, rest),
        "top" => (CameraView::Top, rest),
        "look_at" => look_at(rest)?,
        _ => return None,
    };
    Some(CameraDescription { name: name.to_owned(), view })
}

fn look_at(text: &str) -> Option<(CameraView, &str)> {
    let mut numbers = [0.0; 7];
    let mut rest = text;
    for number in &mut numbers {
        let (word, behind) = rest.split_once(' ')?;
        *number = word.parse().ok()?;
        rest = behind;
    }
    let [x, y, z, to_x, to_y, to_z, field_of_view] = numbers;
    let (eye, target) = (DVec3::new(x, y, z), DVec3::new(to_x, to_y, to_z));
    Some((CameraView::LookAt { eye, target, field_of_view }, rest))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cameras_come_back_to_the_bit() {
        let near = CameraView::LookAt {
            eye: DVec3::new(0.1, -1e-7, 1.0 / 3.0),
            target: DVec3::new(0.0, -0.0, 1e9),
            field_of_view: 0.7,
        };
        let views = [near, CameraView::Isometric, CameraView::Top];
        let names = ["near by", "main", "top"];
        let cameras = views.into_iter().zip(names);
        let cameras: Vec<_> =
            cameras.map(|(view, name)| CameraDescription { name: name.to_owned(), view }).collect();
        assert_eq!(from_text(&to_text(&cameras)), cameras);
    }

    #[test]
    fn lines_without_a_camera_are_left_out() {
        assert_eq!(from_text("\nfront\nlook_at 1 2 x\nlook_at 1 2 3 near\naslant main"), []);
    }
}
