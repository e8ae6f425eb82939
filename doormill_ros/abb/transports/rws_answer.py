"""Answers of a controller are read up to a size that no right one reaches, whatever it announces."""

from __future__ import annotations

from collections.abc import Iterator

import httpx

#: A target file, the longest right answer, has less than a quarter of it [bytes].
LARGEST = 4 * 1024 * 1024


class AnswerRefusedError(httpx.RequestError):
    """An answer that is not read to its end."""


class BoundedTransport(httpx.HTTPTransport):
    """Ends an answer, that to a login included, where it becomes longer than any right one."""

    def handle_request(self, request: httpx.Request) -> httpx.Response:
        """Send one request.

        Raises:
            AnswerRefusedError: The answer is packed, of which a few bytes may unpack to any size.
            httpx.HTTPError: As the base class.
        """
        response = super().handle_request(request)
        packed = response.headers.get("Content-Encoding", "identity")
        if packed != "identity":
            response.close()
            raise AnswerRefusedError(f"the answer is packed ({packed:.40}), asked for was a plain one")
        if isinstance(response.stream, httpx.SyncByteStream):
            response.stream = _BoundedStream(response.stream)
        return response


class _BoundedStream(httpx.SyncByteStream):
    def __init__(self, stream: httpx.SyncByteStream) -> None:
        self._stream = stream

    def __iter__(self) -> Iterator[bytes]:
        """The pieces of the answer; raises AnswerRefusedError beyond the limit."""
        size = 0
        for piece in self._stream:
            size += len(piece)
            if size > LARGEST:
                raise AnswerRefusedError(f"the answer has more than the {LARGEST} bytes that are allowed")
            yield piece

    def close(self) -> None:
        """Give the connection back, or end it where the answer goes on."""
        self._stream.close()
