//! Pictures that grow before the eyes of a viewer: a small tev of our own.

use std::io::{ErrorKind, Read};
use std::net::{TcpListener, TcpStream};
use std::thread::JoinHandle;

use super::{Folder, SCENE};

/// What tev was told, read as tev reads it: length, kind and content of each packet, little-endian, texts with a zero.
#[derive(Debug, Default)]
struct Told {
    name: String,
    width: usize,
    pixels: Vec<[f32; 3]>,
    updates: usize,
}

/// A packet, and how far it is read.
struct Packet(Vec<u8>, usize);

impl Packet {
    fn receive(stream: &mut TcpStream) -> Option<Packet> {
        let mut length = [0; 4];
        match stream.read_exact(&mut length) {
            Err(error) if error.kind() == ErrorKind::UnexpectedEof => return None,
            other => other.expect("a length"),
        }
        let mut packet = vec![0; u32::from_le_bytes(length) as usize - 4];
        stream.read_exact(&mut packet).expect("as long as it says");
        Some(Packet(packet, 0))
    }

    fn take<const N: usize>(&mut self) -> [u8; N] {
        self.1 += N;
        self.0[self.1 - N..self.1].try_into().expect("long enough")
    }

    fn number(&mut self) -> usize {
        u32::from_le_bytes(self.take()) as usize
    }

    fn text(&mut self) -> String {
        let bytes: Vec<u8> = self.0[self.1..].iter().copied().take_while(|&byte| byte != 0).collect();
        self.1 += bytes.len() + 1;
        String::from_utf8(bytes).expect("text")
    }
}

impl Told {
    fn hear(&mut self, mut packet: Packet) {
        let [kind, _grabs_focus] = packet.take();
        let name = packet.text();
        match kind {
            4 => {
                let (width, height) = (packet.number(), packet.number());
                let channels: Vec<String> = (0..packet.number()).map(|_| packet.text()).collect();
                assert_eq!(channels, ["R", "G", "B"]);
                *self = Told { name, width, pixels: vec![[f32::NAN; 3]; width * height], updates: 0 };
            }
            6 => {
                assert_eq!(name, self.name);
                let channels: Vec<String> = (0..packet.number()).map(|_| packet.text()).collect();
                assert_eq!(channels, ["R", "G", "B"]);
                let [x, y, width, height] = [(); 4].map(|()| packet.number());
                let [offsets, strides] = [(); 2].map(|()| [(); 3].map(|()| u64::from_le_bytes(packet.take()) as usize));
                let data =
                    packet.0[packet.1..].chunks(4).map(|four| f32::from_le_bytes(four.try_into().expect("four")));
                let data: Vec<f32> = data.collect();
                for index in 0..width * height {
                    let pixel = &mut self.pixels[(y + index / width) * self.width + x + index % width];
                    *pixel = [0, 1, 2].map(|channel| data[offsets[channel] + index * strides[channel]]);
                }
                self.updates += 1;
            }
            other => panic!("packet {other}"),
        }
    }
}

/// A tev that hears so many packets, or all of them, and the place where it listens.
fn tev(most: usize) -> (String, JoinHandle<Told>) {
    let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
    let address = listener.local_addr().expect("an address").to_string();
    let heard = std::thread::spawn(move || {
        let (mut stream, _) = listener.accept().expect("someone calls");
        let mut told = Told::default();
        for _ in 0..most {
            match Packet::receive(&mut stream) {
                Some(packet) => told.hear(packet),
                None => break,
            }
        }
        told
    });
    (address, heard)
}

#[test]
fn tev_sees_the_picture_grow_and_the_last_it_sees_is_what_is_written() {
    let folder = Folder::with_scene(SCENE);
    for (option, integrator) in [("--preview", "photon-map"), ("--display-server", "light")] {
        let (address, heard) = tev(usize::MAX);
        let options = format!("--integrator {integrator} --time 700ms {option} {address}");
        let (_, stderr) = folder.run(&format!("render scene.toml -o a.npy {options}"));
        assert!(!stderr.contains("warning"), "{stderr}");
        let told = heard.join().expect("understood");
        assert_eq!((told.name.as_str(), told.width, told.pixels.len()), ("a.npy", 8, 48));
        assert!(told.updates > 1, "it saw {} pictures", told.updates);
        let seen: Vec<u8> = told.pixels.as_flattened().iter().flat_map(|value| value.to_le_bytes()).collect();
        assert_eq!(seen, folder.read("a.npy")[128..], "{integrator}");
    }
}

#[test]
fn a_missing_tev_is_one_warning() {
    let folder = Folder::with_scene(SCENE);
    // Nobody listens on a port that has just been given back.
    let place = TcpListener::bind("127.0.0.1:0").and_then(|listener| listener.local_addr()).expect("a port");
    let (_, stderr) = folder.run(&format!("render scene.toml -o a.png --preview {place}"));
    let expected = format!("warning: cannot reach tev at {place}: nobody listens there\nhint: start tev first");
    assert!(stderr.contains(&expected) && stderr.matches("warning").count() == 1, "{stderr}");
    assert!(folder.read("a.png").starts_with(b"\x89PNG"));
    let quiet = folder.run(&format!("render scene.toml -q -o a.png --preview {place}"));
    assert_eq!(quiet, (String::new(), String::new()));
}

#[test]
fn a_tev_that_goes_away_is_one_warning() {
    let folder = Folder::with_scene(SCENE);
    let (address, heard) = tev(1);
    let (_, stderr) = folder.run(&format!("render scene.toml -o a.png --time 1500ms --preview {address}"));
    heard.join().expect("understood");
    let expected = format!("warning: tev at {address} has gone: ");
    assert!(stderr.contains(&expected) && stderr.matches("warning").count() == 1, "{stderr}");
    assert!(folder.read("a.png").starts_with(b"\x89PNG"));
}

#[test]
fn without_a_terminal_there_is_no_picture_in_it() {
    let folder = Folder::with_scene(SCENE);
    let (_, stderr) = folder.run("render scene.toml -o a.png --preview terminal");
    assert!(stderr.contains("warning: there is no terminal to show the picture in\nhint: "), "{stderr}");
    assert!(!stderr.contains('▀') && stderr.ends_with("wrote a.png\n"), "{stderr}");
}
