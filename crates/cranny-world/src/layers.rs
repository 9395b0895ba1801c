//! Layers: which bodies may meet at all, whatever is said about their pairs.

/// Which of 32 layers a body is in, and with which it meets, as bits.
///
/// Two bodies meet where each is in a layer that the other meets. The default is in the first layer
/// and meets all.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Layers {
    /// Layers that the body is in; without any it meets nothing.
    pub memberships: u32,
    /// Layers that it meets.
    pub filters: u32,
}

impl Layers {
    /// How many layers there are.
    pub const COUNT: usize = u32::BITS as usize;

    /// In some layers, and meets whoever shares one of them.
    #[must_use]
    pub const fn shared(layers: u32) -> Self {
        Self { memberships: layers, filters: layers }
    }

    /// Whether two bodies may meet; it is the same in either order.
    #[must_use]
    pub const fn meets(self, other: Self) -> bool {
        self.memberships & other.filters != 0 && other.memberships & self.filters != 0
    }
}

impl Default for Layers {
    fn default() -> Self {
        Self { memberships: 1, filters: u32::MAX }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_must_agree_to_meet() {
        let [first, second] = [Layers::shared(1), Layers::shared(2)];
        assert!(first.meets(first) && !first.meets(second) && !second.meets(first));
        assert!(Layers::default().meets(first) && !Layers::default().meets(second));
        let one_sided = Layers { memberships: 2, filters: 1 };
        assert!(!one_sided.meets(first), "the first does not meet the second layer");
        let none = Layers { memberships: 0, filters: u32::MAX };
        assert!(!none.meets(Layers::default()) && !Layers::default().meets(none));
    }
}
