//! Self-contained HTML: light or dark as the reader's system is, as wide as the screen.

use crate::display::markup;

const STYLE: &str = include_str!("style.css");

/// A page around a body of HTML.
pub fn document(title: &str, body: &str) -> String {
    let title = markup(title);
    format!(
        "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\
         <meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\
         <title>{title}</title><style>\n{STYLE}</style></head>\n<body><h1>{title}</h1>\n{body}</body></html>\n"
    )
}

/// A table. The first column is aligned to the left, and so are columns of words: their names end in a blank.
pub fn table(header: &[&str], rows: impl Iterator<Item = Vec<String>>) -> String {
    let class = |column: usize| match header.get(column) {
        Some(name) if name.ends_with(' ') => " class=\"words\"",
        _ => "",
    };
    // With few columns a phone has room for all.
    let few = if header.len() < 6 { " few" } else { "" };
    let mut html = format!("<div class=\"wide{few}\"><table><tr>");
    for (column, name) in header.iter().enumerate() {
        html += &format!(
            "<th scope=\"col\"{}>{}</th>",
            class(column),
            markup(name.trim_end())
        );
    }
    html += "</tr>\n";
    for row in rows {
        html += "<tr>";
        for (column, cell) in row.iter().enumerate() {
            // Units stay with their numbers.
            let mut cell = markup(cell);
            if cell.len() < 12 && class(column).is_empty() {
                cell = cell.replace(' ', "&nbsp;");
            }
            html += &format!("<td{}>{cell}</td>", class(column));
        }
        html += "</tr>\n";
    }
    html + "</table></div>\n"
}
