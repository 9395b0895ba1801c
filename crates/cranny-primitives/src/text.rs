//! A primitive as a line of text and back, to the bit: a name and its numbers.

use std::fmt;
use std::str::FromStr;

use cranny_exact::DVec3;
use thiserror::Error;

use crate::primitive::{Ball, Capsule, Cone, Cylinder, HalfSpace, Primitive, Segment};

/// A text that names no primitive.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("'{0}' is no primitive: a name and its numbers, as 'ball 0 0 0 0.5'")]
pub struct UnknownPrimitive(pub String);

/// The name and the numbers of a primitive, in the order of its fields; read back, they are the
/// same to the bit.
impl fmt::Display for Primitive {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [a, b, rest] = parts(self);
        f.write_str(self.name())?;
        a.into_iter().chain(b).chain(rest).try_for_each(|number| write!(f, " {number}"))
    }
}

fn parts(primitive: &Primitive) -> [Vec<f64>; 3] {
    let of = |v: DVec3| v.to_array().to_vec();
    match *primitive {
        Primitive::Ball(Ball { center, radius }) => [of(center), vec![], vec![radius]],
        Primitive::Capsule(Capsule { ends: [a, b], radius }) => [of(a), of(b), vec![radius]],
        Primitive::Segment(Segment { ends: [a, b] }) => [of(a), of(b), vec![]],
        Primitive::Cylinder(Cylinder { center, axis, half_height, radius, border })
        | Primitive::Cone(Cone { center, axis, half_height, radius, border }) => {
            [of(center), of(axis), vec![half_height, radius, border]]
        }
        Primitive::HalfSpace(HalfSpace { point, normal }) => [of(point), of(normal), vec![]],
    }
}

impl FromStr for Primitive {
    type Err = UnknownPrimitive;

    fn from_str(text: &str) -> Result<Self, UnknownPrimitive> {
        let unknown = || UnknownPrimitive(text.to_owned());
        let mut words = text.split_whitespace();
        let name = words.next().ok_or_else(unknown)?;
        let numbers: Result<Vec<f64>, _> = words.map(str::parse).collect();
        read(name, &numbers.map_err(|_| unknown())?).ok_or_else(unknown)
    }
}

fn read(name: &str, numbers: &[f64]) -> Option<Primitive> {
    let v =
        |k: usize| Some(DVec3::new(*numbers.get(k)?, *numbers.get(k + 1)?, *numbers.get(k + 2)?));
    Some(match (name, numbers.len()) {
        ("ball", 4) => Ball { center: v(0)?, radius: numbers[3] }.into(),
        ("capsule", 7) => Capsule { ends: [v(0)?, v(3)?], radius: numbers[6] }.into(),
        ("segment", 6) => Segment { ends: [v(0)?, v(3)?] }.into(),
        ("cylinder", 9) => {
            let (center, axis) = (v(0)?, v(3)?);
            let [half_height, radius, border] = [numbers[6], numbers[7], numbers[8]];
            Cylinder { center, axis, half_height, radius, border }.into()
        }
        ("cone", 9) => {
            let (center, axis) = (v(0)?, v(3)?);
            let [half_height, radius, border] = [numbers[6], numbers[7], numbers[8]];
            Cone { center, axis, half_height, radius, border }.into()
        }
        ("half-space", 6) => HalfSpace { point: v(0)?, normal: v(3)? }.into(),
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read_back_to_the_bit() {
        let at = DVec3::new(0.1, -1.0 / 3.0, 1e-200);
        let (axis, half_height, radius, border) = (DVec3::new(0.6, 0.0, 0.8), 0.7, 1e9 / 7.0, 0.0);
        let all: [Primitive; 6] = [
            Ball { center: at, radius }.into(),
            Capsule { ends: [at, axis], radius }.into(),
            Segment { ends: [at, axis] }.into(),
            Cylinder { center: at, axis, half_height, radius, border }.into(),
            Cone { center: at, axis, half_height, radius, border }.into(),
            HalfSpace { point: at, normal: axis }.into(),
        ];
        for primitive in all {
            assert_eq!(primitive.to_string().parse(), Ok(primitive));
        }
        for wrong in ["", "ball", "ball 1 2 3", "ball 1 2 3 x", "cube 1 2 3 4"] {
            assert!(wrong.parse::<Primitive>().is_err(), "{wrong}");
        }
    }
}
