//! The bytes of a board, both ways, and the connection again when it is lost. On a shared line the host gives the board its turns.

use fingertip::link::sink::Turn;
use fingertip::link::wire::MAXIMUM_FRAME;
use std::fmt;
use std::io::{self, ErrorKind, Read, Write};
use std::net::{TcpStream, ToSocketAddrs as _};
use std::str::FromStr;
use std::sync::mpsc::{Receiver, Sender, SyncSender, TryRecvError, channel, sync_channel};
use std::thread;
use std::time::{Duration, Instant};

/// Speed of the board's serial port, bits a second.
pub const BAUD: u32 = 921_600;
/// `--poll` alone, milliseconds: a board that reports each millisecond is asked each sixth, before its eighth report.
pub const SILENCE: &str = "3";
/// How long a read waits for bytes.
const PATIENCE: Duration = Duration::from_millis(20);
/// How long a connection may take.
const CONNECTING: Duration = Duration::from_secs(2);
/// How long a write may take on a line that takes nothing.
const WRITING: Duration = Duration::from_secs(1);
/// Events that wait while nobody takes them, each of at most [`BUFFER`] bytes: beyond it the line waits.
const WAITING: usize = 1024;
/// Bytes of one read.
const BUFFER: usize = 4096;
/// From a lost connection to the next try.
const RETRY: Duration = Duration::from_millis(500);

/// How long a polled board may say nothing: it greets once a second.
const UNANSWERED: Duration = Duration::from_millis(2500);
/// Most bytes of a board's turn.
const LONGEST_TURN: usize = Turn::FRAMES as usize * MAXIMUM_FRAME;
/// An empty frame: the host has nothing to say, and gives the turn.
const POLL: [u8; 1] = [0];

/// Where a board is.
#[derive(Clone, Debug, Eq, PartialEq)]
pub enum Address {
    /// A serial port, such as `/dev/ttyACM0` or `COM3`.
    Serial {
        /// Its name.
        port: String,
        /// Bits a second.
        baud: u32,
    },
    /// `tcp:HOST:PORT`.
    Tcp(String),
}

impl FromStr for Address {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text.strip_prefix("tcp:") {
            Some(address)
                if address
                    .rsplit_once(':')
                    .is_some_and(|(host, port)| !host.is_empty() && port.parse::<u16>().is_ok()) =>
            {
                Ok(Self::Tcp(address.to_owned()))
            }
            Some(_) => Err(format!(
                "`{text}` is no address; write tcp:HOST:PORT, such as tcp:127.0.0.1:4000"
            )),
            None if text.is_empty() => Err("a serial port has a name, such as /dev/ttyACM0".to_owned()),
            None => Ok(Self::Serial {
                port: text.to_owned(),
                baud: BAUD,
            }),
        }
    }
}

impl fmt::Display for Address {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Serial { port, .. } => f.write_str(port),
            Self::Tcp(address) => write!(f, "tcp:{address}"),
        }
    }
}

/// The value of `--poll`: milliseconds of silence after which the host gives the turn.
///
/// # Errors
/// It is no number from [`Turn::QUIET`] to a second.
pub fn silence(text: &str) -> Result<Duration, String> {
    text.parse()
        .ok()
        .filter(|silence| (1e-3 * Turn::QUIET as f64..=1000.0).contains(silence))
        .map(|silence| Duration::from_secs_f64(1e-3 * silence))
        .ok_or_else(|| "not a number of milliseconds from 1 to 1000".to_owned())
}

/// Both ways of a wire.
trait Wire: Read + Write + Send {}
impl<T: Read + Write + Send> Wire for T {}

impl Address {
    fn open(&self, patience: Duration) -> io::Result<Box<dyn Wire>> {
        match self {
            Self::Serial { port, baud } => {
                let port = serialport::new(port, *baud).timeout(patience).open()?;
                Ok(Box::new(port))
            }
            Self::Tcp(address) => {
                let mut last = io::Error::new(ErrorKind::NotFound, "the host has no address");
                for address in address.to_socket_addrs()? {
                    match TcpStream::connect_timeout(&address, CONNECTING) {
                        Ok(stream) => {
                            stream.set_read_timeout(Some(patience))?;
                            stream.set_write_timeout(Some(WRITING))?;
                            stream.set_nodelay(true)?;
                            return Ok(Box::new(stream));
                        }
                        Err(error) => last = error,
                    }
                }
                Err(last)
            }
        }
    }
}

/// What a link has to say.
#[derive(Clone, Debug, Eq, PartialEq)]
pub enum LinkEvent {
    /// It is connected.
    Connected,
    /// Bytes came.
    Bytes(Vec<u8>),
    /// It is not connected, or a polled board does not answer, and why; it will try again.
    Lost(String),
}

/// A connection that comes back. Dropped, it ends.
#[derive(Debug)]
pub struct Link {
    events: Receiver<LinkEvent>,
    outgoing: Sender<Vec<u8>>,
}

impl Link {
    /// Connects in the background, again and again. `poll`: the line is shared (RS-485); the host gives the turn again after so long a
    /// silence, at least [`Turn::QUIET`] and what the port holds bytes back for. `None`: the line is the board's own, and it sends unasked.
    pub fn start(address: Address, poll: Option<Duration>) -> Self {
        let (say, events) = sync_channel(WAITING);
        let (outgoing, to_send) = channel();
        thread::spawn(move || keep(&address, poll, &say, &to_send));
        Self { events, outgoing }
    }

    /// The next event, if it comes within that time.
    pub fn next(&self, within: Duration) -> Option<LinkEvent> {
        self.events.recv_timeout(within).ok()
    }

    /// Sends bytes, of a shared line one frame at a time; those sent while there is no connection are lost, as a board that is off loses
    /// them.
    pub fn send(&self, bytes: &[u8]) {
        // Its thread ends only after this.
        let _ = self.outgoing.send(bytes.to_vec());
    }
}

/// Keeps the connection until nobody listens.
fn keep(address: &Address, poll: Option<Duration>, say: &SyncSender<LinkEvent>, to_send: &Receiver<Vec<u8>>) {
    let patience = poll.map_or(PATIENCE, |quiet| quiet.min(PATIENCE));
    loop {
        let reason = match address.open(patience) {
            Ok(mut wire) => {
                while to_send.try_recv().is_ok() {}
                if say.send(LinkEvent::Connected).is_err() {
                    return;
                }
                let carried = match poll {
                    None => carry(wire.as_mut(), say, to_send),
                    Some(quiet) => take_turns(wire.as_mut(), quiet, say, to_send),
                };
                match carried {
                    Ok(()) => return,
                    Err(error) => error.to_string(),
                }
            }
            Err(error) => error.to_string(),
        };
        if say.send(LinkEvent::Lost(reason)).is_err() {
            return;
        }
        thread::sleep(RETRY);
    }
}

/// Bytes that are there, none if none came in the wire's patience.
fn read(wire: &mut dyn Wire, buffer: &mut [u8]) -> io::Result<usize> {
    match wire.read(buffer) {
        Ok(0) => Err(io::Error::new(
            ErrorKind::UnexpectedEof,
            "the other end closed the connection",
        )),
        Err(error)
            if matches!(
                error.kind(),
                ErrorKind::TimedOut | ErrorKind::WouldBlock | ErrorKind::Interrupted
            ) =>
        {
            Ok(0)
        }
        read => read,
    }
}

/// Carries bytes until the wire breaks, or nobody listens.
fn carry(wire: &mut dyn Wire, say: &SyncSender<LinkEvent>, to_send: &Receiver<Vec<u8>>) -> io::Result<()> {
    let mut buffer = [0; BUFFER];
    loop {
        let count = read(wire, &mut buffer)?;
        if count > 0 && say.send(LinkEvent::Bytes(buffer[..count].to_vec())).is_err() {
            return Ok(());
        }
        loop {
            match to_send.try_recv() {
                Ok(bytes) => wire.write_all(&bytes)?,
                Err(TryRecvError::Empty) => break,
                Err(TryRecvError::Disconnected) => return Ok(()),
            }
        }
    }
}

/// The host's end of a shared line: a command or a poll gives the board the turn, which is over when it is quiet. Until the wire breaks,
/// or nobody listens.
fn take_turns(
    wire: &mut dyn Wire,
    quiet: Duration,
    say: &SyncSender<LinkEvent>,
    to_send: &Receiver<Vec<u8>>,
) -> io::Result<()> {
    let mut buffer = [0; BUFFER];
    let (mut answered, mut is_silent) = (Instant::now(), false);
    loop {
        // Also before the first turn: another program may have given the board one. Only a read that found nothing proves the silence: time
        // alone also passes while bytes wait here.
        let (mut heard, mut came) = (Instant::now(), 0);
        loop {
            let count = read(wire, &mut buffer)?;
            if count == 0 && heard.elapsed() >= quiet {
                break;
            }
            if count == 0 {
                continue;
            }
            heard = Instant::now();
            came += count;
            if came > LONGEST_TURN {
                return Err(io::Error::other(
                    "the board does not stop sending, so its line is not a shared one: leave --poll out",
                ));
            }
            if std::mem::take(&mut is_silent) && say.send(LinkEvent::Connected).is_err()
                || say.send(LinkEvent::Bytes(buffer[..count].to_vec())).is_err()
            {
                return Ok(());
            }
        }
        if came > 0 {
            answered = heard;
        } else if !is_silent && answered.elapsed() > UNANSWERED {
            is_silent = true;
            let reason = format!(
                "no answer to polls for {} s; see that the board has power, and firmware with the feature rs485",
                UNANSWERED.as_secs_f64()
            );
            if say.send(LinkEvent::Lost(reason)).is_err() {
                return Ok(());
            }
        }
        match to_send.try_recv() {
            Ok(bytes) => wire.write_all(&bytes)?,
            Err(TryRecvError::Empty) => wire.write_all(&POLL)?,
            Err(TryRecvError::Disconnected) => return Ok(()),
        }
        wire.flush()?;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::net::TcpListener;

    #[test]
    fn an_address_is_a_port_or_a_socket() {
        assert_eq!(
            "tcp:127.0.0.1:4000".parse(),
            Ok(Address::Tcp("127.0.0.1:4000".to_owned()))
        );
        assert_eq!(
            "/dev/ttyACM0".parse(),
            Ok(Address::Serial {
                port: "/dev/ttyACM0".to_owned(),
                baud: BAUD
            })
        );
        for wrong in [
            "",
            "tcp:",
            "tcp:4000",
            "tcp::4000",
            "tcp:host:port",
            "tcp:host:70000",
        ] {
            assert!(wrong.parse::<Address>().is_err(), "{wrong}");
        }
    }

    const LONG: Duration = Duration::from_secs(10);

    #[test]
    fn a_link_carries_both_ways_and_comes_back() {
        let server = TcpListener::bind("127.0.0.1:0").expect("a port");
        let address = server.local_addr().expect("bound");
        let link = Link::start(Address::Tcp(address.to_string()), None);
        for round in 0..2_u8 {
            let (mut peer, _) = server.accept().expect("it connects");
            assert_eq!(link.next(LONG), Some(LinkEvent::Connected));
            peer.write_all(&[round]).expect("it reads");
            assert_eq!(link.next(LONG), Some(LinkEvent::Bytes(vec![round])));
            link.send(&[7, round]);
            let mut got = [0; 2];
            peer.read_exact(&mut got).expect("it writes");
            assert_eq!(got, [7, round]);
            drop(peer);
            assert!(matches!(link.next(LONG), Some(LinkEvent::Lost(_))));
        }
    }

    /// Bytes that wait, then silence. It counts what the host sends into the bytes that wait.
    struct Waiting {
        chunks: usize,
        collisions: usize,
        polls: usize,
    }

    impl Read for Waiting {
        fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
            if self.polls > 0 {
                return Ok(0);
            }
            if self.chunks == 0 {
                thread::sleep(Duration::from_millis(1));
                return Err(ErrorKind::TimedOut.into());
            }
            self.chunks -= 1;
            buffer[0] = 1;
            Ok(1)
        }
    }

    impl Write for Waiting {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            self.collisions += usize::from(self.chunks > 0);
            self.polls += 1;
            Ok(bytes.len())
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    #[test]
    fn a_host_that_is_slow_to_take_bytes_does_not_send_into_those_that_wait() {
        let (say, events) = sync_channel(0);
        let (_outgoing, to_send) = channel();
        let taker = thread::spawn(move || {
            let mut count = 0;
            while events.recv().is_ok() {
                count += 1;
                thread::sleep(Duration::from_millis(5));
            }
            count
        });
        let mut wire = Waiting {
            chunks: 10,
            collisions: 0,
            polls: 0,
        };
        let ended = take_turns(&mut wire, Duration::from_millis(2), &say, &to_send);
        drop(say);
        assert_eq!(ended.map_err(|error| error.kind()), Err(ErrorKind::UnexpectedEof));
        assert_eq!(taker.join().expect("it ends"), 10);
        assert_eq!((wire.collisions, wire.polls), (0, 1));
    }

    #[test]
    fn a_link_to_nothing_says_why() {
        let free = TcpListener::bind("127.0.0.1:0").expect("a port");
        let address = free.local_addr().expect("bound");
        drop(free);
        let link = Link::start(Address::Tcp(address.to_string()), None);
        assert!(matches!(link.next(LONG), Some(LinkEvent::Lost(reason)) if !reason.is_empty()));
        let port = Address::Serial {
            port: "/dev/no-such-port".to_owned(),
            baud: BAUD,
        };
        let link = Link::start(port, None);
        assert!(matches!(link.next(LONG), Some(LinkEvent::Lost(reason)) if !reason.is_empty()));
    }
}
