use clap::CommandFactory;

use super::*;

fn parsed(line: &str) -> Command {
    match Arguments::try_parse_from(line.split_whitespace()) {
        Ok(arguments) => arguments.command,
        Err(error) => panic!("{error}"),
    }
}

fn render(options: &str) -> RenderArguments {
    match parsed(&format!("lampyris render s.toml {options}")) {
        Command::Render(arguments) => arguments,
        other => panic!("not a render: {other:?}"),
    }
}

/// The first line of what clap says, which must exit with 2.
fn refused(line: &str) -> String {
    let error = Arguments::try_parse_from(line.split_whitespace()).expect_err("it must be refused");
    assert_eq!(error.exit_code(), 2);
    error.to_string().lines().next().unwrap_or_default().to_string()
}

fn render_refused(options: &str) -> String {
    refused(&format!("lampyris render s.toml {options}"))
}

#[test]
fn the_definitions_are_sound() {
    Arguments::command().debug_assert();
}

#[test]
fn a_render_takes_all_of_its_options() {
    let all = render(
        "-o a.png -o b.exr --integrator path --passes 3 --seed 7 --threads 2 --size 64x32 --set kernel=cone \
         --set k=5 --stats s.json --strict --define spp=4 -D res=8 --quiet",
    );
    assert_eq!(all.scene.scene, PathBuf::from("s.toml"));
    assert_eq!(all.outputs, [PathBuf::from("a.png"), PathBuf::from("b.exr")]);
    assert_eq!(all.integrator.as_deref(), Some("path"));
    assert_eq!(all.passes.map(NonZeroU32::get), Some(3));
    assert_eq!(all.changes.seed, Some(7));
    assert_eq!(all.work.threads.map(NonZeroUsize::get), Some(2));
    assert_eq!(all.size, Some([64, 32]));
    assert_eq!(all.changes.settings, [("kernel".into(), "cone".into()), ("k".into(), "5".into())]);
    assert_eq!(all.stats, Some(PathBuf::from("s.json")));
    assert_eq!(all.scene.defines, [("spp".into(), "4".into()), ("res".into(), "8".into())]);
    assert!(all.scene.strict && all.work.quiet);
    assert_eq!(all.time, None);
}

#[test]
fn memory_has_units() {
    let memory = |text: &str| render(&format!("--memory {text}")).memory;
    assert_eq!(["0", "1.5GB", "2MiB", "3kb"].map(memory), [0, 1_500_000_000, 2 << 20, 3000].map(Some));
    for text in ["4", "-1GB", "GB", "nanGB", "4GX", "1e400GB x"] {
        assert!(Arguments::try_parse_from(["lampyris", "render", "s.toml", "--memory", text]).is_err(), "{text}");
    }
}

#[test]
fn a_render_needs_only_a_scene() {
    let plain = render("");
    assert!(plain.outputs.is_empty() && plain.passes.is_none() && plain.size.is_none() && !plain.work.quiet);
}

#[test]
fn times_have_units() {
    let time = |text: &str| render(&format!("--time {text}")).time.map(|time| time.as_secs_f64());
    for (text, seconds) in [("60s", 60.0), ("1.5m", 90.0), ("500ms", 0.5), ("2h", 7200.0), ("2min", 120.0), ("3", 3.0)]
    {
        assert_eq!(time(text), Some(seconds), "{text}");
    }
}

#[test]
fn a_time_must_be_a_time() {
    let sentence = |text: &str, reason: &str| {
        assert_eq!(
            render_refused(&format!("--time {text}")),
            format!("error: invalid value '{text}' for '--time <TIME>': {reason}")
        );
    };
    for text in ["-3s", "0s", "0", "1e-300s"] {
        sentence(text, "a time must be greater than 0");
    }
    for text in ["s", "3d", "1:30", "soon", "infs", "nans"] {
        sentence(text, "a time is a number and a unit, such as 60s, 1.5m, 2h or 500ms");
    }
    sentence("1e300h", "that is longer than anyone can wait");
}

#[test]
fn a_size_has_two_sides_of_at_least_a_pixel() {
    assert_eq!(
        render_refused("--size 0x0"),
        "error: invalid value '0x0' for '--size <WIDTHxHEIGHT>': a picture must be at least 1 pixel wide and high"
    );
    for text in ["640", "x", "640x", "-1x4", "6.5x4", "99999999999x1", "axb"] {
        assert_eq!(
            render_refused(&format!("--size {text}")),
            format!(
                "error: invalid value '{text}' for '--size <WIDTHxHEIGHT>': \
                 a size is two whole numbers with an x between them, such as 640x480"
            )
        );
    }
}

#[test]
fn counts_start_at_one() {
    for text in ["0", "-1", "1.5", "4294967296"] {
        assert_eq!(
            render_refused(&format!("--passes {text}")),
            format!("error: invalid value '{text}' for '--passes <N>': it must be a whole number from 1 to 4294967295")
        );
    }
    for text in ["0", "-1", "1000000"] {
        assert_eq!(
            render_refused(&format!("--threads {text}")),
            format!("error: invalid value '{text}' for '--threads <N>': it must be a whole number from 1 to 4096")
        );
    }
}

#[test]
fn passes_and_time_are_two_ways_to_say_one_thing() {
    let message = render_refused("--passes 3 --time 3s");
    assert_eq!(message, "error: the argument '--passes <N>' cannot be used with '--time <TIME>'");
}

#[test]
fn a_setting_is_a_key_and_a_value() {
    assert_eq!(
        render_refused("--set kernel"),
        "error: invalid value 'kernel' for '--set <KEY=VALUE>': there is no '=' in it"
    );
    assert_eq!(
        render_refused("--set =cone"),
        "error: invalid value '=cone' for '--set <KEY=VALUE>': there is no name before the '='"
    );
    assert_eq!(render("--set a=b=c").changes.settings, [("a".into(), "b=c".into())]);
}

#[test]
fn photons_go_to_one_file() {
    let Command::Photons(photons) = parsed("lampyris photons s.toml -o p.ply --set photons=9") else {
        panic!("not photons");
    };
    assert_eq!((photons.scene.scene, photons.output), (PathBuf::from("s.toml"), PathBuf::from("p.ply")));
    assert_eq!(photons.changes.settings, [("photons".into(), "9".into())]);
    assert!(!photons.work.quiet);
    refused("lampyris photons s.toml");
    refused("lampyris photons s.toml -o a.ply -o b.ply");
}

#[test]
fn info_and_check_take_a_scene() {
    assert!(matches!(parsed("lampyris info s.xml -D a=1"), Command::Info(info) if info.defines.len() == 1));
    assert!(matches!(parsed("lampyris check s.xml --strict"), Command::Check(scene) if scene.strict));
    refused("lampyris check");
}

#[test]
fn tonemap_takes_an_operator_and_its_parameters() {
    let Command::Tonemap(all) = parsed(
        "lampyris tonemap a.exr -o b.png --operator gamma-clamp --exposure -1.5 --gamma 2.2 --value 3 --key 1 \
         --white 2 --phi 8 --epsilon 0.05",
    ) else {
        panic!("not tonemap");
    };
    assert_eq!((all.input, all.output), (PathBuf::from("a.exr"), PathBuf::from("b.png")));
    assert_eq!((&*all.operator, all.exposure), ("gamma-clamp", -1.5));
    assert_eq!(
        [all.gamma, all.value, all.key, all.white, all.phi, all.epsilon],
        [Some(2.2), Some(3.0), Some(1.0), Some(2.0), Some(8.0), Some(0.05)]
    );
    assert_eq!(
        refused("lampyris tonemap a.exr -o b.png --exposure nan"),
        "error: invalid value 'nan' for '--exposure <STOPS>': it must be a finite number"
    );
}

#[test]
fn compare_takes_two_pictures() {
    let Command::Compare(pictures) = parsed("lampyris compare a.exr b.exr -o d.png") else { panic!("not compare") };
    assert_eq!((pictures.image, pictures.reference), (PathBuf::from("a.exr"), PathBuf::from("b.exr")));
    assert_eq!(pictures.output, Some(PathBuf::from("d.png")));
    refused("lampyris compare a.exr");
}

#[test]
fn the_schema_is_there_but_not_in_the_help() {
    assert!(matches!(parsed("lampyris schema"), Command::Schema));
    assert!(!Arguments::command().render_long_help().to_string().contains("schema"));
}

#[test]
fn previews_are_tev_a_place_or_the_terminal() {
    let tev = |address: &str| PreviewTarget::Tev(address.into());
    assert!(render("").preview.is_empty());
    assert_eq!(render("--preview").preview, [tev("127.0.0.1:14158")]);
    assert_eq!(render("--preview tev --preview terminal").preview, [tev("127.0.0.1:14158"), PreviewTarget::Terminal]);
    assert_eq!(render("--display-server box:99").preview, [tev("box:99")]);
    assert_eq!(render("--preview [::1]:14158").preview, [tev("[::1]:14158")]);
    for wrong in ["screen", "box:", ":99", "box:99999"] {
        assert!(render_refused(&format!("--preview {wrong}")).contains("it must be tev, terminal, or HOST:PORT"));
    }
}

#[test]
fn layers_are_named_or_refused() {
    use lampyris::film::Layer;
    assert_eq!(render("").layers, None);
    assert_eq!(render("--layers none").layers, Some(Layers::NONE));
    assert_eq!(render("--layers depth").layers, Some(Layers::NONE.with(Layer::Depth)));
    let message = render_refused("--layers alpha");
    assert!(message.contains("there is no layer 'alpha'"), "{message}");
}
