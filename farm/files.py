# SPDX-License-Identifier: Apache-2.0
"""Files that appear whole or not at all, and what is known of their contents."""

import hashlib
import json
import os
import shutil
import socket
import tempfile


class Refusal(Exception):
    """What a user is told, without a traceback."""


def host():
    return os.environ.get("SLURMD_NODENAME") or socket.gethostname()


def read_json(path, otherwise=None):
    try:
        with open(path, encoding="utf-8") as file:
            return json.load(file)
    except (OSError, ValueError):
        return otherwise


def write_json(path, value):
    """By rename."""
    handle, part = tempfile.mkstemp(dir=os.path.dirname(path), prefix=".", suffix=".tmp")
    try:
        with os.fdopen(handle, "w", encoding="utf-8") as file:
            json.dump(value, file, ensure_ascii=False, indent=1)
            file.write("\n")
            file.flush()
            os.fsync(file.fileno())
        os.chmod(part, 0o644)
        os.replace(part, path)
    except BaseException:
        remove(part)
        raise


def remove(path):
    try:
        os.remove(path)
    except OSError:
        pass


def sha256(path):
    found = hashlib.sha256()
    with open(path, "rb") as file:
        for block in iter(lambda: file.read(1 << 20), b""):
            found.update(block)
    return found.hexdigest()


def told(path, name=None):
    """What identifies a file: its name, size and hash."""
    return {"path": name or path, "size": os.path.getsize(path), "sha256": sha256(path)}


def is_as_told(path, said, thorough=True):
    try:
        return os.path.getsize(path) == said["size"] and (not thorough or sha256(path) == said["sha256"])
    except OSError:
        return False


def synced(path):
    """On the disk itself, or an error: of a full one a network may tell only now."""
    handle = os.open(path, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)


def publish(path, place):
    """The same file under another name; a link where that can be."""
    os.makedirs(os.path.dirname(place), exist_ok=True)
    part = os.path.join(os.path.dirname(place), f".{os.path.basename(place)}.{host()}.{os.getpid()}.tmp")
    remove(part)
    try:
        try:
            os.link(path, part)
        except OSError:
            shutil.copyfile(path, part)
        os.replace(part, place)
    finally:
        remove(part)
