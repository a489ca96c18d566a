#!/usr/bin/env python3
"""What open pages of the live view take from a run (docs/view.md).

    bench/view_cost.py SEQUENCE [--camera fr1] [--program build/release/dkp-slam] [--rounds 3] [--pages 0,1,10] [--realtime]

Runs in turn without --view, with it and no page, and with so many pages, which ask for what a page in a
browser asks for: the stream of events, and with each of them numbers, map and the newest picture. Prints
medians over the rounds. The pages' own work, which is the browser's, is not counted as the program's.
Needs nothing but Python.
"""
import argparse
import csv
import json
import os
import re
import statistics
import struct
import subprocess
import sys
import tempfile
import threading
import urllib.request
from pathlib import Path

ROW = 25  # numbers of a frame, viewer/page/src/rows.js


class Page(threading.Thread):
    """One page, until the program ends."""

    def __init__(self, url):
        super().__init__(daemon=True)
        self.url = url
        self.updates = 0
        self.pictures = 0

    def load(self, path):
        with urllib.request.urlopen(self.url + path, timeout=20) as answer:
            data = answer.read()
        if not data:
            return None, b""
        (length,) = struct.unpack_from("<I", data)
        return json.loads(data[4 : 4 + length]), data[(4 + length + 7) // 8 * 8 :]

    def run(self):
        known = {"run": "", "frame": -1, "path": 0, "map": 0, "message": 0}
        try:
            with urllib.request.urlopen(self.url + "api/stream", timeout=60) as events:
                for line in events:
                    if line.strip():
                        self.pull(known)
        except (OSError, ValueError, EOFError):
            pass  # the program has ended

    def pull(self, known):
        query = "&".join(f"{key}={value}" for key, value in known.items())
        head, body = self.load(f"api/update?{query}")
        offset, size = head["sections"].get("frames", (0, 0))
        if size:
            known["frame"] = int(struct.unpack_from("<f", body, offset + size - 4 * ROW)[0])
        known.update(run=head["run"], path=head["path"], map=head["map"])
        if head["messages"]:
            known["message"] = head["messages"][-1]["number"]
        self.updates += 1
        if self.load("api/picture")[0]:
            self.pictures += 1


def one_run(arguments, pages, folder):
    """Figures of a run; `pages` None: without --view."""
    out = Path(folder) / "out"
    command = [arguments.program, "run", arguments.sequence, "--out", str(out), "--seed", "1"]
    command += ["--camera", arguments.camera] if arguments.camera else []
    command += ["--realtime"] if arguments.realtime else []
    command += [] if pages is None else ["--view"]
    child = subprocess.Popen(command, stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True)
    watching = []
    for line in child.stderr:
        found = re.match(r"view: (\S+)", line)
        if found and pages:
            watching = [Page(found[1]) for _ in range(pages)]
            for page in watching:
                page.start()
    _, status, usage = os.wait4(child.pid, 0)
    child.returncode = os.waitstatus_to_exitcode(status)
    if child.returncode != 0:
        sys.exit(f"{' '.join(command)}: exit code {child.returncode}")
    with open(out / "timings.csv", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    frames = len(rows)
    figures = {
        "processor": 1000.0 * (usage.ru_utime + usage.ru_stime) / frames,
        "frame": statistics.median(float(row["frame_ms"]) for row in rows),
        "tracking": statistics.median(float(row["tracking_ms"]) for row in rows),
        "updates": sum(page.updates for page in watching),
        "pictures": sum(page.pictures for page in watching),
    }
    return figures, (out / "trajectory.txt").read_bytes()


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("sequence")
    parser.add_argument("--camera")
    parser.add_argument("--program", default="build/release/dkp-slam")
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--pages", default="0,1,10")
    parser.add_argument("--realtime", action="store_true")
    arguments = parser.parse_args()
    cases = [None] + [int(count) for count in arguments.pages.split(",")]
    results = {case: [] for case in cases}
    paths = set()
    for _ in range(arguments.rounds):
        for case in cases:
            with tempfile.TemporaryDirectory() as folder:
                figures, path = one_run(arguments, case, folder)
            results[case].append(figures)
            paths.add(path)
    print("| | processor per frame [ms] | frame, median [ms] | tracking, median [ms] | updates | pictures |")
    print("|---|---|---|---|---|---|")
    plain = None
    for case in cases:
        median = {key: statistics.median(one[key] for one in results[case]) for key in results[case][0]}
        plain = plain or median
        name = "without `--view`" if case is None else f"{case} pages"
        cells = [f"{median[k]:.2f} ({100.0 * (median[k] / plain[k] - 1.0):+.1f} %)" for k in ("processor", "frame", "tracking")]
        print(f"| {name} | {' | '.join(cells)} | {median['updates']:.0f} | {median['pictures']:.0f} |")
    if not arguments.realtime:
        print(f"\n{'The same path, to the byte, in all runs.' if len(paths) == 1 else 'THE PATHS DIFFER.'}")


if __name__ == "__main__":
    main()
