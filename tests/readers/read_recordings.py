"""Reads recordings with Python's usual libraries and compares each number.

read_recordings.py FOLDER [--schema FILE]: validates SigMF metadata against that JSON schema (default: sigmf.schema.json beside
this file; SigMF's own sigmf-schema.json works, too), and collections against sigmf-collection.schema.json
"""

import argparse
import hashlib
import json
import pathlib
import struct

import h5py
import jsonschema
import numpy as np

arguments = argparse.ArgumentParser()
arguments.add_argument("folder", type=pathlib.Path)
arguments.add_argument("--schema", type=pathlib.Path, default=pathlib.Path(__file__).parent / "sigmf.schema.json")
arguments = arguments.parse_args()
folder = arguments.folder
rate = 10e6


def same(a, b):
    return a.dtype == b.dtype and a.shape == b.shape and a.tobytes() == b.tobytes()


def columns_of(spheres):
    names = ["v_last_m_per_s", "v_out_m_per_s"]
    for i in range(1, spheres + 1):
        names += [f"x{i}_m", f"v{i}_m_per_s"]
    return names


def check_npy(name, number, columns, values, samples):
    with open(folder / f"{name}.npy", "rb") as f:
        a = np.load(f, max_header_size=10**7)
        about = json.loads(np.load(f).item())
        assert f.read() == b""
    assert a.dtype.names == ("t_s", *columns)
    assert same(a["t_s"], samples / rate)
    for k, column in enumerate(columns):
        assert same(a[column], values[:, k].astype(number)), column
    assert about["sample_rate_hz"] == rate
    assert [c[0] for c in about["columns"]] == columns
    assert about["columns"][0] == ["v_last_m_per_s", "v_last", "m/s"]
    assert about["provenance"]["version"] == "1.2.3"


def check_hdf5(name, number, columns, values, samples):
    with h5py.File(folder / f"{name}.h5") as f:
        assert f.attrs["sample_rate_hz"] == rate
        assert json.loads(f.attrs["provenance"])["version"] == "1.2.3"
        assert [c[0] for c in json.loads(f.attrs["columns"])] == columns
        assert sorted(f) == ["captures", "v_chain", "v_last", "v_out", "x_chain"]
        assert same(f["v_last"][:], values[:, 0].astype(number))
        assert same(f["v_out"][:], values[:, 1].astype(number))
        assert same(f["x_chain"][:], values[:, 2::2].astype(number))
        assert same(f["v_chain"][:], values[:, 3::2].astype(number))
        assert f["x_chain"].attrs["units"] == "m" and f["v_out"].attrs["units"] == "m/s"
        assert f["captures"][:].tolist() == [[0, 3], [1000, 5000]]
        for dataset in f.values():
            assert dataset.compression is None and dataset.chunks is not None
            assert np.prod(dataset.chunks) * dataset.dtype.itemsize <= 256 * 1024


def chunks_of(data):
    at = 12
    while at < len(data):
        kind, size = struct.unpack_from("<4sI", data, at)
        yield kind, data[at + 8 : at + 8 + size]
        at += 8 + size + size % 2


def check_wav(name, columns, values):
    data = (folder / f"{name}.wav").read_bytes()
    assert data[:4] == b"RIFF" and data[8:12] == b"WAVE"
    assert struct.unpack_from("<I", data, 4)[0] == len(data) - 8
    chunks = list(chunks_of(data))
    channels, fs = struct.unpack_from("<2xHI", dict(chunks)[b"fmt "])
    assert (channels, fs) == (len(columns), rate)
    assert dict(chunks)[b"data"] == values.astype("<f4").tobytes()
    about = json.loads(dict(chunks)[b"hzln"])
    assert [c[0] for c in about["columns"]] == columns
    assert about["provenance"]["version"] == "1.2.3"
    info = b"".join(body for kind, body in chunks if kind == b"LIST")
    assert b'{"rows":3000,"captures":[[0,3],[1000,5000]]}' in info


def check_csv(name, datatype, columns, values, samples):
    a = np.genfromtxt(folder / f"{name}.csv", delimiter=",", names=True, deletechars="")
    assert a.dtype.names == ("t_s", *columns)
    assert same(a["t_s"], samples / rate)
    for k, column in enumerate(columns):
        assert same(a[column], values[:, k]), column
    metadata = json.loads((folder / f"{name}.csv-metadata.json").read_text())
    assert metadata["@context"] == "http://www.w3.org/ns/csvw" and metadata["url"] == f"{name}.csv"
    described = metadata["tableSchema"]["columns"]
    assert [c["name"] for c in described] == ["t_s", *columns]
    assert all(c["datatype"] == datatype for c in described[1:])
    assert [c["schema:unitText"] for c in described[:2]] == ["s", "m/s"]
    assert metadata["urn:hertzline:provenance"]["version"] == "1.2.3"


def check_schema(schema_file, document):
    schema = json.loads(schema_file.read_text())
    jsonschema.Draft202012Validator.check_schema(schema)
    jsonschema.Draft202012Validator(schema).validate(document)


def check_sigmf(name, columns, values, samples):
    meta = json.loads((folder / f"{name}.sigmf-meta").read_text())
    check_schema(arguments.schema, meta)
    shared = meta["global"]
    assert shared["core:sample_rate"] == rate and shared["core:datatype"] == "rf32_le"
    data = np.fromfile(folder / f"{name}.sigmf-data", "<f4").reshape(-1, shared["core:num_channels"])
    assert same(data, values.astype("<f4"))
    numbers = np.arange(len(data))
    for capture in meta["captures"]:
        start = capture["core:sample_start"]
        numbers[start:] = capture["core:global_index"] + np.arange(len(data) - start)
    assert same(numbers, samples)
    assert [c["name"] for c in shared["hertzline:columns"]] == columns
    if columns[0] == "v_last_m_per_s":
        assert shared["hertzline:columns"][0] == {"name": "v_last_m_per_s", "quantity": "v_last", "unit": "m/s"}
    assert shared["hertzline:version"] == "1.2.3"
    return meta


def check_collection(name, columns, values, samples):
    document = json.loads((folder / f"{name}.sigmf-collection").read_text())
    check_schema(pathlib.Path(__file__).parent / "sigmf-collection.schema.json", document)
    streams = document["collection"]["core:streams"]
    assert [s["name"] for s in streams] == [f"{name}-{column}" for column in columns]
    for k, (stream, column) in enumerate(zip(streams, columns)):
        assert stream["hash"] == hashlib.sha512((folder / f"{stream['name']}.sigmf-meta").read_bytes()).hexdigest()
        meta = check_sigmf(stream["name"], [column], values[:, k : k + 1], samples)
        assert meta["global"]["core:collection"] == name


def check_tables():
    i = np.arange(300_000)
    columns = {"frequency_hz": i / 3.0, "f_last_n": 1.0 / (1 + i)}
    about = [["frequency_hz", "frequency", "Hz"], ["f_last_n", "f_last", "N"]]
    with open(folder / "spectrum.npy", "rb") as f:
        npy, description = np.load(f), json.loads(np.load(f).item())
    assert description == {"columns": about, "provenance": {"version": "1.2.3"}}
    csv = np.genfromtxt(folder / "spectrum.csv", delimiter=",", names=True, deletechars="")
    metadata = json.loads((folder / "spectrum.csv-metadata.json").read_text())
    assert [c["schema:unitText"] for c in metadata["tableSchema"]["columns"]] == ["Hz", "N"]
    assert metadata["url"] == "spectrum.csv" and metadata["urn:hertzline:provenance"] == {"version": "1.2.3"}
    with h5py.File(folder / "spectrum.h5") as h5:
        assert json.loads(h5.attrs["columns"]) == about and sorted(h5) == ["f_last", "frequency"]
        for name, quantity, unit in about:
            assert same(npy[name], columns[name]) and same(csv[name], columns[name])
            assert same(h5[quantity][:], columns[name]) and h5[quantity].attrs["units"] == unit
    print("spectrum: in each format the same")


check_tables()
for name, number, spheres in [("narrow", "<f4", 3), ("exact", "<f8", 3), ("wide", "<f8", 2000)]:
    columns = columns_of(spheres)
    samples = np.fromfile(folder / f"{name}.samples", "<i8")
    values = np.fromfile(folder / f"{name}.values", "<f8").reshape(len(samples), len(columns))
    check_npy(name, number, columns, values, samples)
    check_hdf5(name, number, columns, values, samples)
    if spheres < 1000:  # numpy is slow with text
        check_csv(name, "float" if number == "<f4" else "double", columns, values, samples)
    if number == "<f4":
        check_sigmf(name, columns, values, samples)
        check_collection(name, columns, values, samples)
        check_wav(name, columns, values)
    print(f"{name}: {values.size} numbers, each the same")
