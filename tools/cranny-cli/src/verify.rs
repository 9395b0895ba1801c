//! `cranny verify`: the certificates of `query --certificate`, checked without the detector.

use std::collections::HashMap;
use std::fs::File;
use std::io::{self, BufRead, BufReader, Read};
use std::path::{Path, PathBuf};
use std::rc::Rc;

use cranny_certificate::{Claim, Contained, SurfaceVerdict, Triangles};
use serde::Serialize;

use crate::args::{Format, VerifyArgs};
use crate::certificate_line::{BodyFile, ReadLine};
use crate::failure::Failure;
use crate::model_file::triangles;
use crate::output::Output;
use crate::paths::check_input;

/// Runs the command.
///
/// # Errors
///
/// Files that cannot be read; a certificate that does not hold.
pub(crate) fn verify(args: &VerifyArgs, format: Option<Format>) -> Result<(), Failure> {
    let mut verifier =
        Verifier { elsewhere: [args.mesh_a.clone(), args.mesh_b.clone()], read: HashMap::new() };
    let mut output = Output::new();
    let (mut held, mut refused) = (0u64, 0u64);
    for file in &args.certificates {
        refuse_other_files(file)?;
        for (number, line) in (1u64..).zip(lines(file)?) {
            let line = line.map_err(|error| cannot_read(file, &error))?;
            if line.trim().is_empty() {
                continue;
            }
            let checked = verifier.check(file, number, &line)?;
            *if checked.holds { &mut held } else { &mut refused } += 1;
            match format {
                Some(Format::Json) => output.json(&checked),
                _ => output.line(&checked.text()),
            }?;
        }
    }
    conclude(&mut output, format, held, refused)
}

/// Bytes of a file in which a line of a certificate begins.
const BEGINNING: u64 = 4096;

/// Fails if a file is none of certificates: each line of theirs is a JSON object with a pose.
fn refuse_other_files(file: &Path) -> Result<(), Failure> {
    // Pipes are read once, and a file that is missing is reported by who reads it.
    if !file.is_file() {
        return Ok(());
    }
    let mut beginning = Vec::new();
    let read = File::open(file).and_then(|open| open.take(BEGINNING).read_to_end(&mut beginning));
    if read.is_err() {
        return Ok(());
    }
    // One flipped bit makes no other file of it.
    let text = String::from_utf8_lossy(&beginning);
    let text = text.trim_start();
    match text.is_empty() || text.starts_with('{') || text.contains("\"pose\"") {
        true => Ok(()),
        false => Err(Failure::input(format!(
            "certificate file {}: there are no certificates in this file. Name one with lines of 'cranny query --certificate'.",
            file.display()
        ))),
    }
}

fn conclude(
    output: &mut Output,
    format: Option<Format>,
    held: u64,
    refused: u64,
) -> Result<(), Failure> {
    match (held, refused) {
        (0, 0) => Err(Failure::input(
            "no certificate was found. Name a file with lines of 'cranny query --certificate'.",
        )),
        (_, 0) if format == Some(Format::Json) => Ok(()),
        (held, 0) => output.line(&format!("{held} of {held} certificates hold")),
        (held, refused) => Err(Failure::run(format!(
            "{refused} of {} certificates do not hold. What they claim may be wrong.",
            held + refused
        ))),
    }
}

/// Lines of a file, or of standard input for `-`. Bytes that are no text become signs that no
/// certificate holds, so that the line is refused and the others are read.
fn lines(file: &Path) -> Result<impl Iterator<Item = io::Result<String>>, Failure> {
    let reader: Box<dyn BufRead> = if file == Path::new("-") {
        Box::new(io::stdin().lock())
    } else {
        check_input("certificate file", file)?;
        Box::new(BufReader::new(File::open(file).map_err(|error| cannot_read(file, &error))?))
    };
    Ok(reader.split(b'\n').map(|line| line.map(|l| String::from_utf8_lossy(&l).into_owned())))
}

fn cannot_read(file: &Path, error: &io::Error) -> Failure {
    let advice = "Check the path and its permissions.";
    let message =
        format!("certificate file {}: cannot be read ({error}). {advice}", file.display());
    Failure::unreadable(message, error.kind())
}

/// Meshes that were read, by file and scale.
struct Verifier {
    elsewhere: [Option<PathBuf>; 2],
    read: HashMap<(PathBuf, u64), Rc<Triangles>>,
}

impl Verifier {
    fn check(&mut self, file: &Path, number: u64, text: &str) -> Result<Checked, Failure> {
        let mut checked = Checked {
            file: file.display().to_string(),
            line: number,
            pose: None,
            holds: false,
            claim: None,
            why: None,
        };
        let line = match ReadLine::read(text) {
            Ok(line) => line,
            Err(why) => return Ok(Checked { why: Some(why), ..checked }),
        };
        let claim = line.claim();
        (checked.pose, checked.claim) = (Some(line.pose), Some(claim));
        let [a, b] = [0, 1].map(|i| self.triangles(i, &line.certificate.bodies[i]));
        let (a, b) = (a?, b?);
        match cranny_certificate::verify(&claim, &line.certificate.proof, [&a, &b]) {
            Ok(()) => checked.holds = true,
            Err(refusal) => checked.why = Some(refusal.to_string()),
        }
        Ok(checked)
    }

    fn triangles(&mut self, body: usize, named: &BodyFile) -> Result<Rc<Triangles>, Failure> {
        let file = self.elsewhere[body].as_ref().unwrap_or(&named.file);
        let key = (file.clone(), named.scale.to_bits());
        if let Some(found) = self.read.get(&key) {
            return Ok(Rc::clone(found));
        }
        let found = Rc::new(triangles(file, named.scale)?);
        self.read.insert(key, Rc::clone(&found));
        Ok(found)
    }
}

/// What became of a line.
#[derive(Debug, Serialize)]
struct Checked {
    file: String,
    line: u64,
    pose: Option<u64>,
    holds: bool,
    claim: Option<Claim>,
    why: Option<String>,
}

impl Checked {
    fn text(&self) -> String {
        let place = format!("{}:{}", self.file, self.line);
        let pose = self.pose.map_or_else(|| "?".to_owned(), |pose| pose.to_string());
        let claim = self.claim.map_or("", |claim| in_words(&claim));
        match &self.why {
            None => format!("{place}  pose {pose}  holds    {claim}"),
            Some(why) => format!("{place}  pose {pose}  refused  {claim}: {why}"),
        }
    }
}

fn in_words(claim: &Claim) -> &'static str {
    match (claim.contained, claim.surface, claim.solid) {
        (Some(Contained::AInB), ..) => "A lies in B",
        (Some(Contained::BInA), ..) => "B lies in A",
        (None, SurfaceVerdict::None, false) => "apart",
        (None, SurfaceVerdict::None, true) => "one is partly in the other, surfaces apart",
        (None, SurfaceVerdict::Touch, false) => "touch",
        (None, SurfaceVerdict::Touch, true) => "touch, interiors meet",
        (None, SurfaceVerdict::Cross, _) => "cross",
    }
}
