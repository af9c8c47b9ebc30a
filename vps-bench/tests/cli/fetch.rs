//! Models: fetched in order, checked, kept; errors of sources and files.

use std::io::{Read, Write};
use std::net::TcpListener;

use crate::project::{BOX, Project};

/// Serves `body` once on the loopback interface and gives its address.
fn serve_once(body: &'static str) -> String {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = listener.local_addr().unwrap();
    std::thread::spawn(move || {
        let (mut stream, _) = listener.accept().unwrap();
        let mut request = [0; 4096];
        let _ = stream.read(&mut request).unwrap();
        let length = body.len();
        let head =
            format!("HTTP/1.1 200 OK\r\nContent-Length: {length}\r\nConnection: close\r\n\r\n");
        stream.write_all(head.as_bytes()).unwrap();
        stream.write_all(body.as_bytes()).unwrap();
    });
    format!("http://{address}/box.obj")
}

fn models(sha256: &str, urls: &[&str]) -> String {
    let sources: String = urls
        .iter()
        .map(|url| format!("[[box.source]]\nurl = \"{url}\"\n"))
        .collect();
    format!("[box]\nabout = \"a box\"\nfile = \"box.obj\"\nsha256 = \"{sha256}\"\n{sources}")
}

/// SHA-256 of [`BOX`], from `sha256sum`.
const BOX_SHA256: &str = "48f5ec06dd0e1ad5b52164d929d4c2312e0fa599a5718c5cb6cbb497574123a1";

/// A port nothing listens on.
const NOBODY: &str = "http://127.0.0.1:9/box.obj";

#[test]
fn models_are_fetched_in_order_checked_and_kept() {
    let project = Project::new("fetch");
    let address = serve_once(BOX);
    project.write(
        "experiments/models.toml",
        &models(BOX_SHA256, &[NOBODY, &address]),
    );
    project.succeeds(&["fetch"]);
    assert_eq!(project.read(".cache/models/box.obj"), BOX);
    // From now on no source is asked.
    project.succeeds(&["fetch", "box"]);
    project.write(".cache/models/box.obj", "v 0 0 0\n");
    project.fails(
        2,
        &["fetch"],
        &["box.obj: SHA-256 is", BOX_SHA256, "remove the file"],
    );
}

#[test]
fn wrong_and_unreachable_models_are_refused() {
    let project = Project::new("refuse");
    let address = serve_once("v 6 6 6\n");
    project.write(
        "experiments/models.toml",
        &models(BOX_SHA256, &[NOBODY, &address]),
    );
    let by_hand = ".cache/models/box.obj";
    project.fails(
        2,
        &["fetch"],
        &[NOBODY, &address, "refused", by_hand, BOX_SHA256],
    );
    assert!(!project.0.join(by_hand).exists());
    project.fails(2, &["fetch", "cow"], &["`cow`", "models.toml"]);
    project.write(
        "experiments/models.toml",
        "[box]\nabout = \"\"\nfile = \"b\"\nsha = \"1\"\n",
    );
    project.fails(2, &["fetch"], &["models.toml:4: ", "`sha`"]);
}
