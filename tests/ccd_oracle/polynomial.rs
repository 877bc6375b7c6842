//! Polynomials with rational coefficients, and their real roots in 0..1.

use dashu_ratio::RBig;
use std::cmp::Ordering;

/// The coefficients, that of the lowest power first; the last is not zero.
#[derive(Debug, Clone, PartialEq)]
pub struct Polynomial(Vec<RBig>);

fn rational(x: i64) -> RBig {
    RBig::from(x)
}

fn sign(x: &RBig) -> Ordering {
    x.cmp(&RBig::ZERO)
}

impl Polynomial {
    fn trimmed(mut coefficients: Vec<RBig>) -> Self {
        while coefficients.last() == Some(&RBig::ZERO) {
            coefficients.pop();
        }
        Self(coefficients)
    }

    /// from + (to − from) t.
    pub fn linear(from: i64, to: i64) -> Self {
        Self::trimmed(vec![rational(from), rational(to - from)])
    }

    pub fn is_zero(&self) -> bool {
        self.0.is_empty()
    }

    pub fn plus(&self, other: &Self, factor: i64) -> Self {
        let at = |p: &Self, i: usize| p.0.get(i).cloned().unwrap_or(RBig::ZERO);
        let n = self.0.len().max(other.0.len());
        Self::trimmed(
            (0..n)
                .map(|i| at(self, i) + at(other, i) * rational(factor))
                .collect(),
        )
    }

    pub fn minus(&self, other: &Self) -> Self {
        self.plus(other, -1)
    }

    pub fn times(&self, other: &Self) -> Self {
        if self.is_zero() || other.is_zero() {
            return Self(Vec::new());
        }
        let mut out = vec![RBig::ZERO; self.0.len() + other.0.len() - 1];
        for (i, a) in self.0.iter().enumerate() {
            for (j, b) in other.0.iter().enumerate() {
                out[i + j] += a * b;
            }
        }
        Self::trimmed(out)
    }

    pub fn at(&self, t: &RBig) -> RBig {
        let highest_first = self.0.iter().rev();
        highest_first.fold(RBig::ZERO, |sum, c| sum * t + c)
    }

    fn derivative(&self) -> Self {
        let terms = self.0.iter().enumerate().skip(1);
        Self::trimmed(terms.map(|(i, c)| c * rational(i as i64)).collect())
    }

    /// Quotient and remainder.
    fn divided(&self, by: &Self) -> (Self, Self) {
        let mut rest = self.0.clone();
        let n = by.0.len();
        let mut quotient = vec![RBig::ZERO; (rest.len() + 1).saturating_sub(n)];
        while rest.len() >= n {
            let shift = rest.len() - n;
            let factor = &rest[rest.len() - 1] / &by.0[n - 1];
            for (i, c) in by.0.iter().enumerate() {
                rest[shift + i] -= c * &factor;
            }
            quotient[shift] = factor;
            rest = Self::trimmed(rest).0;
        }
        (Self::trimmed(quotient), Self(rest))
    }

    fn common_divisor(&self, other: &Self) -> Self {
        let (mut a, mut b) = (self.clone(), other.clone());
        while !b.is_zero() {
            let rest = a.divided(&b).1;
            (a, b) = (b, rest);
        }
        a
    }

    /// The same roots, each once.
    fn square_free(&self) -> Self {
        match self.0.len() {
            0..=2 => self.clone(),
            _ => self.divided(&self.common_divisor(&self.derivative())).0,
        }
    }
}

/// Sturm's sequence of a square-free polynomial.
struct Sturm(Vec<Polynomial>);

impl Sturm {
    fn new(p: &Polynomial) -> Self {
        let mut chain = vec![p.clone(), p.derivative()];
        while let [.., a, b] = &chain[..]
            && !b.is_zero()
        {
            let rest = a.divided(b).1;
            chain.push(Polynomial(Vec::new()).minus(&rest));
        }
        Self(chain)
    }

    fn changes(&self, t: &RBig) -> usize {
        let signs = self.0.iter().map(|p| sign(&p.at(t)));
        let signs: Vec<Ordering> = signs.filter(|s| s.is_ne()).collect();
        signs.windows(2).filter(|w| w[0] != w[1]).count()
    }

    /// Roots above `low` and not above `high`.
    fn roots(&self, low: &RBig, high: &RBig) -> usize {
        self.changes(low) - self.changes(high)
    }
}

/// A real number: the one root of a square-free polynomial above `low` and not above `high`.
pub struct Root {
    polynomial: Polynomial,
    sturm: Sturm,
    pub low: RBig,
    pub high: RBig,
}

impl Root {
    /// A rational number.
    pub fn rational(x: i64) -> Self {
        let polynomial = Polynomial::trimmed(vec![rational(-x), RBig::ONE]);
        Self {
            sturm: Sturm::new(&polynomial),
            polynomial,
            low: rational(x - 1),
            high: rational(x),
        }
    }

    fn halve(&mut self) {
        let middle = (&self.low + &self.high) / rational(2);
        if self.sturm.roots(&self.low, &middle) == 1 {
            self.high = middle;
        } else {
            self.low = middle;
        }
    }

    /// Brings the upper bound to within 2^−n, or onto the root.
    pub fn refine(&mut self, n: i32) {
        let small = RBig::try_from(2f64.powi(-n)).expect("finite");
        while self.polynomial.at(&self.high) != RBig::ZERO && &self.high - &self.low > small {
            self.halve();
        }
    }

    /// The sign of another polynomial there.
    pub fn sign_of(&mut self, p: &Polynomial) -> Ordering {
        if p.0.len() <= 1 {
            return p.0.first().map_or(Ordering::Equal, sign);
        }
        if self.polynomial.at(&self.high) == RBig::ZERO {
            return sign(&p.at(&self.high));
        }
        let common = self.polynomial.common_divisor(p);
        if common.0.len() > 1 && Sturm::new(&common).roots(&self.low, &self.high) > 0 {
            return Ordering::Equal;
        }
        let chain = Sturm::new(&p.square_free());
        while chain.roots(&self.low, &self.high) > 0 {
            self.halve();
        }
        sign(&p.at(&self.high))
    }
}

/// All roots from 0 to 1, in ascending order; those of 0 are none.
pub fn roots(p: &Polynomial) -> Vec<Root> {
    if p.0.len() <= 1 {
        return Vec::new();
    }
    let p = p.square_free();
    let mut found = Vec::new();
    if p.at(&RBig::ZERO) == RBig::ZERO {
        found.push(Root::rational(0));
    }
    let mut open = vec![(RBig::ZERO, RBig::ONE)];
    let chain = Sturm::new(&p);
    while let Some((low, high)) = open.pop() {
        match chain.roots(&low, &high) {
            0 => {}
            1 => found.push(Root {
                polynomial: p.clone(),
                sturm: Sturm::new(&p),
                low,
                high,
            }),
            _ => {
                let middle = (&low + &high) / rational(2);
                open.push((middle.clone(), high));
                open.push((low, middle));
            }
        }
    }
    found
}
