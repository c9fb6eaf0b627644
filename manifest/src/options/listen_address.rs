//! Options that name an address to receive at.

use super::{Allowed, Setting};
use std::net::{IpAddr, Ipv4Addr, SocketAddr};
use toml::de::DeValue;

/// An IP address and a port, at which packets are received.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ListenAddress(SocketAddr);

impl ListenAddress {
    /// A port of this computer's IPv4 loopback, which other computers cannot reach.
    pub(super) const fn loopback(port: u16) -> Self {
        Self(SocketAddr::new(IpAddr::V4(Ipv4Addr::LOCALHOST), port))
    }

    /// The address to bind.
    pub const fn socket(self) -> SocketAddr {
        self.0
    }

    /// Whether only programs of this computer can send to it.
    pub fn is_loopback(self) -> bool {
        self.0.ip().is_loopback()
    }

    /// Port 0 is none: the system would choose another one each time, which no sender knows.
    fn parse(text: &str) -> Option<Self> {
        text.parse().ok().filter(|address: &SocketAddr| address.port() != 0).map(Self)
    }
}

impl Setting for ListenAddress {
    type Range = ();

    fn read(value: &DeValue<'_>, (): ()) -> Option<Self> {
        Self::parse(value.as_str()?)
    }

    fn allowed((): ()) -> Allowed {
        Allowed::Text("an IP address and a port from 1 to 65535, such as \"127.0.0.1:9020\"")
    }

    fn to_toml(self) -> String {
        format!("\"{}\"", self.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nobody_else_is_listened_to_unless_the_user_says_so() {
        assert!(crate::config::Config::default().gaze.osc_listen.is_loopback());
        for preset in crate::options::Preset::ALL {
            assert!(crate::config::Config::of_preset(*preset).gaze.osc_listen.is_loopback(), "{preset:?}");
        }
    }

    #[test]
    fn an_address_and_a_port_are_taken_and_names_are_not() {
        for (text, is_loopback) in [
            ("127.0.0.1:9020", true),
            ("127.3.2.1:1", true),
            ("[::1]:65535", true),
            ("0.0.0.0:9020", false),
            ("192.168.1.2:9000", false),
            ("[::]:9000", false),
        ] {
            let address = ListenAddress::parse(text).unwrap();
            assert_eq!((address.is_loopback(), address.to_toml()), (is_loopback, format!("\"{text}\"")));
        }
        for refused in ["", "9020", ":9020", "localhost:9020", "127.0.0.1", "127.0.0.1:0", "127.0.0.1:65536"]
        {
            assert_eq!(ListenAddress::parse(refused), None, "{refused}");
        }
    }
}
