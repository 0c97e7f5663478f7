#!/usr/bin/python3
"""Checks meta, meters, end and headers of frames of real streams against their schema: messages_keep_their_schema.py HERTZLINE SCHEMA"""
import json, subprocess, sys, tempfile
import jsonschema, zmq
from streaming import LONG_ENOUGH_S, Stream

program, schema_file = sys.argv[1:]
with open(schema_file) as text:
    schema = json.load(text)
schema["$defs"]["scene"] = json.loads(subprocess.run([program, "scenes", "--keys", "--json"], check=True, stdout=subprocess.PIPE).stdout)
jsonschema.Draft202012Validator.check_schema(schema)
jsonschema.Draft202012Validator.check_schema(schema["$defs"]["scene"])
topics = {name: jsonschema.Draft202012Validator({"$ref": f"#/$defs/{name}", "$defs": schema["$defs"]})
          for name in ("meta", "meters", "end")}
header = jsonschema.Draft202012Validator({"$ref": "#/$defs/header", "$defs": schema["$defs"]})


def messages_of(scene, duration_s, *words, command="stream"):
    """Returns all JSON messages of a stream, as [(topic, object)]."""
    with Stream(program, scene, "--pace", "flat-out", "--duration", str(duration_s), "--wait-for-subscriber",
                *words, command=command) as stream, zmq.Context() as context, context.socket(zmq.SUB) as socket:
        socket.rcvtimeo = LONG_ENOUGH_S * 1000
        socket.connect(stream.endpoint)
        for topic in (*topics, "v_last/raw", "v_last/np"):
            socket.subscribe(topic)
        said = []
        while not said or said[-1][0] != "end":
            topic, *parts = socket.recv_multipart()
            if topic.decode() in topics:
                assert len(parts) == 1, f"{topic}: {len(parts)} parts after the topic"
                said.append((topic.decode(), json.loads(parts[0])))
            elif topic == b"v_last/np":
                header.validate(json.loads(parts[0]))
        assert said[-1][1] == json.loads(stream.summary()), "end differs from the output of --json"
        return said


def require_closed(topic, message):
    """Checks that the schema refuses an unknown key, a missing one, and a value of the wrong type."""
    for change in ({"not_documented": 1}, {"v_out_sent": 1}, {"run": 7}, {"run": None}):
        assert not topics[topic].is_valid(message | change), f"{topic} may have {change}"
    for key in message:
        without = {name: value for name, value in message.items() if name != key}
        assert key.endswith(("_sent", "_dropped")) or not topics[topic].is_valid(without), f"{topic} may lack {key}"


def replayed(folder):
    """Returns the messages of a replay of a short recording."""
    file = folder + "/recording.sigmf-meta"
    with Stream(program, "paper-wall", "--pace", "flat-out", "--duration", "2e-4", "--record", file) as stream:
        stream.summary()
    return messages_of(file, 2e-4, command="replay")


def replayed_with_changes(folder):
    """Returns the messages of a replay of a recording whose scene changes."""
    changes, file = folder + "/changes.json", folder + "/changed.sigmf-meta"
    with open(changes, "w") as text:
        json.dump([{"sample": 10000, "set": {"drive.cycles": 5}}, {"sample": 15000, "set": {"chain.preload_n": 0.2}}], text)
    subprocess.run([program, "run", "paper-stream", "--set", "output.duration_s=2e-3", "--changes", changes, "-o", file],
                   check=True, stdout=subprocess.DEVNULL)
    said = messages_of(file, 2e-3, command="replay")
    metas = [message for topic, message in said if topic == "meta"]
    assert len(metas[-1]["changes"]) == 2 and metas[-1]["epoch"] == 2 and metas[-1]["epoch_sample"] == 15000
    return said


with tempfile.NamedTemporaryFile("w", suffix=".toml") as own_material:
    own_material.write('[end]\nmaterial = "tin"\n[materials.tin]\n'
                       "youngs_modulus_pa = 50e9\npoissons_ratio = 0.36\ndensity_kg_per_m3 = 7265.0\n")
    own_material.flush()
    plate = messages_of("paper-stream", 2e-3)
    others = [messages_of("paper-wall", 2e-4), messages_of(own_material.name, 2e-4),
              messages_of("long-chain", 1e-4, "--set", "chain.spheres=1000", "--set", "numerics.step_s=20e-9")]
with tempfile.TemporaryDirectory() as folder:
    others.append(replayed(folder))
    others.append(replayed_with_changes(folder))
for said in (plate, *others):
    assert {topic for topic, _ in said} == set(topics), "a topic has no message"
    assert said[0][0] == "meta"
    for topic, message in said:
        topics[topic].validate(message)
        if topic == "meters":  # live plotters look no deeper, and draw numbers
            assert all(isinstance(value, (int, float)) for key, value in message.items() if key != "run")
    for stream in said[0][1]["streams"]:
        for counted in (f"{topic.replace('/', '_')}_{what}" for topic in stream["topics"] for what in ("sent", "dropped")):
            assert counted in said[-1][1], f"end lacks {counted}"
for topic, message in plate:
    require_closed(topic, message)
