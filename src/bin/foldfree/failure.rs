//! What went wrong, in one line that names the file or the argument.

use std::fmt;
use std::path::Path;

/// An error of the command line.
#[derive(Debug)]
pub struct Failure(String);

impl Failure {
    /// An error in words.
    pub fn new(what: impl fmt::Display) -> Self {
        Self(one_line(&what.to_string()))
    }

    /// An error that concerns a file.
    pub fn of_file(path: &Path, what: impl fmt::Display) -> Self {
        Self::new(format!("{}: {what}", path.display()))
    }

    /// An error of the operating system on a file, without its number.
    pub fn of_system(path: &Path, error: &std::io::Error) -> Self {
        use std::io::ErrorKind;
        let what = match error.kind() {
            ErrorKind::NotFound => "no such file or folder".to_owned(),
            ErrorKind::PermissionDenied => "permission denied".to_owned(),
            ErrorKind::IsADirectory => "is a folder".to_owned(),
            _ => error.to_string(),
        };
        Self::of_file(path, what)
    }

    /// Arguments that could not be understood: clap's message without the usage text.
    pub fn usage(error: &clap::Error) -> Self {
        let text = error.render().to_string();
        let lines: Vec<&str> = text
            .lines()
            .map(str::trim)
            .filter(|line| !line.is_empty())
            .take_while(|line| !line.starts_with("Usage:") && !line.starts_with("For more"))
            .collect();
        let text = lines.join(" ");
        let text = text.strip_prefix("error: ").unwrap_or(&text);
        if text.is_empty() || !lines[0].starts_with("error:") {
            return Self::new("which command? (see foldfree --help)");
        }
        Self::new(format!("{text} (see foldfree --help)"))
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}
