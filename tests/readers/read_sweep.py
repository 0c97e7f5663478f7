#!/usr/bin/python3
"""Reads a sweep with h5py and as CSV, and compares each number, and the waveforms with those of a run: read_sweep.py PROGRAM"""
import csv
import json
import pathlib
import subprocess
import sys
import tempfile

import h5py
import numpy as np

program = sys.argv[1]
SCENE = ["paper-vitreous-carbon", "--set", "drive.cycles=3"]
VARY = ["--vary", "chain.preload_n=0.05..0.5:log:3", "--vary", "output.duration_s=5e-5,1e-4"]
MATERIALS = ["--vary", "end.material=pyrex,vitreous_carbon"]


def hertzline(*words):
    subprocess.run([program, *words], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def check_table(table, units, names, rows, metadata):
    """Checks that both files have the same."""
    assert list(table.dtype.names) == names
    described = metadata["tableSchema"]["columns"]
    assert [c["name"] for c in described] == names
    assert [c["schema:unitText"] for c in described] == list(units)
    by_name = dict(zip(names, units))
    assert by_name["chain.preload_n"] == "N" and by_name["harmonics_db_3"] == "dB"
    assert by_name["peak_v_out_m_per_s"] == "m/s" and by_name["thd_r"] == "" and by_name["step_s"] == "s"
    for name, column in zip(names, zip(*rows)):
        if table.dtype[name].kind == "S":
            assert [text.decode() for text in table[name]] == list(column), name
        else:
            assert np.array_equal(table[name].astype(float), np.array(column, float), equal_nan=True), name


def check_waveforms(folder, table, waveforms):
    """Those of a run, and nothing behind the end of a short one."""
    assert waveforms.shape == (12, 1001) and waveforms.dtype == np.float32 and waveforms.attrs["units"] == "m/s"
    assert waveforms.compression == "gzip" and waveforms.chunks is not None
    for point in (0, 11):
        row = table[point]
        keys = [["--set", f"{key}={value}"] for key, value in
                [("chain.preload_n", repr(float(row["chain.preload_n"]))),
                 ("output.duration_s", repr(float(row["output.duration_s"]))),
                 ("numerics.step_s", repr(float(row["step_s"]))),
                 ("end.material", row["end.material"].decode())]]
        hertzline("run", *SCENE, *sum(keys, []), "-o", folder / "run.npy")
        run = np.load(folder / "run.npy")["v_out_m_per_s"].astype(np.float32)
        assert np.array_equal(waveforms[point][: len(run)], run)
        assert np.isnan(waveforms[point][len(run):]).all()
        assert len(run) == row["rows"] == (501 if point == 0 else 1001)


with tempfile.TemporaryDirectory() as name:
    folder = pathlib.Path(name)
    hertzline("sweep", *SCENE, *VARY[:2], *MATERIALS, *VARY[2:], "-o", folder / "s.csv")
    hertzline("sweep", *SCENE, *VARY[:2], *MATERIALS, *VARY[2:], "-o", folder / "s.h5", "--waveforms", "v_out")
    with open(folder / "s.csv", newline="", encoding="utf-8") as file:
        names, *rows = csv.reader(file)
    metadata = json.loads((folder / "s.csv-metadata.json").read_text())
    with h5py.File(folder / "s.h5") as file:
        dataset = file["points"]
        assert dataset.compression == "gzip" and dataset.chunks is not None
        table = dataset[:]
        texts = [name for name in table.dtype.names if table.dtype[name].kind == "S"]
        assert texts and all(h5py.check_string_dtype(dataset.dtype[name]).encoding == "utf-8" for name in texts)
        provenance = json.loads(file.attrs["provenance"])
        check_table(table, dataset.attrs["units"], names, rows, metadata)
        check_waveforms(folder, table, file["v_out"])
    assert provenance == metadata["urn:hertzline:provenance"] | {"waveform": "v_out"}
    assert provenance["scene"]["drive"]["cycles"] == 3 and len(provenance["plan"]["vary"]) == 3
    assert set(table["status"]) == {b"ok"} and table["point"].tolist() == list(range(12))
    assert table["chain.preload_n"][0] == 0.05 and table["chain.preload_n"][-1] == 0.5
    print(f"{table.size} points, each number the same")
