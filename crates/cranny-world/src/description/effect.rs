//! The effects that a scene can name: where a new one begins.

use cranny_estimate::Accuracy;

/// What a scene names; nothing else is computed, allocated or scheduled.
///
/// To add an effect, begin with a variant here and go on by CONTRIBUTING.md, 'An effect': it lists
/// every place.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Effect {
    /// Overlap began and ended: yes or no.
    Trigger {
        /// How exactly that is known; `None`: at the level of the pair, or else of the scene.
        accuracy: Option<Accuracy>,
    },
    /// Distance and nearest points of pairs whose surfaces are nearer than `within` (of those that
    /// cross, the distance 0 alone); what is farther apart costs the broad phase only.
    Proximity {
        /// Distance up to which pairs are reported, > 0.
        within: f64,
        /// How exactly it is known; `None`: at the level of the pair, or else of the scene.
        accuracy: Option<Accuracy>,
    },
    /// Contact points, curves and regions up to `margin` apart: as much of it as somebody reads
    /// ([`ContactFields`](crate::ContactFields)).
    Contacts {
        /// Separation up to which near contacts are reported, >= 0.
        margin: f64,
    },
    /// Rigid bodies through rapier.
    Response,
    /// A body passes through no other one, nor any through it, however fast. It needs `Response`.
    Continuous,
    /// How deep bodies overlap, and a way out, for whoever has no solver.
    Penetration,
    /// What is to be heard: impacts, sliding, rolling. It needs `Response`.
    Sound {
        /// Speed above which a collision, sliding or rolling is heard, > 0, units of length a
        /// second.
        above: f64,
    },
    /// Dents that stay where bodies are hit. It needs `Response`.
    Deformation {
        /// Energy that it takes to displace a unit of volume, > 0: the pressure at which the
        /// material yields.
        hardness: f64,
        /// How far from where it is hit a body yields, > 0.
        radius: f64,
    },
    /// Force and torque on kinematic bodies that somebody moves, at 1 kHz.
    ForceFeedback {
        /// Force a unit of length by which a body is moved into another one, > 0.
        stiffness: f64,
    },
    /// What [`Trigger`](Self::Trigger) says of pairs whose poses are known to a tolerance only: it
    /// begins and ends where that is certain. It needs `Trigger`.
    Tracking {
        /// By how much poses misplace a point of a body at most, > 0, units of length.
        tolerance: f64,
    },
}

impl Effect {
    /// `Trigger` that states no level.
    pub const TRIGGER: Self = Self::Trigger { accuracy: None };

    /// `Proximity` up to a distance, that states no level.
    #[must_use]
    pub const fn proximity(within: f64) -> Self {
        Self::Proximity { within, accuracy: None }
    }

    /// Whether it can be known at a level or within a budget: others need exact contacts.
    #[must_use]
    pub fn has_levels(&self) -> bool {
        matches!(self, Self::Trigger { .. } | Self::Proximity { .. })
    }

    /// Whether it works on the meshes of bodies, so that a primitive has no part in it.
    #[must_use]
    pub fn works_on_meshes(&self) -> bool {
        matches!(self, Self::Deformation { .. } | Self::ForceFeedback { .. })
    }

    /// Whether it works on what a solver does, which has no part in the pairs of sensors.
    #[must_use]
    pub fn pushes(&self) -> bool {
        match self {
            Self::Response
            | Self::Continuous
            | Self::Sound { .. }
            | Self::Deformation { .. }
            | Self::ForceFeedback { .. } => true,
            Self::Trigger { .. }
            | Self::Proximity { .. }
            | Self::Contacts { .. }
            | Self::Penetration
            | Self::Tracking { .. } => false,
        }
    }

    /// The level that it states; `None` where it states none.
    #[must_use]
    pub fn stated_level(&self) -> Option<Accuracy> {
        match *self {
            Self::Trigger { accuracy } | Self::Proximity { accuracy, .. } => accuracy,
            _ => None,
        }
    }

    /// The level at which a pair with it is known: the one that it states or else this one, or
    /// `Exact` for what needs contacts.
    #[must_use]
    pub fn level(&self, unstated: Accuracy) -> Accuracy {
        match self.has_levels() {
            true => self.stated_level().unwrap_or(unstated),
            false => Accuracy::Exact,
        }
    }

    /// The same effect, stating another level; unchanged where levels mean nothing.
    #[must_use]
    pub fn stating(self, accuracy: Option<Accuracy>) -> Self {
        match self {
            Self::Trigger { .. } => Self::Trigger { accuracy },
            Self::Proximity { within, .. } => Self::Proximity { within, accuracy },
            other => other,
        }
    }

    /// Its name in scene files.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Self::Trigger { .. } => "Trigger",
            Self::Proximity { .. } => "Proximity",
            Self::Contacts { .. } => "Contacts",
            Self::Response => "Response",
            Self::Continuous => "Continuous",
            Self::Penetration => "Penetration",
            Self::Sound { .. } => "Sound",
            Self::Deformation { .. } => "Deformation",
            Self::ForceFeedback { .. } => "ForceFeedback",
            Self::Tracking { .. } => "Tracking",
        }
    }
}
