//! Colours of marks. Those of depth are the ones of our own pictures.

/// How deep bodies overlap: amber, red, dark red ('YlOrRd' of Brewer and Harrower 2003); lightness
/// falls all the way, so that it is read in grey and by every eye.
const DEPTH: [[u8; 3]; 5] = [
    [0xFE, 0xB2, 0x4C],
    [0xFD, 0x8D, 0x3C],
    [0xFC, 0x4E, 0x2A],
    [0xCB, 0x18, 0x1D],
    [0x6F, 0x00, 0x20],
];

/// Of contacts across a gap.
const GAP: [u8; 3] = [0x0A, 0x5E, 0x8A];

/// Of arrows along normals.
pub(crate) const NORMAL: [u8; 3] = [0x1A, 0x73, 0xE6];

/// Of curves in which surfaces meet.
pub(crate) const CURVE: [u8; 3] = [0xFF, 0xFF, 0xFF];

/// Of a contact, where `deepest` is the depth of the darkest.
pub(crate) fn of_contact(separation: f32, deepest: f32) -> [u8; 3] {
    match separation > 0.0 {
        true => GAP,
        false if deepest > 0.0 => of_share(-separation / deepest),
        false => DEPTH[0],
    }
}

fn of_share(share: f32) -> [u8; 3] {
    let at = share.clamp(0.0, 1.0) * (DEPTH.len() - 1) as f32;
    let below = (at.floor() as usize).min(DEPTH.len() - 2);
    let (a, b) = (DEPTH[below], DEPTH[below + 1]);
    let mixed = |i: usize| {
        let (a, b) = (f32::from(a[i]), f32::from(b[i]));
        (a + (b - a) * (at - below as f32)).round() as u8
    };
    [mixed(0), mixed(1), mixed(2)]
}

/// Red, green, blue and opacity from 0 to 1, in bytes.
pub(crate) fn bytes(color: [f64; 4]) -> [u8; 4] {
    color.map(|part| (part.clamp(0.0, 1.0) * 255.0).round() as u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn deeper_is_darker_and_gaps_are_blue() {
        let colors = [0.0, 0.25, 0.5, 0.75, 1.0].map(|depth| of_contact(-depth, 1.0));
        assert_eq!(colors, DEPTH);
        assert_eq!([of_contact(0.1, 1.0), of_contact(0.0, 0.0)], [GAP, DEPTH[0]]);
        assert_eq!(bytes([0.0, 0.5, 1.0, 2.0]), [0, 128, 255, 255]);
    }
}
