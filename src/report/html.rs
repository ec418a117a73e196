//! Self-contained HTML: light or dark as the reader's system is, as wide as the screen.

use crate::display::markup;

const STYLE: &str = include_str!("style.css");

/// A page around a body of HTML, with a script that it can do without.
pub fn document(title: &str, body: &str, script: &str) -> String {
    let title = markup(title);
    let script = match script {
        "" => String::new(),
        script => format!("<script>\n{script}</script>\n"),
    };
    format!(
        "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\
         <meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\
         <title>{title}</title><style>\n{STYLE}</style></head>\n<body><h1>{title}</h1>\n{body}{script}</body></html>\n"
    )
}

/// A table. The first column is aligned to the left, and so are columns of words: their names end in a blank.
pub fn table(header: &[&str], rows: impl Iterator<Item = Vec<String>>) -> String {
    let class = |column: usize| match header.get(column) {
        Some(name) if name.ends_with(' ') => " class=\"words\"",
        _ => "",
    };
    // With few columns a phone has room for all; else it shows a list for each row.
    let kind = if header.len() < 5 { "few" } else { "cards" };
    let mut html = format!("<div class=\"wide {kind}\"><table><thead><tr>");
    for (column, name) in header.iter().enumerate() {
        html += &format!(
            "<th scope=\"col\"{}>{}</th>",
            class(column),
            markup(name.trim_end())
        );
    }
    html += "</tr></thead>\n<tbody>";
    for row in rows {
        html += "<tr>";
        for (column, cell) in row.iter().enumerate() {
            // Units stay with their numbers.
            let mut cell = markup(cell);
            if cell.len() < 12 && class(column).is_empty() {
                cell = cell.replace(' ', "&nbsp;");
            }
            let label = markup(header.get(column).map_or("", |name| name.trim_end()));
            html += &format!("<td{} data-label=\"{label}\">{cell}</td>", class(column));
        }
        html += "</tr>\n";
    }
    html + "</tbody></table></div>\n"
}
