# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's data may be changed by its main thread alone; a window renders in another."""

import threading

import bpy

_SECONDS = 60.0


def on_main_thread(function):
    """What the function returns; TimeoutError where the main thread does not come to it."""
    if threading.current_thread() is threading.main_thread():
        return function()
    done, answer = threading.Event(), []

    def timer():
        if not done.is_set():  # else nobody waits any more
            try:
                answer.append((function(), None))
            except Exception as error:  # is raised where it was asked for
                answer.append((None, error))
            done.set()

    bpy.app.timers.register(timer)
    if not done.wait(_SECONDS):
        done.set()
        raise TimeoutError("Blender's main thread does not answer")
    value, error = answer[0]
    if error:
        raise error
    return value
