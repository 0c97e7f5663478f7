#!/usr/bin/python3
"""A subscriber that comes late, leaves and returns receives meta first and then whole frames: meta_comes_first.py HERTZLINE"""
import json, sys
import zmq
from streaming import LONG_ENOUGH_S, Stream

JOINS = 100
# Of a hundred joins. A machine loaded eightfold had four.
MOST_EARLY = 20


class Listener:
    """A subscriber that checks every received frame."""

    def __init__(self, context, endpoint, *prefixes):
        self.socket = context.socket(zmq.SUB)
        self.socket.setsockopt(zmq.LINGER, 0)
        self.socket.rcvtimeo = LONG_ENOUGH_S * 1000
        self.subscribe(*prefixes)
        self.socket.connect(endpoint)
        self.next = {}  # of each topic: sample and count of dropped frames

    def subscribe(self, *prefixes):
        for prefix in prefixes:
            self.socket.subscribe(prefix)

    def unsubscribe(self, *prefixes):
        for prefix in prefixes:
            self.socket.unsubscribe(prefix)

    def hear(self):
        """Returns the next message's topic and, of a frame with a header, the first sample."""
        topic, *parts = self.socket.recv_multipart()
        topic = topic.decode()
        if topic.endswith("/raw"):
            assert len(parts) == 1 and len(parts[0]) % 4 == 0 and parts[0], topic
        if not topic.endswith("/np"):
            return topic, None
        header = json.loads(parts[0])
        samples, channels = header["shape"]
        assert len(parts) == 2 and len(parts[1]) == 4 * samples * channels, topic
        lost = header["sample"] - self.next.get(topic, (header["sample"], 0))[0]
        dropped = header["dropped"] - self.next.get(topic, (0, header["dropped"]))[1]
        assert lost == samples * dropped, f"{topic}: {lost} samples lost on the way"
        self.next[topic] = header["sample"] + samples, header["dropped"]
        return topic, header["sample"]

    def hear_frames(self, *topics):
        heard = dict.fromkeys(topics, 0)
        while min(heard.values()) < 3:
            topic, _ = self.hear()
            if topic in heard:
                heard[topic] += 1

    def early_frames(self):
        """Returns the frames before meta, which belong to one block."""
        early = []
        while (said := self.hear())[0] != "meta":
            early.append(said)
        frames = [topic for topic, _ in early if topic.startswith("v_")]
        assert len(frames) == len(set(frames)), f"more than a block before meta: {early}"
        assert len({sample for _, sample in early if sample is not None}) <= 1, early
        return len(frames)


def wait_for_meta_then_subscribe(context, endpoint):
    listener = Listener(context, endpoint)
    for stream in ("v_out", "v_last"):  # leaves the first, stays connected, returns for the second
        topics = f"{stream}/np", f"{stream}/raw"
        listener.subscribe("meta")
        assert listener.hear()[0] == "meta"
        listener.subscribe(*topics)
        listener.hear_frames(*topics)
        listener.unsubscribe(*topics, "meta")
    listener.socket.close()


def subscribe_at_once(context, endpoint, *prefixes):
    listener = Listener(context, endpoint, *prefixes)
    early = listener.early_frames()
    listener.hear_frames("v_out/np")
    listener.socket.close()
    return early > 0


with Stream(sys.argv[1], "paper-stream", "--pace", "0.05") as stream, zmq.Context() as context:
    another = Listener(context, stream.endpoint, "v_out/raw")  # so that frames are on their way when another subscriber joins
    another.hear_frames("v_out/raw")
    for _ in range(JOINS // 4):
        wait_for_meta_then_subscribe(context, stream.endpoint)
    for prefixes in (["meta", "v_out/np"], ["v_out/np", "meta"], [""]):
        early = sum(subscribe_at_once(context, stream.endpoint, *prefixes) for _ in range(JOINS))
        print(f"{prefixes}: {early} of {JOINS} heard frames before meta")
        assert early <= MOST_EARLY, "meta is not sent right before the frames"
    another.socket.close()
