//! The emulated board behind a socket: what its serial wire says goes to whoever is connected, what they send goes to the board,
//! and its time is held back to the clock on the wall.

use crate::bench::{Listener, Moment};
use crate::plant::Plant;
use std::io::{self, ErrorKind, Read, Write};
use std::net::{SocketAddr, TcpListener, TcpStream};
use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

/// Bytes that a client may be behind before it is let go.
const BACKLOG: usize = 1 << 20;

/// A socket that is the board's serial wire.
#[derive(Debug)]
pub struct Server {
    socket: TcpListener,
    clients: Vec<Client>,
    /// Wall clock at virtual time zero; set by the first millisecond.
    start: Option<Instant>,
    /// Since the last millisecond.
    heard: Vec<u8>,
    ended: Arc<AtomicBool>,
}

#[derive(Debug)]
struct Client {
    stream: TcpStream,
    waiting: Vec<u8>,
}

impl Server {
    /// Listens at an address such as `127.0.0.1:4000`.
    ///
    /// # Errors
    /// What the operating system answers.
    pub fn bind(address: &str) -> io::Result<Self> {
        let socket = TcpListener::bind(address)?;
        socket.set_nonblocking(true)?;
        Ok(Self {
            socket,
            clients: vec![],
            start: None,
            heard: vec![],
            ended: Arc::default(),
        })
    }

    /// Where it listens.
    ///
    /// # Errors
    /// What the operating system answers.
    pub fn address(&self) -> io::Result<SocketAddr> {
        self.socket.local_addr()
    }

    /// Set to end the run.
    pub fn ended(&self) -> Arc<AtomicBool> {
        Arc::clone(&self.ended)
    }

    fn accept(&mut self) {
        while let Ok((stream, _)) = self.socket.accept() {
            if stream.set_nonblocking(true).is_ok() && stream.set_nodelay(true).is_ok() {
                self.clients.push(Client {
                    stream,
                    waiting: vec![],
                });
            }
        }
    }
}

impl Client {
    /// Both ways, as far as they go; `None` when it is gone.
    fn exchange(&mut self, heard: &[u8], emitted: &mut Vec<u8>) -> Option<()> {
        self.waiting.extend_from_slice(heard);
        let mut sent = 0;
        while sent < self.waiting.len() {
            match self.stream.write(&self.waiting[sent..]) {
                Ok(0) => return None,
                Ok(count) => sent += count,
                Err(error) if error.kind() == ErrorKind::WouldBlock => break,
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(_) => return None,
            }
        }
        self.waiting.drain(..sent);
        let mut buffer = [0; 256];
        loop {
            match self.stream.read(&mut buffer) {
                Ok(0) => return None,
                Ok(count) => emitted.extend_from_slice(&buffer[..count]),
                Err(error) if error.kind() == ErrorKind::WouldBlock => break,
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(_) => return None,
            }
        }
        (self.waiting.len() < BACKLOG).then_some(())
    }
}

impl Listener for Server {
    fn hear(&mut self, byte: u8, _moment: Moment, _plant: &Plant) -> ControlFlow<()> {
        self.heard.push(byte);
        if self.ended.load(Ordering::Relaxed) {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    }

    fn say(&mut self, time: f64) -> Vec<u8> {
        let start = *self.start.get_or_insert_with(Instant::now);
        if let Some(ahead) = Duration::from_secs_f64(time).checked_sub(start.elapsed()) {
            thread::sleep(ahead);
        }
        self.accept();
        let mut emitted = vec![];
        let heard = std::mem::take(&mut self.heard);
        self.clients
            .retain_mut(|client| client.exchange(&heard, &mut emitted).is_some());
        emitted
    }
}
