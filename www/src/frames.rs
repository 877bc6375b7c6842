//! What is kept of a run to be drawn again, within a budget of memory.

use crate::solid::contact::Contact;

/// The maps of a run, single precision, within a budget of memory, each with its contacts if it has any. When it is
/// exceeded every second map is dropped, the first and the newest kept; the numbers of all stay in [`Run::records`].
#[derive(Debug, Clone)]
pub struct Frames {
    kept: Vec<Kept>,
    stride: usize,
    budget: usize,
}

/// What is kept of an iterate.
#[derive(Debug, Clone)]
struct Kept {
    index: usize,
    map: Vec<f32>,
    contacts: Vec<Contact>,
}

impl Kept {
    fn bytes(&self) -> usize {
        size_of_val(&self.map[..]).max(4) + size_of_val(&self.contacts[..])
    }
}

impl Frames {
    /// An empty history of at most `budget` bytes.
    pub fn new(budget: usize) -> Self {
        Self {
            kept: Vec::new(),
            stride: 1,
            budget,
        }
    }

    /// Forgets everything.
    pub fn clear(&mut self) {
        *self = Self::new(self.budget);
    }

    /// Adds the map of iterate `index`; indices grow.
    pub fn push(&mut self, index: usize, map: Vec<f32>) {
        self.push_with(index, map, Vec::new());
    }

    /// Adds the map of iterate `index` with its contacts; indices grow.
    pub fn push_with(&mut self, index: usize, map: Vec<f32>, contacts: Vec<Contact>) {
        let new = Kept {
            index,
            map,
            contacts,
        };
        // The newest is always kept; it goes when the next one comes, unless it is on the stride.
        if self.kept.len() > 1 && self.kept.last().is_some_and(|k| k.index % self.stride != 0) {
            self.kept.pop();
        }
        while self.kept.len() > 2 && self.bytes() + new.bytes() > self.budget {
            self.stride *= 2;
            let stride = self.stride;
            self.kept.retain(|k| k.index % stride == 0);
        }
        self.kept.push(new);
    }

    fn bytes(&self) -> usize {
        self.kept.iter().map(Kept::bytes).sum()
    }

    /// The newest kept map at or before iterate `index`, with its own index.
    pub fn at(&self, index: usize) -> Option<(usize, &[f32])> {
        let after = self.kept.partition_point(|k| k.index <= index);
        self.kept
            .get(after.saturating_sub(1))
            .map(|k| (k.index, k.map.as_slice()))
    }

    /// The contacts of iterate `index`, if its map is kept.
    pub fn contacts(&self, index: usize) -> Option<&[Contact]> {
        let place = self.kept.binary_search_by_key(&index, |k| k.index).ok()?;
        Some(&self.kept[place].contacts)
    }

    /// How many maps are kept.
    pub fn len(&self) -> usize {
        self.kept.len()
    }

    /// Whether none is.
    pub fn is_empty(&self) -> bool {
        self.kept.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_frame_is_kept_within_the_budget() {
        let mut frames = Frames::new(4 * 10 * 100);
        (0..100).for_each(|i| frames.push(i, vec![i as f32; 10]));
        assert_eq!(frames.len(), 100);
        assert!((0..100).all(|i| frames.at(i) == Some((i, &[i as f32; 10][..]))));
    }

    #[test]
    fn a_full_history_is_thinned_and_keeps_its_ends() {
        let mut frames = Frames::new(4 * 10 * 16);
        for i in 0..1000 {
            frames.push(i, vec![i as f32; 10]);
            assert!(frames.len() <= 17);
            assert_eq!(frames.at(i).map(|(k, _)| k), Some(i), "the newest is there");
            assert_eq!(frames.at(0).map(|(k, _)| k), Some(0), "the start is there");
        }
        assert!(frames.len() >= 8);
        let (k, map) = frames.at(500).unwrap();
        assert!(k <= 500 && 500 - k < 128 && map[0] == k as f32);
    }

    #[test]
    fn contacts_go_with_their_map_and_count() {
        let contact = Contact {
            vertices: [0, 1, 2, 3],
            edges: false,
            active: true,
            zone: 0,
        };
        let bytes = 40 + 5 * size_of::<Contact>();
        let mut frames = Frames::new(16 * bytes);
        for i in 0..100 {
            frames.push_with(i, vec![0.0; 10], vec![contact; 5]);
            assert!(frames.bytes() <= 17 * bytes);
            assert_eq!(frames.contacts(i).map(<[_]>::len), Some(5), "of the newest");
        }
        assert!(
            frames.contacts(1).is_none(),
            "its map was dropped: {frames:?}"
        );
        // many contacts make room for themselves
        let before = frames.len();
        frames.push_with(100, vec![0.0; 10], vec![contact; 40]);
        assert!(frames.len() < before && frames.contacts(100).is_some());
    }

    #[test]
    fn an_empty_history_has_nothing() {
        let mut frames = Frames::new(0);
        assert!(frames.is_empty() && frames.at(3).is_none());
        frames.push(0, vec![1.0]);
        frames.clear();
        assert!(frames.is_empty());
    }
}
