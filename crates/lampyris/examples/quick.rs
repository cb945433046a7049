use lampyris::{import::*, integrator::*, render::*, scene::*, *};
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let mut im = load::load(a[1].as_ref(), &load::LoadOptions::default()).unwrap();
    let mut passes = 16;
    for s in &a[3..] {
        let (k, v) = s.split_once('=').unwrap();
        if k == "integrator" {
            im.description.use_integrator(v).unwrap()
        } else if k == "passes" {
            passes = v.parse().unwrap()
        } else {
            im.description.set(k, v).unwrap()
        }
    }
    let b = build(&im.description, &Files::beside(a[1].as_ref()))
        .map_err(|e| im.places.locate(e))
        .unwrap_or_else(|e| panic!("{e}"));
    let t = std::time::Instant::now();
    let mut r = Render::new(&b.scene, &im.description, &Silent);
    println!("pilot {:?}", t.elapsed());
    for _ in 0..passes {
        r.step(&Silent);
    }
    println!("{:?} mean {} err {:?}", t.elapsed(), r.film().image().mean(), r.film().relative_error());
    output::write_image(a[2].as_ref(), &r.film().image()).unwrap();
}
