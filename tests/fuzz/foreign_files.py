"""Damages recordings that other programs have written, and has the readers read them: foreign_files.py BUILD [COUNT] [SEED].

Each of COUNT files (default 20000) is read by the fuzz function of its format, with its claims (recording_claims.hpp): no crash, no
hang, a message or numbers that are finite and in order. A file that breaks one stays in BUILD/foreign_findings. Exit status 1 then.
"""

import collections
import pathlib
import random
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).parent.parent / "readers"))
import foreign

TARGETS = {
    ".csv": "recording_csv",
    ".npy": "recording_npy",
    ".wav": "recording_wav",
    ".h5": "recording_hdf5",
    ".sigmf-meta": "recording_sigmf",
    ".sigmf": "recording_sigmf_archive",
}
AT_ONCE = 500  # files that a process reads
PATIENCE_S = 300  # for these, on a busy machine
EXTREMES = [b"\0", b"\xff", b"\xff\xff\xff\xff", b"\0\0\0\0", b"\x7f", b"\x80", b"nan", b"1e308", b"-1", b"999999999999999999999"]


def damaged(bytes_, others, draw):
    """Returns a copy with one to four faults, many of them near the beginning, where formats have their heads."""
    data = bytearray(bytes_)
    for _ in range(draw.randint(1, 4)):
        most = len(data) if draw.random() < 0.5 else min(len(data), 600)
        at = draw.randrange(most + 1)
        length = min(len(data) - at, draw.choice([1, 1, 2, 4, 8, 100, 1000]))
        kind = draw.randrange(8)
        if kind == 0 and length:
            data[at] = draw.randrange(256)
        elif kind == 1 and length:
            data[at] ^= 1 << draw.randrange(8)
        elif kind == 2:
            extreme = draw.choice(EXTREMES)
            data[at : at + len(extreme)] = extreme
        elif kind == 3:
            del data[at:]
        elif kind == 4:
            del data[at : at + length]
        elif kind == 5:
            data[at:at] = data[at : at + length]
        elif kind == 6:
            other = draw.choice(others)
            begin = draw.randrange(len(other) + 1)
            data[at : at + length] = other[begin : begin + length]
        else:
            digits = [i for i, c in enumerate(data[:2000]) if chr(c).isdigit()]
            if digits:
                data[draw.choice(digits)] = ord(draw.choice("0123456789.,-+e"))
    return bytes(data)


def failure_of(program, folder):
    """Returns what a fuzz function says of the files in a folder, None when all claims hold."""
    try:
        done = subprocess.run([program, folder], capture_output=True, text=True, errors="replace", timeout=PATIENCE_S, check=False)
    except subprocess.TimeoutExpired:
        return "does not return"
    return None if done.returncode == 0 else f"exit status {done.returncode}: {done.stderr.strip()[-500:]}"


def read(program, files, findings):
    """Reads the files; returns how many break a claim, and keeps these."""
    with tempfile.TemporaryDirectory() as folder:
        for i, data in enumerate(files):
            (pathlib.Path(folder) / f"{i:05}").write_bytes(data)
        if failure_of(program, folder) is None:
            return 0
    if len(files) > 1:
        half = len(files) // 2
        return read(program, files[:half], findings) + read(program, files[half:], findings)
    with tempfile.TemporaryDirectory() as folder:
        (pathlib.Path(folder) / "0").write_bytes(files[0])
        print(f"{program.name}: {failure_of(program, folder)}")
    findings.mkdir(exist_ok=True)
    (findings / f"{program.name}-{len(list(findings.iterdir()))}").write_bytes(files[0])
    return 1


def main():
    build = pathlib.Path(sys.argv[1])
    count = int(sys.argv[2]) if len(sys.argv) > 2 else 20_000
    draw = random.Random(int(sys.argv[3]) if len(sys.argv) > 3 else 1)
    whole = collections.defaultdict(list)
    with tempfile.TemporaryDirectory() as folder:
        for case in foreign.write_all(folder):
            whole[TARGETS[case.file.suffix]].append(case.file.read_bytes())
    broken = 0
    for place, (target, files) in enumerate(sorted(whole.items())):
        share = count // len(whole) + (place < count % len(whole))
        batch = list(files)  # the undamaged ones first
        for i in range(share):
            batch.append(damaged(draw.choice(files), files, draw))
            if len(batch) >= AT_ONCE or i + 1 == share:
                broken += read(build / f"fuzz_{target}", batch, build / "foreign_findings")
                batch.clear()
        print(f"{target}: {len(files)} files of others, {share} damaged ones", flush=True)
    for name, package in foreign.missing.items():
        print(f"left out: {name} is not there (Debian: {package})")
    print(f"{broken} break a claim")
    return 1 if broken else 0


sys.exit(main())
