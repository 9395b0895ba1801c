//! From effects to demands.

use cranny_narrow_phase::Demand;

use crate::description::Effect;
use crate::error::WorldError;

/// What a list of effects asks of the narrow phase.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Wish {
    pub(crate) demand: Demand,
}

impl Wish {
    /// The join of what the effects ask. `owner` names whose effects they are, for errors.
    ///
    /// `Response` asks nothing here: the solver's step detects its pairs itself, once, and its
    /// answers come in by [`World::supply`](crate::World::supply).
    pub(crate) fn of(
        effects: &[Effect],
        owner: impl FnOnce() -> String,
    ) -> Result<Self, WorldError> {
        let mut demand = Demand::None;
        for effect in effects {
            demand = demand.join(match *effect {
                Effect::Trigger => Demand::Intersects,
                Effect::Contacts { margin } if margin.is_finite() && margin >= 0.0 => {
                    Demand::Regions { margin }
                }
                Effect::Contacts { margin } => {
                    return Err(WorldError::Margin { owner: owner(), margin });
                }
                Effect::Response => Demand::None,
            });
        }
        Ok(Self { demand })
    }

    /// The margin that the effects ask for; 0 where they ask for none.
    pub(crate) fn margin(&self) -> f64 {
        self.demand.margin().unwrap_or(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn demand(effects: &[Effect]) -> Demand {
        Wish::of(effects, String::new).unwrap().demand
    }

    #[test]
    fn each_effect_asks_its_own() {
        assert_eq!(demand(&[]), Demand::None);
        assert_eq!(demand(&[Effect::Response]), Demand::None);
        assert_eq!(demand(&[Effect::Response, Effect::Trigger]), Demand::Intersects);
        let near = Effect::Contacts { margin: 0.25 };
        let far = Effect::Contacts { margin: 2.0 };
        assert_eq!(demand(&[Effect::Trigger, far, near]), Demand::Regions { margin: 2.0 });
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
