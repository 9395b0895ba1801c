//! What the picture of `cranny inspect` shows.

use clap::ValueEnum;
use cranny_exact::DVec3;
use cranny_scene::MeshFormat;

/// What is drawn of a model, besides the model.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Show {
    /// What lies on the hull; concavities with their caps and boundary loops.
    #[default]
    Classes,
    /// The patches from which contacts are drawn.
    Patches,
    /// The boxes of one level of the concavities' trees, 0 the roots.
    Boxes(usize),
    /// The layers of the concavities' envelopes at one depth, 0 the first, next to the cap.
    Envelope(usize),
    /// Where findings are.
    Findings,
}

/// Which axis of a model points up in its picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Up {
    /// x
    X,
    /// y
    Y,
    /// z
    Z,
}

impl Up {
    /// glTF says that y points up (2.0, section 3.4); no other format here says anything that its
    /// reader has not already applied.
    pub(crate) fn of_format(format: &str) -> Self {
        if format == MeshFormat::Gltf.name() { Self::Y } else { Self::Z }
    }

    /// A place of the model, turned by right angles such that this axis is z.
    pub(crate) fn upright(self, p: DVec3) -> DVec3 {
        match self {
            Self::X => DVec3::new(p.y, p.z, p.x),
            Self::Y => DVec3::new(p.x, -p.z, p.y),
            Self::Z => p,
        }
    }

    /// Its name, where it is not the rule.
    pub(crate) fn name_unless_usual(self) -> Option<&'static str> {
        match self {
            Self::X => Some("x"),
            Self::Y => Some("y"),
            Self::Z => None,
        }
    }
}

/// An axis of a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum CutAxis {
    /// x
    X,
    /// y
    Y,
    /// z
    Z,
}

impl CutAxis {
    /// The unit vector.
    pub(crate) fn direction(self) -> DVec3 {
        match self {
            Self::X => DVec3::X,
            Self::Y => DVec3::Y,
            Self::Z => DVec3::Z,
        }
    }
}

/// Reads `classes`, `patches`, `boxes:LEVEL`, `envelope:DEPTH` or `findings`.
pub(super) fn show(text: &str) -> Result<Show, String> {
    let (what, level) = match text.split_once(':') {
        Some((what, level)) => (what, Some(level)),
        None => (text, None),
    };
    let number = |of: fn(usize) -> Show, word: &str| match level.map(str::parse::<usize>) {
        Some(Ok(level)) => Ok(of(level)),
        Some(Err(_)) => Err(format!("a {word} is a number from 0, as in {what}:0")),
        None => Err(format!("which {word}? Say {what}:0, or a higher number")),
    };
    match (what, level) {
        ("classes", None) => Ok(Show::Classes),
        ("patches", None) => Ok(Show::Patches),
        ("findings", None) => Ok(Show::Findings),
        ("boxes", _) => number(Show::Boxes, "level"),
        ("envelope", _) => number(Show::Envelope, "depth"),
        ("classes" | "patches" | "findings", Some(_)) => Err(format!("{what} has no levels")),
        _ => Err("choose classes, patches, boxes:LEVEL, envelope:DEPTH or findings".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_shown_is_read_with_its_level() {
        assert_eq!(show("classes"), Ok(Show::Classes));
        assert_eq!(show("boxes:3"), Ok(Show::Boxes(3)));
        assert_eq!(show("envelope:0"), Ok(Show::Envelope(0)));
        for (text, reason) in [
            ("boxes", "which level"),
            ("boxes:-1", "from 0"),
            ("envelope:", "from 0"),
            ("patches:1", "no levels"),
            ("hull", "choose classes"),
            ("", "choose classes"),
        ] {
            assert!(show(text).unwrap_err().contains(reason), "{text}");
        }
    }
}
