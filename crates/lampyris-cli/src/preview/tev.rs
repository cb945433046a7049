//! The viewer tev, over TCP <https://github.com/Tom94/tev>.

use std::io;
use std::net::{TcpStream, ToSocketAddrs};
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::time::Duration;

use lampyris::error::{Result, Warning};
use tev_client::{PacketCreateImage, PacketUpdateImage, TevClient};

use super::canvas::{Canvas, Rows};

/// How often it is sent what is new.
const INTERVAL: Duration = Duration::from_millis(200);

/// How long it may take to answer, and to take a packet.
const PATIENCE: Duration = Duration::from_secs(2);

/// Floats in a packet, about.
const PACKET: usize = 1 << 18;

const CHANNELS: [&str; 3] = ["R", "G", "B"];

/// Shows the canvas under this name until `more` is closed, and all of it then.
///
/// # Errors
/// If tev cannot be reached, or goes away.
pub fn show(canvas: &Canvas, address: &str, name: &str, more: &Receiver<()>) -> Result<()> {
    let stream = connect(address).map_err(|error| {
        Warning::new(format!("cannot reach tev at {address}: {}", reason(&error)))
            .with_hint("start tev first, or name the place where it listens: --preview HOST:PORT")
    })?;
    send_all(TevClient::wrap(stream), canvas, name, more).map_err(|error| {
        Warning::new(format!("tev at {address} has gone: {}", reason(&error)))
            .with_hint("the render goes on without the preview")
    })
}

fn connect(address: &str) -> io::Result<TcpStream> {
    let mut failure = io::Error::new(io::ErrorKind::NotFound, "the host has no address");
    for place in address.to_socket_addrs()? {
        match TcpStream::connect_timeout(&place, PATIENCE) {
            Ok(stream) => {
                stream.set_write_timeout(Some(PATIENCE))?;
                stream.set_nodelay(true)?;
                return Ok(stream);
            }
            Err(error) => failure = error,
        }
    }
    Err(failure)
}

fn send_all(mut tev: TevClient, canvas: &Canvas, name: &str, more: &Receiver<()>) -> io::Result<()> {
    let (width, height) = canvas.size();
    tev.send(PacketCreateImage {
        image_name: name,
        grab_focus: true,
        width: width as u32,
        height: height as u32,
        channel_names: &CHANNELS,
    })?;
    let most_rows = (PACKET / (3 * width).max(1)).max(1);
    let mut seen = 0;
    loop {
        let is_last = more.recv_timeout(INTERVAL) != Err(RecvTimeoutError::Timeout);
        for rows in canvas.since(&mut seen, most_rows) {
            send(&mut tev, name, width, &rows)?;
        }
        if is_last {
            return Ok(());
        }
    }
}

fn send(tev: &mut TevClient, name: &str, width: usize, rows: &Rows) -> io::Result<()> {
    tev.send(PacketUpdateImage {
        image_name: name,
        grab_focus: false,
        channel_names: &CHANNELS,
        channel_offsets: &[0, 1, 2],
        channel_strides: &[3; 3],
        x: 0,
        y: rows.first as u32,
        width: width as u32,
        height: rows.count as u32,
        data: rows.pixels.as_flattened(),
    })
}

/// What the operating system says, without its number.
fn reason(error: &io::Error) -> String {
    match error.kind() {
        io::ErrorKind::ConnectionRefused => "nobody listens there".into(),
        io::ErrorKind::TimedOut | io::ErrorKind::WouldBlock => "it does not answer".into(),
        io::ErrorKind::BrokenPipe | io::ErrorKind::ConnectionReset | io::ErrorKind::ConnectionAborted => {
            "it has closed the connection".into()
        }
        _ => error.to_string(),
    }
}
