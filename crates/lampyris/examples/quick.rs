use lampyris::{import::*, integrator::*, render::*, scene::*, *};
use std::sync::Mutex;
struct Clock(Mutex<(std::time::Instant, Option<Phase>, std::collections::HashMap<Phase, f64>, Work)>);
impl Observer for Clock {
    fn phase(&self, p: Phase) { let mut g = self.0.lock().unwrap(); let now = std::time::Instant::now(); let d = (now - g.0).as_secs_f64(); if let Some(q) = g.1 { *g.2.entry(q).or_default() += d; } g.0 = now; g.1 = Some(p); }
    fn work(&self, w: &Work) { let mut g = self.0.lock().unwrap(); g.3.rays += w.rays; g.3.light_paths += w.light_paths; g.3.photons += w.photons; g.3.flux_cut += w.flux_cut; g.3.flux_emitted += w.flux_emitted; }
}
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let mut im = load::load(a[1].as_ref(), &load::LoadOptions::default()).unwrap();
    for w in &im.warnings { println!("warning: {w}"); }
    let mut passes = 16;
    for s in &a[3..] {
        let (k, v) = s.split_once('=').unwrap();
        if k == "integrator" { im.description.use_integrator(v).unwrap() } else if k == "passes" { passes = v.parse().unwrap() } else { im.description.set(k, v).unwrap() }
    }
    let b = build(&im.description, &Files::beside(a[1].as_ref())).map_err(|e| im.places.locate(e)).unwrap_or_else(|e| panic!("{e}"));
    let t = std::time::Instant::now();
    let c = Clock(Mutex::new((t, None, Default::default(), Work::default())));
    let mut r = Render::new(&b.scene, &im.description, &c);
    println!("pilot {:?}", t.elapsed());
    c.0.lock().unwrap().2.clear();
    c.0.lock().unwrap().3 = Work::default();
    for _ in 0..passes { r.step(&c); }
    c.phase(Phase::Pilot);
    println!("{:?} mean {} err {:?}", t.elapsed(), r.film().image().mean(), r.film().relative_error());
    let g = c.0.lock().unwrap();
    println!("{:?} {:?} paths/s {}", g.2, g.3, g.3.light_paths as f64 / (g.2.get(&Phase::Photons).unwrap_or(&0.0) + g.2.get(&Phase::Map).unwrap_or(&0.0)));
    output::write_image(a[2].as_ref(), &r.film().image()).unwrap();
}
