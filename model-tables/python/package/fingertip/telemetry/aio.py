"""The client for asyncio. The line is read by the same thread, so that it works with every event loop on every system."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator
from typing import TYPE_CHECKING

from .client import CAPACITY, Client, Counts
from .codes import CommandKind
from .frames import Answer, Frame, Hello
from .ports import BAUD

if TYPE_CHECKING:
    from .batch import Batch

__all__ = ["AsyncClient"]


class AsyncClient:
    """A board, for ``async with`` and ``async for``; arguments and errors are those of :class:`Client`."""

    def __init__(
        self,
        address: str,
        *,
        baud: int = BAUD,
        capacity: int = CAPACITY,
        reconnect: bool = True,
        poll: float | None = None,
    ) -> None:
        self._arguments = (address, baud, capacity, reconnect, poll)
        self._client: Client | None = None
        self._came = asyncio.Event()
        self._loop: asyncio.AbstractEventLoop | None = None

    async def __aenter__(self) -> AsyncClient:
        address, baud, capacity, reconnect, poll = self._arguments
        self._loop = asyncio.get_running_loop()
        self._client = await asyncio.to_thread(
            Client, address, baud=baud, capacity=capacity, reconnect=reconnect, poll=poll
        )
        self._client.listen(self._wake)
        return self

    async def __aexit__(self, *_: object) -> None:
        await asyncio.to_thread(self.client.close)

    @property
    def client(self) -> Client:
        """The client that reads the line."""
        if self._client is None:
            raise RuntimeError("the client is not open: use `async with`")
        return self._client

    @property
    def counts(self) -> Counts:
        """What came and what did not."""
        return self.client.counts

    def _wake(self, _: Frame | None) -> None:
        # One call a wait is enough, however many frames come.
        if self._loop is not None and not self._came.is_set():
            try:
                self._loop.call_soon_threadsafe(self._came.set)
            except RuntimeError:
                # The loop was closed before the client.
                pass

    async def read(self) -> Frame:
        """The next frame.

        Raises:
            EOFError: there is no more: the file or the connection has ended.
        """
        while True:
            self._came.clear()
            try:
                return self.client.read(0)
            except TimeoutError:
                await self._came.wait()

    async def __aiter__(self) -> AsyncIterator[Frame]:
        """Frames until the connection ends."""
        while True:
            try:
                frame = await self.read()
            except EOFError:
                return
            yield frame

    async def batch(self, *, count: int | None = None, seconds: float | None = None) -> Batch:
        """As :meth:`Client.batch`."""
        return await asyncio.to_thread(self.client.batch, count=count, seconds=seconds)

    async def command(self, kind: CommandKind, payload: bytes = b"") -> Answer:
        """As :meth:`Client.command`."""
        return await asyncio.to_thread(self.client.command, kind, payload)

    async def tare(self) -> Answer:
        """As :meth:`Client.tare`."""
        return await asyncio.to_thread(self.client.tare)

    async def hello(self) -> Hello:
        """As :meth:`Client.hello`."""
        return await asyncio.to_thread(self.client.hello)
