//! Location of this user's server (PulseAudio's `pulse-client.conf(5)` and its `client.conf`, as far as variables go).

use std::env::var_os;
use std::ffi::OsString;
use std::path::PathBuf;

/// The server's socket; `None` if the environment names no local one.
pub fn socket() -> Option<PathBuf> {
    find_socket(|name| var_os(name))
}

/// Length of a cookie, bytes; a server does not talk to a client that sends another one.
const COOKIE_BYTES: usize = 256;

/// The cookie that lets this user in where the kernel's credentials are not enough: in containers. Zeros without a cookie.
pub fn cookie() -> Vec<u8> {
    let named = var_os("PULSE_COOKIE").map(PathBuf::from);
    let home = var_os("HOME").map(PathBuf::from);
    let config =
        var_os("XDG_CONFIG_HOME").map(PathBuf::from).or_else(|| Some(home.as_ref()?.join(".config")));
    let usual = config.map(|config| config.join("pulse/cookie"));
    let former = home.map(|home| home.join(".pulse-cookie"));
    let places = [named, usual, former];
    let mut cookie =
        places.into_iter().flatten().find_map(|path| std::fs::read(path).ok()).unwrap_or_default();
    cookie.resize(COOKIE_BYTES, 0);
    cookie
}

fn find_socket(variable: impl Fn(&str) -> Option<OsString>) -> Option<PathBuf> {
    let set = |name| variable(name).filter(|value| !value.is_empty());
    if let Some(server) = set("PULSE_SERVER") {
        return server.to_str().and_then(local);
    }
    let folder = set("PULSE_RUNTIME_PATH").map(PathBuf::from);
    let folder = folder.or_else(|| Some(PathBuf::from(set("XDG_RUNTIME_DIR")?).join("pulse")))?;
    Some(folder.join("native"))
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

#[cfg(test)]
mod tests {
    use super::*;

    fn found(variables: &[(&str, &str)]) -> Option<PathBuf> {
        find_socket(|name| {
            variables.iter().find(|(known, _)| *known == name).map(|(_, value)| OsString::from(value))
        })
    }

    #[test]
    fn the_socket_is_where_clients_of_the_server_look_for_it() {
        let runtime = ("XDG_RUNTIME_DIR", "/run/user/1");
        for (variables, path) in [
            (&[runtime][..], Some("/run/user/1/pulse/native")),
            (&[runtime, ("PULSE_RUNTIME_PATH", "/p")], Some("/p/native")),
            (&[runtime, ("PULSE_SERVER", "unix:/a/b")], Some("/a/b")),
            (&[runtime, ("PULSE_SERVER", "tcp:host {id}unix:/c /d")], Some("/c")),
            (&[runtime, ("PULSE_SERVER", "/d")], Some("/d")),
            (&[runtime, ("PULSE_SERVER", "tcp:host")], None),
            (&[runtime, ("PULSE_SERVER", "")], Some("/run/user/1/pulse/native")),
            (&[], None),
        ] {
            assert_eq!(found(variables), path.map(PathBuf::from), "{variables:?}");
        }
    }
}
