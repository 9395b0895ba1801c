//! The first picture of an animated PNG, as a PNG of its own.

/// What every PNG begins with.
const SIGNATURE: &[u8] = b"\x89PNG\r\n\x1a\n";

/// Kinds of chunks that only an animation has.
const ANIMATION: [&[u8]; 3] = [b"acTL", b"fcTL", b"fdAT"];

/// The file without what animates it; `None` if it is no PNG.
pub(crate) fn first_picture(png: &[u8]) -> Option<Vec<u8>> {
    let mut rest = png.strip_prefix(SIGNATURE)?;
    let mut still = SIGNATURE.to_vec();
    while !rest.is_empty() {
        // Length, kind, data, check sum.
        let length = u32::from_be_bytes(rest.get(..4)?.try_into().ok()?) as usize;
        let chunk = rest.get(..length.checked_add(12)?)?;
        if !ANIMATION.contains(&&chunk[4..8]) {
            still.extend_from_slice(chunk);
        }
        rest = &rest[chunk.len()..];
    }
    Some(still)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chunk(kind: &[u8], data: &[u8]) -> Vec<u8> {
        [&(data.len() as u32).to_be_bytes()[..], kind, data, b"sum!"].concat()
    }

    #[test]
    fn what_animates_is_left_out_and_all_else_stays() {
        let (head, image, end) =
            (chunk(b"IHDR", b"13"), chunk(b"IDAT", b"pixels"), chunk(b"IEND", b""));
        let (control, frame) = (chunk(b"acTL", b"12345678"), chunk(b"fdAT", b"more"));
        let whole = [SIGNATURE, &head, &control, &image, &frame, &end].concat();
        assert_eq!(first_picture(&whole), Some([SIGNATURE, &head, &image, &end].concat()));
        assert_eq!(first_picture(&whole[..whole.len() - 1]), None, "cut off");
        assert_eq!(first_picture(b"GIF89a"), None);
    }
}
