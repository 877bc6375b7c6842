//! Contacts: what keeps a boundary from passing through itself.

use glam::Vec3;

/// Two parts of a boundary that must not pass through each other.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Contact {
    /// A vertex and those of a facet (of an edge in the plane the last twice), or those of two edges.
    pub vertices: [u32; 4],
    /// Whether it is about two edges.
    pub edges: bool,
    /// Whether it holds them apart now.
    pub active: bool,
    /// The zone of violated constraints that it is in, the first being 1; 0: in none.
    pub zone: u32,
}

impl Contact {
    /// From seven numbers each: the vertices, which must be below `limit`, two edges or not, active or not, the zone.
    pub fn from_numbers(numbers: &[u32], limit: usize) -> Vec<Self> {
        let all = numbers.as_chunks::<7>().0.iter();
        let contacts = all.map(|&[a, b, c, d, edges, active, zone]| Self {
            vertices: [a, b, c, d],
            edges: edges != 0,
            active: active != 0,
            zone,
        });
        contacts
            .filter(|contact| contact.vertices.iter().all(|v| (*v as usize) < limit))
            .collect()
    }
}

/// Where the parts of a contact are nearest to each other, about: at the vertex, or amid the edges.
pub fn place(contact: &Contact, positions: &[f32]) -> Vec3 {
    let at = |i: usize| Vec3::from_slice(&positions[3 * contact.vertices[i] as usize..]);
    if !contact.edges {
        return at(0);
    }
    let (p, q) = nearest([at(0), at(1)], [at(2), at(3)]);
    0.5 * (p + q)
}

/// The nearest points of two segments; of parallel ones some.
fn nearest([a, b]: [Vec3; 2], [c, d]: [Vec3; 2]) -> (Vec3, Vec3) {
    let (u, v, w) = (b - a, d - c, a - c);
    let (uu, uv, vv) = (u.dot(u), u.dot(v), v.dot(v));
    let square = uu * vv - uv * uv;
    let s = match square > 1e-6 * uu * vv {
        true => ((uv * v.dot(w) - vv * u.dot(w)) / square).clamp(0.0, 1.0),
        false => 0.5,
    };
    let t = match vv > 0.0 {
        true => ((a + s * u - c).dot(v) / vv).clamp(0.0, 1.0),
        false => 0.0,
    };
    (a + s * u, c + t * v)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn contacts_come_from_seven_numbers_each() {
        let numbers = [
            0, 1, 2, 3, 0, 1, 5, 4, 5, 6, 9, 1, 0, 0, 4, 5, 6, 7, 1, 0, 0, 8,
        ];
        let contacts = Contact::from_numbers(&numbers, 8);
        let [first, second] = contacts[..] else {
            panic!("vertex 9 is none, and a rest is no contact: {contacts:?}")
        };
        assert!(first.active && !first.edges && first.zone == 5 && first.vertices == [0, 1, 2, 3]);
        assert!(second.edges && !second.active && second.vertices == [4, 5, 6, 7]);
    }

    #[test]
    fn contacts_are_where_their_parts_are_nearest() {
        let positions = [
            -1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.5, -1.0, 0.2, 0.5, 1.0, 0.2f32,
        ];
        let contact = |edges| Contact {
            vertices: [0, 1, 2, 3],
            edges,
            active: true,
            zone: 0,
        };
        assert!((place(&contact(true), &positions) - Vec3::new(0.5, 0.0, 0.1)).length() < 1e-6);
        assert_eq!(
            place(&contact(false), &positions),
            Vec3::new(-1.0, 0.0, 0.0)
        );
        // beyond its end, parallel, and without extent
        let short = [Vec3::ZERO, Vec3::X];
        let (p, q) = nearest(short, [Vec3::new(2.0, -1.0, 0.0), Vec3::new(2.0, 1.0, 0.0)]);
        assert_eq!((p, q), (Vec3::X, Vec3::new(2.0, 0.0, 0.0)));
        let (p, q) = nearest(short, [Vec3::Y, Vec3::ONE - Vec3::Z]);
        assert!((p - q).length() < 1.0 + 1e-6);
        let (p, q) = nearest([Vec3::ONE; 2], [Vec3::ZERO; 2]);
        assert!(p == Vec3::ONE && q == Vec3::ZERO);
    }
}
