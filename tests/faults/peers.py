"""Disturbances of a stream by peers: strangers on its port, and subscribers that misbehave or die."""
import contextlib
import itertools
import json
import os
import resource
import signal
import socket
import struct
import subprocess
import sys
import threading
import time

import zmq

import stand as stands
from stand import check, wait_until

# ZMTP 3.1 (rfc.zeromq.org/spec/37): signature, version, mechanism NULL, no server; then a READY command of a SUB socket.
GREETING = b"\xff" + bytes(8) + b"\x7f" + b"\x03\x01" + b"NULL".ljust(20, b"\0") + bytes(32)
READY = b"\x04\x19\x05READY\x0bSocket-Type\x00\x00\x00\x03SUB"
LENGTH_OF_READY = 27  # least length of the stream's answer


def _connected(stream, receives=None):
    """receives: bytes that the system buffers for it before it reads."""
    peer = socket.socket()
    peer.settimeout(stands.LONG_ENOUGH_S)
    if receives:
        peer.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, receives)
    peer.connect(stream.address)
    return peer


def _subscriber(stream, **how):
    """Opens a connection with a completed handshake, for messages that no library would send."""
    peer = _connected(stream, **how)
    peer.sendall(GREETING + READY)
    received = 0
    while received < len(GREETING) + LENGTH_OF_READY:
        received += len(peer.recv(4096))
    return peer


def _introduced(stream):
    """Opens a connection with as much of the handshake as the stream accepts. It may stay, however silent it is."""
    peer = _connected(stream)
    with contextlib.suppress(ConnectionError):
        peer.sendall(GREETING + READY)
    return peer


def _subscription(prefix):
    """Returns a subscription in ZMTP 3.0: flags, length, 1, prefix."""
    body = b"\x01" + prefix
    length = bytes([0, len(body)]) if len(body) < 256 else b"\x02" + struct.pack(">Q", len(body))
    return length + body


def _is_closed_by_the_stream(peer):
    try:
        while peer.recv(65536):
            pass
    except ConnectionResetError:
        pass
    return True


def plain_garbage(stand):
    huge = struct.pack(">Q", 2**63 - 1)
    garbage = [b"GET / HTTP/1.1\r\nHost: localhost\r\n\r\n", b"\0" * 5000, b"\xff" * 5000, os.urandom(100_000),
               GREETING[:10] + os.urandom(1000), GREETING + os.urandom(1000), GREETING + b"\x06" + huge,
               GREETING + READY + os.urandom(1000), GREETING + READY + b"\x02" + huge, GREETING + READY + b"\x00\x00",
               GREETING + READY + b"\x00\x05hello", GREETING + READY + b"\x04\x05\x04PING"]
    with stand.stream() as stream:
        for bytes_ in 10 * garbage:
            with _connected(stream) as peer, contextlib.suppress(ConnectionError):
                peer.sendall(bytes_)
                peer.settimeout(0.02)
                with contextlib.suppress(TimeoutError):
                    _is_closed_by_the_stream(peer)


def half_open_connections(stand):
    with stand.stream() as stream:
        for _ in range(8):  # memory kept by the allocator serves the next round; a leak grows with each
            with contextlib.ExitStack() as connections:
                for begun in 30 * [b"", GREETING[:1], GREETING[:10], GREETING, GREETING + READY[:5]]:
                    connections.enter_context(_connected(stream)).sendall(begun)
                stream.first_frame()  # a real subscriber finds room among them


def connections_beyond_the_descriptors(stand):
    few = 100
    with stand.stream(before_exec=lambda: resource.setrlimit(resource.RLIMIT_NOFILE, (few, few))) as stream:
        with contextlib.ExitStack() as connections:
            for _ in range(few + 50):
                connections.enter_context(_introduced(stream))
            wait_until(lambda: stream.footprint()[0] < few, "left any for others")
            stream.first_frame()  # a new subscriber is served while they are still there


def very_many_strangers(stand):
    with stand.stream("--max-clients", "8") as stream:
        with contextlib.ExitStack() as connections:
            for _ in range(2000):
                connections.enter_context(_introduced(stream))
            wait_until(lambda: stream.footprint()[0] <= stream.before[0] + 8, "cut them off")
            stream.first_frame()


def subscribers_that_read_nothing(stand):
    # Over a Unix socket; one after the other, so that their queues hold different messages.
    budget = 32 << 20
    with _on_a_unix_socket(stand, "--queue-memory", str(budget), scene=stands.BUSY) as stream:
        stopped, most = [], 0
        for _ in range(9):
            stopped.append(_hearing_peer(stream, "--chain"))
            stopped[-1].send_signal(signal.SIGSTOP)
            time.sleep(0.7)
            most = max(most, stream.footprint()[1] - stream.before[1])
        check(stand.sanitized or 4 << 20 < most < budget + stands.KEPT_BY_ALLOCATOR, f"{most >> 20} MiB for queues")
        for peer in stopped:
            peer.kill()


def subscribers_that_trickle(stand):
    """Subscribers read a few bytes at a time and never stop, so they cannot be taken for dead."""
    budget = 32 << 20
    peers, over = [], threading.Event()

    def read_a_little():
        while not over.wait(0.005):
            for peer in list(peers):
                with contextlib.suppress(BlockingIOError, ConnectionError):
                    peer.recv(16)
    reader = threading.Thread(target=read_a_little)
    with stand.stream("--queue-memory", str(budget), scene=stands.BUSY) as stream, contextlib.ExitStack() as connections:
        reader.start()
        try:
            most = 0
            for _ in range(9):  # one after the other, so that their queues hold different messages
                peer = connections.enter_context(_subscriber(stream, receives=4096))
                peer.sendall(_subscription(b"v_chain/raw"))
                peer.setblocking(False)
                peers.append(peer)
                time.sleep(0.7)
                most = max(most, stream.footprint()[1] - stream.before[1])
            check(stand.sanitized or 4 << 20 < most < budget + stands.KEPT_BY_ALLOCATOR, f"{most >> 20} MiB for queues")
        finally:
            over.set()
            reader.join()


def clients_beyond_the_limit(stand):
    """All clients subscribe. A further one receives a message with the limit, and is admitted when another leaves."""
    most = 64
    with stand.stream() as stream, contextlib.ExitStack() as leaving:
        context = leaving.enter_context(zmq.Context())
        clients = []
        for _ in range(most - 1):  # beside the listener
            client = context.socket(zmq.SUB)
            client.linger, client.rcvhwm = 0, 10
            client.connect(stream.endpoint)
            client.subscribe("meters")
            clients.append(client)
        leaving.callback(lambda: [client.close() for client in clients])
        wait_until(lambda: all(client.poll(1) for client in clients), "served all that it may")
        file = stand.folder / "newcomer.csv"
        newcomer = stream._start([stand.program, "listen", "--connect", stream.endpoint, "-o", file, "--json",
                                  "--duration", "0.001"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        time.sleep(2)
        check(newcomer.poll() is None, "it gave up")
        check(not list(stand.folder.glob("newcomer*")), "it was served although there were enough")
        for client in clients:
            while client.poll(0):
                client.recv_multipart()
        wait_until(lambda: all(client.poll(1) for client in clients), "went on serving the others")
        clients.pop().close()
        out, messages = newcomer.communicate(timeout=stands.LONG_ENOUGH_S)
        check(newcomer.returncode == 0 and json.loads(out)["samples"] == 1000, f"{newcomer.returncode}: {out} {messages}")
        check("as many clients as it serves (--max-clients)" in messages, f"it printed: {messages}")
    check(stream.messages.read_text().count("(--max-clients)") == 1, f"{stream.messages.read_text()}")


def port_scan(stand):
    at_once = struct.pack("ii", 1, 0)
    with stand.stream() as stream:
        for i in range(1500):
            with _connected(stream) as peer:
                if i % 2:
                    peer.sendall(b"\r\n")
                if i % 3 == 0:
                    peer.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, at_once)  # closes with a reset


def _flood(stream, subscriptions):
    """Sends them while the stream reads, for at most five seconds. Returns the stream's growth of memory [bytes]."""
    with _subscriber(stream) as peer, contextlib.suppress(ConnectionError):
        end = time.monotonic() + 5
        for subscription in subscriptions:
            peer.sendall(subscription)
            if time.monotonic() > end:
                break
        time.sleep(0.5)
        return stream.footprint()[1] - stream.before[1]
    return stream.footprint()[1] - stream.before[1]


def very_many_subscriptions(stand):
    # Each has the largest allowed length and differs from the first byte on: the worst case for a table of prefixes.
    different = (_subscription(struct.pack("<Q", i * 0x9E3779B97F4A7C15 % 2**64) * 31) for i in range(200_000))
    with stand.stream(scene=stands.LARGE_FRAMES, recorded=False) as stream:
        memory = _flood(stream, different)
        check(stand.sanitized or memory < 16 << 20, f"{memory >> 20} MiB for one peer's subscriptions")


def one_subscription_very_often(stand):
    with stand.stream(scene=stands.LARGE_FRAMES, recorded=False) as stream:
        memory = _flood(stream, itertools.repeat(_subscription(b"meta"), 200_000))
        check(stand.sanitized or memory < 16 << 20, f"{memory >> 20} MiB for one peer's subscriptions")


def subscription_longer_than_allowed(stand):
    with stand.stream() as stream:
        for length in (300, 100_000):
            with _subscriber(stream) as peer:
                with contextlib.suppress(ConnectionError):
                    peer.sendall(_subscription(b"v" * length))
                check(_is_closed_by_the_stream(peer), "")


def two_publishers_on_one_port(stand):
    with stand.stream() as stream:
        second = stand.run("stream", "paper-stream", "--bind", stream.endpoint)
        check(second.returncode == 1 and "in use" in second.stderr, f"the second: {second}")


def two_publishers_on_one_path(stand):
    with _on_a_unix_socket(stand) as stream:
        second = stand.run("stream", "paper-stream", "--bind", stream.endpoint)
        check(second.returncode == 1 and "in use" in second.stderr, f"the second: {second}")


def _hearing_peer(stream, *words):
    peer = stream.peer(*words)
    check(peer.stdout.readline() == "hears\n", "a peer receives nothing")
    return peer


def _account(peer):
    return json.loads(peer.communicate(timeout=stands.LONG_ENOUGH_S)[0])


# Over a Unix socket, which has a small buffer: unread messages wait in the stream's own queue for the peer, 3.6 MB a second for a
# subscriber of all streams.
def _on_a_unix_socket(stand, *words, **how):
    return stand.stream(*words, endpoint=f"ipc://{stand.folder}/socket", **how)


def subscriber_stopped_for_a_while(stand):
    with _on_a_unix_socket(stand) as stream:
        peer = _hearing_peer(stream, "--everything")
        peer.send_signal(signal.SIGSTOP)
        if not stand.sanitized:
            wait_until(lambda: stream.footprint()[1] - stream.before[1] > 2 << 20, "had a queue")
        peer.send_signal(signal.SIGCONT)
        stream.interrupt()
        # a sender that is late on a busy machine may drop frames; none is lost on the way
        check(_account(peer)["frames_lost_on_the_way"] == 0, "the queue has room for more than that")


def subscriber_stopped_for_good(stand):
    with _on_a_unix_socket(stand) as stream:
        _hearing_peer(stream, "--everything").send_signal(signal.SIGSTOP)
        time.sleep(1)
        stream.interrupt()  # a subscriber that will never read its messages is still connected


def subscriber_killed(stand):
    with _on_a_unix_socket(stand, scene=stands.BUSY) as stream:
        peer = _hearing_peer(stream, "--everything")
        peer.send_signal(signal.SIGSTOP)
        queued = lambda: stream.footprint()[1] - stream.before[1]
        wait_until(lambda: queued() > 4 * stands.KEPT_BY_ALLOCATOR, "had a queue", 4 * stands.LONG_ENOUGH_S)
        peer.kill()


def slow_subscriber(stand):
    # A thousand spheres. Half of the memory for queues holds few of their frames, too few for a listener to v_out alone, which loses
    # some.
    with _on_a_unix_socket(stand, scene=stands.LONG_CHAIN, listener="pyzmq") as stream:
        peer = _hearing_peer(stream, "--slow", 2.5, "--queue", 1)
        time.sleep(3)
        stream.interrupt()
        account = _account(peer)
        check(stand.sanitized or account["missing_samples"] > 0, "the slow one lost nothing: this tests nothing")


if __name__ == "__main__":
    stands.main(sys.modules[__name__])
