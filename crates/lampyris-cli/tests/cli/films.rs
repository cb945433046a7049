//! Films: kept on the way, gone on with after any end, merged in any order, always to the same bits.

use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant, SystemTime};

use super::{Folder, SCENE, WALL, program};

/// Every way of rendering, with whatever makes its films differ in kind.
const WAYS: [&str; 11] = [
    "--integrator auto --set photons=500",
    "--integrator path",
    "--integrator path --set samples=3 --set filter=tent --set filter.radius=1.3",
    "--integrator photon-map",
    "--integrator photon-map --set filter=tent --set bandwidth=nearest --set direct=photons",
    "--integrator photon-map --set bandwidth=fixed --set radius=0.3",
    "--integrator light --set photons=500 --set filter=tent",
    "--integrator photon-map --set time.bins=4 --set time.layers=direct,indirect",
    "--integrator auto --set photons=500 --set time.bins=9 --set time.variance=true --set time.bounces=1",
    "--integrator light --set photons=500 --set time.frequencies=0.5,1.25",
    "--integrator path --set time.frequencies=0.5,1.25 --set time.layers=caustic",
];

#[test]
fn films_of_parts_make_the_film_of_the_whole() {
    for (way, number) in WAYS.iter().zip(0..) {
        let folder = Folder::with_scene(SCENE);
        let render = |options: &str| folder.run(&format!("render scene.toml -q --layers all {way} {options}"));
        render("-o whole.npy --checkpoint whole.film --passes 8 --threads 1");
        render("-o a.npy --checkpoint a.film --pass-range 0..3 --threads 2");
        render("-o b.npy --checkpoint b.film --pass-range 3..8 --threads 1");
        assert_eq!(folder.run("merge b.film a.film -o m.film -o m.npy").0, "8 passes: 0..8\n");
        folder.run("merge a.film b.film -o n.film");
        assert_eq!(folder.read("m.npy"), folder.read("whole.npy"), "{way}");
        assert!(folder.read("m.film") == folder.read("whole.film"), "{way}, all sums");
        assert!(folder.read("n.film") == folder.read("whole.film"), "{way}, the other way round");
        if number % 2 == 0 {
            // What comes later may also be there before.
            render("-o c.npy --resume b.film --passes 8 --threads 2");
            assert_eq!(folder.read("c.npy"), folder.read("whole.npy"), "{way}, backwards");
            assert!(folder.read("b.film") == folder.read("whole.film"), "{way}, in the same file");
        }
    }
}

#[test]
fn a_merged_film_of_a_wall_knows_how_it_was_captured() {
    for mode in ["'single'", "'confocal', legs = true", "'exhaustive', laser-grid = [2, 1]"] {
        let folder = Folder::with_scene(&WALL.replace("'single'", mode));
        let render = |options: &str| folder.run(&format!("render scene.toml -q {options}"));
        render("-o whole.npy -o whole.npz -o whole.hdf5 --checkpoint whole.film --passes 4");
        render("-o a.npy --checkpoint a.film --pass-range 0..1");
        render("-o b.npy --checkpoint b.film --pass-range 1..4");
        folder.run("merge b.film a.film -o m.film -o m.npy -o m.npz -o m.hdf5");
        render("-o again.hdf5 --resume m.film --passes 4");
        assert!(String::from_utf8_lossy(&folder.read("m.json")).contains("laser_grid_xyz"));
        for end in ["film", "npy", "json", "direct.npy", "direct.json", "npz", "hdf5"] {
            assert!(folder.read(&format!("m.{end}")) == folder.read(&format!("whole.{end}")), "{mode}, .{end}");
        }
        assert!(folder.read("again.hdf5") == folder.read("whole.hdf5"), "{mode}");
    }
}

#[test]
fn films_of_other_walls_and_of_none_are_told_so() {
    let folder = Folder::with_scene(WALL);
    let amplitudes = "--set time.frequencies=0,0.5 --checkpoint p.film --passes 1";
    let said = folder.refuse(&format!("render scene.toml -q {amplitudes} -o p.hdf5"));
    assert!(said.contains("cannot write 'p.hdf5': the film has amplitudes in place of time bins"), "{said}");
    folder.run(&format!("render scene.toml -q {amplitudes} -o p.npz"));
    let said = folder.refuse("merge p.film -o p.hdf5");
    assert!(said.contains("cannot write 'p.hdf5': the film has amplitudes in place of time bins"), "{said}");
    folder.run("render scene.toml -q -o a.npy --checkpoint a.film --pass-range 0..1");
    for (from, to, expected) in [
        ("'single'", "'confocal'", "of another camera.capture.mode: confocal instead of single"),
        ("'single'", "'single', legs = true", "of another camera.capture.legs: true instead of false"),
        ("0.3, 0.2", "0.3, 0.1", "of another scene"),
    ] {
        folder.write("other.toml", WALL.replace(from, to));
        folder.run("render other.toml -q -o b.npy --checkpoint b.film --pass-range 1..2");
        let said = folder.refuse("merge a.film b.film -o m.hdf5");
        assert!(said.contains("cannot merge 'b.film' with 'a.film'") && said.contains(expected), "{said}");
    }
    folder.write("scene.toml", SCENE);
    folder.run("render scene.toml -q --integrator path --set time.bins=4 -o c.npy --checkpoint c.film --passes 1");
    let said = folder.refuse("merge c.film -o c.hdf5");
    assert!(said.contains("cannot write 'c.hdf5': the camera captures no wall"), "{said}");
}

/// What takes more memory than there may be is kept in a file without a name.
#[test]
fn a_film_that_does_not_fit_in_memory_has_the_same_bits() {
    let ways = WAYS.iter().filter(|way| way.contains("time.")).chain([
        &"--integrator path --set filter=tent --set filter.radius=1.3 --set time.bins=7 --set time.variance=true",
    ]);
    for way in ways {
        let folder = Folder::with_scene(SCENE);
        let render = |options: &str| folder.run(&format!("render scene.toml {way} {options}"));
        let memory = render("-o a.npy -o a.npz --checkpoint a.film --passes 4 --threads 1 --memory 1GB").1;
        assert!(memory.contains("of memory"), "{memory}");
        let disk = render("-o b.npy -o b.npz --checkpoint b.film --passes 4 --threads 2 --memory 0").1;
        assert!(disk.contains("of the disk, in '.'"), "{disk}");
        render("-o c.npy --checkpoint c.film --passes 2 --memory 0");
        render("-o c.npy --resume c.film --passes 4 --memory 0");
        render("-o d.npy --checkpoint d.film --pass-range 2..4 --memory 0");
        render("-o e.npy --checkpoint e.film --pass-range 0..2 --memory 0");
        folder.run("merge d.film e.film -o m.film -o m.npy --memory 0");
        for name in ["b", "c", "m"] {
            assert!(folder.read(&format!("{name}.film")) == folder.read("a.film"), "{way}, {name}.film");
            assert!(folder.read(&format!("{name}.npy")) == folder.read("a.npy"), "{way}, {name}.npy");
        }
        assert!(folder.read("b.npz") == folder.read("a.npz"), "{way}");
        let hidden: Vec<String> = folder.names().into_iter().filter(|name| name.starts_with('.')).collect();
        assert!(hidden.is_empty(), "{hidden:?}");
    }
}

#[test]
fn a_film_for_which_there_is_no_room_is_refused_before_the_first_pass() {
    let folder = Folder::with_scene(SCENE);
    let time = "--size 1000x1000 --set time.bins=1000000 --set time.start=0 --set time.bin-width=1";
    let said = folder.refuse(&format!("render scene.toml -o a.npy {time} --memory 1GB"));
    assert!(said.contains("cannot keep the film's time bins in '.'") && said.contains("fewer bins"), "{said}");
    let said = folder.refuse(&format!("render scene.toml -o a.npy {time} --memory 1000TB"));
    assert!(said.contains("fewer bins"), "{said}");
    assert_eq!(folder.names(), ["scene.toml"]);
    assert!(folder.refuse("render scene.toml --memory 4").contains("such as 500MB"));
}

#[test]
fn the_room_that_a_film_takes_is_told_before_it_is_rendered() {
    let folder = Folder::with_scene(&SCENE.replace("size = [8, 6]", "size = [8, 6]\ntime = { bins = 254 }"));
    let expected = "254 time bins that take 612 KiB";
    for command in ["info", "check"] {
        let (said, _) = folder.run(&format!("{command} scene.toml"));
        assert!(said.contains(expected), "{said}");
    }
}

#[test]
fn layers_in_time_are_written_beside_all_light_and_read_by_their_names() {
    let folder = Folder::with_scene(SCENE);
    let time = "--integrator path --set time.bins=9 --set time.layers=direct,indirect --set time.bounces=1";
    let (_, said) = folder.run(&format!("render scene.toml {time} -o a.npy -o a.npz --passes 2"));
    assert!(said.contains("9 time bins of") && said.contains("for all light and 5 layers"), "{said}");
    for layer in ["direct", "indirect", "bounces-1", "more-bounces"] {
        for file in ["a.npy", "a.npz"] {
            folder.run(&format!("transient {file} --layer {layer} -o b.npy -q"));
            assert_eq!(folder.read("b.npy"), folder.read(&format!("a.{layer}.npy")), "{file}, {layer}");
        }
    }
    let said = folder.refuse("transient a.npy --layer volume -o b.npy");
    assert!(said.contains("no layer 'volume'") && said.contains("direct, indirect, bounces-0"), "{said}");
}

#[test]
fn a_film_with_amplitudes_is_written_with_them() {
    let folder = Folder::with_scene(SCENE);
    let time = "--integrator path --set time.bins=100 --set time.bin-width=0.1 --set time.phasor={mean=2,sigma=5}";
    let (_, said) = folder.run(&format!("render scene.toml {time} -o a.npy -o a.npz -o a.pfm --passes 2"));
    // Mean 10 / 2 = 5, σ 10 / 30: from 4 to 6 tenths.
    assert!(said.contains("frequencies from 0.4") && said.contains("to 0.6"), "{said}");
    let header = String::from_utf8_lossy(&folder.read("a.npy")[..128]).to_string();
    assert!(header.contains("(6, 8, 3, 2), }"), "{header}");
    let facts: serde_json::Value = serde_json::from_slice(&folder.read("a.json")).expect("JSON");
    assert_eq!(facts["frequencies"], serde_json::json!([0.4, 0.5, 0.6]));
    assert!(folder.path("a.npz").exists() && folder.path("a.pfm").exists());
    let said = folder.refuse("render scene.toml -o a.npy --set time.phasor={mean=2,sigma=5}");
    assert!(said.contains("width is not given"), "{said}");
}

#[test]
fn a_film_with_time_is_written_with_its_bins() {
    let folder = Folder::with_scene(SCENE);
    let time = "--integrator path --set time.bins=9 --set time.bin-width=0.25 --set time.start=1";
    let (_, said) =
        folder.run(&format!("render scene.toml {time} -o a.npy -o a.npz -o a.pfm --checkpoint a.film --passes 2"));
    assert!(said.contains("9 time bins of 0.25") && said.contains("of the light came before"), "{said}");
    folder.run("render scene.toml -q --integrator path -o b.pfm --passes 2");
    assert_eq!(folder.read("a.pfm"), folder.read("b.pfm"), "the picture is the same");
    let array = folder.read("a.npy");
    let header = String::from_utf8_lossy(&array[..128]).to_string();
    assert!(header.contains(", 9, 3), }"), "{header}");
    let axis: serde_json::Value = serde_json::from_slice(&folder.read("a.json")).expect("JSON");
    assert_eq!((axis["start_opl"].as_f64(), axis["bin_width_opl"].as_f64()), (Some(1.0), Some(0.25)));
    folder.run("merge a.film -o c.npy");
    assert_eq!(folder.read("c.npy"), array);
    let said = folder.refuse("render scene.toml -o a.npz");
    assert!(said.contains("the film has no time bins"), "{said}");
    let said = folder.refuse("render scene.toml -o a.npy --size 8000x8000 --set time.bins=100000000");
    assert!(said.contains("100000000 time bins") && said.contains("TiB"), "{said}");
}

#[test]
fn a_render_goes_on_where_it_ended() {
    let folder = Folder::with_scene(SCENE);
    folder.run("render scene.toml -q -o a.exr --checkpoint a.film --passes 3");
    let before = folder.read("a.film");
    let (_, said) = folder.run("render scene.toml -o b.npy --resume a.film --checkpoint b.film --passes 7");
    assert!(said.contains("going on from passes 0..3") && said.contains("7 passes"), "{said}");
    assert!(before == folder.read("a.film"), "the film went elsewhere");
    folder.run("render scene.toml -q -o c.npy -o c.exr --passes 7");
    assert_eq!(folder.read("b.npy"), folder.read("c.npy"));
    folder.run("merge b.film -o d.npy -o d.exr");
    folder.run("tonemap c.exr --layer normal -o c-normal.pfm --operator clamp");
    folder.run("tonemap d.exr --layer normal -o d-normal.pfm --operator clamp");
    folder.run("tonemap b.film --layer normal -o b-normal.pfm --operator clamp");
    assert_eq!(folder.read("c-normal.pfm"), folder.read("d-normal.pfm"));
    assert_eq!(folder.read("c-normal.pfm"), folder.read("b-normal.pfm"));
    assert!(folder.run("compare b.film c.npy").0.contains("RMSE                0\n"));
}

#[test]
fn a_film_that_has_all_passes_is_only_looked_at() {
    let folder = Folder::with_scene(SCENE);
    folder.run("render scene.toml -q -o a.npy --checkpoint a.film --passes 3 --stats a.json");
    folder.run("render scene.toml -q -o b.npy --resume a.film --passes 2 --stats b.json");
    assert_eq!(folder.read("a.npy"), folder.read("b.npy"));
    let stats = |name: &str| serde_json::from_slice::<serde_json::Value>(&folder.read(name)).expect("JSON");
    assert_eq!((stats("b.json")["pass_ranges"].as_str(), stats("b.json")["rays"].as_u64()), (Some("0..3"), Some(0)));
    assert_eq!(stats("a.json")["errors"][0]["passes"], 2);
}

#[test]
fn films_of_something_else_are_refused() {
    let folder = Folder::with_scene(SCENE);
    folder.write("other.toml", SCENE.replace("radius = 0.5", "radius = 0.4"));
    folder.run("render scene.toml -q -o a.png --checkpoint a.film --passes 2 --seed 1");
    folder.run("render scene.toml -q -o a.png --checkpoint b.film --pass-range 1..3 --seed 1");
    folder.run("render scene.toml -q -o a.png --checkpoint c.film --pass-range 2..3 --seed 2");
    folder.write("cut.film", &folder.read("a.film")[..900]);
    let mut damaged = folder.read("a.film");
    damaged[700] ^= 4;
    folder.write("damaged.film", damaged);
    let refusals = [
        ("render scene.toml --resume a.film --passes 4", "it is of seed 1 instead of 0"),
        ("render other.toml --resume a.film --passes 4 --seed 1", "it is of another scene"),
        (
            "render scene.toml --resume a.film --seed 1 --set k=11",
            "of another integrator.photon-map.k: 10 instead of 11",
        ),
        ("render scene.toml --resume a.film --seed 1 --integrator path", "of another integrator"),
        ("render scene.toml --resume a.film --seed 1 --size 8x7", "of another film.size"),
        ("render scene.toml --resume a.film --seed 1 --set fov=50", "of another camera.fov"),
        ("render scene.toml --resume a.film --seed 1 --layers albedo -o x.exr", "it has other layers"),
        ("render scene.toml --resume cut.film --seed 1", "cut.film: the film is damaged or cut short"),
        ("render scene.toml --resume damaged.film --seed 1", "the film is damaged or cut short"),
        ("render scene.toml --resume scene.toml", "not a film of Lampyris"),
        ("render scene.toml --resume none.film", "no such file"),
        ("render scene.toml --checkpoint no/a.film", "there is no folder"),
        ("render scene.toml --checkpoint a.png -o a.png", "cannot hold both"),
        ("render scene.toml --checkpoint-every 3s", "needs a film to write"),
        ("merge a.film b.film -o m.film", "both have pass 1"),
        ("merge a.film a.film -o m.film", "both have passes 0..2"),
        ("merge a.film c.film -o m.film", "one is of seed 2 instead of 1"),
        ("merge a.film -o m.jpeg", "names no picture format"),
        ("tonemap a.film -o m.png --layer albedo", "there is no layer 'albedo'"),
    ];
    for (arguments, expected) in refusals {
        let said = folder.refuse(arguments);
        assert!(said.contains(expected), "{arguments}: {said}");
    }
}

#[test]
fn a_render_ends_at_its_error_and_at_the_same_pass_again() {
    let folder = Folder::with_scene(SCENE);
    let render = |options: &str| folder.run(&format!("render scene.toml -q --integrator path {options}"));
    let stats = |name: &str| serde_json::from_slice::<serde_json::Value>(&folder.read(name)).expect("JSON");
    render("-o a.npy --target-error 4% --stats a.json");
    let passes = stats("a.json")["passes"].as_u64().expect("a number");
    assert!(passes >= 8 && stats("a.json")["relative_error"].as_f64().expect("a number") <= 0.04, "{passes}");
    render("-o b.npy --checkpoint b.film --passes 5");
    render("-o b.npy --resume b.film --target-error 0.04 --threads 1");
    assert_eq!(folder.read("a.npy"), folder.read("b.npy"));
    render("-o b.npy --resume b.film --target-error 4%");
    assert_eq!(folder.read("a.npy"), folder.read("b.npy"), "what is good enough stays as it is");
    render("-o c.npy --target-error 0.0001% --passes 9 --stats c.json");
    assert_eq!(stats("c.json")["passes"], 9, "whichever comes first");
}

/// Numbers that nobody chose, the same in each run.
struct Moments(u64);

impl Moments {
    fn below(&mut self, most: u64) -> u64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % most
    }
}

/// Waits until the file has been written so often, or the render has ended.
fn wait_for_films(folder: &Folder, child: &mut Child, count: u64) {
    let written = || std::fs::metadata(folder.path("a.film")).and_then(|file| file.modified()).ok();
    let (mut last, mut seen) = (written(), 0);
    let begun = Instant::now();
    while seen < count && child.try_wait().expect("a child").is_none() {
        assert!(begun.elapsed() < Duration::from_secs(60), "nothing is written");
        let now: Option<SystemTime> = written();
        seen += u64::from(now != last);
        last = now;
    }
}

#[test]
fn a_render_that_is_killed_again_and_again_gives_the_same_bits() {
    const ENOUGH: u32 = 10;
    for way in ["--integrator path --set filter=tent", "--integrator photon-map", "--integrator auto"] {
        let folder = Folder::with_scene(SCENE);
        folder.run(&format!("render scene.toml -q -o straight.npy --passes {PASSES} {way}"));
        let mut moments = Moments(7);
        let mut kills = 0;
        // On a busy machine a render may be over before it is killed often enough: then once more.
        for _ in 0..100 {
            kills += killed_render(&folder, way, &mut moments);
            assert!(folder.read("a.npy") == folder.read("straight.npy"), "{way}");
            if kills >= ENOUGH {
                break;
            }
        }
        assert!(kills >= ENOUGH, "only {kills} in the middle of {way}");
    }
}

const PASSES: u32 = 400;

/// Renders `a.npy`, killed and resumed until it is whole; returns how often it was killed.
fn killed_render(folder: &Folder, way: &str, moments: &mut Moments) -> u32 {
    const KILLS: u32 = 40;
    let render = format!("render scene.toml -q -o a.npy --checkpoint-every 1ms --passes {PASSES} {way}");
    let (mut kills, mut kept) = (0, 0);
    let exists = || folder.path("a.film").exists();
    if exists() {
        std::fs::remove_file(folder.path("a.film")).expect("the film of the last time");
    }
    loop {
        let film = if exists() { "--resume a.film" } else { "--checkpoint a.film" };
        let mut child = Command::new(program())
            .current_dir(folder.path(""))
            .args(render.split_whitespace().chain(film.split_whitespace()))
            .stderr(Stdio::null())
            .spawn()
            .expect("it runs");
        if kills < KILLS {
            wait_for_films(folder, &mut child, moments.below(4));
            // Into the next pass, or the writing of its film.
            let moment = Instant::now() + Duration::from_micros(moments.below(4000));
            while Instant::now() < moment {}
            kills += u32::from(child.try_wait().expect("a child").is_none());
            child.kill().expect("SIGKILL, or it has ended");
        }
        let status = child.wait().expect("it ends");
        if exists() {
            // Always whole, and never less than before.
            let (told, _) = folder.run("merge a.film -o now.npy");
            let passes: u32 = told.split(' ').next().and_then(|count| count.parse().ok()).expect("a number");
            assert!(passes >= kept && told.ends_with(&format!(": 0..{passes}\n")), "{told} after {kept}");
            kept = passes;
        }
        if status.success() {
            assert_eq!(kept, PASSES);
            return kills;
        }
    }
}
