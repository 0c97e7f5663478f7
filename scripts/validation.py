#!/usr/bin/python3
"""Recomputes published numbers of chains of spheres: docs/validation.md and its pictures.

    scripts/validation.py --program build/release/hertzline --out docs/validation.md     writes the page and the pictures
    scripts/validation.py --program build/release/hertzline --check docs/validation.md

Fails where a number of ours is not within the tolerance of the published one. --check also fails where the page has other numbers.
Takes half a minute on two cores.
"""
import argparse
import concurrent.futures
import json
import math
import pathlib
import re
import subprocess
import sys
import tempfile

import numpy as np

RADIUS_M = 5e-3
STEEL = {"youngs_modulus_pa": 201e9, "poissons_ratio": 0.30, "density_kg_per_m3": 7833.0}
MODULUS_PA = STEEL["youngs_modulus_pa"] / (1 - STEEL["poissons_ratio"] ** 2)
MASS_KG = STEEL["density_kg_per_m3"] * 4 / 3 * math.pi * RADIUS_M**3
STIFFNESS = math.sqrt(2 * RADIUS_M) / 3 * MODULUS_PA
STRUCK = {"drive": {"kind": "none"},
          "chain": {"material": "steel", "diameter_m": 2 * RADIUS_M, "preload_n": 0.0, "damping_kg_per_s": 0.0,
                    "impact_velocity_m_per_s": 0.01},
          "end": {"kind": "wall", "material": "steel"},
          "numerics": {"accuracy": 1e-7},
          "output": {"sample_rate_hz": 5e6}}


def toml_of(scene):
    return "\n".join(f"[{section}]\n" + "\n".join(f"{key} = {json.dumps(value)}" for key, value in keys.items())
                     for section, keys in scene.items())


def merged(base, **sections):
    """Returns the scene with other values in sections; a section "materials.NAME" is written materials__NAME."""
    scene = {section: dict(keys) for section, keys in base.items()}
    for section, keys in sections.items():
        scene.setdefault(section.replace("__", "."), {}).update(keys)
    return scene


def with_densities(base, *densities):
    """Returns the scene with spheres of steel that have these densities in turn."""
    names = [f"steel_{i}" for i in range(len(densities))]
    materials = {f"materials__{name}": {**STEEL, "density_kg_per_m3": density}
                 for name, density in zip(names, densities)}
    return merged(base, chain={"materials": names}, **materials)


class Program:
    def __init__(self, path):
        self.path = path

    def run(self, scene, *taps):
        """Returns the samples of each tap, [sample, channel], and their interval."""
        with tempfile.TemporaryDirectory() as folder:
            file, out = pathlib.Path(folder, "scene.toml"), pathlib.Path(folder, "out.npy")
            file.write_text(toml_of(scene))
            done = subprocess.run([self.path, "run", file, "--columns", ",".join(taps), "-o", out], capture_output=True, text=True)
            if done.returncode:
                raise RuntimeError(done.stderr + file.read_text())
            samples = np.load(out, max_header_size=10**7)
        def channels(tap):
            """v1_m_per_s, v2_m_per_s, ... of v_chain; v_last_m_per_s of v_last."""
            prefix = re.compile(tap[0] + r"\d" if tap.endswith("_chain") else tap)
            return np.column_stack([samples[name] for name in samples.dtype.names if prefix.match(name)])
        return *map(channels, taps), 1 / scene["output"]["sample_rate_hz"]

    def summary(self, scene):
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder, "scene.toml")
            file.write_text(toml_of(scene))
            return json.loads(subprocess.run([self.path, "run", file, "--json"], capture_output=True, text=True).stdout)

    def check(self, scene):
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder, "scene.toml")
            file.write_text(toml_of(scene))
            return json.loads(subprocess.run([self.path, "check", file, "--json"], capture_output=True, text=True).stdout)


def crest(values):
    """Returns height and place, in samples, of the largest value, by the parabola through its neighbours."""
    i = int(np.argmax(values))
    if not 0 < i < len(values) - 1:
        return values[i], float(i)
    a, b, c = values[i - 1:i + 2]
    shift = (a - c) / (2 * (a - 2 * b + c))
    return b - (a - c) * shift / 4, i + shift


def time_above(values, level):
    """Returns the time from where the values pass the level upward to where they pass it downward, in samples."""
    above = np.flatnonzero(values > level)
    first, last = above[0], above[-1]
    return (last - first + (values[first] - level) / (values[first] - values[first - 1]) +
            (values[last] - level) / (values[last] - values[last + 1]))


def struck(spheres, seconds, **sections):
    return merged(STRUCK, **{**sections, "chain": {"spheres": spheres, **sections.get("chain", {})},
                             "output": {"duration_s": seconds, **sections.get("output", {})}})


def row(name, source, published, ours, tolerance, digits=5):
    """A line of the table; the tolerance is absolute, None where only a trend is published."""
    return {"name": name, "source": source, "published": published, "ours": ours, "tolerance": tolerance, "digits": digits}


def solitary_wave(program):
    """V. F. Nesterenko's wave far from both ends."""
    v, f, step = program.run(struck(80, 2.7e-3), "v_chain", "f_chain")
    heights, places = zip(*(crest(v[:, i]) for i in (40, 60)))
    v_m, speed = heights[0], 20 * 2 * RADIUS_M / ((places[1] - places[0]) * step)
    force = crest(f[:, 45])[0]
    theta = 3 / (4 * MODULUS_PA)
    long_wave = (6 / (5 * math.pi * STEEL["density_kg_per_m3"] * theta)) ** 0.4 * v_m**0.2
    diameters = speed * step / (2 * RADIUS_M)
    half = time_above(v[:, 50], v_m / 2) * diameters
    cosine = 10 * math.acos(0.5**0.25) / math.sqrt(10)   # of cos^4, in radii, both sides: half of that in diameters
    coste = "C. Coste, E. Falcon, S. Fauve, PRE 56 (1997) 6104"
    moose = "documentation of MOOSE's DEM"
    return [row("solitary wave: velocity over the striker's", coste, 0.681632, v_m / 0.01, 2e-6, 6),
            row("speed over D (k/m)^(2/5) v_m^(1/5)", coste, 0.907470,
                speed / (2 * RADIUS_M * (STIFFNESS / MASS_KG) ** 0.4 * v_m**0.2), 2e-6, 6),
            row("force over k^(2/5) (m v_m²)^(3/5)", coste, 1.013019, force / (STIFFNESS**0.4 * (MASS_KG * v_m**2) ** 0.6), 3e-6, 6),
            row("speed over that of the long-wave formula", moose, 0.992, speed / long_wave, 5e-4, 4),
            row("width at 1 % of the velocity, in diameters", moose, 3.95, time_above(v[:, 50], v_m / 100) * diameters, 0.01, 3),
            row("half width over that of cos⁴", moose, 0.87, half / cosine, 5e-3, 3)]


def ends(program):
    """A solitary wave at a wall, and at a free end."""
    def at(**end):
        scene = struck(60, 2.6e-3, end=end, **({"materials__rigid": {**STEEL, "youngs_modulus_pa": 1e15}}))
        f, _ = program.run(scene, "f_chain")
        return crest(f[:, -1])[0] / crest(f[:8000, 30])[0]
    free, _ = program.run(struck(60, 2.6e-3, end={"kind": "free"}), "v_last")
    leaves = free[-1, 0] / 0.01
    source = "E. Falcon et al., Eur. Phys. J. B 5 (1998) 111"
    return [row("force at a wall of the same material over the wave's", source, 1.94390, at(material="steel"), 2e-5),
            row("force at a rigid wall over the wave's", source, 2.23838, at(material="rigid"), 1e-4),
            row("velocity with which the last sphere leaves a free end, over the striker's", source, 0.98568, leaves, 2e-5),
            row("its share of the energy", source, 0.9716, leaves**2, 1e-4, 4)]


def dimers(program):
    """Chains of heavy and light spheres of equal stiffness, without preload."""
    def loss(ratio):
        scene = with_densities(struck(120, 5e-3), STEEL["density_kg_per_m3"], ratio * STEEL["density_kg_per_m3"])
        v, _ = program.run(scene, "v_chain")
        return 1 - crest(v[:, 80])[0] / crest(v[:, 40])[0]
    jayaprakash = "K. R. Jayaprakash, Y. Starosvetsky, A. F. Vakakis, PRE 83 (2011) 036606"
    rows = [row(f"dimer, light over heavy = {ratio}: loss of velocity from sphere 41 to 81", jayaprakash, 0.0, loss(ratio), 1e-4, 6)
            for ratio in (0.3428, 0.1548, 0.0901)]
    rows += [row(f"the same at {ratio}, a resonance", jayaprakash, expected, loss(ratio), 0.02, 3)
             for ratio, expected in ((0.59, 0.41), (0.24, 0.05))]
    potekin = "PRE 91 (2015) 062211"
    rows += [row("dimer, 0.98: loss from sphere 41 to 81, a wave that stays", potekin, 0.0, loss(0.98), 0.02, 4),
             row("dimer, 0.55: the same, a wave that is lost", potekin, None, loss(0.55), None, 3)]
    return rows


def bands(program):
    """Small waves in a chain of steel and aluminium under 0.1 N."""
    scene = {"drive": {"frequency_hz": 128.9e3, "cycles": 400, "amplitude_m": 1e-13},
             "chain": {"materials": ["steel", "aluminium"], "spheres": 40, "damping_kg_per_s": 0.0},
             "end": {"kind": "wall", "material": "steel"}, "numerics": {"accuracy": 1e-6},
             "output": {"sample_rate_hz": 2e6, "duration_s": 3.2e-3}}
    report = program.check(scene)
    v, step = program.run(scene, "v_chain")
    middle = slice(int(1.4e-3 / step), int(1.7e-3 / step))
    per_pair = np.ptp(v[middle, 6]) / np.ptp(v[middle, 4])
    brillouin = "L. Brillouin, Wave Propagation in Periodic Structures (1946)"
    uniform = {**scene, "chain": {"spheres": 40, "damping_kg_per_s": 0.0}}
    aluminium, radius = 69e9 / (1 - 0.33**2), 0.5e-3
    k, mass = math.sqrt(2 * radius) / 3 * aluminium, 2700 * 4 / 3 * math.pi * radius**3
    cut_off = math.sqrt(1.5 * k ** (2 / 3) * 0.1 ** (1 / 3) / mass) / math.pi
    return [row("dimer of steel and aluminium, 1 mm, 0.1 N: acoustic band up to [kHz]", brillouin, 98.8, report["acoustic_band_to_hz"] / 1e3, 0.05, 1),
            row("optical band from [kHz]", brillouin, 168.3, report["optical_band_from_hz"] / 1e3, 0.05, 1),
            row("optical band to [kHz]", brillouin, 195.1, report["optical_band_to_hz"] / 1e3, 0.05, 1),
            row("decay by a pair at 128.9 kHz, between the bands", brillouin, 0.3565, per_pair, 5e-4, 4),
            row("uniform chain of aluminium: cut-off [kHz]", brillouin, cut_off / 1e3, program.check(uniform)["cutoff_hz"] / 1e3, 0.01, 2)]


def weight(program):
    """A small blow on a chain that stands under its own weight."""
    spheres = 1600
    scene = struck(spheres, 0.06, chain={"gravity_m_per_s2": 9.81, "impact_velocity_m_per_s": 1e-7},
                   output={"sample_rate_hz": 1e5}, numerics={"accuracy": 1e-4})
    v, x, step = program.run(scene, "v_chain", "x_chain")
    depths = np.unique(np.geomspace(150, 1100, 25).astype(int))
    arrivals = np.array([crest(v[:, i])[1] * step for i in depths])
    velocities = np.array([crest(v[:, i])[0] for i in depths])
    displacements = np.array([crest(x[:, i])[0] for i in depths])
    reached = arrivals < (len(v) - 2) * step
    slope = lambda y: np.polyfit(np.log(depths[reached]), np.log(y[reached]), 1)[0]
    speeds = np.gradient(depths, arrivals)
    hong = "J. Hong, J.-Y. Ji, H. Kim, PRL 82 (1999) 3058"
    return [row("chain under its weight, depth h: displacement as h to the power", hong, -1 / 12, slope(displacements), 0.02, 3),
            row("velocity as h to the power", hong, -1 / 4, slope(velocities), 0.02, 3),
            row("speed as h to the power", hong, 1 / 6, slope(speeds), 0.02, 3)]


def pulses(values, share=0.02):
    """Returns the heights of the maxima above a share of the largest, in their order."""
    inside = values[1:-1]
    peaks = np.flatnonzero((inside > values[:-2]) & (inside >= values[2:]) & (inside > share * values.max()))
    return inside[peaks]


def strikers(program):
    """Several strikers, and a heavy one."""
    job = "S. Job, F. Melo, A. Sokolow, S. Sen, Granular Matter 10 (2007) 13; PRE 67 (2003) 066607"
    rows = []
    for count in (2, 3):
        f, step = program.run(struck(260, 8e-3, chain={"impact_spheres": count}), "f_chain")
        heights = pulses(f[:, 120])
        rows.append(row(f"{count} strikers: solitary waves", job, count, len(heights), 0, 0))
        rows.append(row("... the second over the first", job, None, heights[1] / heights[0], None, 3))
    tapered = 0.05
    v, _ = program.run(struck(14, 1.2e-3, chain={"taper": tapered}), "v_chain")
    hard = 2 / (1 + (1 - tapered) ** 3)
    ours = (crest(v[:, 10])[0] / crest(v[:, 4])[0]) ** (1 / 6)
    rows.append(row("tapered by 5 %: velocity of a sphere over the one before; published: hard spheres", "binary collisions, U. Harbola et al., PRE 80 (2009) 031303",
                    hard, ours, 0.01, 4))
    return rows


def intruder(program):
    """A light sphere in a chain without preload."""
    light, small = 30, 2 * RADIUS_M * 0.4
    diameters = [2 * RADIUS_M] * 60
    diameters[light] = small
    v, step = program.run(struck(60, 1.8e-3, chain={"diameters_m": diameters}), "v_chain")
    arrives = int(crest(v[:, light - 2])[1])
    window = slice(arrives - 1500, arrives + 2500)
    own, wave = (np.abs(np.fft.rfft(v[window, i])) for i in (light, light - 8))
    centre = lambda s: float((np.arange(len(s)) * s**2).sum() / (s**2).sum())  # of the velocity's power
    return [row("light intruder, 0.4 D: centre of its spectrum over the wave's", "S. Job et al., PRE 80 (2009) 025602, a trend", None,
                centre(own) / centre(wave), None, 2)]


def short_chains(program):
    """Two to ten spheres of steel, 1 mm, on a horn of 73 kHz: which of them make impulses, and how wide their band is."""
    source = "D. A. Hutchins et al., Ultrasonics 69 (2016) 215, a trend"
    counts = range(2, 11)
    def of(spheres, preload_n):
        scene = {"drive": {"amplitude_m": 1e-6}, "chain": {"material": "steel", "spheres": spheres, "preload_n": preload_n},
                 "end": {"kind": "wall", "material": "steel"}}
        return program.summary(scene)
    shares = {spheres: of(spheres, 0.01)["thd_r"] for spheres in counts}
    if (max(shares, key=shares.get), min(shares, key=shares.get)) != (3, 10):
        raise SystemExit(f"validation.py: the largest and the smallest share are not those of 3 and 10 spheres: {shares}")
    return [row("2 to 10 spheres of 1 mm at 73 kHz, 0.01 N: share of the harmonics at the wall, most (3 spheres)", source, None, shares[3], None, 2),
            row("... least (10 spheres): impulses come with some numbers of spheres only", source, None, shares[10], None, 2),
            row("... of 3 spheres at 1 N: and with some preloads only", source, None, of(3, 1.0)["thd_r"], None, 2)]


def focusing(program):
    """Five chains in a row, 12 mm apart, whose preloads alone let their sound arrive together at a point."""
    source = "A. Spadoni, C. Daraio, PNAS 107 (2010) 7230; C. M. Donahue et al., APL 104 (2014) 014103"
    places, depth_m, sound = [-24e-3, -12e-3, 0, 12e-3, 24e-3], 40e-3, 1482
    line = [[x / 1000, 0, depth_m] for x in range(-30, 31, 3)]
    def of(preloads, points, x_m):
        scene = {"drive": {"frequency_hz": 40e3, "cycles": 1, "amplitude_m": 1e-7},
                 "chain": {"material": "steel", "spheres": 20, "diameter_m": 2e-3, "damping_kg_per_s": 0.1}, "end": {"model": "modal"},
                 "array": {"x_m": x_m, "y_m": [0] * len(x_m), "preloads_n": preloads},
                 "output": {"duration_s": 250e-6, "points_m": points}}
        return program.summary(scene)
    def way_s(preload_n):  # through the chain, with its disc
        return of([preload_n], [[0, 0, depth_m]], [0.0])["first_arrival_s"] - depth_m / sound
    ways = {preload_n: way_s(preload_n) for preload_n in (1, 4, 16)}
    def focused(x_m):
        """Preloads with which the chains make up for the ways from their discs, by the sixth root."""
        ways_in_water = [math.hypot(x - x_m, depth_m) / sound for x in places]
        return [4 * (ways[4] / (ways[4] - way + min(ways_in_water))) ** 6 for way in ways_in_water]
    alike = of([4.0], line, places)["peaks_p_points_pa"]
    left, right = (of(focused(x), line, places)["peaks_p_points_pa"] for x in (-12e-3, 12e-3))
    loudest = lambda peaks: 1000 * line[int(np.argmax(peaks))][0]
    at = line.index([12e-3, 0, depth_m])
    one = of([4.0], [[12e-3, 0, depth_m]], [0.0])["peaks_p_points_pa"][0]
    return [row("20 spheres of 2 mm on a disc in water: travel time of a weak wave, 16 N over 1 N, as F₀^(−1/6)", "Hertz's law, weak waves", 0.630,
                ways[16] / ways[1], 0.04, 3),
            row("five such chains, preloads that focus at x = 12 mm, z = 40 mm: loudest x at that depth [mm]", source, None, loudest(right), None, 0),
            row("... that focus at x = −12 mm: the focus moves with precompression [mm]", source, None, loudest(left), None, 0),
            row("... pressure at the focus over that with equal preloads", source, None, right[at] / alike[at], None, 2),
            row("... over that of one chain", source, None, right[at] / one, None, 2)]


EXPERIMENTS = [solitary_wave, ends, strikers, dimers, intruder, weight, bands, short_chains, focusing]

HEAD = """# Chains of spheres against published numbers

This page recomputes published results for chains of spheres other than the paper's device. The published numbers come from theories, experiments and other
programs. Where a source gives an effect but too few digits, the number comes from an independent solver. `scripts/validation.py --program
build/release/hertzline --out docs/validation.md` makes this page and its pictures; a test runs it again, and fails where ours is
farther from the published number than the tolerance. Spheres are of steel, 10 mm, struck with 0.01 m/s, without preload and loss,
unless stated otherwise. k and m are a contact's stiffness and a sphere's mass, D its diameter, v_m the largest velocity in the wave.

"""

TAIL = """
![A heavy striker sends a train of solitary waves through a chain: velocity of each sphere over time](validation-striker.png)

`hertzline run striker --tap v_chain -o striker.h5`, then `hertzline plot striker.h5 -o striker.png`: the velocity of each sphere over time. The striker
has eight times the mass of a sphere and gives its momentum away in several blows; the wall sends the waves back.

Hutchins and others also found wider bands in longer chains. That is not reproduced here: with the paper's damping the band is widest
for three to five spheres.

hertzline is also compared with solutions of an independent solver, good to ten digits, in
[tests/reference](../tests/reference/README.md).
"""


def shown(value, digits):
    return "-" if value is None else f"{value:.{digits}f}".replace("-", "−")


def page_of(rows):
    lines = ["| | published | ours | tolerance | source |", "|---|---|---|---|---|"]
    for r in rows:
        tolerance = "trend" if r["tolerance"] is None else f"{r['tolerance']:g}"
        lines.append(f"| {r['name']} | {shown(r['published'], r['digits'])} | {shown(r['ours'], r['digits'])} | {tolerance} | {r['source']} |")
    return HEAD + "\n".join(lines) + "\n" + TAIL


def differs(page, written):
    """Whether numbers of the two pages differ by more than one in the last digit."""
    number = re.compile(r"−?\d+\.?\d*")
    ours, theirs = (number.findall(text) for text in (page, written))
    if number.sub("", page) != number.sub("", written) or len(ours) != len(theirs):
        return True
    value = lambda text: float(text.replace("−", "-"))
    unit = lambda text: 10.0 ** -len(text.partition(".")[2])
    return any(abs(value(a) - value(b)) > 1.01 * unit(a) for a, b in zip(ours, theirs))


def draw(program, folder):
    with tempfile.TemporaryDirectory() as scratch:
        recording = pathlib.Path(scratch, "striker.h5")
        subprocess.run([program.path, "run", "striker", "--tap", "v_chain", "-o", recording], check=True, capture_output=True)
        subprocess.run([program.path, "plot", recording, "-o", folder / "validation-striker.png"], check=True, capture_output=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", required=True)
    where = parser.add_mutually_exclusive_group(required=True)
    where.add_argument("--out", type=pathlib.Path)
    where.add_argument("--check", type=pathlib.Path)
    options = parser.parse_args()
    program = Program(options.program)
    with concurrent.futures.ThreadPoolExecutor(2) as pool:
        rows = [r for result in pool.map(lambda experiment: experiment(program), EXPERIMENTS) for r in result]
    missed = [r for r in rows if r["tolerance"] is not None and not abs(r["ours"] - r["published"]) <= r["tolerance"]]
    for r in missed:
        print(f"{r['name']}: published {r['published']}, ours {r['ours']}, tolerance {r['tolerance']}", file=sys.stderr)
    page = page_of(rows)
    if options.out:
        options.out.write_text(page)
        draw(program, options.out.parent)
    elif differs(page, options.check.read_text()):
        print(f"{options.check} has other numbers; write it anew with --out", file=sys.stderr)
        return 1
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
