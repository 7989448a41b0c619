# SPDX-License-Identifier: GPL-3.0-or-later
"""Modules of the add-on by name, and what stands in for parts of them for a while."""

import contextlib
import importlib

import common


def module(name):
    return importlib.import_module(f"{common.MODULE}.{name}")


@contextlib.contextmanager
def replaced(owner, **parts):
    held = {name: getattr(owner, name) for name in parts}
    try:
        for name, part in parts.items():
            setattr(owner, name, part)
        yield
    finally:
        for name, part in held.items():
            setattr(owner, name, part)


def raised(function, *arguments):
    """What the error says; "" without one."""
    try:
        function(*arguments)
    except Exception as error:  # whatever it is
        return str(error)
    return ""
