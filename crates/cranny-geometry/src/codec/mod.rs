//! How prepared structures become bytes and come back: little-endian, flat, the same on every
//! machine.
//!
//! A model file ([`crate::model`]'s `file`) is a head and sections; the codec of a section stands
//! beside the structure it is of. What is written is what cannot be had more cheaply from what was
//! read before: boxes, owners and adjacency are made again while loading, so they cannot lie.
//!
//! **Nothing that is read is believed.** A checksum shows accidents, not malice: whoever writes a
//! file can write its checksum. So every index, range, order and float is checked where it is read,
//! with the structure's own needs in mind: no later code may panic, or run in circles, for what a
//! file says. Memory is bounded by the bytes present: a list is as long as the bytes that follow
//! allow.

mod checksum;
mod reader;
mod rows;
mod writer;

pub(crate) use checksum::checksum;
pub(crate) use reader::Reader;
pub(crate) use rows::{check_each_once, check_rows, owners_of_rows};
pub(crate) use writer::Writer;

use std::fmt;

use cranny_exact::DVec3;

/// What is wrong with a section.
#[derive(Debug)]
pub(crate) struct Flaw(pub(crate) String);

impl<T: fmt::Display> From<T> for Flaw {
    fn from(what: T) -> Self {
        Self(what.to_string())
    }
}

/// A condition on what was read.
pub(crate) fn check(holds: bool, flaw: &str) -> Result<(), Flaw> {
    if holds { Ok(()) } else { Err(flaw.into()) }
}

/// Something of fixed size.
pub(crate) trait Plain: Copy {
    /// Bytes.
    const SIZE: usize;
    /// Appends its bytes.
    fn put(self, out: &mut Vec<u8>);
    /// From exactly [`SIZE`](Self::SIZE) bytes.
    fn get(bytes: &[u8]) -> Self;

    /// From as many bytes as several take, one behind the other.
    fn get_all(bytes: &[u8]) -> Vec<Self> {
        bytes.chunks_exact(Self::SIZE).map(Self::get).collect()
    }

    /// The same of arrays of them.
    fn get_arrays<const N: usize>(bytes: &[u8]) -> Vec<[Self; N]> {
        bytes.chunks_exact(N * Self::SIZE).map(Plain::get).collect()
    }
}

macro_rules! number {
    ($($number:ty),*) => {$(
        impl Plain for $number {
            const SIZE: usize = size_of::<$number>();

            fn put(self, out: &mut Vec<u8>) {
                out.extend_from_slice(&self.to_le_bytes());
            }

            #[inline(always)]
            fn get(bytes: &[u8]) -> Self {
                let mut own = [0; Self::SIZE];
                own.copy_from_slice(bytes);
                Self::from_le_bytes(own)
            }

            // A copy, where memory is little-endian too.
            fn get_all(bytes: &[u8]) -> Vec<Self> {
                let (items, _) = bytes.as_chunks();
                items.iter().map(|&item| Self::from_le_bytes(item)).collect()
            }

            // Likewise.
            fn get_arrays<const N: usize>(bytes: &[u8]) -> Vec<[Self; N]> {
                let (items, _) = bytes.as_chunks();
                let (arrays, _) = items.as_chunks::<N>();
                arrays.iter().map(|array| array.map(Self::from_le_bytes)).collect()
            }
        }
    )*};
}
number!(u8, u32, u64, f64);

impl<T: Plain, const N: usize> Plain for [T; N] {
    const SIZE: usize = N * T::SIZE;

    fn put(self, out: &mut Vec<u8>) {
        self.into_iter().for_each(|item| item.put(out));
    }

    #[inline(always)]
    fn get(bytes: &[u8]) -> Self {
        std::array::from_fn(|i| T::get(&bytes[i * T::SIZE..(i + 1) * T::SIZE]))
    }

    fn get_all(bytes: &[u8]) -> Vec<Self> {
        T::get_arrays(bytes)
    }
}

/// Makes a struct [`Plain`], field by field: a field left out does not compile.
macro_rules! plain_struct {
    ($name:ident($kind:ty)) => {
        impl $crate::codec::Plain for $name {
            const SIZE: usize = <$kind as $crate::codec::Plain>::SIZE;

            fn put(self, out: &mut Vec<u8>) {
                let Self(own) = self;
                $crate::codec::Plain::put(own, out);
            }

            #[inline(always)]
            fn get(bytes: &[u8]) -> Self {
                Self($crate::codec::Plain::get(bytes))
            }

            fn get_all(bytes: &[u8]) -> Vec<Self> {
                let (items, _) = bytes.as_chunks::<{ <$name as $crate::codec::Plain>::SIZE }>();
                items.iter().map(|item| $crate::codec::Plain::get(item)).collect()
            }
        }
    };
    ($name:ident { $($field:ident: $kind:ty),* $(,)? }) => {
        impl $crate::codec::Plain for $name {
            const SIZE: usize = 0 $(+ <$kind as $crate::codec::Plain>::SIZE)*;

            fn put(self, out: &mut Vec<u8>) {
                let Self { $($field),* } = self;
                $($crate::codec::Plain::put($field, out);)*
            }

            #[allow(unused_assignments, reason = "the last field advances for nobody")]
            #[inline(always)]
            fn get(bytes: &[u8]) -> Self {
                let mut at = 0;
                $(
                    let size = <$kind as $crate::codec::Plain>::SIZE;
                    let $field = $crate::codec::Plain::get(&bytes[at..at + size]);
                    at += size;
                )*
                Self { $($field),* }
            }

            // Of a length known when compiled: no check is left in the loop.
            fn get_all(bytes: &[u8]) -> Vec<Self> {
                let (items, _) = bytes.as_chunks::<{ <$name as $crate::codec::Plain>::SIZE }>();
                items.iter().map(|item| $crate::codec::Plain::get(item)).collect()
            }
        }
    };
}
pub(crate) use plain_struct;

plain_struct!(DVec3 { x: f64, y: f64, z: f64 });

/// Whether all are below a limit; looks at all, which is quicker than stopping at the first that is
/// not.
pub(crate) fn check_below(
    indices: impl IntoIterator<Item = u32>,
    limit: usize,
    flaw: &str,
) -> Result<(), Flaw> {
    let limit = u32::try_from(limit).unwrap_or(u32::MAX);
    check(!indices.into_iter().fold(false, |is_beyond, i| is_beyond | (i >= limit)), flaw)
}

/// Whether a vector has length 1, to rounding.
pub(crate) fn is_unit(v: DVec3) -> bool {
    const ROUNDING: f64 = 16.0 * f64::EPSILON;
    (v.length_squared() - 1.0).abs() <= ROUNDING
}

/// Whether a number is one, and not negative.
pub(crate) fn is_size(x: f64) -> bool {
    x.is_finite() & (x >= 0.0)
}

/// Whether a number can say how flat is flat: not negative, infinite where everything is.
pub(crate) fn is_flatness(x: f64) -> bool {
    x >= 0.0
}
