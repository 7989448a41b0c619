# SPDX-License-Identifier: Apache-2.0
"""The parts of a study, which is a section of the report that `make compare` writes.

A study is a file compare/study_<name>.py with

    NAME, TITLE      id of its section and of its CSV, build/compare/data/<NAME>.csv; its heading
    INTRO            a paragraph in plain words: what is asked, how it is measured, what is the truth
    tasks(quick)     list of Task: the work, in pieces that a second run need not do again
    findings(rows)   list of Finding: what was seen, each with the test of it
    figures(rows)    list of Figure
    tables(rows)     list of Table

`rows` are all rows of its tasks, dictionaries of str, int and float, as read back from its CSV: a
column that some rows lack is missing there. Functions get nothing else, so that every number of the
page is one of a CSV beside it.
"""
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field


@dataclass(frozen=True)
class Task:
    """A piece of work. Its rows are kept once it is done, until what it depends on changes.

    key      unique in the study; letters, digits, - and _ : it is the name of a file
    seconds  what it takes on two idle cores, for the time that is said beforehand
    run      run(folder, say): rows, a list of dictionaries of str, int and float. `folder` (a Path,
             there already) is its own, for what it writes; `say(text)` shows a line of progress
    command  what a user types to make these rows again; "" where that is the report alone
    needs    paths of programs and files whose change makes the rows old, beside the study's own code
             and the library
    """

    key: str
    seconds: float
    run: Callable
    command: str = ""
    needs: Sequence = field(default=())


@dataclass(frozen=True)
class Finding:
    """A sentence in plain words, its numbers taken from rows, and whether rows make it true.

    A page with one that does not hold is not written. `figure`: the id of the figure or table
    of the same study that shows it, linked from the sentence; "" for none. `timed`: it rests on
    measured times; the quick report, which busy machines make, leaves it out where it does not hold.
    """

    text: str
    holds: bool
    figure: str = ""
    timed: bool = False


@dataclass(frozen=True)
class Figure:
    """A chart. id: unique in the study; svg: text from style.svg(); alt: what is to be seen, in words.

    The caption is plain text and may hold `code` in backquotes, such as the command.
    """

    id: str
    title: str
    caption: str
    svg: str
    alt: str


@dataclass(frozen=True)
class Table:
    """Rows that the page can sort. columns: heads, with units; rows: lists of str, int, float or None.

    Numbers are shown to three digits or so; one that is a text stands as it is.
    """

    id: str
    title: str
    caption: str
    columns: Sequence[str]
    rows: Sequence[Sequence]
