//! From effects, and what somebody reads of them, to fields of answers.

use cranny_narrow_phase::Fields;

use crate::description::{Accuracy, Effect};
use crate::error::WorldError;

/// What of the effect `Contacts` somebody reads; the effect says for which pairs, and how far
/// apart.
///
/// Each field costs its own: a depth is read off contacts where bodies overlap, points are contacts
/// up to the margin, and only regions bring curves and areas. The default is all of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactFields {
    /// How deep the bodies overlap, where that is deeper than this, >= 0: by the deepest contact,
    /// or by regions where they are read too.
    pub depth: Option<f64>,
    /// Contact points with their normals, up to the margin.
    pub points: bool,
    /// Regions with curves, depths and areas, up to the margin.
    pub regions: bool,
}

impl Default for ContactFields {
    fn default() -> Self {
        Self::ALL
    }
}

impl ContactFields {
    /// Everything.
    pub const ALL: Self = Self { depth: Some(0.0), points: true, regions: true };
    /// Nothing.
    pub const NONE: Self = Self { depth: None, points: false, regions: false };

    /// What either reader reads.
    #[must_use]
    pub fn join(self, other: Self) -> Self {
        let both = self.depth.zip(other.depth).map(|(a, b)| a.min(b));
        Self {
            depth: both.or(self.depth).or(other.depth),
            points: self.points || other.points,
            regions: self.regions || other.regions,
        }
    }

    /// The fields of an answer that these are, up to a margin.
    #[must_use]
    pub fn within(self, margin: f64) -> Fields {
        Fields {
            depth: self.depth,
            contacts: self.points.then_some(margin),
            regions: self.regions.then_some(margin),
            ..Fields::NONE
        }
    }

    /// Their names: "depth", "points", "regions".
    pub fn names(self) -> impl Iterator<Item = &'static str> {
        let named =
            [("depth", self.depth.is_some()), ("points", self.points), ("regions", self.regions)];
        named.into_iter().filter(|(_, read)| *read).map(|(name, _)| name)
    }
}

/// What a list of effects needs.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Wish {
    verdict: bool,
    /// Depth and way out.
    overlap: bool,
    /// The distance of `Proximity`.
    within: Option<f64>,
    /// The margin of `Contacts`.
    contacts: Option<f64>,
    /// The tolerance of `Tracking`.
    tolerance: Option<f64>,
    levels: Levels,
}

/// At which level a list of effects wants answers.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Levels {
    /// The level that triggers and distances state.
    stated: Option<Accuracy>,
    /// Some of them state none.
    unstated: bool,
    /// Some effect needs exact contacts.
    exact: bool,
    /// Some effect works on what the solver does, which needs exact contacts where there is one.
    pushes: bool,
}

impl Levels {
    fn of(effect: &Effect) -> Self {
        let stated = effect.stated_level();
        let (pushes, has_levels) = (effect.pushes(), effect.has_levels());
        Self {
            stated,
            unstated: has_levels && stated.is_none(),
            exact: !has_levels && !pushes,
            pushes,
        }
    }

    fn join(self, other: Self) -> Self {
        let both = self.stated.zip(other.stated).map(|(a, b)| a.join(b));
        Self {
            stated: both.or(self.stated).or(other.stated),
            unstated: self.unstated || other.unstated,
            exact: self.exact || other.exact,
            pushes: self.pushes || other.pushes,
        }
    }
}

impl Wish {
    /// What the effects need together. `owner` names whose effects they are, for errors.
    ///
    /// `Response` needs nothing here: the solver's step detects its pairs itself, once, and its
    /// answers come in by [`World::supply`](crate::World::supply).
    pub(crate) fn of(
        effects: &[Effect],
        owner: impl FnOnce() -> String,
    ) -> Result<Self, WorldError> {
        let mut wish = Self::default();
        for effect in effects {
            wish.levels = wish.levels.join(Levels::of(effect));
            wish = wish.join(match *effect {
                Effect::Trigger { .. } => Self { verdict: true, ..Self::default() },
                Effect::Proximity { within, .. } if within.is_finite() && within > 0.0 => {
                    Self { within: Some(within), ..Self::default() }
                }
                Effect::Proximity { within, .. } => {
                    return Err(WorldError::Proximity { owner: owner(), within });
                }
                Effect::Contacts { margin } if margin.is_finite() && margin >= 0.0 => {
                    Self { contacts: Some(margin), ..Self::default() }
                }
                Effect::Contacts { margin } => {
                    return Err(WorldError::Margin { owner: owner(), margin });
                }
                Effect::Tracking { tolerance } => {
                    Self { tolerance: Some(tolerance), ..Self::default() }
                }
                Effect::Penetration => Self { overlap: true, ..Self::default() },
                Effect::Response
                | Effect::Continuous
                | Effect::Sound { .. }
                | Effect::Deformation { .. }
                | Effect::ForceFeedback { .. } => Self::default(),
            });
        }
        match effects.iter().find_map(refused_parameter) {
            Some((effect, parameter, value)) => {
                Err(WorldError::Parameter { effect, parameter, owner: owner(), value })
            }
            None => Ok(wish),
        }
    }

    /// What either needs.
    pub(crate) fn join(self, other: Self) -> Self {
        let larger = |a: Option<f64>, b: Option<f64>| match (a, b) {
            (Some(a), Some(b)) => Some(a.max(b)),
            (a, b) => a.or(b),
        };
        Self {
            verdict: self.verdict || other.verdict,
            overlap: self.overlap || other.overlap,
            within: larger(self.within, other.within),
            contacts: larger(self.contacts, other.contacts),
            levels: self.levels.join(other.levels),
            tolerance: larger(self.tolerance, other.tolerance),
        }
    }

    /// The level of a pair: the most exact of its effects. Those that state none are at
    /// `unstated`, those that need contacts are exact. With a `sensor` nobody pushes.
    pub(crate) fn accuracy(&self, unstated: Accuracy, sensor: bool) -> Accuracy {
        if !self.may_stay_open(sensor) {
            return Accuracy::Exact;
        }
        let unstated = self.levels.unstated.then_some(unstated);
        let levels = self.levels.stated.into_iter().chain(unstated);
        levels.reduce(Accuracy::join).unwrap_or_default()
    }

    /// Whether a budget may leave answers open: where the pair has triggers and distances alone.
    pub(crate) fn may_stay_open(&self, sensor: bool) -> bool {
        !self.levels.exact && (sensor || !self.levels.pushes)
    }

    /// The fields that this takes, if so much of `Contacts` is read.
    pub(crate) fn fields(self, read: ContactFields) -> Fields {
        let regions = self.overlap.then_some(0.0);
        let verdict = self.verdict || self.overlap;
        // A verdict with a tolerance is one of depths and gaps up to it.
        let contacts = self.tolerance.filter(|_| self.verdict);
        let own = Fields { verdict, distance: self.within, regions, contacts, depth: None };
        self.contacts.map_or(own, |margin| own.join(read.within(margin)))
    }

    /// Up to which gap the effects need answers; 0 where they need none across gaps.
    pub(crate) fn margin(&self) -> f64 {
        [self.contacts, self.within, self.tolerance].into_iter().flatten().fold(0.0, f64::max)
    }
}

/// The first parameter that must be a finite number above zero and is none: effect, name, value.
fn refused_parameter(effect: &Effect) -> Option<(&'static str, &'static str, f64)> {
    let parameters: &[(&str, f64)] = match *effect {
        Effect::Sound { above } => &[("above", above)],
        Effect::Deformation { hardness, radius } => &[("hardness", hardness), ("radius", radius)],
        Effect::ForceFeedback { stiffness } => &[("stiffness", stiffness)],
        Effect::Tracking { tolerance } => &[("tolerance", tolerance)],
        _ => &[],
    };
    let mut refused = parameters.iter().filter(|(_, value)| !(*value > 0.0 && value.is_finite()));
    refused.next().map(|&(parameter, value)| (effect.name(), parameter, value))
}

#[cfg(test)]
mod tests {
    use cranny_narrow_phase::Demand;

    use super::*;

    fn demand(effects: &[Effect], read: ContactFields) -> Demand {
        Wish::of(effects, String::new).unwrap().fields(read).demand()
    }

    #[test]
    fn each_effect_asks_its_own() {
        let demand = |effects: &[Effect]| demand(effects, ContactFields::default());
        assert_eq!(demand(&[]), Demand::None);
        assert_eq!(demand(&[Effect::Response]), Demand::None);
        assert_eq!(demand(&[Effect::Response, Effect::TRIGGER]), Demand::Intersects);
        let near = Effect::Contacts { margin: 0.25 };
        let far = Effect::Contacts { margin: 2.0 };
        assert_eq!(demand(&[Effect::TRIGGER, far, near]), Demand::Regions { margin: 2.0 });
        let distance = Effect::proximity;
        let of_both = demand(&[Effect::TRIGGER, distance(3.0), distance(0.5)]);
        assert_eq!(of_both, Demand::Distance { below: Some(3.0) });
        let overlap = demand(&[Effect::Penetration]);
        assert_eq!(overlap, Demand::Regions { margin: 0.0 });
        assert_eq!(demand(&[Effect::Penetration, near]), Demand::Regions { margin: 0.25 });
        let of_others = [
            Effect::Sound { above: 1.0 },
            Effect::Deformation { hardness: 1.0, radius: 1.0 },
            Effect::ForceFeedback { stiffness: 1.0 },
            Effect::Tracking { tolerance: 1.0 },
        ];
        assert_eq!(demand(&of_others), Demand::None);
        // A verdict within a tolerance reads how deep, and how far apart.
        let tracked = [Effect::TRIGGER, Effect::Tracking { tolerance: 0.5 }];
        assert_eq!(demand(&tracked), Demand::contacts(0.5));
    }

    #[test]
    fn contacts_ask_for_what_is_read() {
        let effects = [Effect::Contacts { margin: 0.25 }];
        let [depth, points, regions] = [
            ContactFields { depth: Some(0.0), ..ContactFields::NONE },
            ContactFields { points: true, ..ContactFields::NONE },
            ContactFields { regions: true, ..ContactFields::NONE },
        ];
        assert_eq!(demand(&effects, ContactFields::NONE), Demand::None);
        assert_eq!(demand(&effects, depth), Demand::contacts(0.0));
        assert_eq!(demand(&effects, points.join(depth)), Demand::contacts(0.25));
        assert_eq!(demand(&effects, regions.join(depth)), Demand::Regions { margin: 0.25 });
        assert_eq!(demand(&[Effect::TRIGGER], ContactFields::NONE), Demand::Intersects);
        assert_eq!(points.join(regions).names().collect::<Vec<_>>(), ["points", "regions"]);
        assert_eq!(depth.join(points).join(regions), ContactFields::ALL);
    }

    #[test]
    fn the_most_exact_of_a_pairs_levels_counts_and_what_needs_contacts_is_exact() {
        use Accuracy::{Caps, Exact, Hulls, Tree};
        let trigger = |level| Effect::Trigger { accuracy: Some(level) };
        let near = |level| Effect::Proximity { within: 1.0, accuracy: Some(level) };
        let level = |effects: &[Effect], unstated, sensor| {
            Wish::of(effects, String::new).unwrap().accuracy(unstated, sensor)
        };
        let pairs = |effects: &[Effect]| level(effects, Hulls, false);
        assert_eq!(pairs(&[trigger(Caps)]), Caps, "what is stated counts");
        assert_eq!(level(&[trigger(Hulls)], Exact, false), Hulls, "also where it is coarser");
        assert_eq!(pairs(&[Effect::TRIGGER]), Hulls);
        assert_eq!(pairs(&[Effect::TRIGGER, near(Caps)]), Caps);
        assert_eq!(pairs(&[trigger(Tree(2)), near(Tree(5))]), Tree(5));
        assert_eq!(pairs(&[trigger(Hulls), near(Tree(5))]), Exact, "neither holds the other");
        for needs_contacts in [Effect::Contacts { margin: 0.0 }, Effect::Penetration] {
            assert_eq!(pairs(&[trigger(Hulls), needs_contacts]), Exact);
            assert_eq!(level(&[trigger(Hulls), needs_contacts], Hulls, true), Exact);
        }
        assert_eq!(pairs(&[trigger(Hulls), Effect::Response]), Exact);
        assert_eq!(level(&[trigger(Hulls), Effect::Response], Exact, true), Hulls, "a sensor");
        let open = |effects: &[Effect], sensor| {
            Wish::of(effects, String::new).unwrap().may_stay_open(sensor)
        };
        assert!(open(&[Effect::TRIGGER], false) && open(&[Effect::Response], true));
        assert!(!open(&[Effect::Response], false) && !open(&[Effect::Penetration], true));
    }

    #[test]
    fn a_parameter_that_is_none_is_refused_by_name() {
        for value in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            let cases = [
                (Effect::Sound { above: value }, "`above` of Sound"),
                (Effect::Deformation { hardness: value, radius: 1.0 }, "`hardness` of Deformation"),
                (Effect::Deformation { hardness: 1.0, radius: value }, "`radius` of Deformation"),
                (Effect::ForceFeedback { stiffness: value }, "`stiffness` of ForceFeedback"),
                (Effect::Tracking { tolerance: value }, "`tolerance` of Tracking"),
            ];
            for (effect, says) in cases {
                let error = Wish::of(&[effect], || "body 'hook'".into()).unwrap_err().to_string();
                assert!(error.starts_with(&format!("{says} of body 'hook' is {value}")), "{error}");
            }
        }
    }

    #[test]
    fn a_margin_must_be_a_length() {
        for margin in [-1e-9, f64::NAN, f64::INFINITY] {
            let error = Wish::of(&[Effect::Contacts { margin }], || "the scene".into());
            let message = error.unwrap_err().to_string();
            assert!(message.contains("the scene") && message.contains(&margin.to_string()));
        }
    }
}
