# SPDX-License-Identifier: Apache-2.0
"""The report as HTML files that need no others: what to use first, then each study, then all numbers; the atlas by itself."""
import html as escaping
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import style

LEAD = ("speed", "choice")  # study and figure that stand beside the answers
MOST = 6000  # words before the appendix
PARTS = Path(__file__).resolve().parent / "page"
QUICK = ("This is the quick report: fewer methods, angles and runs than `make compare` takes, "
         "and no more than one small picture of each renderer.")


@dataclass(frozen=True)
class Section:
    """What the page shows of a study. commands: {command: keys of what it makes}; left: how many findings about times it does
    not tell; topic, answers: its lines of the first table; apart: it has a page of its own, of which the report says no more
    than its last finding; alone: this is that page."""

    name: str
    title: str
    intro: str
    findings: Sequence
    figures: Sequence
    tables: Sequence
    commands: Mapping
    count: int
    left: int = 0
    topic: str = ""
    answers: Sequence = ()
    apart: bool = False
    alone: bool = False


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


def late(section, figure):
    """Whether a figure stands in the appendix: no finding leads to it, and the study has no page of its own."""
    return not section.alone and figure.id not in {finding.figure for finding in section.findings}


def numbered(sections):
    """{anchor: "Figure 3"} of all figures and tables, counted through the page as they stand there."""
    names = {}
    for word, parts in (("Figure", "figures"), ("Table", "tables")):
        found = [(section, part) for section in sections for part in getattr(section, parts)]
        found.sort(key=lambda of: ((of[0].name, of[1].id) != LEAD, word == "Figure" and late(*of)))
        for count, (section, part) in enumerate(found, 1):
            name = anchor(section, part)
            if name in names:
                raise ValueError(f"study {section.name}: two parts are called '{part.id}'")
            names[name] = f"{word} {count}"
    return names


def cell(value, head):
    """One <td>, with what it is sorted by, and its column's head, which stands beside it on a phone."""
    if value is None or value == "":
        return "<td></td>"
    beside = f'data-head="{attribute(head)}"'
    if isinstance(value, str):
        return f"<td {beside}{' class=short' if len(value) < 20 else ''}>{text(value)}</td>"
    shown = str(value) if isinstance(value, int) else style.number(value)
    return f'<td class="number" {beside} data-value="{float(value)!r}">{shown}</td>'


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
    body = "\n".join("<tr>" + "".join(map(cell, row, part.columns)) + "</tr>" for row in part.rows)
    name = anchor(section, part)
    return f"""<div class="table" id="{name}">
<p class="caption" id="{name}-caption"><b>{names[name]}.</b> <strong>{text(part.title)}</strong> {text(part.caption)}</p>
<div class="scroll" tabindex="0" role="region" aria-label="{attribute(part.title)}"><table{' class="many"' if len(part.columns) > 7 else ""} aria-labelledby="{name}-caption">
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
    if section.apart:
        return f"""<section id="{section.name}">
<h2>{text(section.title)}</h2>
<p class="intro">{text(section.findings[-1].text) if section.findings else ""}
<a href="{section.name}.html">Maps, findings and reasons</a></p>
</section>"""
    parts = [figure(section, part, names) for part in section.figures
             if (section.name, part.id) != LEAD and not late(section, part)]
    lines = "\n".join(sentence(section, finding, names) for finding in section.findings)
    return f"""<section id="{section.name}">
<h2>{text(section.title)}</h2>
<p class="intro">{text(section.intro)}</p>
<ul class="findings">
{lines}
</ul>
{chr(10).join(parts)}
</section>"""


def numbers(section, names):
    """A study's part of the appendix."""
    figures = [figure(section, part, names) for part in section.figures if (section.name, part.id) != LEAD and late(section, part)]
    return f"""<div id="{section.name}-appendix">
<h3 class="of">{text(section.title)}</h3>
{chr(10).join(figures)}
{chr(10).join(table(section, part, names) for part in section.tables)}
{remake(section)}
</div>"""


def answers(sections, names):
    """The first screen: what to use, and the chart of speed against accuracy."""
    lines = [(section, answer) for section in sections for answer in section.answers]
    if not lines:
        return ""
    heads = ("If your surface …", "use", "costs", "fails where")
    body = []
    for section, answer in lines:
        use = f'<a href="#{section.name}">{text(section.topic)}</a> {text(answer.use)}'
        body.append(f'<tr><td>{text(answer.surface)}</td><td data-head="use">{use}</td><td data-head="costs">{text(answer.costs)}</td>'
                    f'<td data-head="fails where">{text(answer.fails)}</td></tr>')
    lead = [figure(section, part, names) for section in sections for part in section.figures if (section.name, part.id) == LEAD]
    return f"""<section id="answers">
<h2>What to use</h2>
<div class="scroll"><table class="answers">
<thead><tr>{"".join(f'<th scope="col">{head}</th>' for head in heads)}</tr></thead>
<tbody>
{chr(10).join(body)}
</tbody></table></div>
{chr(10).join(lead)}
</section>"""


def words(page):
    """Of the page's main part before the appendix, those of its charts among them."""
    main = page.split("<main>")[1].split("</main>")[0].split('<section id="appendix">')[0]
    return len(escaping.unescape(re.sub(r"<[^>]*>", " ", main)).split())


def html(sections, head, quick, alone=False):
    """The page. sections: Section; head: {word: text}, what was measured where; alone: that of one study, of its own."""
    told = [replace(section, apart=False, alone=True) for section in sections] if alone else sections
    names = numbered([section for section in told if not section.apart])
    listed = [*([("answers", "What to use")] if any(s.answers for s in told) else []), *((s.name, s.title) for s in told),
              ("appendix", "Appendix: all numbers, and more pictures")]
    contents = "\n".join(f'<li><a href="#{name}">{text(title)}</a></li>' for name, title in listed)
    facts = "\n".join(f"<div><dt>{word}</dt><dd>{text(said)}</dd></div>"
                      for word, said in head.items() if word != "command")
    left = sum(section.left for section in sections)
    css = (PARTS / "page.css").read_text(encoding="utf-8")
    script = (PARTS / "page.js").read_text(encoding="utf-8")
    title = told[0].title if alone else "Speed, accuracy, and where methods fail"
    made = f"""<!DOCTYPE html>
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
<a class="skip" href="#{listed[0][0]}">To the {'answers' if listed[0][0] == 'answers' else 'text'}</a>
<header>
<p class="kicker">libshade · {'<a href="report.html">report</a>' if alone else 'quick report' if quick else 'report'}</p>
<h1>{text(title)}</h1>
</header>
<div class="columns">
<nav aria-label="Contents"><details open><summary>Contents</summary>
<ol>{contents}</ol></details></nav>
<main>
{'' if alone else answers(told, names)}
{chr(10).join(study(section, names) for section in told)}
<section id="appendix">
<h2>Appendix: all numbers, and more pictures</h2>
{chr(10).join(numbers(section, names) for section in told if not section.apart)}
</section>
</main>
</div>
<p id="said" role="status" class="unseen"></p>
<footer>
<p>Every number here was computed by the run that wrote this page, and every sentence was tested against its tables.
Bars span the middle half of what was seen in repeated runs, unless a caption says otherwise.
Colours are those of Okabe and Ito; a method keeps its colour and its marker through the page.</p>
{f'<p class="note">{text(QUICK)}</p>' if quick else ''}
{f'<p class="note">{left_out(left)}</p>' if left else ''}
<dl class="facts">
{facts}
<div><dt>made by</dt><dd><code>{text(head['command'])}</code></dd></div>
</dl>
</footer>
<script>
{script}</script>
</body>
</html>
"""
    if not alone and words(made) > MOST:
        raise ValueError(f"the report has {words(made)} words before its appendix: expected {MOST} at most")
    return made
