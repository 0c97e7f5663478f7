"""A page's WebSocket without a browser (RFC 6455), as much of it as a test needs."""
import base64
import json
import os
import socket
import struct
import urllib.parse
from collections import namedtuple

import numpy as np

Picture = namedtuple("Picture", "kind flags columns rows epoch trigger first samples burst rate_hz received_at_s numbers")
HEAD = struct.Struct("<BBHIIIqqQQdd")  # scope/pictures/picture.hpp
WAVEFORM, SPECTRUM, CHAIN = 1, 2, 3
EACH_SAMPLE, UNTRIGGERED, HELD, FORCES = 1, 2, 4, 8


class Refused(Exception):
    pass


def picture_of(data):
    kind, version, *rest = HEAD.unpack_from(data)
    assert version == 2 and HEAD.size == 64, version
    return Picture(kind, *rest, np.frombuffer(data, "<f4", offset=HEAD.size))


def row_of(picture, row):
    """Returns a waveform of one channel of it."""
    values = picture.numbers.reshape(-1, picture.rows, picture.columns)[:, row]  # smallest and largest, or the samples
    return picture._replace(rows=1, numbers=values.ravel())


class PageSocket:
    def __init__(self, url, origin=True, host=None, path="socket", timeout_s=60):
        """origin: True: the page's; None: none; else another one."""
        parts = urllib.parse.urlsplit(url)
        self.socket = socket.create_connection((parts.hostname, parts.port), timeout=timeout_s)
        lines = [f"GET {parts.path}{path} HTTP/1.1", f"Host: {host or parts.netloc}", "Upgrade: websocket", "Connection: Upgrade",
                 "Sec-WebSocket-Version: 13", "Sec-WebSocket-Key: " + base64.b64encode(os.urandom(16)).decode()]
        if origin is not None:
            lines.append(f"Origin: http://{parts.netloc}" if origin is True else f"Origin: {origin}")
        self.socket.sendall("\r\n".join([*lines, "", ""]).encode())
        self.rest = b""
        while b"\r\n\r\n" not in self.rest:
            more = self.socket.recv(4096)
            if not more:
                raise Refused("closed")
            self.rest += more
        head, self.rest = self.rest.split(b"\r\n\r\n", 1)
        if b" 101 " not in head.split(b"\r\n")[0] + b" ":
            raise Refused(head.split(b"\r\n")[0].decode())
        self.texts = {}

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.socket.close()

    def _take(self, count):
        while len(self.rest) < count:
            more = self.socket.recv(1 << 16)
            if not more:
                raise EOFError("the scope has closed the connection")
            self.rest += more
        taken, self.rest = self.rest[:count], self.rest[count:]
        return taken

    def send_frame(self, opcode, payload):
        size = len(payload)
        length = bytes([128 | size]) if size < 126 else bytes([128 | 126]) + struct.pack(">H", size) if size < 65536 else \
            bytes([128 | 127]) + struct.pack(">Q", size)
        mask = os.urandom(4)
        self.socket.sendall(bytes([128 | opcode]) + length + mask + bytes(b ^ mask[i % 4] for i, b in enumerate(payload)))

    def say(self, request):
        self.send_frame(1, json.dumps(request).encode())

    def receive(self):
        """Returns a picture, or the object of a text. Answers updates and pings."""
        data, kind = b"", None
        while True:
            first, second = self._take(2)
            size = second & 127
            size = struct.unpack(">H", self._take(2))[0] if size == 126 else struct.unpack(">Q", self._take(8))[0] if size == 127 else size
            payload, opcode = self._take(size), first & 15
            if opcode == 9:
                self.send_frame(10, payload)
                continue
            if opcode == 8:
                raise EOFError("the scope closes the connection")
            kind, data = (opcode or kind), data + payload
            if first & 128:
                break
        if kind == 2:
            return picture_of(data)
        text = json.loads(data)
        self.say({"ack": text["update"]})
        self.texts |= text
        return text

    def until(self, condition, most=4000):
        """Returns the first message for which the condition holds."""
        for _ in range(most):
            message = self.receive()
            if condition(message):
                return message
        raise AssertionError("never came")

    def picture(self, kind=WAVEFORM, condition=lambda picture: True):
        return self.until(lambda m: isinstance(m, Picture) and m.kind == kind and condition(m))

    def text(self, condition):
        return self.until(lambda m: isinstance(m, dict) and condition(m))

    def knows(self, condition, most=4000):
        """Waits until the condition holds for the newest value of each member of all texts."""
        for _ in range(most):
            if self.texts and condition(self.texts):
                return self.texts
            self.receive()
        raise AssertionError("timed out")
