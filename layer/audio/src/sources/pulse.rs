//! The system's sound, from a sound server that speaks PulseAudio's protocol: PulseAudio, or PipeWire with pipewire-pulse.
//!
//! A stream is recorded from the monitor of the default output, which is found by asking the server for that output. The server may not
//! move it (`no_move`): when an output goes away, it moves recordings to the default *input*, which is a microphone. cpal's host for
//! PulseAudio cannot forbid that, nor report whether the output is muted, and waits for the server without limit; hence the protocol
//! itself, one thread, and nothing that waits longer than a moment.

mod connection;
mod cookie;
mod output;
mod volume;

pub use connection::Fault;

use crate::ring::Writer;
use crate::shared::Shared;
use connection::{Connection, Event, Message};
use output::Output;
use parafovea_manifest::sound_server;
use pulseaudio::protocol::{
    Command, CreateRecordStreamReply, GetSinkInfo, PulseError, ServerInfo, SinkInfo, SubscriptionMask,
};
use std::env::var_os;
use std::os::unix::net::UnixStream;
use std::time::{Duration, Instant};

/// A server that does not answer for so long is left, and tried again.
const PATIENCE: Duration = Duration::from_secs(2);

/// Interval between looks for an output, while there is none to listen to.
const LOOK_EVERY: Duration = Duration::from_millis(250);

/// Changes that come closer together, as while a slider is moved, are looked at together.
const SETTLE: Duration = Duration::from_millis(20);

/// Whether a server is running. (A socket may be left by one that has ended.)
pub fn is_there() -> bool {
    sound_server::socket(|name| var_os(name)).is_ok_and(|path| UnixStream::connect(path).is_ok())
}

/// Listens until the capture ends.
///
/// # Errors
/// There is no server, or it ended, or does not answer.
pub fn listen(shared: &Shared) -> Result<(), Fault> {
    let path = sound_server::socket(|name| var_os(name))?;
    let cookie = cookie::read(&sound_server::cookie_files(|name| var_os(name)));
    let mut connection = Connection::open(&path, cookie, PATIENCE)?;
    let mask = SubscriptionMask::SINK | SubscriptionMask::SERVER;
    connection.send(&Command::Subscribe(mask))?;
    let mut listener = Listener {
        shared,
        connection,
        is_pipewire: false,
        asked: None,
        is_stale: true,
        looked: Instant::now(),
        gain: 1.0,
        stream: None,
    };
    while !shared.is_stopped() {
        listener.step()?;
    }
    Ok(())
}

/// A connection, and its recording.
struct Listener<'a> {
    shared: &'a Shared,
    connection: Connection,
    is_pipewire: bool,
    /// The question that the server has yet to answer; one at a time.
    asked: Option<Asked>,
    /// The server's state may differ from its last answer.
    is_stale: bool,
    looked: Instant,
    /// Factor for samples ([`volume::gain`]).
    gain: f32,
    stream: Option<Stream>,
}

struct Asked {
    sequence: u32,
    question: Question,
    since: Instant,
}

enum Question {
    /// The name of the default output.
    Server,
    /// The properties of that output.
    Output,
    /// To record it.
    Record(Output),
}

/// A recording.
struct Stream {
    channel: u32,
    output: Output,
    writer: Writer,
}

/// The meaning of a message, apart from samples, which are written at once.
enum ServerMessage {
    Server(ServerInfo),
    Output(Box<SinkInfo>),
    Recording(Output, Box<CreateRecordStreamReply>),
    Refused(Question, PulseError),
    Happened(Event),
}

impl Listener<'_> {
    /// Takes one message, if there is one within a moment.
    fn step(&mut self) -> Result<(), Fault> {
        self.ask()?;
        match self.receive()? {
            None => Ok(()),
            Some(ServerMessage::Happened(Event::Changed)) => {
                self.is_stale = true;
                Ok(())
            }
            Some(ServerMessage::Happened(Event::Ended(channel))) => {
                self.is_stale = true;
                match &self.stream {
                    Some(stream) if stream.channel == channel => {
                        self.nothing_to_hear("the output device was removed")
                    }
                    _ => Ok(()),
                }
            }
            Some(ServerMessage::Happened(Event::Moved)) => {
                self.is_stale = true;
                self.nothing_to_hear("the server moved the stream to another device")
            }
            Some(ServerMessage::Server(info)) => {
                self.is_pipewire = volume::is_pipewire(&info);
                match info.default_sink_name {
                    Some(name) => {
                        let question = GetSinkInfo { index: None, name: Some(name) };
                        self.send(&Command::GetSinkInfo(question), Question::Output)
                    }
                    None => self.nothing_to_hear("the server has no output"),
                }
            }
            Some(ServerMessage::Output(info)) => self.listen_to(&info),
            Some(ServerMessage::Recording(output, reply)) => {
                self.shared.messages.say(format!("capturing {output}"));
                let writer = self.shared.begin(output.format);
                self.stream = Some(Stream { channel: reply.channel, output, writer });
                Ok(())
            }
            // The output went away between two requests: the next query shows the new state.
            Some(ServerMessage::Refused(_, PulseError::NoEntity)) => {
                self.nothing_to_hear("the output device was removed")
            }
            Some(ServerMessage::Refused(question, error)) => {
                let what = match question {
                    Question::Server | Question::Output => "does not name its output",
                    Question::Record(_) => "refuses to record its output",
                };
                self.nothing_to_hear(&format!("the server {what} ({error:?})"))
            }
        }
    }

    /// Asks for the output's properties, where those may have changed.
    fn ask(&mut self) -> Result<(), Fault> {
        match &self.asked {
            Some(asked) if asked.since.elapsed() > PATIENCE => Err(Fault::Silent),
            Some(_) => Ok(()),
            None if self.is_time_to_look() => {
                self.is_stale = false;
                self.looked = Instant::now();
                self.send(&Command::GetServerInfo, Question::Server)
            }
            None => Ok(()),
        }
    }

    fn is_time_to_look(&self) -> bool {
        let since = self.looked.elapsed();
        (self.is_stale && since > SETTLE) || (self.stream.is_none() && since > LOOK_EVERY)
    }

    fn send(&mut self, command: &Command, question: Question) -> Result<(), Fault> {
        let sequence = self.connection.send(command)?;
        self.asked = Some(Asked { sequence, question, since: Instant::now() });
        Ok(())
    }

    /// The next message, if there is one within a moment. Samples are written.
    fn receive(&mut self) -> Result<Option<ServerMessage>, Fault> {
        match self.connection.receive()? {
            None => Ok(None),
            Some(Message::Samples { channel, bytes }) => {
                if let Some(stream) = self.stream.as_mut().filter(|stream| stream.channel == channel) {
                    stream.writer.write_f32_le(bytes, self.gain);
                }
                Ok(None)
            }
            Some(Message::Event(event)) => Ok(Some(ServerMessage::Happened(event))),
            Some(Message::Reply { sequence, body }) => {
                let Some(asked) = self.asked.take_if(|asked| asked.sequence == sequence) else {
                    return Ok(None);
                };
                Ok(Some(match asked.question {
                    Question::Server => ServerMessage::Server(body.read()?),
                    Question::Output => ServerMessage::Output(Box::new(body.read()?)),
                    Question::Record(output) => ServerMessage::Recording(output, Box::new(body.read()?)),
                }))
            }
            Some(Message::Refused { sequence, error }) => {
                let asked = self.asked.take_if(|asked| asked.sequence == sequence);
                Ok(asked.map(|asked| ServerMessage::Refused(asked.question, error)))
            }
        }
    }

    /// Records the monitor of this output, if it is not recorded already.
    fn listen_to(&mut self, info: &SinkInfo) -> Result<(), Fault> {
        let Some(output) = Output::of(info) else {
            return self.nothing_to_hear("the output has no monitor");
        };
        self.shared.set_muted(volume::is_muted(info));
        self.gain = volume::gain(info, self.is_pipewire);
        if self.stream.as_ref().is_some_and(|stream| stream.output == output) {
            return Ok(());
        }
        self.leave()?;
        let command = output.record();
        self.send(&command, Question::Record(output))
    }

    fn nothing_to_hear(&mut self, why: &str) -> Result<(), Fault> {
        self.leave()?;
        self.shared.messages.say(format!("not captured: {why}"));
        Ok(())
    }

    /// Ends the recording. Samples of it that still arrive are ignored.
    fn leave(&mut self) -> Result<(), Fault> {
        if let Some(stream) = self.stream.take() {
            // The server may know it no more; its answer is of no interest.
            self.connection.send(&Command::DeleteRecordStream(stream.channel))?;
        }
        Ok(())
    }
}
