//! Standard error: errors, warnings and, where asked for, what is being done.

use std::fmt;
use std::io::{self, Write};
use std::sync::atomic::{AtomicBool, Ordering};

use tracing::{Event, Level, Subscriber};
use tracing_subscriber::fmt::format::Writer;
use tracing_subscriber::fmt::{FmtContext, FormatEvent, FormatFields};
use tracing_subscriber::registry::LookupSpan;

use super::args::{Common, Format};
use super::escape::escaped;
use super::failure::Failure;

/// Whether errors are told as JSON.
static IS_JSON: AtomicBool = AtomicBool::new(false);

/// From now on errors are told as JSON.
pub(crate) fn tell_json() {
    IS_JSON.store(true, Ordering::Relaxed);
}

/// Starts the log at the level that the flags ask for.
pub(crate) fn start(common: &Common) {
    if common.format == Format::Json {
        tell_json();
    }
    let level = match (common.quiet, common.verbose) {
        (true, _) => Level::ERROR,
        (_, 0) => Level::WARN,
        (_, 1) => Level::INFO,
        _ => Level::DEBUG,
    };
    let log = tracing_subscriber::fmt()
        .with_max_level(level)
        .with_writer(io::stderr)
        .log_internal_errors(false)
        .event_format(Line);
    // Only a second start could fail.
    let _ = log.try_init();
}

/// Says why the command failed.
pub(crate) fn error(failure: &Failure) {
    // Where standard error is closed there is no one to tell.
    let line = match IS_JSON.load(Ordering::Relaxed) {
        true => failure.as_json(),
        false => format!("secateur: error: {}", escaped(&failure.to_string())),
    };
    let _ = writeln!(io::stderr(), "{line}");
}

/// Formats an event as one line: `secateur: warning: ...`.
struct Line;

impl<S, N> FormatEvent<S, N> for Line
where
    S: Subscriber + for<'a> LookupSpan<'a>,
    N: for<'a> FormatFields<'a> + 'static,
{
    fn format_event(
        &self,
        context: &FmtContext<'_, S, N>,
        mut writer: Writer<'_>,
        event: &Event<'_>,
    ) -> fmt::Result {
        let level = match *event.metadata().level() {
            Level::ERROR => "error: ",
            Level::WARN => "warning: ",
            _ => "",
        };
        write!(writer, "secateur: {level}")?;
        let mut text = String::new();
        context.format_fields(Writer::new(&mut text), event)?;
        writeln!(writer, "{}", escaped(&text))
    }
}
