//! A hash of answers, by which two revisions are compared.

use cranny_exact::DVec3;
use cranny_narrow_phase::{Answer, Contact, Feature};

/// FNV-1a over words of 64 bits.
///
/// Fowler, Noll, Vo 1991; here a step takes a whole word.
#[derive(Clone, Copy, Debug)]
pub(super) struct Digest(u64);

impl Default for Digest {
    fn default() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }
}

impl Digest {
    /// Returns the hash of an answer without counters and without region ids, which are history.
    pub(super) fn of(answer: &Answer) -> u64 {
        let mut digest = Self::default();
        digest.word(answer.surface as u64);
        digest.word(u64::from(answer.solid));
        digest.word(answer.contained.map_or(0, |contained| 1 + contained as u64));
        digest.optional(answer.distance);
        for witness in answer.witnesses.iter().flatten() {
            digest.point(witness.point);
            digest.feature(witness.feature);
        }
        answer.contacts.iter().for_each(|contact| digest.contact(contact));
        for region in &answer.regions {
            digest.contact(&region.deepest);
            digest.point(region.normal);
            digest.optional(region.depth);
            digest.optional(region.area);
            region.points.iter().for_each(|point| digest.contact(point));
            digest.word(region.curves.len() as u64);
            for face in region.faces.iter().flatten() {
                digest.word(face.0.into());
            }
        }
        digest.value()
    }

    /// Adds a word.
    pub(super) fn word(&mut self, word: u64) {
        // A product alone never carries high bits to low ones.
        self.0 = (self.0 ^ word).wrapping_mul(0x0000_0100_0000_01b3).rotate_left(29);
    }

    /// Returns the hash of all words so far.
    pub(super) fn value(self) -> u64 {
        self.0 ^ (self.0 >> 32)
    }

    fn number(&mut self, x: f64) {
        // Both zeros are one number.
        self.word((x + 0.0).to_bits());
    }

    fn optional(&mut self, x: Option<f64>) {
        self.word(u64::from(x.is_some()));
        self.number(x.unwrap_or(0.0));
    }

    fn point(&mut self, p: DVec3) {
        p.to_array().into_iter().for_each(|x| self.number(x));
    }

    fn feature(&mut self, feature: Feature) {
        let (kind, id) = match feature {
            Feature::Vertex(vertex) => (0, vertex.0),
            Feature::Edge(edge) => (1, edge.0),
            Feature::Face(face) => (2, face.0),
        };
        self.word(kind << 32 | u64::from(id));
    }

    fn contact(&mut self, contact: &Contact) {
        self.feature(contact.id.0);
        self.feature(contact.id.1);
        self.point(contact.point_a);
        self.point(contact.point_b);
        self.point(contact.normal);
        self.number(contact.separation);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(numbers: &[f64]) -> u64 {
        let mut digest = Digest::default();
        numbers.iter().for_each(|&x| digest.number(x));
        digest.value()
    }

    #[test]
    fn order_and_last_bits_count_and_the_sign_of_zero_does_not() {
        assert_eq!(of(&[1.0, 2.0]), of(&[1.0, 2.0]));
        assert_ne!(of(&[1.0, 2.0]), of(&[2.0, 1.0]));
        assert_ne!(of(&[1.0]), of(&[1.0 + f64::EPSILON]));
        assert_eq!(of(&[0.0]), of(&[-0.0]));
    }
}
