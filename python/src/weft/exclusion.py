# SPDX-License-Identifier: BSD-3-Clause
"""Which thread may use a simulation: one that changes it, or one after the other that read it."""
from __future__ import annotations

import os
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, Optional

from weft.library import Error


class Exclusion:
    """Reads wait for one another, and a change waits for a read. During a change both are refused, but the thread that
    changes may read: it is in a callback."""

    def __init__(self) -> None:
        self._process, self._gate = os.getpid(), threading.RLock()
        self._change: Optional[list[int]] = None  # one that is under way: its thread

    def _entrance(self) -> Any:
        """A lock that reads hold, and changes while they begin."""
        if os.getpid() != self._process:  # the thread that held it is not in a fork
            self._process, self._gate = os.getpid(), threading.RLock()
        return self._gate

    @contextmanager
    def change(self) -> Iterator[None]:
        own = [threading.get_ident()]
        try:  # what a handler of a signal raises may come between any two calls
            with self._entrance():
                if self._change is not None:
                    raise Error("this simulation is in use: by another thread, or because this is one of its callbacks")
                self._change = own
            yield
        finally:
            if self._change is own:
                self._change = None

    @contextmanager
    def read(self) -> Iterator[None]:
        with self._entrance():
            change = self._change
            if change is not None and change[0] != threading.get_ident():
                raise Error("this simulation is in use by another thread")
            yield
