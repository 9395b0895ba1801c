//! The page: one file, no script, nothing from elsewhere. It is well-formed XML beneath its first
//! line, so that any parser can check it.

use std::fmt::Write;

use cranny_record::topic;
use cranny_render::Color;
use cranny_render::palette::{self, palette};

use super::facts::{Facts, Overlap};
use super::pictures::Picture;
use super::plot::{Axis, PlotSeries, plot};
use crate::page::{escaped, picture_data};
use crate::words::counted;

/// What is put on a page.
pub(super) struct RunPage<'a> {
    pub(super) facts: &'a Facts,
    /// The recording, as it was named.
    pub(super) recording: String,
    /// What the recording says of its own end.
    pub(super) ending: Option<String>,
    pub(super) strip: Vec<Picture>,
    pub(super) close_ups: Vec<(Overlap, Vec<u8>)>,
}

/// PlotSeries that have a colour of their own.
const COLORS: usize = 6;

impl RunPage<'_> {
    /// The page as text.
    pub(super) fn html(&self) -> String {
        let title = escaped(self.facts.fact("scene"));
        let title = if title.is_empty() { "run".to_owned() } else { title };
        let mut out =
            String::from("<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"/>");
        out += "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>";
        // Writing to a string cannot fail.
        let _ =
            write!(out, "<title>{title}: report of a run</title><style>{}</style></head>", style());
        let _ = write!(out, "<body><main><h1>{title}</h1><p class=\"lead\">{}</p>", self.lead());
        if let Some(ending) = &self.ending {
            let _ = write!(out, "<p class=\"note\">{}</p>", escaped(ending));
        }
        out += &self.pictures();
        out += &self.plots();
        out += &self.overlaps();
        out += &self.what_ran();
        out += &self.again();
        out += "</main></body></html>\n";
        out
    }

    /// What happened, in three sentences.
    fn lead(&self) -> String {
        let facts = self.facts;
        let [moving, fixed] = facts.bodies;
        let contacts = facts.stats.iter().map(|(_, stats)| stats.contacts).max().unwrap_or(0);
        let mut text = format!(
            "{} and {} for {} of simulated time. ",
            counted(moving, "moving body"),
            counted(fixed, "fixed one"),
            seconds(facts.last())
        );
        if !facts.reports_contacts() {
            text += "Contacts and depths are not recorded: the scene does not ask for Contacts.";
            return text;
        }
        let _ = write!(text, "At most {} at once. ", counted(contacts, "contact"));
        text += &match facts.deepest.first() {
            None => "No overlap was found.".to_owned(),
            Some(deepest) => format!(
                "The deepest overlap is {}, of {} and {} at {}.",
                short(deepest.depth),
                escaped(&deepest.a),
                escaped(&deepest.b),
                seconds(deepest.time)
            ),
        };
        text
    }

    fn pictures(&self) -> String {
        let figure = |picture: &Picture| {
            let alt = format!("the scene at {}", picture.caption);
            figure(&picture.png, &alt, &picture.caption)
        };
        let figures: String = self.strip.iter().map(figure).collect();
        format!("<h2>From start to end</h2><div class=\"strip\">{figures}</div>")
    }

    fn plots(&self) -> String {
        let facts = self.facts;
        let charts = [
            ("Contacts", "", facts.contacts(), Axis::FromZero),
            ("Deepest overlap", "in the scene's unit of length", facts.depth(), Axis::FromZero),
            ("Mechanical energy", "in the scene's units", facts.energy(), Axis::Free),
            ("Cost", "milliseconds a step, by phase", facts.cost(), Axis::FromZero),
        ];
        let drawn = charts.into_iter().filter_map(|(title, unit, series, axis)| {
            let svg = plot(&series, axis, &title.to_lowercase())?;
            let unit =
                if unit.is_empty() { String::new() } else { format!(" <small>{unit}</small>") };
            Some(format!(
                "<figure class=\"plot\"><h3>{title}{unit}</h3>{svg}{}</figure>",
                legend(&series)
            ))
        });
        let drawn: String = drawn.collect();
        let [recording, pictures] = facts.beside();
        let between = match facts.every() {
            0 | 1 => String::new(),
            every => format!(" Frames are {every} steps apart; what was between is not shown."),
        };
        format!(
            "<h2>Over time</h2><div class=\"plots\">{drawn}</div><p class=\"small\">Beside the simulation, recording took {} ms a step and pictures {} ms.{between}</p>",
            short(recording),
            short(pictures)
        )
    }

    fn overlaps(&self) -> String {
        let figures: String = self
            .close_ups
            .iter()
            .map(|(overlap, png)| {
                let area =
                    overlap.area.map_or(String::new(), |area| format!(", area {}", short(area)));
                let caption = format!(
                    "<b>{} and {}</b>: {} deep{area}, at {}",
                    escaped(&overlap.a),
                    escaped(&overlap.b),
                    short(overlap.depth),
                    seconds(overlap.time)
                );
                let alt = format!("section through {} and {}", overlap.a, overlap.b);
                figure(png, &escaped(&alt), &caption)
            })
            .collect();
        match self.close_ups.is_empty() {
            true => String::new(),
            false => format!(
                "<h2>Deepest overlaps</h2><p>Each pair at its deepest, cut open there.</p><div class=\"close\">{figures}</div>"
            ),
        }
    }

    fn what_ran(&self) -> String {
        let facts = self.facts;
        let row = |name: &str, value: &str| match value.is_empty() {
            true => String::new(),
            false => format!("<tr><th>{name}</th><td>{}</td></tr>", escaped(value)),
        };
        let rows = [
            row("effects", facts.fact(topic::EFFECTS_KEY)),
            row("detector", &[facts.fact("detector"), facts.fact("accuracy")].join(", ")),
            row("step", &format!("{} s", facts.fact("dt"))),
            row("seed", facts.fact("seed")),
            row("version", facts.fact("version")),
            row("scene hash", facts.fact("scene_hash")),
        ];
        let warnings: String =
            facts.warnings.iter().map(|text| format!("<li>{}</li>", escaped(text))).collect();
        let skipped = match warnings.is_empty() {
            true => "<p>Nothing was skipped.</p>".to_owned(),
            false => format!("<p>Skipped, or doubtful:</p><ul>{warnings}</ul>"),
        };
        format!("<h2>What ran</h2><table>{}</table>{skipped}", rows.concat())
    }

    fn again(&self) -> String {
        let recording = escaped(&self.recording);
        let mut out = "<h2>How to do it again</h2>".to_owned();
        if self.facts.reports_contacts() {
            let _ = write!(
                out,
                "<p>The recording holds all poses to the bit; this computes every pair of it anew and compares:</p><pre>cranny replay {recording}</pre>"
            );
        }
        if let Some(scene) = &self.facts.scene {
            let _ = write!(
                out,
                "<p>To simulate it again as it was, with its step, seed and detector, and to compare every pose, save the scene below as <code>scene.ron</code>, beside the meshes that it names:</p><pre>cranny replay {recording} --scene scene.ron</pre><details><summary>scene.ron</summary><pre>{}</pre></details>",
                escaped(scene)
            );
        }
        out
    }
}

fn figure(png: &[u8], alt: &str, caption: &str) -> String {
    format!(
        "<figure><img alt=\"{alt}\" src=\"{}\"/><figcaption>{caption}</figcaption></figure>",
        picture_data(png)
    )
}

/// Names of the series, where there are several.
fn legend(series: &[PlotSeries]) -> String {
    if series.len() < 2 {
        return String::new();
    }
    let name = |(i, series): (usize, &PlotSeries)| {
        format!("<span><i class=\"s{i}\"></i>{}</span>", escaped(&series.name))
    };
    format!(
        "<div class=\"legend\">{}</div>",
        series.iter().enumerate().map(name).collect::<String>()
    )
}

fn seconds(time: f64) -> String {
    format!("{time:.3} s")
}

/// Three digits.
fn short(value: f64) -> String {
    match value.abs() {
        0.0 => "0".to_owned(),
        size if (1e-3..1e5).contains(&size) => {
            let digits = (2.0 - size.max(1e-3).log10().floor()).clamp(0.0, 5.0);
            format!("{value:.*}", digits as usize)
        }
        _ => format!("{value:.2e}"),
    }
}

fn hex(Color { r, g, b, .. }: Color) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// The one palette: its dark round of colours on paper, its light one on ink.
fn style() -> String {
    let colors = |round: usize| -> String {
        (0..COLORS).map(|i| format!("--s{i}:{};", hex(palette(i + 8 * round)))).collect()
    };
    let (ink, paper) = (hex(palette::INK), hex(palette::PAPER));
    let (on_paper, on_ink) = (colors(1), colors(0));
    let series: String = (0..COLORS)
        .map(|i| format!(".line.s{i}{{stroke:var(--s{i})}}i.s{i}{{background:var(--s{i})}}"))
        .collect();
    format!(
        ":root{{color-scheme:light dark;--ink:{ink};--paper:{paper};--soft:#5b6470;--rule:#d5d8dc;--box:#eef0f2;{on_paper}}}\
@media (prefers-color-scheme:dark){{:root{{--ink:{paper};--paper:#14181f;--soft:#a8b0ba;--rule:#39414c;--box:#1f252e;{on_ink}}}}}\
*{{box-sizing:border-box}}body{{margin:0;background:var(--paper);color:var(--ink);font:16px/1.5 system-ui,sans-serif}}\
main{{max-width:1180px;margin:0 auto;padding:20px 16px 48px}}h1{{font-size:28px;margin:8px 0;overflow-wrap:anywhere}}\
h2{{font-size:20px;margin:36px 0 10px;padding-top:10px;border-top:1px solid var(--rule)}}\
h3{{font-size:16px;margin:0 0 4px}}small{{color:var(--soft);font-weight:400;font-size:13px}}\
.small{{color:var(--soft);font-size:14px}}.lead{{font-size:18px;max-width:46em;margin:4px 0}}.note{{background:var(--box);border-left:4px solid var(--s1);padding:8px 12px}}\
figure{{margin:0}}img{{display:block;width:100%;height:auto;border-radius:6px;background:#fbfbfa}}\
figcaption{{color:var(--soft);font-size:14px;margin-top:4px}}figcaption b{{color:var(--ink)}}\
.strip{{display:grid;gap:14px;grid-template-columns:repeat(auto-fill,minmax(min(44%,320px),1fr))}}\
.plots,.close{{display:grid;gap:26px;grid-template-columns:repeat(auto-fill,minmax(min(100%,420px),1fr))}}\
svg{{display:block;width:100%;height:auto}}svg text{{font:13px system-ui,sans-serif;fill:var(--soft)}}\
.end{{text-anchor:end}}.middle{{text-anchor:middle}}.grid{{stroke:var(--rule);fill:none}}\
.line{{fill:none;stroke-width:2;stroke-linejoin:round}}{series}\
.legend{{display:flex;flex-wrap:wrap;gap:4px 16px;font-size:14px;color:var(--soft);padding-left:12%}}\
.legend i{{display:inline-block;width:18px;height:3px;margin-right:6px;vertical-align:middle}}\
table{{border-collapse:collapse}}th{{text-align:left;font-weight:600;padding:3px 18px 3px 0;vertical-align:top;white-space:nowrap}}\
td{{padding:3px 0;overflow-wrap:anywhere}}pre{{background:var(--box);padding:10px 12px;border-radius:6px;overflow-x:auto;font-size:13px;line-height:1.4}}\
summary{{cursor:pointer}}"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_three_digits() {
        let cases =
            [(0.0, "0"), (0.0123, "0.0123"), (1.5, "1.50"), (1234.4, "1234"), (3e-9, "3.00e-9")];
        for (value, text) in cases {
            assert_eq!(short(value), text);
        }
    }
}
