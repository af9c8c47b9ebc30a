//! Downloading models from their sources.

use std::path::Path;
use std::process::Command;
use std::time::Duration;

use crate::config::models::{DebianSource, Source, UrlSource};
use crate::harness::scratch::Scratch;

impl Source {
    /// The source as an error names it.
    pub(super) fn name(&self) -> String {
        match self {
            Self::Url(source) => source.url.clone(),
            Self::Debian(source) => format!("Debian package {}", source.debian_package),
        }
    }

    /// Downloads the bytes of the model.
    pub(super) fn fetch(&self) -> Result<Vec<u8>, String> {
        match self {
            Self::Url(source) => source.fetch(),
            Self::Debian(source) => source.fetch(),
        }
    }
}

impl UrlSource {
    fn fetch(&self) -> Result<Vec<u8>, String> {
        let agent = ureq::Agent::config_builder()
            .timeout_connect(Some(Duration::from_secs(10)))
            .timeout_global(Some(Duration::from_secs(120)))
            .build()
            .new_agent();
        let mut response = agent.get(&self.url).call().map_err(|e| e.to_string())?;
        let body = response.body_mut().with_config().limit(1 << 30);
        body.read_to_vec().map_err(|e| e.to_string())
    }
}

impl DebianSource {
    /// Downloads the package without installing it: first with the package lists of the system,
    /// then with new ones in a temporary folder, which needs no rights and leaves the system
    /// unchanged.
    fn fetch(&self) -> Result<Vec<u8>, String> {
        let folder = Scratch::new("vps-fetch")?;
        let timeouts = ["-oAcquire::http::Timeout=10", "-oAcquire::Retries=1"].map(String::from);
        let download = |extra: &[String]| {
            let mut arguments = [timeouts.as_slice(), extra].concat();
            arguments.extend(["download".into(), self.debian_package.clone()]);
            run("apt-get", &arguments, folder.path())
        };
        if download(&[]).is_err() {
            let lists = folder.path().join("lists");
            std::fs::create_dir_all(lists.join("partial")).map_err(|e| e.to_string())?;
            let own_lists = [
                format!("-oDir::State::lists={}", lists.display()),
                format!("-oDir::Cache={}", folder.path().display()),
                "-oDebug::NoLocking=1".into(),
            ];
            let update = [timeouts.as_slice(), &own_lists, &["update".into()]].concat();
            run("apt-get", &update, folder.path())?;
            download(&own_lists)?;
        }
        let entries = std::fs::read_dir(folder.path()).map_err(|e| e.to_string())?;
        let package = entries
            .flatten()
            .map(|entry| entry.path())
            .find(|path| path.extension().is_some_and(|e| e == "deb"))
            .ok_or("apt-get download left no package behind")?;
        let unpack = ["-x".into(), package.display().to_string(), "content".into()];
        run("dpkg-deb", &unpack, folder.path())?;
        let file = folder.path().join("content").join(&self.path);
        std::fs::read(&file).map_err(|e| format!("{} in the package: {e}", self.path))
    }
}

fn run(program: &str, arguments: &[String], folder: &Path) -> Result<(), String> {
    let output = Command::new(program)
        .args(arguments)
        .current_dir(folder)
        .env("LC_ALL", "C")
        .output()
        .map_err(|e| format!("{program}: {e}"))?;
    if output.status.success() {
        return Ok(());
    }
    let errors = String::from_utf8_lossy(&output.stderr);
    let last = errors
        .lines()
        .rfind(|l| l.starts_with("E:"))
        .unwrap_or("failed");
    Err(format!("{program}: {last}"))
}
