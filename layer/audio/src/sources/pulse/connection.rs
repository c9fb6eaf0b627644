//! A connection to a sound server, one message at a time; nothing waits longer than a moment, and repeated messages do not allocate.

use parafovea_manifest::sound_server::NoSocket;
use pulseaudio::protocol::{
    AuthParams, AuthReply, Command, DESCRIPTOR_SIZE, MAX_VERSION, Prop, Props, ProtocolError, PulseError,
    SetClientNameReply, TagStructRead, TagStructReader, read_descriptor, write_command_message,
};
use std::io::{self, ErrorKind, Read, Write};
use std::os::unix::net::UnixStream;
use std::path::Path;
use std::time::{Duration, Instant};
use thiserror::Error;

/// Longest wait for a message.
const MOMENT: Duration = Duration::from_millis(50);

/// Room for messages; grows for one that needs more.
const ROOM: usize = 1 << 16;

/// The longest message that is taken.
const LONGEST: usize = 1 << 20;

/// The channel of messages that are not samples.
const NO_CHANNEL: u32 = u32::MAX;

/// Reason why a server is not listened to.
#[derive(Debug, Error)]
pub enum Fault {
    /// The environment names none.
    #[error(transparent)]
    NoSocket(#[from] NoSocket),
    /// There is none.
    #[error("no PulseAudio or PipeWire server is running")]
    NoServer,
    /// It cannot be reached any more.
    #[error("the connection to the sound server was lost ({0})")]
    Gone(io::Error),
    /// It does not answer.
    #[error("the sound server does not answer")]
    Silent,
    /// Its message makes no sense.
    #[error("the sound server sent an unknown message ({0})")]
    NotUnderstood(#[from] ProtocolError),
}

impl Fault {
    /// Whether there is no server at all.
    pub fn is_absence(&self) -> bool {
        matches!(self, Self::NoSocket(_) | Self::NoServer)
    }
}

/// A message of a server.
pub enum Message<'a> {
    /// The answer to a command.
    Reply { sequence: u32, body: Body<'a> },
    /// A command was refused.
    Refused { sequence: u32, error: PulseError },
    /// The server reports an event.
    Event(Event),
    /// Samples of a stream.
    Samples { channel: u32, bytes: &'a [u8] },
}

/// An event that a server reports on its own.
pub enum Event {
    /// Something that was subscribed to changed.
    Changed,
    /// The server ended the recording with this channel.
    Ended(u32),
    /// The server moved a recording to another source.
    Moved,
}

/// The content of a reply.
pub struct Body<'a> {
    bytes: &'a [u8],
    version: u16,
}

impl Body<'_> {
    /// Reads it as the requested type.
    pub fn read<T: TagStructRead>(mut self) -> Result<T, Fault> {
        Ok(TagStructReader::new(&mut self.bytes, self.version).read()?)
    }
}

/// A connection.
pub struct Connection {
    socket: UnixStream,
    version: u16,
    sequence: u32,
    room: Vec<u8>,
    /// Begin and end of the bytes in `room` that were not handed out yet.
    filled: std::ops::Range<usize>,
}

impl Connection {
    /// Connects, within `patience`.
    pub fn open(path: &Path, cookie: Vec<u8>, patience: Duration) -> Result<Self, Fault> {
        let socket = UnixStream::connect(path).map_err(|error| match error.kind() {
            ErrorKind::NotFound | ErrorKind::ConnectionRefused => Fault::NoServer,
            _ => Fault::Gone(error),
        })?;
        socket.set_read_timeout(Some(MOMENT)).map_err(Fault::Gone)?;
        socket.set_write_timeout(Some(patience)).map_err(Fault::Gone)?;
        let mut connection =
            Self { socket, version: MAX_VERSION, sequence: 0, room: vec![0; ROOM], filled: 0..0 };
        let auth = AuthParams { version: MAX_VERSION, supports_shm: false, supports_memfd: false, cookie };
        let reply: AuthReply = connection.ask(&Command::Auth(auth), patience)?;
        connection.version = reply.version.min(MAX_VERSION);
        let mut props = Props::new();
        props.set(Prop::ApplicationName, c"Parafovea");
        let _: SetClientNameReply = connection.ask(&Command::SetClientName(props), patience)?;
        Ok(connection)
    }

    /// Sends a command; returns the number that its answer will have.
    pub fn send(&mut self, command: &Command) -> Result<u32, Fault> {
        self.sequence = self.sequence.wrapping_add(1);
        let mut message = Vec::new();
        write_command_message(&mut message, self.sequence, command, self.version)?;
        self.socket.write_all(&message).map_err(Fault::Gone)?;
        Ok(self.sequence)
    }

    /// The next message, if there is one within a moment.
    pub fn receive(&mut self) -> Result<Option<Message<'_>>, Fault> {
        let Some(message) = self.fill()? else { return Ok(None) };
        let bytes = &self.room[message.start + DESCRIPTOR_SIZE..message.end];
        let channel = read_descriptor(&mut &self.room[message])?.channel;
        if channel != NO_CHANNEL {
            return Ok(Some(Message::Samples { channel, bytes }));
        }
        let mut rest = bytes;
        Ok(match Command::read_tag_prefixed(&mut rest, self.version) {
            Ok((sequence, Command::Reply)) => {
                Some(Message::Reply { sequence, body: Body { bytes: rest, version: self.version } })
            }
            Ok((sequence, Command::Error(error))) => Some(Message::Refused { sequence, error }),
            Ok((_, Command::SubscribeEvent(_))) => Some(Message::Event(Event::Changed)),
            Ok((_, Command::RecordStreamKilled(channel))) => Some(Message::Event(Event::Ended(channel))),
            Ok((_, Command::RecordStreamMoved(_))) => Some(Message::Event(Event::Moved)),
            // Events that are of no interest, or that came after this version of the protocol.
            Ok(_) | Err(_) => None,
        })
    }

    /// Sends a command and waits for its answer.
    fn ask<T: TagStructRead>(&mut self, command: &Command, patience: Duration) -> Result<T, Fault> {
        let asked = self.send(command)?;
        let end = Instant::now() + patience;
        while Instant::now() < end {
            match self.receive()? {
                Some(Message::Reply { sequence, body }) if sequence == asked => return body.read(),
                Some(Message::Refused { sequence, error }) if sequence == asked => {
                    return Err(ProtocolError::ServerError(error).into());
                }
                _ => {}
            }
        }
        Err(Fault::Silent)
    }

    /// Range in `room` of the next whole message, which counts as handed out; reads once, if it is not there yet.
    fn fill(&mut self) -> Result<Option<std::ops::Range<usize>>, Fault> {
        if let Some(message) = self.next_message()? {
            return Ok(Some(message));
        }
        if self.filled.is_empty() {
            self.filled = 0..0;
        } else if self.filled.start > 0 {
            self.room.copy_within(self.filled.clone(), 0);
            self.filled = 0..self.filled.len();
        }
        if self.filled.end == self.room.len() {
            self.room.resize(self.room.len() * 2, 0);
        }
        match self.socket.read(&mut self.room[self.filled.end..]) {
            Ok(0) => Err(Fault::Gone(ErrorKind::UnexpectedEof.into())),
            Ok(count) => {
                self.filled.end += count;
                self.next_message()
            }
            Err(error) => match error.kind() {
                ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted => Ok(None),
                _ => Err(Fault::Gone(error)),
            },
        }
    }

    fn next_message(&mut self) -> Result<Option<std::ops::Range<usize>>, Fault> {
        let waiting = &self.room[self.filled.clone()];
        if waiting.len() < DESCRIPTOR_SIZE {
            return Ok(None);
        }
        let length = DESCRIPTOR_SIZE + read_descriptor(&mut &waiting[..])?.length as usize;
        if length > LONGEST {
            let what = format!("a message of {length} bytes");
            return Err(ProtocolError::Invalid(what).into());
        }
        if waiting.len() < length {
            return Ok(None);
        }
        let message = self.filled.start..self.filled.start + length;
        self.filled.start = message.end;
        Ok(Some(message))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::os::unix::net::UnixListener;

    /// Patience with a server that answers or ends, however busy the machine is.
    const LONG: Duration = Duration::from_secs(20);

    /// Patience with a server that does not answer.
    const SHORT: Duration = Duration::from_millis(300);

    /// A client's error with a server that answers with these bytes, and then ends if `it_ends`.
    fn fault(answer: Vec<u8>, it_ends: bool, patience: Duration) -> Fault {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("native");
        let listener = UnixListener::bind(&path).unwrap();
        let server = std::thread::spawn(move || {
            let (mut socket, _) = listener.accept().unwrap();
            // A client may have left by then.
            drop(socket.write_all(&answer));
            let mut nothing = [0; 1024];
            // Until the client ends, or at once.
            while !it_ends && socket.read(&mut nothing).is_ok_and(|count| count > 0) {}
        });
        let fault = Connection::open(&path, vec![0; 256], patience).err().unwrap();
        server.join().unwrap();
        fault
    }

    fn message(length: u32, content: &[u8]) -> Vec<u8> {
        let mut bytes = length.to_be_bytes().to_vec();
        bytes.extend([0xff; 4]);
        bytes.extend([0; 12]);
        bytes.extend_from_slice(content);
        bytes
    }

    #[test]
    fn a_server_that_makes_no_sense_is_left() {
        assert!(matches!(fault(vec![], true, LONG), Fault::Gone(_)));
        assert!(matches!(fault(vec![], false, SHORT), Fault::Silent));
        // Longer than any message of a server.
        assert!(matches!(fault(message(u32::MAX, &[]), false, LONG), Fault::NotUnderstood(_)));
        // Commands that there are not; samples of a stream that there is not; a message that never ends.
        assert!(matches!(fault(message(10, b"L\0\0\xff\xffL\0\0\0\x01"), false, SHORT), Fault::Silent));
        assert!(matches!(fault(message(4, b"\x00\x01\x02\x03"), false, SHORT), Fault::Silent));
        assert!(matches!(fault(message(100, b"L\0"), false, SHORT), Fault::Silent));
        // A refusal: error 1 to the first command.
        let refused = message(15, b"L\0\0\0\0L\0\0\0\x01L\0\0\0\x01");
        assert!(matches!(fault(refused, false, LONG), Fault::NotUnderstood(ProtocolError::ServerError(_))));
    }

    #[test]
    fn a_missing_server_gives_no_connection() {
        let fault = Connection::open(Path::new("/nowhere/native"), Vec::new(), Duration::ZERO).err().unwrap();
        assert!(fault.is_absence());
        let fault = Fault::from(NoSocket::Remote);
        assert!(fault.is_absence());
        assert_eq!(fault.to_string(), "PULSE_SERVER names no local socket");
    }
}
