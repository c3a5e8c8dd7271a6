# SPDX-License-Identifier: BSD-3-Clause
"""Own methods: functions of Python that the program calls for its steps, through its plugin weft-own.so."""
from __future__ import annotations

import os
import re
import socketserver
import struct
import tempfile
import threading
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Optional

import numpy as np

from weft.library import ArgumentError, ArgumentTypeError, Array, real

Rhs = Callable[[float, Array], Array]
Method = Callable[[Rhs, float, Array, float], Array]

_EVALUATE, _DONE, _UNUSABLE, _RAISED = range(4)
_MOST = 16


class _Unusable(Exception):
    """A right-hand side that cannot be evaluated."""


class _Server(socketserver.ThreadingUnixStreamServer):
    daemon_threads = True
    request_queue_size = 64

    def __init__(self, path: str, methods: Mapping[str, Method]) -> None:
        super().__init__(path, _Instance)
        self.functions = list(methods.values())
        self.error: Optional[BaseException] = None
        self.stop: Callable[[], None] = lambda: None

    def handle_error(self, _request: Any, _address: Any) -> None:
        """The program ended within a step."""


class _Instance(socketserver.StreamRequestHandler):
    """Answers to one instance of the plugin."""

    server: _Server

    def _read(self, size: int) -> bytes:
        data = self.rfile.read(size)
        if len(data) < size:
            raise EOFError
        return data

    def _rhs(self, t: float, y: Array) -> Array:
        state = real(y, "a state", (self.dim,))
        self.wfile.write(struct.pack("=qd", _EVALUATE, t) + state.tobytes())
        code, = struct.unpack("=q", self._read(8))
        dydt = np.frombuffer(self._read(8 * self.dim)).copy()
        if code != 0:
            raise _Unusable
        return dydt

    def _step(self, function: Method, t: float, h: float) -> bytes:
        y = np.frombuffer(self._read(8 * self.dim)).copy()
        try:
            end = real(function(self._rhs, t, y, h), "what a method returns", (self.dim,))
            return struct.pack("=qd", _DONE, 0.0) + end.tobytes()
        except _Unusable:
            return struct.pack("=qd", _UNUSABLE, 0.0)
        except EOFError:
            raise
        except BaseException as error:
            if self.server.error is None:
                self.server.error = error
                self.server.stop()
            return struct.pack("=qd", _RAISED, 0.0)

    def handle(self) -> None:
        which, self.dim = struct.unpack("=QQ", self._read(16))
        with np.errstate(all="ignore"):  # steps that are too long
            while head := self.rfile.read(16):
                self.wfile.write(self._step(self.server.functions[which], *struct.unpack("=dd", head)))


def check(methods: Mapping[str, Method]) -> None:
    for name, function in methods.items():
        if not re.fullmatch(r"[A-Za-z_][A-Za-z0-9_]{0,31}", name):
            raise ArgumentError("%r is no name of a method: letters, digits and _" % (name,))
        if not callable(function):
            raise ArgumentTypeError("the method %s is no function: %r" % (name, function))
    if not 0 < len(methods) <= _MOST:
        raise ArgumentError("%d own methods, not 1 to %d" % (len(methods), _MOST))


@contextmanager
def served(methods: Optional[Mapping[str, Method]]) -> Iterator[tuple[dict[str, str], Optional[_Server]]]:
    """While it lasts, a program with the environment given calls the methods."""
    if methods is None:
        yield dict(os.environ), None
        return
    check(methods)
    with tempfile.TemporaryDirectory(prefix="weft-") as folder:
        path = os.path.join(folder, "own")
        with _Server(path, methods) as server:
            threading.Thread(target=server.serve_forever, kwargs={"poll_interval": 0.05}, daemon=True).start()
            plugins = [str(Path(__file__).parent), *filter(None, [os.environ.get("WEFT_PLUGIN_PATH")])]
            try:
                yield {**os.environ, "WEFT_OWN": "\n".join([path, *methods]), "WEFT_PLUGIN_PATH": ":".join(plugins)}, server
            finally:
                server.shutdown()
