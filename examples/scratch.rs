use foldfree::{energy::*, geometry::*, mesh::*, optim::*, space::*, wrapd::*, embedding::*};
use glam::{DVec2, DVec3};
use std::collections::HashMap;
fn main() {
    let name = std::env::args().nth(1).unwrap();
    let star: f64 = std::env::args().nth(2).unwrap().parse().unwrap();
    let iters: usize = std::env::args().nth(3).unwrap().parse().unwrap();
    let verbose = std::env::args().nth(4).is_some();
    let text = std::fs::read_to_string(format!("/work/data/{name}.obj")).unwrap();
    let mut mesh = SurfaceMesh::default();
    for l in text.lines() {
        let mut t = l.split_whitespace();
        match t.next() {
            Some("v") => { let v: Vec<f64> = t.map(|x| x.parse().unwrap()).collect(); mesh.positions.push(DVec3::new(v[0], v[1], v[2])); }
            Some("f") => { let v: Vec<u32> = t.map(|x| x.split('/').next().unwrap().parse::<u32>().unwrap() - 1).collect(); mesh.simplices.push([v[0], v[1], v[2]]); }
            _ => {}
        }
    }
    let mut next: HashMap<u32, u32> = HashMap::new();
    let mut edges: HashMap<(u32, u32), u32> = HashMap::new();
    for t in &mesh.simplices { for i in 0..3 { edges.insert((t[i], t[(i + 1) % 3]), 0); } }
    for &(a, b) in edges.keys() { if !edges.contains_key(&(b, a)) { next.insert(a, b); } }
    let first = *next.keys().min().unwrap();
    let mut boundary = vec![first];
    loop { let n = next[boundary.last().unwrap()]; if n == first { break; } boundary.push(n); }
    let scale = surface_area(&mesh).sqrt().recip();
    let rest = RestShape::of_surface(&mesh, scale).unwrap();
    let t = std::time::Instant::now();
    let mut map = harmonic(&mesh, &rest, &boundary).unwrap();
    let flips = mesh.simplices.iter().filter(|t| { let [a,b,c] = t.map(|v| map[v as usize]); (b-a).perp_dot(c-a) <= 0.0 }).count();
    println!("{} v {} f, boundary {}, harmonic {:?}, flips {flips}", mesh.positions.len(), mesh.simplices.len(), boundary.len(), t.elapsed());
    if flips > 0 { map = tutte(&mesh, &rest, &boundary).unwrap(); }
    let (lo, hi) = map.iter().fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(l, h), p| (l.min(*p), h.max(*p)));
    let c = (lo + hi) / 2.0;
    let pin = (0..map.len()).min_by(|&a, &b| map[a].distance(c).total_cmp(&map[b].distance(c))).unwrap() as u32;
    let start: Vec<f64> = map.iter().flat_map(|p| [p.x, p.y]).collect();
    let t = std::time::Instant::now();
    let mut options = WrapdOptions { tolerance: 1e-12, max_iterations: iters, ..Default::default() };
    if std::env::var("NORESTART").is_ok() { options.restart_duals = false; }
    if let Ok(d) = std::env::var("DELAY") { options.reweighting.as_mut().unwrap().delay = d.parse().unwrap(); }
    let mut s = Wrapd::<Plane, RotationAware, _>::new(Problem { rest: &rest, start: &start, pins: &[pin] }, SymmetricDirichlet, options).unwrap();
    println!("setup {:?}, L {} entries; start E {}", t.elapsed(), s.factor_entries(), s.report().energy);
    let (mut a, mut b) = (None, None);
    let mut phases = [0.0; 4]; let mut n = 0; let mut lb = 0; let mut rw = 0;
    while s.status() == Status::Running {
        let r = s.step().unwrap();
        if verbose { println!("{:4} E {:.12} flips {} |g| {:.3e} lbfgs {} rw {} prox {}", r.iteration, r.energy, r.inverted, r.gradient_norm, r.lbfgs_iterations, r.reweighted, r.phases[0].count); }
        if r.iteration <= 100 { for (p, q) in phases.iter_mut().zip(&r.phases) { *p += q.milliseconds; } n += 1; lb += r.lbfgs_iterations; }
        rw += r.reweighted as usize;
        if r.inverted == 0 && a.is_none() && r.energy <= star * 1.01 { a = Some(r.iteration); }
        if r.inverted == 0 && b.is_none() && r.energy <= star * (1.0 + 1e-6) { b = Some(r.iteration); }
    }
    println!("{name}: {a:?} / {b:?}; end {:?} E {:.12}; {} reweights; per iteration (first {n}) {:.3} ms = {:?}; lbfgs/iter {:.2}", s.report(), s.report().energy, rw, phases.iter().sum::<f64>() / n as f64, phases.map(|p| p / n as f64), lb as f64 / n as f64);
}
