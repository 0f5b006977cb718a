//! Access control: requests must be addressed to the server, and come from its own page.
//!
//! A foreign page cannot forge `Host` and `Origin`. `Host` is a foreign name after DNS rebinding,
//! `Origin` is foreign for cross-origin requests.

use std::net::{IpAddr, SocketAddr, UdpSocket};

use axum::extract::{Request, State};
use axum::http::{HeaderMap, HeaderValue, StatusCode, Uri, header};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};

/// The host names of the server.
#[derive(Debug, Clone)]
pub(super) struct Names {
    /// As given with `--host`.
    host: String,
    address: SocketAddr,
}

impl Names {
    pub(super) fn new(host: &str, address: SocketAddr) -> Self {
        Self { host: host.trim_matches(['[', ']']).to_ascii_lowercase(), address }
    }

    /// The URL of the page.
    pub(super) fn url(&self) -> String {
        let host = match self.host.parse::<IpAddr>() {
            // Not an address that a browser can open.
            Ok(ip) if ip.is_unspecified() && ip.is_ipv6() => "[::1]".to_owned(),
            Ok(ip) if ip.is_unspecified() => "127.0.0.1".to_owned(),
            Ok(IpAddr::V6(ip)) => format!("[{ip}]"),
            _ => self.host.clone(),
        };
        format!("http://{host}:{}/", self.address.port())
    }

    /// The URL for other machines, if the server listens to them.
    pub(super) fn url_for_others(&self) -> Option<String> {
        let bound = self.address.ip();
        if bound.is_loopback() {
            return None;
        }
        if !bound.is_unspecified() {
            return Some(self.url());
        }
        // The address from which this machine would answer; nothing is sent.
        let any = SocketAddr::new(bound, 0);
        let elsewhere = if bound.is_ipv6() { "[2001:db8::1]:9" } else { "192.0.2.1:9" };
        let own = UdpSocket::bind(any).and_then(|socket| {
            socket.connect(elsewhere)?;
            socket.local_addr()
        });
        let host = own.map_or(bound, |own| own.ip());
        Some(format!("http://{}/", SocketAddr::new(host, self.address.port())))
    }

    /// True if only this machine reaches the server.
    pub(super) fn is_local(&self) -> bool {
        self.address.ip().is_loopback()
    }

    /// True for `host` or `host:port` of this server.
    fn knows(&self, authority: &str) -> bool {
        let (host, port) = match authority.rsplit_once(':') {
            Some((host, port)) if !port.contains(']') => (host, port.parse().ok()),
            _ => (authority, Some(80)),
        };
        if port != Some(self.address.port()) {
            return false;
        }
        let host = host.trim_matches(['[', ']']).to_ascii_lowercase();
        let bound = self.address.ip();
        let everywhere = bound.is_unspecified();
        let loopback = bound.is_loopback() || everywhere;
        match host.parse::<IpAddr>() {
            // After DNS rebinding the request still carries the name of the foreign page.
            Ok(ip) => ip == bound || everywhere || (loopback && ip.is_loopback()),
            Err(_) => host == self.host || (loopback && host == "localhost"),
        }
    }

    /// Why a request is rejected, if it is.
    fn fault(&self, headers: &HeaderMap) -> Option<&'static str> {
        let mut hosts = headers.get_all(header::HOST).iter();
        let host = hosts.next().and_then(|h| h.to_str().ok());
        if hosts.next().is_some() || !host.is_some_and(|h| self.knows(h)) {
            return Some(
                "The Host of this request is not an address of this server. Open the URL that \
                 `cylindroid view` printed, or name the host with --host.",
            );
        }
        let own = |origin: &HeaderValue| {
            let authority = origin.to_str().ok().and_then(|o| o.strip_prefix("http://"));
            authority.is_some_and(|a| self.knows(a))
        };
        if !headers.get_all(header::ORIGIN).iter().all(own) {
            return Some("Requests from other pages are not allowed.");
        }
        None
    }
}

/// What requests are checked with.
#[derive(Debug, Clone)]
pub(super) struct Guard {
    pub(super) names: Names,
    /// The pages that may show this one in a frame; `None`: no page.
    pub(super) frame_ancestors: Option<String>,
}

/// Rejects foreign requests; adds the security headers to all answers.
pub(super) async fn guard(State(own): State<Guard>, request: Request, next: Next) -> Response {
    let fault = own.names.fault(request.headers());
    let host = request.headers().get(header::HOST).and_then(|h| h.to_str().ok());
    let frames = own.frame_ancestors.as_deref().unwrap_or("'none'");
    let policy = policy(host.filter(|_| fault.is_none()).unwrap_or_default(), frames);
    let mut response = match fault {
        Some(fault) => (StatusCode::FORBIDDEN, fault).into_response(),
        None if has_foreign_form(request.uri()) => {
            (StatusCode::BAD_REQUEST, "Request a path, not a URL of another server.")
                .into_response()
        }
        None => next.run(request).await,
    };
    let headers = response.headers_mut();
    for (name, value) in [
        (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
        (header::REFERRER_POLICY, "no-referrer"),
        (header::CACHE_CONTROL, "no-cache"),
        (header::HeaderName::from_static("cross-origin-resource-policy"), "same-origin"),
        (header::HeaderName::from_static("cross-origin-opener-policy"), "same-origin"),
    ] {
        headers.insert(name, HeaderValue::from_static(value));
    }
    if own.frame_ancestors.is_none() {
        headers.insert(header::X_FRAME_OPTIONS, HeaderValue::from_static("DENY"));
    }
    if let Ok(policy) = HeaderValue::from_str(&policy) {
        headers.insert(header::CONTENT_SECURITY_POLICY, policy);
    }
    response
}

/// True for `GET http://elsewhere/ HTTP/1.1`, the form for proxies.
fn has_foreign_form(uri: &Uri) -> bool {
    uri.authority().is_some()
}

/// Only resources of this server, and those created by the page (textures of meshes).
fn policy(host: &str, frame_ancestors: &str) -> String {
    format!(
        "default-src 'self'; script-src 'self'; style-src 'self'; img-src 'self' data: blob:; connect-src 'self' blob: ws://{host}; worker-src 'self' blob:; object-src \
         'none'; base-uri 'none'; form-action 'none'; frame-ancestors {frame_ancestors}"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(host: &str, address: &str) -> Names {
        Names::new(host, address.parse().unwrap())
    }

    #[test]
    fn own_addresses_are_known_and_others_not() {
        let own = names("127.0.0.1", "127.0.0.1:8080");
        for host in ["127.0.0.1:8080", "localhost:8080", "LOCALHOST:8080", "[::1]:8080"] {
            assert!(own.knows(host), "{host}");
        }
        for host in [
            "evil.example:8080",
            "127.0.0.1:8081",
            "127.0.0.1",
            "localhost.evil.example:8080",
            "192.168.1.5:8080",
            "",
            ":8080",
            "localhost:8080:8080",
            "[::1]",
        ] {
            assert!(!own.knows(host), "{host}");
        }
        let all = names("0.0.0.0", "0.0.0.0:80");
        assert!(all.knows("192.168.1.5") && all.knows("localhost:80"));
        assert!(!all.knows("evil.example"));
        assert_eq!(all.url(), "http://127.0.0.1:80/");
        let named = names("robot.lab", "192.168.1.5:9");
        assert!(named.knows("robot.lab:9") && !named.knows("localhost:9"));
        assert_eq!(names("::1", "[::1]:7").url(), "http://[::1]:7/");
        assert_eq!(own.url_for_others(), None);
        assert_eq!(named.url_for_others().as_deref(), Some("http://robot.lab:9/"));
        let url = all.url_for_others().unwrap();
        assert!(url.starts_with("http://") && url.ends_with(":80/"), "{url}");
    }

    #[test]
    fn foreign_hosts_and_origins_are_refused() {
        let own = names("127.0.0.1", "127.0.0.1:8080");
        let fault = |headers: &[(&str, &str)]| {
            let mut map = HeaderMap::new();
            for (name, value) in headers {
                let name = header::HeaderName::from_bytes(name.as_bytes()).unwrap();
                map.append(name, HeaderValue::from_str(value).unwrap());
            }
            own.fault(&map).is_some()
        };
        let host = ("host", "127.0.0.1:8080");
        assert!(!fault(&[host]));
        assert!(!fault(&[host, ("origin", "http://127.0.0.1:8080")]));
        assert!(fault(&[]) && fault(&[("host", "evil.example:8080")]));
        assert!(fault(&[host, host]));
        for origin in
            ["null", "http://evil.example", "https://127.0.0.1:8080", "http://localhost:1"]
        {
            assert!(fault(&[host, ("origin", origin)]), "{origin}");
        }
    }
}
