//! How generated worlds are written down: bodies, joints and paths as lines of a scene file.

use std::fmt::Write as _;

use crate::generated::number;

/// Numbers as a scene file lists them.
pub(crate) fn list(numbers: &[f64]) -> String {
    numbers.iter().map(|&x| number(x)).collect::<Vec<_>>().join(", ")
}

/// A scene in the making.
#[derive(Default)]
pub(crate) struct World {
    bodies: String,
    joints: String,
}

/// Where a body stands: a point, and degrees about z.
#[derive(Clone, Copy)]
pub(crate) struct Place(pub(crate) [f64; 3], pub(crate) f64);

impl Place {
    fn text(self) -> String {
        let Self(at, degrees) = self;
        if degrees == 0.0 {
            return format!("(at: ({}))", list(&at));
        }
        format!("(at: ({}), euler_degrees: (0, 0, {}))", list(&at), number(degrees))
    }
}

/// A pose at a time on a path.
pub(crate) struct Stop(pub(crate) f64, pub(crate) Place);

impl World {
    /// A line about a body; `rest` is what it says beyond name, shape and pose.
    pub(crate) fn body(&mut self, name: &str, shape: &str, place: Place, rest: &str) {
        let pose = place.text();
        let _ = writeln!(
            self.bodies,
            "        (name: \"{name}\", shape: Generator({shape}), pose: {pose}, {rest}),"
        );
    }

    pub(crate) fn fixed(&mut self, name: &str, shape: &str, place: Place) {
        self.body(name, shape, place, "kind: Fixed");
    }

    /// A dynamic body of a material.
    pub(crate) fn loose(&mut self, name: &str, shape: &str, place: Place, density: f64) {
        let rest = format!("material: (density: {}, friction: 0.5)", number(density));
        self.body(name, shape, place, &rest);
    }

    /// A body whose orientation is not about z alone.
    pub(crate) fn posed(
        &mut self,
        name: &str,
        shape: &str,
        at: [f64; 3],
        euler: [f64; 3],
        rest: &str,
    ) {
        let _ = writeln!(
            self.bodies,
            "        (name: \"{name}\", shape: Generator({shape}), pose: (at: ({}), euler_degrees: ({})), {rest}),",
            list(&at),
            list(&euler)
        );
    }

    /// A kinematic body on a path.
    pub(crate) fn walker(&mut self, name: &str, shape: &str, stops: &[Stop], rest: &str) {
        let _ = write!(
            self.bodies,
            "        (\n            name: \"{name}\", shape: Generator({shape}), kind: Kinematic, {rest}\n            path: (keyframes: [\n"
        );
        for Stop(time, place) in stops {
            let _ = writeln!(
                self.bodies,
                "                (time: {}, pose: {}),",
                number(*time),
                place.text()
            );
        }
        self.bodies.push_str("            ]),\n        ),\n");
    }

    /// A hinge about z at a point of both bodies' frames; it turns from shut on, against a damper.
    pub(crate) fn hinge(&mut self, [parent, child]: [&str; 2], anchor: Place, limit: f64) {
        let _ = writeln!(
            self.joints,
            "        (name: \"hinge of {child}\", parent: \"{parent}\", child: \"{child}\", parent_anchor: {},\n         kind: Revolute(axis: (0, 0, 1), limits: (0, {})), motor: (stiffness: 0, damping: 8)),",
            anchor.text(),
            number(limit)
        );
    }

    /// A joint about the child's z axis, where it is: `anchor` and `turn` (degrees about the fixed
    /// axes) are those of its frame in the parent. A damper resists.
    pub(crate) fn axle(
        &mut self,
        [parent, child]: [&str; 2],
        anchor: [f64; 3],
        turn: [f64; 3],
        damping: f64,
    ) {
        let _ = writeln!(
            self.joints,
            "        (name: \"axle of {child}\", parent: \"{parent}\", child: \"{child}\", parent_anchor: (at: ({}), euler_degrees: ({})),\n         kind: Revolute(axis: (0, 0, 1)), motor: (stiffness: 0, damping: {})),",
            list(&anchor),
            list(&turn),
            number(damping)
        );
    }

    /// The file: comment lines, settings, and what follows the bodies.
    pub(crate) fn file(&self, comment: &str, settings: &str, rest: &str) -> String {
        let comment: String = comment.lines().map(|line| format!("// {line}\n")).collect();
        let joints = match self.joints.as_str() {
            "" => String::new(),
            joints => format!("    joints: [\n{joints}    ],\n"),
        };
        format!(
            "{comment}(\n    version: 1,\n{settings}    bodies: [\n{}    ],\n{joints}{rest})\n",
            self.bodies
        )
    }
}
