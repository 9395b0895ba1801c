//! What was found about a pair, in 128 bits: two answers have one digest where they agree to the
//! bit.

use cranny_exact::DVec3;
use cranny_narrow_phase::{Answer, Contact, Containment, Feature, Region, Surface};

/// Hash of the fields of an answer that are a function of models, poses and margin alone: verdicts,
/// containment, and regions with their points and curves. Names of regions, counters, distances and
/// contacts for a solver are left out: history and other readers decide what they are. So are
/// normals across a gap, whose last bit depends on what a pair remembers; the points on both sides
/// are in.
#[must_use]
pub fn answer_digest(answer: &Answer) -> String {
    let mut hash = Hash(blake3::Hasher::new());
    hash.number(match answer.surface {
        Surface::None => 0,
        Surface::Touch => 1,
        Surface::Cross => 2,
    });
    hash.number(u64::from(answer.solid));
    hash.number(match answer.contained {
        None => 0,
        Some(Containment::AInB) => 1,
        Some(Containment::BInA) => 2,
    });
    hash.number(answer.regions.len() as u64);
    answer.regions.iter().for_each(|region| hash.region(region));
    hash.0.finalize().to_hex()[..DIGITS].to_owned()
}

/// Hexadecimal digits of a digest.
const DIGITS: usize = 32;

struct Hash(blake3::Hasher);

impl Hash {
    fn number(&mut self, number: u64) {
        self.0.update(&number.to_le_bytes());
    }

    fn float(&mut self, x: f64) {
        self.number(x.to_bits());
    }

    fn optional(&mut self, x: Option<f64>) {
        self.number(u64::from(x.is_some()));
        self.float(x.unwrap_or_default());
    }

    fn vector(&mut self, v: DVec3) {
        v.to_array().into_iter().for_each(|x| self.float(x));
    }

    fn feature(&mut self, feature: Feature) {
        let (kind, id) = match feature {
            Feature::Vertex(id) => (0, id.0),
            Feature::Edge(id) => (1, id.0),
            Feature::Face(id) => (2, id.0),
        };
        self.number(kind << 32 | u64::from(id));
    }

    /// The points on either side of a gap say which way it is.
    fn normal(&mut self, normal: DVec3, separation: f64) {
        if separation <= 0.0 {
            self.vector(normal);
        }
    }

    fn contact(&mut self, contact: &Contact) {
        self.feature(contact.id.0);
        self.feature(contact.id.1);
        self.vector(contact.point_a);
        self.vector(contact.point_b);
        self.float(contact.separation);
        self.normal(contact.normal, contact.separation);
    }

    fn region(&mut self, region: &Region) {
        self.contact(&region.deepest);
        self.normal(region.normal, region.deepest.separation);
        self.optional(region.depth);
        self.optional(region.area);
        self.number(u64::from(region.triangle_pairs));
        self.number(region.points.len() as u64);
        region.points.iter().for_each(|point| self.contact(point));
        self.number(region.curves.len() as u64);
        for curve in &region.curves {
            self.number(u64::from(curve.closed));
            self.number(curve.points.len() as u64);
            curve.points.iter().for_each(|&point| self.vector(point));
        }
    }
}
