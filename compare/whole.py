# SPDX-License-Identifier: Apache-2.0
"""Files that appear whole or not at all. All that compare/ writes itself goes through here."""
import contextlib
import csv
import os
from pathlib import Path


@contextlib.contextmanager
def place(path):
    """A path beside `path`, with its ending, to write to: `with place(path) as part:`.

    When the block ends it takes the place of what was there; where an error leaves the block it
    is removed, and what was there stays. What is no plain file is refused.
    """
    path = Path(os.path.realpath(path))
    if path.exists() and not path.is_file():
        raise OSError(f"{path}: no plain file")
    part = path.with_name(f".{path.stem}.{os.getpid()}{path.suffix}")
    try:
        yield part
        os.replace(part, path)
    except BaseException:
        part.unlink(missing_ok=True)
        raise


def write_text(path, text):
    with place(path) as part:
        part.write_text(text, encoding="utf-8")


def write_csv(path, rows):
    """Rows of values; dictionaries have their keys as the first row."""
    rows = list(rows)
    head = [list(rows[0])] if rows and isinstance(rows[0], dict) else []
    with place(path) as part, open(part, "w", newline="", encoding="utf-8") as file:
        csv.writer(file).writerows(
            head + [row.values() if isinstance(row, dict) else row for row in rows])
