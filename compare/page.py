# SPDX-License-Identifier: Apache-2.0
"""The report as one HTML file that needs no other: findings first, then each study."""
import html as escaping
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import style

PARTS = Path(__file__).resolve().parent / "page"
QUICK = ("This is the quick report: fewer methods, angles and runs than `make compare` takes, "
         "and no more than one small picture of each renderer.")


@dataclass(frozen=True)
class Section:
    """What the page shows of a study. commands: {command: keys of what it makes}; left: how many
    findings about times it does not tell."""

    name: str
    title: str
    intro: str
    findings: Sequence
    figures: Sequence
    tables: Sequence
    commands: Mapping
    count: int
    left: int = 0


def left_out(count):
    sentences = "One sentence about times is" if count == 1 else f"{count} sentences about times are"
    return f"{sentences} left out: this run was too noisy to tell."


def text(plain):
    """Plain text as HTML; what stands in backquotes as code."""
    return re.sub(r"`([^`]+)`", r"<code>\1</code>", escaping.escape(plain, quote=False))


def attribute(plain):
    return escaping.escape(plain, quote=True)


def anchor(section, part):
    return f"{section.name}-{part.id}"


def numbered(sections):
    """{anchor: "Figure 3"} of all figures and tables, counted through the page."""
    names = {}
    for word, parts in (("Figure", "figures"), ("Table", "tables")):
        count = 0
        for section in sections:
            for part in getattr(section, parts):
                name = anchor(section, part)
                if name in names:
                    raise ValueError(f"study {section.name}: two parts are called '{part.id}'")
                count += 1
                names[name] = f"{word} {count}"
    return names


def cell(value):
    """One <td>, with what it is sorted by."""
    if value is None or value == "":
        return "<td></td>"
    if isinstance(value, str):
        return f"<td{' class=short' if len(value) < 28 else ''}>{text(value)}</td>"
    shown = str(value) if isinstance(value, int) else style.number(value)
    return f'<td class="number" data-value="{float(value)!r}">{shown}</td>'


def table(section, part, names):
    for row in part.rows:
        if len(row) != len(part.columns):
            raise ValueError(f"study {section.name}, table {part.id}: a row of {len(row)} for "
                             f"{len(part.columns)} columns")
    numeric = [all(not isinstance(row[i], str) for row in part.rows) for i in range(len(part.columns))]
    heads = "".join(
        f'<th scope="col"{" class=number" if is_number else ""}><button type="button">{text(column)}'
        "<span aria-hidden=true></span></button></th>"
        for column, is_number in zip(part.columns, numeric))
    body = "\n".join("<tr>" + "".join(map(cell, row)) + "</tr>" for row in part.rows)
    name = anchor(section, part)
    return f"""<div class="table" id="{name}">
<p class="caption" id="{name}-caption"><b>{names[name]}.</b> <strong>{text(part.title)}</strong> {text(part.caption)}</p>
<div class="scroll" tabindex="0" role="region" aria-label="{attribute(part.title)}"><table aria-labelledby="{name}-caption">
<thead><tr>{heads}</tr></thead>
<tbody>
{body}
</tbody></table></div></div>"""


def figure(section, part, names):
    name = anchor(section, part)
    return f"""<figure id="{name}">
<h3>{text(part.title)}</h3>
<div class="panels" role="img" aria-label="{attribute(part.alt)}">
{part.svg}
</div>
<figcaption><b>{names[name]}.</b> {text(part.caption)}</figcaption>
</figure>"""


def sentence(section, finding, names):
    link = ""
    if finding.figure:
        name = f"{section.name}-{finding.figure}"
        if name not in names:
            raise ValueError(f"study {section.name}: a finding links '{finding.figure}', which is no "
                             f"figure or table of it: \"{finding.text}\"")
        link = f' <a href="#{name}">{names[name].replace(" ", "&nbsp;")}</a>'
    return f"<li>{text(finding.text)}{link}</li>"


def remake(section):
    lines = "\n".join(
        f"<li><code>{text(command)}</code><span>{text(', '.join(keys[:6]))}"
        f"{' …' if len(keys) > 6 else ''}</span></li>" for command, keys in section.commands.items())
    whole = f"build/venv/bin/python compare/report_page.py --only {section.name}"
    return f"""<details><summary>Numbers, and how to make them again</summary>
<p><a href="data/{section.name}.csv" download>data/{section.name}.csv</a>, {section.count} rows.
All of this section: <code>{whole}</code></p>
{f'<ul class="commands">{lines}</ul>' if lines else ''}</details>"""


def study(section, names):
    parts = [figure(section, part, names) for part in section.figures]
    parts += [table(section, part, names) for part in section.tables]
    return f"""<section id="{section.name}">
<h2>{text(section.title)}</h2>
<p class="intro">{text(section.intro)}</p>
{chr(10).join(parts)}
{remake(section)}
</section>"""


def findings(sections, names):
    groups = []
    for section in sections:
        if section.findings:
            lines = "\n".join(sentence(section, finding, names) for finding in section.findings)
            groups.append(f'<div class="group"><h3><a href="#{section.name}">{text(section.title)}</a>'
                          f"</h3>\n<ul>\n{lines}\n</ul></div>")
    left = sum(section.left for section in sections)
    if left:
        groups.append(f'<p class="note">{left_out(left)}</p>')
    return "\n".join(groups)


def html(sections, head, quick):
    """The page. sections: Section; head: {word: text}, what was measured where."""
    names = numbered(sections)
    contents = "\n".join(f'<li><a href="#{s.name}">{text(s.title)}</a></li>' for s in sections)
    facts = "\n".join(f"<div><dt>{word}</dt><dd>{text(said)}</dd></div>"
                      for word, said in head.items() if word != "command")
    css = (PARTS / "page.css").read_text(encoding="utf-8")
    script = (PARTS / "page.js").read_text(encoding="utf-8")
    return f"""<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="color-scheme" content="light dark">
<title>libshade, measured</title>
<link rel="icon" href="data:,">
<style>
{css}</style>
</head>
<body>
<a class="skip" href="#findings">To the findings</a>
<header>
<p class="kicker">libshade · {'quick report' if quick else 'report'}</p>
<h1>Speed, accuracy, and where methods fail</h1>
<p class="lead">How well each way to carry a normal's detail, to round, to fade at the horizon, to stand for
cloth and maps from afar follows the truth, and what it costs. Every number here was computed by the run
that wrote this page, and every sentence of the findings was tested against the tables when it was written.</p>
{f'<p class="note">{text(QUICK)}</p>' if quick else ''}
<dl class="facts">
{facts}
<div><dt>made by</dt><dd><code>{text(head['command'])}</code></dd></div>
</dl>
</header>
<div class="columns">
<nav aria-label="Contents"><details open><summary>Contents</summary>
<ol><li><a href="#findings">Findings</a></li>
{contents}</ol></details></nav>
<main>
<section id="findings">
<h2>Findings</h2>
{findings(sections, names)}
</section>
{chr(10).join(study(section, names) for section in sections)}
</main>
</div>
<p id="said" role="status" class="unseen"></p>
<footer><p>Bars span the middle half of what was seen in repeated runs, unless a caption says otherwise.
Colours are those of Okabe and Ito; a method keeps its colour and its marker through the page.</p></footer>
<script>
{script}</script>
</body>
</html>
"""
