# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender in both versions, for all tests of the add-on.

Needs `make blender` and build/venv-bpy; both come with `make check`.
"""

import pytest

from blender_runs import ROOT, ZIP, Blender


class _PlainFolder:
    """The add-on's folder is a package only inside Blender: pytest must not import it."""

    @staticmethod
    def pytest_collect_directory(path, parent):
        if path == ROOT / "blender_addon_c":
            return pytest.Dir.from_parent(parent, path=path)
        return None


def pytest_configure(config):
    config.pluginmanager.register(_PlainFolder())


def _blender(version, factory):
    assert ZIP.exists(), f"{ZIP} is missing: run `make blender`"
    blender = Blender(version, factory.mktemp("blender" + version))
    yield blender
    blender.close()


@pytest.fixture(scope="session")
def blender34(tmp_path_factory):
    yield from _blender("3.4", tmp_path_factory)


@pytest.fixture(scope="session")
def blender50(tmp_path_factory):
    yield from _blender("5.0", tmp_path_factory)


@pytest.fixture(scope="session", params=["34", "50"])
def blender(request):
    return request.getfixturevalue("blender" + request.param)
