//! A self-contained HTML page: light or dark as the reader's system is, as wide as the screen.

use super::chart::escape;

const STYLE: &str = "\
:root{color-scheme:light dark;--ink:#1c1c1e;--paper:#fff;--soft:#6b6b70;--grid:#e3e3e8;--card:#f6f6f8;\
--warn:#9a3b00;--c0:#1f69b4;--c1:#d05410;--c2:#288c50;--c3:#823c96;--c4:#8c6a00;--c5:#555}\
@media(prefers-color-scheme:dark){:root{--ink:#ececf0;--paper:#16161a;--soft:#a0a0a8;--grid:#34343c;\
--card:#202026;--warn:#ffb27a;--c0:#6db3ff;--c1:#ff9a5c;--c2:#66d28f;--c3:#d59be8;--c4:#e6c34a;--c5:#bbb}}\
body{margin:0 auto;max-width:1180px;padding:12px;font:15px/1.45 system-ui,sans-serif;color:var(--ink);\
background:var(--paper)}h1{font-size:1.3em;overflow-wrap:anywhere}h2{font-size:1.05em;margin:1.4em 0 .4em}\
.wide{overflow-x:auto}table{border-collapse:collapse;font-variant-numeric:tabular-nums;font-size:.9em}\
th,td{padding:3px 10px 3px 0;text-align:right;white-space:nowrap;border-bottom:1px solid var(--grid)}\
th:first-child,td:first-child{text-align:left}th{color:var(--soft);font-weight:600}\
.plots{display:grid;grid-template-columns:repeat(auto-fill,minmax(min(100%,340px),1fr));gap:12px}\
figure{margin:0;padding:8px;background:var(--card);border-radius:8px}figcaption{font-weight:600;font-size:.9em}\
svg{width:100%;height:auto;display:block}svg text{font-size:10.5px;fill:var(--soft)}\
.grid{stroke:var(--grid);fill:none}.line{fill:none;stroke-width:1.3;stroke-linejoin:round}\
.dots{fill:none;stroke-width:2.4;stroke-linecap:round}.legend{margin:2px 0 0;font-size:.82em}\
.legend span{margin-right:10px}.warning{color:var(--warn)}\
.s0{stroke:var(--c0)}.s1{stroke:var(--c1)}.s2{stroke:var(--c2)}.s3{stroke:var(--c3)}.s4{stroke:var(--c4)}\
.s5{stroke:var(--c5)}.k0{color:var(--c0)}.k1{color:var(--c1)}.k2{color:var(--c2)}.k3{color:var(--c3)}\
.k4{color:var(--c4)}.k5{color:var(--c5)}";

/// A page around a body of HTML.
pub fn page(title: &str, body: &str) -> String {
    let title = escape(title);
    format!(
        "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\
         <meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\
         <title>{title}</title><style>{STYLE}</style></head>\n<body><h1>{title}</h1>\n{body}</body></html>\n"
    )
}

/// A table; the first column to the left.
pub fn table(header: &[&str], rows: impl Iterator<Item = Vec<String>>) -> String {
    let mut html = String::from("<div class=\"wide\"><table><tr>");
    for name in header {
        html += &format!("<th>{}</th>", escape(name));
    }
    html += "</tr>\n";
    for row in rows {
        html += "<tr>";
        for cell in row {
            html += &format!("<td>{}</td>", escape(&cell));
        }
        html += "</tr>\n";
    }
    html + "</table></div>\n"
}
