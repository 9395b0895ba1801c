//! A page of HTML that needs nothing else: text, tables, drawings and pictures in one file.

use std::fmt::Write;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

/// Letters, widths and colours, by day and by night.
const STYLE: &str = include_str!("page.css");

/// A page that grows from top to bottom.
pub(crate) struct Page {
    title: String,
    body: String,
}

impl Page {
    pub(crate) fn new(title: &str) -> Self {
        let title = escaped(title);
        Self { body: format!("<h1>{title}</h1>\n"), title }
    }

    pub(crate) fn heading(&mut self, words: &str) {
        self.add(format_args!("<h2>{}</h2>", escaped(words)));
    }

    pub(crate) fn paragraph(&mut self, words: &str) {
        self.add(format_args!("<p>{}</p>", escaped(words)));
    }

    /// What the page is there to say.
    pub(crate) fn emphasis(&mut self, words: &str) {
        self.add(format_args!("<p class=\"said\">{}</p>", escaped(words)));
    }

    /// Lines to type.
    pub(crate) fn command(&mut self, lines: &str) {
        self.add(format_args!("<pre>{}</pre>", escaped(lines)));
    }

    /// A drawing as SVG, by whoever drew it: it is not escaped.
    pub(crate) fn drawing(&mut self, svg: &str, caption: &str) {
        let caption = escaped(caption);
        self.add(format_args!(
            "<figure class=\"drawing\">{svg}<figcaption>{caption}</figcaption></figure>"
        ));
    }

    /// A picture as PNG.
    pub(crate) fn picture(&mut self, png: &[u8], caption: &str) {
        let (data, caption) = (picture_data(png), escaped(caption));
        self.add(format_args!(
            "<figure><img alt=\"{caption}\" src=\"{data}\">\
             <figcaption>{caption}</figcaption></figure>"
        ));
    }

    /// A table; its first column holds names, the others numbers.
    pub(crate) fn table(&mut self, headings: &[String], rows: &[Vec<String>]) {
        let row = |cells: &[String], tag: &str| -> String {
            let cells = cells.iter().map(|cell| format!("<{tag}>{}</{tag}>", escaped(cell)));
            format!("<tr>{}</tr>\n", cells.collect::<String>())
        };
        let body: String = rows.iter().map(|cells| row(cells, "td")).collect();
        self.add(format_args!(
            "<div class=\"wide\"><table><thead>\n{}</thead><tbody>\n{body}</tbody></table></div>",
            row(headings, "th")
        ));
    }

    /// Words and what they mean.
    pub(crate) fn glossary(&mut self, words: &[(&str, &str)]) {
        let entry = |(word, meaning): &(&str, &str)| {
            format!("<dt>{}</dt><dd>{}</dd>\n", escaped(word), escaped(meaning))
        };
        let entries: String = words.iter().map(entry).collect();
        self.add(format_args!("<dl>\n{entries}</dl>"));
    }

    /// The whole file.
    pub(crate) fn html(&self) -> String {
        let Self { title, body } = self;
        format!(
            "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
             <title>{title}</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n<main>\n\
             {body}</main>\n</body>\n</html>\n"
        )
    }

    fn add(&mut self, element: std::fmt::Arguments) {
        // Writing to a string cannot fail.
        let _ = writeln!(self.body, "{element}");
    }
}

/// A PNG as the address of an image.
pub(crate) fn picture_data(png: &[u8]) -> String {
    format!("data:image/png;base64,{}", STANDARD.encode(png))
}

/// A text as it may stand in a page, also in quotes.
pub(crate) fn escaped(text: &str) -> String {
    let shown = |c: &char| !c.is_control() || *c == '\n' || *c == '\t';
    let mut out = String::with_capacity(text.len());
    for c in text.chars().filter(shown) {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            _ => out.push(c),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_text_becomes_an_element() {
        let mut page = Page::new("a <b> & \"c\"");
        page.table(&["<i>".to_owned()], &[vec!["x<y".to_owned()]]);
        page.paragraph("</main>");
        let html = page.html();
        assert!(html.contains("<title>a &lt;b&gt; &amp; &quot;c&quot;</title>"), "{html}");
        assert!(html.contains("<th>&lt;i&gt;</th>") && html.contains("<td>x&lt;y</td>"), "{html}");
        assert_eq!(html.matches("</main>").count(), 1);
        assert_eq!(escaped("<a & \"b\">\u{7}"), "&lt;a &amp; &quot;b&quot;&gt;");
    }
}
