//! The edges that the sweep line crosses, from bottom to top: a sorted list cut into short rows, so
//! that insertion and removal move few entries.
//!
//! Source: two levels of a B-tree (Bayer and McCreight 1972, "Organization and maintenance of large
//! ordered indexes"). Cost: O(log s) questions to find a place among s edges; to insert or remove
//! moves at most the entries of a row and, when rows come or go, the list of rows.

/// Rows longer than this are halved. Shorter rows make more of them to search among, longer ones
/// cost more to shift (`it_behaves_as_a_sorted_vector` runs through both).
const LONGEST_ROW: usize = 256;

/// Edges in order. The order itself is the caller's: the list only searches it by a predicate that
/// is true of a lower part.
#[derive(Default)]
pub(super) struct Status {
    /// No row is empty.
    rows: Vec<Vec<u32>>,
}

/// Before an edge, or at the end. Valid until the list changes by other than the call that gave it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Place {
    row: usize,
    column: usize,
}

impl Status {
    pub(super) fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// The first place whose edge is not `below`. `O(log s)` calls for `s` edges.
    pub(super) fn partition(&self, mut below: impl FnMut(u32) -> bool) -> Place {
        let row = self.rows.partition_point(|row| below(row[0])).saturating_sub(1);
        let Some(edges) = self.rows.get(row) else { return Place { row, column: 0 } };
        self.normal(Place { row, column: edges.partition_point(|&e| below(e)) })
    }

    pub(super) fn get(&self, place: Place) -> Option<u32> {
        Some(self.rows.get(place.row)?[place.column])
    }

    pub(super) fn next(&self, place: Place) -> Place {
        self.normal(Place { column: place.column + 1, ..place })
    }

    pub(super) fn previous(&self, place: Place) -> Option<Place> {
        match place.column.checked_sub(1) {
            Some(column) => Some(Place { column, ..place }),
            None => {
                let row = place.row.checked_sub(1)?;
                Some(Place { row, column: self.rows[row].len() - 1 })
            }
        }
    }

    /// The edge before a place.
    pub(super) fn before(&self, place: Place) -> Option<u32> {
        self.get(self.previous(place)?)
    }

    /// Removes the edge at a place, if there is one, and returns the place of the following edge.
    pub(super) fn remove(&mut self, place: Place) -> Place {
        if let Some(row) = self.rows.get_mut(place.row) {
            row.remove(place.column);
            if row.is_empty() {
                self.rows.remove(place.row);
                return Place { row: place.row, column: 0 };
            }
        }
        self.normal(place)
    }

    /// Inserts an edge and returns the place behind it.
    pub(super) fn insert(&mut self, place: Place, edge: u32) -> Place {
        // Ahead of a row means at the end of the row before it, so that one is never started anew.
        let mut place = match (place.column, place.row.checked_sub(1)) {
            (0, Some(row)) => Place { row, column: self.rows[row].len() },
            _ => place,
        };
        if self.rows.is_empty() {
            self.rows.push(Vec::new());
        }
        self.rows[place.row].insert(place.column, edge);
        let length = self.rows[place.row].len();
        if length > LONGEST_ROW {
            let upper = self.rows[place.row].split_off(length / 2);
            self.rows.insert(place.row + 1, upper);
            if place.column >= length / 2 {
                place = Place { row: place.row + 1, column: place.column - length / 2 };
            }
        }
        self.next(place)
    }

    /// A place behind a row's end is the first of the next row.
    fn normal(&self, place: Place) -> Place {
        match self.rows.get(place.row) {
            Some(row) if place.column >= row.len() => Place { row: place.row + 1, column: 0 },
            _ => place,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_behaves_as_a_sorted_vector() {
        let (mut status, mut model) = (Status::default(), Vec::new());
        let mut state = 1u32;
        for round in 0..8000 {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let edge = state >> 8;
            let at = status.partition(|e| e < edge);
            let i = model.partition_point(|&e| e < edge);
            assert_eq!(status.get(at), model.get(i).copied());
            assert_eq!(status.before(at), i.checked_sub(1).map(|i| model[i]));
            if round % 3 == 0 || (3000..4500).contains(&round) {
                let next = status.remove(at);
                if i < model.len() {
                    model.remove(i);
                }
                assert_eq!(status.get(next), model.get(i).copied());
                assert_eq!(status.before(next), i.checked_sub(1).map(|i| model[i]));
            } else {
                let next = status.insert(at, edge);
                model.insert(i, edge);
                assert_eq!(status.before(next), Some(edge));
                assert_eq!(status.get(next), model.get(i + 1).copied());
            }
        }
        let mut place = status.partition(|_| false);
        for &edge in &model {
            assert_eq!(status.get(place), Some(edge));
            place = status.next(place);
        }
        assert_eq!(status.get(place), None);
        assert!(status.rows.len() > 2);
    }
}
