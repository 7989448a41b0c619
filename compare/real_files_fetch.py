# SPDX-License-Identifier: Apache-2.0
"""Packages that hold scenes: fetched by apt and pip, unpacked, each once."""
import os
import re
import shutil
import subprocess
import sys
import tarfile
import zipfile
from pathlib import Path

import report
import whole


def root_of(source, package, version, folder):
    """Folder that the paths of a package's files start from. StepFailed where it cannot be had.

    source: "deb", a Debian package, "src", the upstream part of the source of one, "pypi", a wheel.
    """
    if source == "deb" and _installed(package) == version:
        return Path("/")
    place = folder / f"{package}_{version.replace(':', '_')}_{source}"
    if not place.exists():
        fetch = {"deb": _deb, "src": _source, "pypi": _wheel}[source]
        part = folder / "part"
        shutil.rmtree(part, ignore_errors=True)
        (part / "got").mkdir(parents=True)
        (part / "root").mkdir()
        fetch(package, version, folder, part / "got", part / "root")
        (part / "root").rename(place)
        shutil.rmtree(part)
    return place


def _installed(package):
    done = subprocess.run(["dpkg-query", "-W", "-f", "${Version}", package], text=True,
                          stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, check=False)
    return done.stdout if done.returncode == 0 else None


def _run(words, command, folder, got):
    report.step(words, command, folder / "fetch.log", folder=got)


def _sources(folder):
    """Lists of apt of our own, with sources: nothing of the system is touched. Options for apt-get."""
    lists = folder / "apt"
    options = ["-q", "-o", "Dir::Etc::sourcelist=/dev/null", "-o", f"Dir::Etc::sourceparts={lists}",
               "-o", f"Dir::State::Lists={lists}/lists", "-o", f"Dir::Cache={lists}/cache",
               "-o", "APT::Sandbox::User=root", "-o", "Acquire::Retries=3"]
    if (lists / "updated").exists():
        return options
    for part in ("lists/partial", "cache/archives/partial"):
        (lists / part).mkdir(parents=True, exist_ok=True)
    system = Path("/etc/apt")
    for file in [system / "sources.list", *sorted((system / "sources.list.d").glob("*"))]:
        text = file.read_text(encoding="utf-8") if file.is_file() else ""
        if "debian" not in text:
            continue
        if file.suffix == ".sources":
            text = re.sub(r"(?m)^Types:.*$", "Types: deb deb-src", text)
        else:
            entries = re.findall(r"(?m)^\s*deb\s.*$", text)
            text = "\n".join(e + "\n" + e.replace("deb", "deb-src", 1) for e in entries) + "\n"
        whole.write_text(lists / file.name, text)
    _run("apt-get update", ["apt-get", *options, "update"], folder, folder)
    (lists / "updated").touch()
    return options


def _deb(package, version, folder, got, root):
    _run(f"Fetching {package} {version}",
         ["apt-get", *_sources(folder), "download", f"{package}={version}"], folder, got)
    _run(f"Unpacking {package}", ["dpkg-deb", "-x", str(next(got.glob("*.deb"))), str(root)], folder, got)


def _source(package, version, folder, got, root):
    _run(f"Fetching the source of {package} {version}",
         ["apt-get", *_sources(folder), "source", "--download-only", "--tar-only", f"{package}={version}"],
         folder, got)
    with tarfile.open(next(got.glob("*.orig.tar.*"))) as archive:
        for member in archive.getmembers():
            member.name = member.name.lstrip("./").partition("/")[2]
            if member.isfile() and member.name and ".." not in Path(member.name).parts:
                archive.extract(member, root)


def _wheel(package, version, folder, got, root):
    _run(f"Fetching {package} {version}",
         [sys.executable, "-m", "pip", "download", "-q", "--no-deps", "--only-binary", ":all:",
          f"{package}=={version}"], folder, got)
    with zipfile.ZipFile(next(got.glob("*.whl"))) as archive:
        archive.extractall(root)


def path_of(root, path):
    """A file, inside its package; OSError where it is not there."""
    whole = os.path.normpath(root / path)
    if not os.path.isfile(whole):
        raise OSError(f"{path}: not in its package")
    return whole
