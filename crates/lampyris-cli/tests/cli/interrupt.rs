//! Ctrl-C: the first keeps the picture, the second quits at once.
#![cfg(unix)]

use std::io::{BufRead, BufReader};
use std::process::{Child, ChildStderr, Command, Stdio};

use super::{Folder, SCENE, program};

/// A render under way, of which we hear what it says.
struct Running {
    child: Child,
    said: BufReader<ChildStderr>,
}

impl Running {
    fn start(folder: &Folder, arguments: &str) -> Running {
        let mut child = Command::new(program())
            .current_dir(folder.path(""))
            .args(arguments.split_whitespace())
            .stderr(Stdio::piped())
            .spawn()
            .expect("it runs");
        let said = BufReader::new(child.stderr.take().expect("piped"));
        Running { child, said }
    }

    /// Waits for a line that begins like this.
    fn wait_for(&mut self, beginning: &str) {
        let mut all = String::new();
        while self.said.read_line(&mut all).expect("text") > 0 {
            if all.lines().last().is_some_and(|line| line.starts_with(beginning)) {
                return;
            }
        }
        panic!("no '{beginning}' in:\n{all}");
    }

    fn press_ctrl_c(&self) {
        let killed = Command::new("kill").args(["-INT", &self.child.id().to_string()]).status().expect("kill");
        assert!(killed.success());
    }

    /// Its exit code.
    fn end(mut self) -> Option<i32> {
        std::io::copy(&mut self.said, &mut std::io::sink()).expect("read");
        self.child.wait().expect("it ends").code()
    }
}

#[test]
fn the_first_keeps_the_picture() {
    let folder = Folder::with_scene(SCENE);
    let mut running = Running::start(&folder, "render scene.toml -o a.npy --passes 4000000000 --stats s.json");
    running.wait_for("pass 1 of");
    running.press_ctrl_c();
    running.wait_for("stopping");
    assert_eq!(running.end(), Some(0));
    let stats: serde_json::Value = serde_json::from_slice(&folder.read("s.json")).expect("JSON");
    assert_eq!(stats["interrupted"], true);
    let passes = stats["passes"].as_u64().expect("a number");
    let kept = folder.read("a.npy");
    folder.run(&format!("render scene.toml -q -o b.npy --passes {passes}"));
    assert_eq!(kept, folder.read("b.npy"), "the picture is that of the passes made");
}

#[test]
fn the_film_is_kept_too() {
    let folder = Folder::with_scene(SCENE);
    let mut running = Running::start(&folder, "render scene.toml -o a.npy --passes 4000000000 --checkpoint a.film");
    running.wait_for("pass 1 of");
    running.press_ctrl_c();
    assert_eq!(running.end(), Some(0));
    let (told, _) = folder.run("merge a.film -o b.npy");
    assert_eq!(folder.read("a.npy"), folder.read("b.npy"));
    let passes: u32 = told.split(' ').next().and_then(|count| count.parse().ok()).expect("a number");
    let more = passes + 3;
    folder.run(&format!("render scene.toml -q -o a.npy --resume a.film --passes {more}"));
    folder.run(&format!("render scene.toml -q -o b.npy --passes {more}"));
    assert_eq!(folder.read("a.npy"), folder.read("b.npy"));
}

#[test]
fn nothing_is_left_of_a_film_on_the_disk() {
    let folder = Folder::with_scene(SCENE);
    let render = "render scene.toml -o a.npy --integrator path --set time.bins=64 --memory 0";
    let mut running = Running::start(&folder, &format!("{render} --passes 4000000000"));
    running.wait_for("pass 1 of");
    running.press_ctrl_c();
    assert_eq!(running.end(), Some(0));
    assert_eq!(folder.names(), ["a.json", "a.npy", "scene.toml"]);
    // Nor if it ends within a pass.
    let mut running = Running::start(&folder, &format!("{render} --passes 1 --set samples=4000000000"));
    running.wait_for("64 time bins");
    running.press_ctrl_c();
    running.wait_for("stopping");
    running.press_ctrl_c();
    assert_eq!(running.end(), Some(130));
    assert_eq!(folder.names(), ["a.json", "a.npy", "scene.toml"]);
}

#[test]
fn the_second_quits_at_once() {
    let folder = Folder::with_scene(SCENE);
    let endless = "render scene.toml -o a.png --integrator path --passes 1 --set samples=4000000000";
    let mut running = Running::start(&folder, endless);
    running.wait_for("rendering");
    running.press_ctrl_c();
    running.wait_for("stopping");
    running.press_ctrl_c();
    assert_eq!(running.end(), Some(130));
    assert_eq!(folder.names(), ["scene.toml"], "no picture, no part of one");
}
