//! The one palette of pictures, safe for colour-blind readers.
//!
//! Bodies that move are light, bodies that stand still grey, and marks of contact dark and strong,
//! so that what matters differs in lightness too. The body colours are the 'light' scheme of Paul
//! Tol (*Colour schemes*, SRON/EPS/TN/09-002, 2021). `colours_are_apart_for_every_eye` holds all of
//! this to simulated protanopia, deuteranopia and tritanopia (Machado, Oliveira and Fernandes
//! 2009).

use crate::color::Color;

/// Eight light colours; neighbours in this order are far apart, because bodies that touch usually
/// have neighbouring numbers.
const BODIES: [Color; 8] = [
    Color::rgb(0x77, 0xAA, 0xDD),
    Color::rgb(0xEE, 0x88, 0x66),
    Color::rgb(0x44, 0xBB, 0x99),
    Color::rgb(0xFF, 0xAA, 0xBB),
    Color::rgb(0xBB, 0xCC, 0x33),
    Color::rgb(0x99, 0xDD, 0xFF),
    Color::rgb(0xAA, 0xAA, 0x00),
    Color::rgb(0xEE, 0xDD, 0x88),
];

/// Of bodies that stand still.
pub const STATIONARY: Color = Color::rgb(0x7C, 0x82, 0x89);
/// Of what two bodies share, of contacts that overlap, and of their curves.
pub const OVERLAP: Color = Color::rgb(0xB4, 0x00, 0x3C);
/// Of contacts across a gap, and of distances.
pub const GAP: Color = Color::rgb(0x0A, 0x5E, 0x8A);
/// Of what a search does not look at.
pub const COLD: Color = Color::rgb(0xB9, 0xBE, 0xC4);
/// Of words and lines.
pub const INK: Color = Color::rgb(0x1D, 0x24, 0x30);
/// Behind words.
pub const PAPER: Color = Color::rgb(0xFB, 0xFB, 0xFA);

/// Light of a further round through [`BODIES`], in parts of the round before.
const DARKER: f32 = 0.55;

/// Rounds until the colours repeat.
const ROUNDS: usize = 3;

/// The colour of moving body number `index`: eight colours, then the same darker, twice; repeats
/// after 24.
#[must_use]
pub fn palette(index: usize) -> Color {
    let round = (index / BODIES.len()) % ROUNDS;
    let light = DARKER.powi(round as i32);
    let [r, g, b, a] = BODIES[index % BODIES.len()].to_linear();
    Color::from_linear([light * r, light * g, light * b, a])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn distance(a: Color, b: Color) -> f32 {
        let d = |x: u8, y: u8| (f32::from(x) - f32::from(y)).powi(2);
        (d(a.r, b.r) + d(a.g, b.g) + d(a.b, b.b)).sqrt()
    }

    /// Rows of the maps of linear light, severity 1.
    const EYES: [(&str, [[f32; 3]; 3]); 4] = [
        ("usual", [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]),
        ("protanopia", [[0.152, 1.053, -0.205], [0.115, 0.786, 0.099], [-0.004, -0.048, 1.052]]),
        ("deuteranopia", [[0.367, 0.861, -0.228], [0.280, 0.673, 0.047], [-0.012, 0.043, 0.969]]),
        ("tritanopia", [[1.256, -0.077, -0.179], [-0.078, 0.931, 0.148], [0.005, 0.691, 0.304]]),
    ];

    fn seen(rows: &[[f32; 3]; 3], color: Color) -> Color {
        let [r, g, b, a] = color.to_linear();
        let [x, y, z] = rows.map(|row| row[0] * r + row[1] * g + row[2] * b);
        Color::from_linear([x, y, z, a])
    }

    #[test]
    fn colours_are_apart_for_every_eye() {
        for (eye, rows) in &EYES {
            let bodies: Vec<Color> = (0..8).map(|i| seen(rows, palette(i))).collect();
            for (i, &a) in bodies.iter().enumerate() {
                for &b in &bodies[..i] {
                    assert!(distance(a, b) > 35.0, "{eye}, {i}: {a:?} {b:?}");
                }
                for mark in [OVERLAP, GAP, INK] {
                    let apart = distance(a, seen(rows, mark));
                    assert!(apart > 80.0, "{eye}, {i} and {mark:?}: {apart}");
                }
                assert!(distance(a, seen(rows, STATIONARY)) > 35.0, "{eye}, {i}: {a:?}");
            }
        }
    }

    #[test]
    fn palette_colours_can_be_told_apart() {
        for i in 0..24 {
            for j in 0..i {
                let (a, b) = (palette(i), palette(j));
                assert!(distance(a, b) > 16.0, "{i} and {j}: {a:?} {b:?}");
            }
            let next = distance(palette(i), palette(i + 1));
            assert!(next > 60.0, "{i} and its neighbour: {next}");
        }
        assert_eq!(palette(3), palette(27));
    }
}
