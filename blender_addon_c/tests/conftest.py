# SPDX-License-Identifier: GPL-3.0-or-later
"""Blenders, for all tests of the add-on.

Needs `make blender` and build/venv-bpy; both come with `make check`.
"""

import pytest

from blender_runs import ROOT, ZIP, Blender, Missing


class _PlainFolder:
    """The add-on's folder is a package only inside Blender: pytest must not import it."""

    @staticmethod
    def pytest_collect_directory(path, parent):
        if path == ROOT / "blender_addon_c":
            return pytest.Dir.from_parent(parent, path=path)
        return None


def pytest_configure(config):
    config.pluginmanager.register(_PlainFolder())


def _blender(which, factory):
    assert ZIP.exists(), f"{ZIP} is missing: run `make blender`"
    blender = Blender(which, factory.mktemp("blender_" + which))
    yield blender
    blender.close()


@pytest.fixture(scope="session")
def blender_old(tmp_path_factory):
    """The system's own."""
    yield from _blender("old", tmp_path_factory)


@pytest.fixture(scope="session")
def blender_new(tmp_path_factory):
    """PyPI's bpy."""
    yield from _blender("new", tmp_path_factory)


@pytest.fixture(scope="session")
def blender52(tmp_path_factory):
    try:
        yield from _blender("5.2", tmp_path_factory)
    except Missing as missing:
        pytest.skip(str(missing))


@pytest.fixture(scope="session", params=["old", "new"])
def blender(request):
    return request.getfixturevalue("blender_" + request.param)
