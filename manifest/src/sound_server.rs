//! Location of the user's sound server, PulseAudio or PipeWire in its place, from an environment that the caller passes.
//!
//! Source: `pulse-client.conf(5)` and PulseAudio's `client-conf.c`, `core-util.c` and `authkey.c`, as far as variables go.

use crate::paths::Environment;
use std::ffi::OsString;
use std::path::PathBuf;
use thiserror::Error;

/// The variable with a list of servers.
const SERVERS_VARIABLE: &str = "PULSE_SERVER";

/// Reason why an environment has no socket of a sound server.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum NoSocket {
    /// The variable names servers on other computers alone.
    #[error("PULSE_SERVER names no local socket")]
    Remote,
    /// No variable names the folder of the socket.
    #[error("no sound server can be found: XDG_RUNTIME_DIR is unset or not an absolute path")]
    NoFolder,
}

/// The server's socket, by the variables that `variable` looks up. It need not exist.
///
/// # Errors
/// The environment names none.
pub fn socket(variable: impl Fn(&str) -> Option<OsString>) -> Result<PathBuf, NoSocket> {
    let set = |name| variable(name).filter(|value| !value.is_empty());
    if let Some(servers) = set(SERVERS_VARIABLE) {
        return servers.to_str().and_then(local).ok_or(NoSocket::Remote);
    }
    let named = set("PULSE_RUNTIME_PATH").map(PathBuf::from).filter(|folder| folder.is_absolute());
    let usual = || Some(Environment::new(false, &variable).runtime_dir()?.join("pulse"));
    let folder = named.or_else(usual).ok_or(NoSocket::NoFolder)?;
    Ok(folder.join("native"))
}

/// The first local socket in a list of servers: `{machine}unix:/path /path tcp:host`.
fn local(servers: &str) -> Option<PathBuf> {
    let path = |server: &str| {
        let server = match server.strip_prefix('{') {
            Some(rest) => rest.split_once('}')?.1,
            None => server,
        };
        let path = server.strip_prefix("unix:").unwrap_or(server);
        path.starts_with('/').then(|| PathBuf::from(path))
    };
    servers.split_whitespace().find_map(path)
}

/// Files that may have the cookie that lets this user in, the first choice first.
pub fn cookie_files(variable: impl Fn(&str) -> Option<OsString>) -> Vec<PathBuf> {
    let environment = Environment::new(false, &variable);
    let folder = environment.config_home().map(|config| config.join("pulse"));
    let named = variable("PULSE_COOKIE").filter(|value| !value.is_empty()).map(PathBuf::from);
    // A relative path is below that folder.
    let named = named.map(|named| folder.clone().unwrap_or_default().join(named));
    let usual = folder.map(|folder| folder.join("cookie"));
    let former = environment.home().map(|home| home.join(".pulse-cookie"));
    [named, usual, former].into_iter().flatten().filter(|file| file.is_absolute()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn looked_up(variables: &[(&str, &str)]) -> impl Fn(&str) -> Option<OsString> {
        move |name| variables.iter().find(|(known, _)| *known == name).map(|(_, value)| OsString::from(value))
    }

    #[test]
    fn the_socket_is_where_clients_of_the_server_look_for_it() {
        let runtime = ("XDG_RUNTIME_DIR", "/run/user/1");
        for (variables, expected) in [
            (&[runtime][..], Ok("/run/user/1/pulse/native")),
            (&[runtime, ("PULSE_RUNTIME_PATH", "/p")], Ok("/p/native")),
            (&[runtime, ("PULSE_RUNTIME_PATH", "p")], Ok("/run/user/1/pulse/native")),
            (&[runtime, ("PULSE_SERVER", "unix:/a/b")], Ok("/a/b")),
            (&[runtime, ("PULSE_SERVER", "unix:/a tcp:b")], Ok("/a")),
            (&[runtime, ("PULSE_SERVER", "tcp:host {id}unix:/c /d")], Ok("/c")),
            (&[runtime, ("PULSE_SERVER", "/d")], Ok("/d")),
            (&[runtime, ("PULSE_SERVER", "tcp:host")], Err(NoSocket::Remote)),
            (&[runtime, ("PULSE_SERVER", "")], Ok("/run/user/1/pulse/native")),
            (&[("XDG_RUNTIME_DIR", "run")], Err(NoSocket::NoFolder)),
            (&[], Err(NoSocket::NoFolder)),
        ] {
            assert_eq!(socket(looked_up(variables)), expected.map(PathBuf::from), "{variables:?}");
        }
    }

    #[test]
    fn no_cookie_is_searched_in_the_working_directory() {
        let home = ("HOME", "/h");
        let usual = ["/h/.config/pulse/cookie", "/h/.pulse-cookie"];
        for (variables, expected) in [
            (&[home][..], &usual[..]),
            (&[home, ("XDG_CONFIG_HOME", "")], &usual),
            (&[home, ("XDG_CONFIG_HOME", "rel")], &usual),
            (
                &[home, ("XDG_CONFIG_HOME", "/c"), ("PULSE_COOKIE", "")],
                &["/c/pulse/cookie", "/h/.pulse-cookie"],
            ),
            (&[home, ("PULSE_COOKIE", "/k")], &["/k", usual[0], usual[1]]),
            (&[home, ("PULSE_COOKIE", "k")], &["/h/.config/pulse/k", usual[0], usual[1]]),
            (&[("PULSE_COOKIE", "k")], &[]),
            (&[("PULSE_COOKIE", "/k")], &["/k"]),
            (&[], &[]),
        ] {
            let expected: Vec<_> = expected.iter().map(PathBuf::from).collect();
            assert_eq!(cookie_files(looked_up(variables)), expected, "{variables:?}");
        }
    }
}
