"""A page without a browser, for tests: it opens the WebSocket, asks, and keeps what is pushed."""

import asyncio
import json
import time

import support
from tornado.httpclient import HTTPRequest
from tornado.websocket import websocket_connect

from robot_vision.dashboard.access import Access
from robot_vision.dashboard.features import operations_of, routes_of
from robot_vision.dashboard.server import Server, bind

TOKEN, VIEW_TOKEN = "token-for-control", "token-for-view"


class ToolServer:
    """A dashboard of some features, in this process."""

    def __init__(self, *features):
        sockets = bind("127.0.0.1", 0)
        self.port = sockets[0].getsockname()[1]
        access = Access("127.0.0.1", self.port, TOKEN, VIEW_TOKEN)
        self._features = features
        self._server = Server(sockets, access, operations_of(features), routes_of(features))
        self._pages = []

    def page(self, token=TOKEN):
        self._pages.append(Page(self.port, token))
        return self._pages[-1]

    def url(self, path, token=TOKEN):
        return f"http://127.0.0.1:{self.port}{path}?token={token}"

    def close(self):
        for page in self._pages:
            page.close()
        self._server.close()
        for feature in self._features:
            feature.close()


class Page:
    """A session; requests raise ValueError with the text that the page would show."""

    def __init__(self, port, token):
        self._loop = asyncio.new_event_loop()
        url = f"ws://127.0.0.1:{port}/ws?token={token}"
        headers = {"Origin": f"http://127.0.0.1:{port}"}
        self._socket = self._run(self._connect(HTTPRequest(url, headers=headers)))
        self._number = 0
        self.pushed = []

    def request(self, op, **fields):
        self._number += 1
        self._socket.write_message(json.dumps({"op": op, "id": self._number, **fields}))
        while True:
            message = self._read(support.DEADLINE)
            if message.get("id") == self._number:
                break
        if "error" in message:
            raise ValueError(message["error"])
        return message["result"]

    def wait(self, kind, condition, what):
        """The first push of this kind, of those that came and come, that the condition is for."""
        deadline = time.monotonic() + support.DEADLINE
        while True:
            while self.pushed:
                push = self.pushed.pop(0)
                if push["push"] == kind and condition(push["data"]):
                    return push["data"]
            left = deadline - time.monotonic()
            assert left > 0.0, f"not within {support.DEADLINE:.0f} s: {what}"
            self._read(left)

    def close(self):
        self._socket.close()
        self._run(asyncio.sleep(0))

    async def _connect(self, request):
        return await websocket_connect(request)

    def _read(self, seconds):
        text = self._run(asyncio.wait_for(self._receive(), seconds))
        assert text is not None, "the server has closed the connection"
        message = json.loads(text)
        if "push" in message:
            self.pushed.append(message)
        return message

    async def _receive(self):
        return await self._socket.read_message()

    def _run(self, work):
        asyncio.set_event_loop(self._loop)
        return self._loop.run_until_complete(work)
