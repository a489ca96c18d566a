#!/usr/bin/env python3
"""Measures the back end: places, relocalisation, loops, several maps, map files, a long run.

  back_end.py --data DIR [--work out/back_end] [--out out/back_end.md]

Prints tables in Markdown, for `dkp-slam-results --also`. DIR holds fr1_xyz, composite_xyz_walking
and composite_xyz_sitting. Generated sequences and runs are kept in --work; delete it to measure anew.
"""

import argparse
import csv
import json
import os
import pathlib
import statistics
import subprocess
import sys

import there_and_back

ROUNDS = 20


def stop(message):
    sys.exit(f"back_end.py: {message}")


def call(command, log):
    log.parent.mkdir(parents=True, exist_ok=True)
    with open(log, "w") as file:
        code = subprocess.run([str(c) for c in command], stdout=file, stderr=subprocess.STDOUT).returncode
    if code != 0:
        last = (log.read_text().splitlines() or [""])[-1]
        stop(f"{command[0]}: exit code {code}: {last} (all of it: {log})")
    return log.read_text()


def cut(source, out, keep, image=None):
    """Lists of the frames that `keep` (index, count) wants, images shared; those of `image`
    (index, count) name that file instead of their own."""
    out.mkdir(parents=True, exist_ok=True)
    for name in ("rgb", "depth", "groundtruth"):
        rows = there_and_back.entries(source / f"{name}.txt")
        if name != "groundtruth":
            link = out / name
            if not link.exists():
                link.symlink_to((source / name).resolve())
            rows = [(t, rest if not (image and image(i, len(rows))) else [f"black_{name}.png"])
                    for i, (t, rest) in enumerate(rows) if keep(i, len(rows))]
        (out / f"{name}.txt").write_text("".join(f"{t:.6f} {' '.join(r)}\n" for t, r in rows))
    return out


class Bench:
    def __init__(self, arguments):
        self.program = arguments.build / "dkp-slam"
        self.bench = arguments.build / "dkp-slam-bench"
        self.data, self.work, self.config = arguments.data, arguments.work, arguments.config
        for tool in (self.program, self.bench):
            if not tool.is_file():
                stop(f"{tool}: no such program; build it, or name its folder with --build")
        for name in ("fr1_xyz", "composite_xyz_walking", "composite_xyz_sitting"):
            if not (self.data / name / "groundtruth.txt").is_file():
                stop(f"{self.data / name}: no such sequence; see --data")

    def run(self, name, sequence, camera, *more):
        """Summary of a run, with its folder and frames; runs it unless it lies there already."""
        out = self.work / "runs" / name
        if not (out / "summary.json").is_file():
            print(f"{name} ...", file=sys.stderr, flush=True)
            call([self.program, "run", sequence, "--camera", camera, "--out", out, *more],
                 self.work / "logs" / f"{name}.txt")
        summary = json.loads((out / "summary.json").read_text())
        summary["folder"] = out
        with open(out / "timings.csv") as file:
            summary["rows"] = list(csv.DictReader(file))
        return summary

    def camera(self, global_shutter=False):
        """fr1's; played backward, a rolling shutter reads the rows the wrong way round."""
        camera = self.config / "tum_fr1.yaml"
        if not global_shutter:
            return camera
        lines = camera.read_text().splitlines()
        if not any(l.startswith("readout:") for l in lines):
            stop(f"{camera}: has no line `readout:`")
        path = self.work / "fr1_global.yaml"
        path.write_text("\n".join("readout: 0" if l.startswith("readout:") else l for l in lines) + "\n")
        return path

    def flat(self):
        out = self.work / "flat_loop"
        if not (out / "groundtruth.txt").is_file():
            print("synth flat_loop ...", file=sys.stderr, flush=True)
            call([self.program, "synth", "flat_loop", "--out", out], self.work / "logs" / "synth.txt")
        return out


def table(header, rows):
    lines = ["| " + " | ".join(header) + " |", "|" + "---|" * len(header)]
    return "\n".join(lines + ["| " + " | ".join(str(c) for c in row) + " |" for row in rows]) + "\n\n"


def outcome(name, s, said=""):
    return [name, s["options"]["mode"], s["frames"], s["lost_frames"], f"{s['ate']['rmse_m']:.4f}",
            s["keyframes"], s["landmarks"], s["loops_closed"], s.get("maps_joined", 0),
            len(s.get("maps", [0])), said]


def frames_until_found(summary, gap):
    """Of a run whose time stamps jump by more than `gap` seconds once: see `found_from` there."""
    rows = summary["rows"]
    times = [float(r["timestamp"]) for r in rows]
    first = next(i for i in range(1, len(times)) if times[i] - times[i - 1] > gap)
    return found_from(rows, first)


def found_from(rows, first):
    """Which frame, counted from 1 at row `first`, is the first localised one."""
    return next((i - first + 1 for i in range(first, len(rows)) if rows[i]["localised"] == "1"), "never")


def places(bench):
    log = bench.work / "logs" / "places.txt"
    if not log.is_file() or " | " not in log.read_text():
        print("places ...", file=sys.stderr, flush=True)
        call([bench.bench, "place", bench.data / "fr1_xyz", "--camera", bench.camera()], log)
    rows = []
    for line in log.read_text().splitlines():
        cells = [c.split() for c in line.split("|")]
        if len(cells) != 4 or not cells[0][0].isdigit():
            continue
        size, add, real = cells[0], cells[1], cells[3]
        rows.append([size[0], size[1], size[3], add[0], f"{real[0]} {real[1]}", real[2], real[4],
                     f"{real[5]} {real[6]}"])
    return ("### Places\n\nThe map of fr1_xyz's first half among generated keyframes; the frames of its "
            "second half ask. Processor time, median (99 %). Must: query <= 10 ms, memory <= 100 MB at "
            "2,000 keyframes.\n\n" +
            table(["keyframes", "landmarks", "memory MB", "add ms", "query ms", "right one first %",
                   "relocalised %", "relocalise ms"], rows))


def relocalisation(bench):
    fr1, camera = bench.data / "fr1_xyz", bench.camera()
    second = 30

    def middle(i, n, length):
        return n // 2 <= i < n // 2 + length

    gap = cut(fr1, bench.work / "fr1_cut", lambda i, n: not middle(i, n, 2 * second))
    jump = cut(fr1, bench.work / "fr1_jump", lambda i, n: not n // 4 <= i < 3 * n // 4)
    covered = cut(fr1, bench.work / "fr1_covered", lambda i, n: True, lambda i, n: middle(i, n, 2 * second))
    black(covered)
    rows = []
    for name, folder in (("2 s cut out", gap), ("jump over half of it", jump)):
        s = bench.run(f"relocalisation_{folder.name}", folder, camera, "--mode", "off")
        rows.append([name, frames_until_found(s, 1.0), s["lost_frames"], f"{s['ate']['rmse_m']:.4f}",
                     len(s.get("maps", [0]))])
    s = bench.run("relocalisation_fr1_covered", covered, camera, "--mode", "off")
    first = next(i + 1 for i in range(len(s["rows"]) - 1, 0, -1) if int(s["rows"][i]["features"]) == 0)
    rows.append(["covered for 2 s", found_from(s["rows"], first), s["lost_frames"],
                 f"{s['ate']['rmse_m']:.4f}", len(s.get("maps", [0]))])
    return ("### Relocalisation\n\nfr1_xyz, mode off. Found: at which frame of those that see the mapped "
            "place again; must: 3.\n\n" +
            table(["what", "found at frame", "frames lost", "ATE m", "maps"], rows))


def black(folder):
    """Images of a covered camera, without a library."""
    import struct
    import zlib

    def png(depth, channels, kind):
        def chunk(name, data):
            body = name + data
            return struct.pack(">I", len(data)) + body + struct.pack(">I", zlib.crc32(body))
        row = b"\0" * (1 + 640 * channels * depth // 8)
        return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", 640, 480, depth, kind, 0, 0, 0))
                + chunk(b"IDAT", zlib.compress(row * 480)) + chunk(b"IEND", b""))
    (folder / "black_rgb.png").write_bytes(png(8, 3, 2))
    (folder / "black_depth.png").write_bytes(png(16, 1, 0))


def sessions(bench):
    flat, fr1 = bench.flat(), bench.data / "fr1_xyz"
    camera, flat_camera = bench.camera(), flat / "camera.yaml"
    flat_cut = cut(flat, bench.work / "flat_cut", lambda i, n: not n * 2 // 5 <= i < n * 2 // 5 + 150)
    rows = []
    for mode in ("off", "dkp+"):
        rows.append(outcome("round a flat (generated)", bench.run(f"flat_{mode}", flat, flat_camera,
                                                                 "--mode", mode)))
    rows.append(outcome("the same, 5 s cut out", bench.run("flat_cut", flat_cut, flat_camera)))
    map_file = bench.work / "walking.map"
    walking = bench.data / "composite_xyz_walking"
    if not (bench.work / "runs" / "map_new" / "summary.json").is_file():
        for leftover in bench.work.glob("walking.map*"):
            leftover.unlink()
    s = bench.run("map_new", walking, camera, "--map", map_file)
    rows.append(outcome("composite_xyz_walking, new map file", s, f"{map_file.stat().st_size / 1e6:.1f} MB"))
    rows.append(outcome("fr1_xyz, goes on in that file",
                        bench.run("map_continued", fr1, camera, "--mode", "off", "--map", map_file)))
    before = map_file.read_bytes()
    s = bench.run("map_localized", bench.data / "composite_xyz_sitting", camera, "--localize", map_file)
    same = "file unchanged" if map_file.read_bytes() == before else "FILE CHANGED"
    rows.append(outcome("composite_xyz_sitting, localised in it", s, same))
    return ("### Loops, several maps, map files\n\n" +
            table(["session", "mode", "frames", "lost", "ATE m", "keyframes", "landmarks", "loops closed",
                   "maps joined", "maps", ""], rows))


def long_run(bench):
    folder = bench.work / "there_and_back"
    if not (folder / "rounds.txt").is_file():
        there_and_back.make(bench.data / "fr1_xyz", folder, ROUNDS)
    s = bench.run("there_and_back", folder, bench.camera(global_shutter=True), "--mode", "off")
    figures = list(there_and_back.rounds(folder, s["folder"], bench.program))
    rows = [[r["round"], r["frames"], r["localised"], f"{r['frame_ms']:.2f}", f"{r['tracking_ms']:.2f}",
             f"{r['decode_ms']:.2f}", r["keyframes"], f"{r['median_mb']:.1f}", f"{r['most_mb']:.1f}", f"{r['ate']:.4f}"]
            for r in figures]
    return (f"### A long run\n\nfr1_xyz forward and backward in turn, {ROUNDS} times, mode off. Must: the last "
            "round's frame time within 10 % of the first's, its ATE no worse, memory that has stopped "
            f"growing. Over the second half memory grew by {there_and_back.growth(figures):.2f} MB a round. "
            "Decoding knows nothing of the map: a round in which it is slower had a slower machine.\n\n"
            + table(["round", "frames", "localised", "frame ms", "tracking ms", "decoding ms",
                     "keyframes made", "memory MB, median", "most", "ATE m"], rows))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", type=pathlib.Path, default=os.environ.get("DKP_SLAM_DATA"))
    parser.add_argument("--work", type=pathlib.Path, default=pathlib.Path("out/back_end"))
    parser.add_argument("--out", type=pathlib.Path)
    parser.add_argument("--build", type=pathlib.Path, default=pathlib.Path("build/release"))
    parser.add_argument("--config", type=pathlib.Path, default=pathlib.Path("config"))
    arguments = parser.parse_args()
    if arguments.data is None:
        parser.error("the folder of the sequences is missing: --data, or DKP_SLAM_DATA")
    bench = Bench(arguments)
    page = "## Back end\n\n" + "".join(part(bench) for part in (places, relocalisation, sessions, long_run))
    page += f"Made by `{' '.join(sys.argv)}`.\n"
    if arguments.out:
        arguments.out.write_text(page)
    print(page)


if __name__ == "__main__":
    main()
