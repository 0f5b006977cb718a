"""As much of a WebSocket client as the tests of the viewer need."""

import base64
import json
import os
import socket
import struct
import urllib.parse


class Page:
    """What a page of a view is told, and what it says."""

    def __init__(self, url, query=""):
        parts = urllib.parse.urlsplit(url)
        self.socket = socket.create_connection((parts.hostname, parts.port), timeout=60)
        key = base64.b64encode(os.urandom(16)).decode()
        lines = [
            f"GET {parts.path}ws{query} HTTP/1.1", f"Host: {parts.netloc}", "Upgrade: websocket",
            "Connection: Upgrade", f"Sec-WebSocket-Key: {key}", "Sec-WebSocket-Version: 13", "", "",
        ]
        self.socket.sendall("\r\n".join(lines).encode())
        self.file = self.socket.makefile("rb")
        self.status = int(self.file.readline().split()[1])
        while self.file.readline().strip():
            pass

    def say(self, **message):
        data = json.dumps(message).encode()
        size = struct.pack("!BB", 0x81, 0x80 | len(data)) if len(data) < 126 else struct.pack(
            "!BBH", 0x81, 0xFE, len(data)
        )
        self.socket.sendall(size + bytes(4) + data)  # a mask of zeros

    def hear(self):
        while True:
            kind, size = struct.unpack("!BB", self.file.read(2))
            if size > 125:
                size = struct.unpack("!H" if size == 126 else "!Q", self.file.read(2 if size == 126 else 8))[0]
            data = self.file.read(size)
            if kind & 0x0F == 1:
                return json.loads(data)

    def until(self, is_so):
        while True:
            message = self.hear()
            if is_so(message):
                return message

    def next(self, kind):
        return self.until(lambda message: message["type"] == kind)

    def close(self):
        self.file.close()
        self.socket.close()
